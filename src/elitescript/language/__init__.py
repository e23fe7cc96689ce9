"""The language: text in, Python code out. Knows no robot, no clock and no catalogue.

Import the module you need; this package imports nothing by itself.

    source       the text of a program, its lines
    diagnostics  what is wrong with it, where, and how to repair it
    lexer        strings, comments, brackets, logical lines
    dialect      what EliteScript has beyond Python, rewritten without moving a line
    parser       text to syntax tree, several errors in one pass
    units        which kind of program a text is; cutting a byte stream into programs
    policy       what scripts may name
    checkpoints  where a running script can be paused, stopped and counted
    symbols      scopes, names and calls, for tools
    compiler     all of the above in one call
"""
