"""Lists built-ins of Python: those that a program does not get, and those that only give a value."""

from __future__ import annotations

from typing import Final

REFUSED_BUILTINS: Final = {
    "breakpoint": "the robot has no debugger on a terminal",
    "compile": "eval() computes an expression, exec() runs statements",
    "globals": "a program's globals are its `global` names",
    "help": "see `elitescript commands NAME`",
    "locals": "name the variables one by one",
    "memoryview": "bytes and bytearray hold binary data",
    "vars": "name the attributes one by one",
}
"""Built-ins that lead to hidden objects or to the computer, with their replacements."""

WITHHELD_ERRORS: Final = frozenset(
    ("BaseExceptionGroup", "ExceptionGroup", "KeyboardInterrupt", "PythonFinalizationError")
)
"""Not for scripts: groups can rebuild uncatchable exceptions, an interrupt belongs to the user."""

PURE_BUILTINS: Final = frozenset(
    """
    abs all any bin bool bytearray bytes chr complex dict divmod enumerate float format frozenset hash hex id int
    isinstance len list long max min oct ord pow range repr reversed round set sorted str sum tuple type unichr zip
    """.split()  # noqa: SIM905
)
"""Built-in functions that only give a value."""
