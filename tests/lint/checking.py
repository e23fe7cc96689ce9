"""Programs in, findings out, in the form in which the tests of the checker compare them."""

from __future__ import annotations

from textwrap import dedent

from elitescript.language.diagnostics import Diagnostic
from elitescript.language.text.source import SourceFile, apply_fixes
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile


def problems(text: str, *, firmware: str = "2.14", strict: bool = False) -> tuple[Diagnostic, ...]:
    """All problems of a text; its common indentation is taken away."""
    return check_source(SourceFile("<test>", source(text)), profile(firmware), strict=strict)


def source(text: str) -> str:
    """A text as the tests write it, without the indentation and the first empty line."""
    return dedent(text).removeprefix("\n")


def found(text: str, *, firmware: str = "2.14", strict: bool = False) -> list[str]:
    """`CODE line:column` of every problem."""
    return [f"{p.code} {p.line}:{p.column}" for p in problems(text, firmware=firmware, strict=strict)]


def body(*lines: str, firmware: str = "2.14") -> list[str]:
    """`found` for the lines of a program's body, which count from 2 and begin in column 3."""
    return found("def job():\n" + "".join(f"  {line}\n" for line in lines) + "end\n", firmware=firmware)


def only(text: str, *, firmware: str = "2.14", strict: bool = False) -> Diagnostic:
    """The only problem of a text."""
    (problem,) = problems(text, firmware=firmware, strict=strict)
    return problem


def repaired(text: str) -> str:
    """The text with the fix of its only problem."""
    problem = only(text)
    assert problem.fix is not None
    return apply_fixes(source(text), [problem.fix])


def marked(text: str) -> str:
    """What the only problem of a text underlines, on its first line."""
    problem = only(text)
    row = source(text).split("\n")[problem.line - 1]
    return row[problem.column - 1 : problem.end_column - 1 if problem.end_line == problem.line else None]
