"""Compiles EliteScript text to Python code. Depends on no robot, clock or catalogue.

Import the module you need; this package imports nothing by itself. From text to code:

    text.source   the text of a program, its lines
    options       kinds of text, and how strictly one is read
    text.lexer    logical lines, comments and brackets; `strings` and `masked` help it
    text.dialect  what EliteScript has beyond Python, rewritten without moving a line, by
                  `blocks` (indentation, `end`, `sec`), `advice.python2`, `advice.foreign` (other languages)
                  and `rewriting` (the author's positions)
    parser        text to syntax tree, several mistakes in one pass; `advice.syntax_errors`
                  rewords Python's messages
    policy        what programs may name; `nodes` is the table of known syntax
    checkpoints   where a running program can be paused, stopped and counted
    hoisting      `global` statements that come late
    compiler      all of the above in one call

Beside that: `diagnostics` (what is wrong, where, and the repair), `text.units` (programs in a stream of
bytes) with `kinds`, `symbols` with `scopes` (names and calls, for tools), `hooks` (hidden names)
and `modules` (what a program can import).
"""
