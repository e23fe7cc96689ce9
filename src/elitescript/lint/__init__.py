"""Static checks of `check`, beyond the errors that keep a program from starting.

Import the module you need; this package imports nothing by itself.

    engine       checks a text with all rules
    registry     what a rule is, and all of them
    program      the input of rules: the tree, its names, the firmware
    constants    expressions whose value is certain before the run
    arguments    calls of commands, their arguments in order
    repetition   what a loop calls and changes, and how it ends
    kinds        whether six numbers are joint positions or a pose
    places       where the arm would be, for targets that are certain
    suppression  `# check: ignore`
    rules        one file for each rule
"""
