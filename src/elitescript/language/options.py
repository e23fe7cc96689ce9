"""Kinds of text, and options for reading one."""

from __future__ import annotations

from typing import Final

from elitescript.records import record

PROGRAM: Final = "program"
"""`def name(): ... end`: the body runs, the name is a label."""
SECONDARY: Final = "secondary"
"""`sec name(): ... end`: runs beside the program."""
SCRIPT: Final = "script"
"""Statements without a `def` around them; they run as if they had one."""
LINE: Final = "line"
"""One statement, as network clients send them."""

KINDS: Final = (PROGRAM, SECONDARY, SCRIPT, LINE)


@record
class Options:
    """Options for reading and compiling a text.

    Args:
        strict: refuse what only this implementation accepts (remains of Python 2, late `global`).
        kind: one of `KINDS` when the caller knows what the text must be; None to determine it.
        one_line_blocks: accept `def f(): ; a() ; end` on a single line, as the interpreter
            channel does.
        probes: count statements: `steps` for a debugger, `coverage`; see `language.probes`. Empty for not.
        first_probe: number of the first of them.
        ignored: codes of findings that `check` leaves out.
    """

    strict: bool = False
    kind: str | None = None
    one_line_blocks: bool = False
    probes: str = ""
    first_probe: int = 0
    ignored: frozenset[str] = frozenset()


DEFAULT: Final = Options()
