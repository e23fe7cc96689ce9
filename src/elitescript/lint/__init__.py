"""What `check` finds beyond what keeps a program from starting.

Import the module you need; this package imports nothing by itself.

    engine       a text in, all problems out
    registry     what a rule is, and all of them
    program      what rules look at: the tree, its names, the firmware
    constants    expressions whose value is certain before the run
    arguments    calls of commands, their arguments in order
    repetition   what a loop does that matters for how it ends
    kinds        whether six numbers are joint positions or a pose
    places       where the arm would be, for targets that are certain
    suppression  `# check: ignore`
    rules        one file for each rule
"""
