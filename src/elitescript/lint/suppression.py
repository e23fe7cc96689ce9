"""Hides findings on lines with `# check: ignore`, those of `check` and those of runs.

`# check: ignore` hides every finding on its line, `# check: ignore[W203, E305]` those with these codes. What
keeps the program from starting cannot be hidden.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache, lru_cache

from elitescript.language.diagnostics import Diagnostic
from elitescript.language.text.masked import lex
from elitescript.language.text.source import SourceFile

_MARK = "check:"


def without_suppressed(
    problems: Iterable[Diagnostic], source: SourceFile, ignored: frozenset[str] = frozenset()
) -> list[Diagnostic]:
    """Return the problems that no comment hides, and whose codes are not ignored."""
    found = [problem for problem in problems if problem.code not in ignored or not can_be_hidden(problem)]
    if _MARK not in source.text:
        return found
    hidden = _suppressions(source)
    return [problem for problem in found if not _is_hidden(problem, hidden)]


def hides(source: SourceFile, line: int, code: str) -> bool:
    """Return whether a comment in a line hides what a run finds there; without a code only one that hides all."""
    if _MARK not in source.line(line):
        return False
    codes = _kept_suppressions(source).get(line)
    return codes is not None and (not codes or code in codes)


def can_be_hidden(problem: Diagnostic) -> bool:
    """Return whether a comment can hide a problem."""
    return not (problem.is_error and problem.code[:2] in ("E0", "E1"))


def hiding(problem: Diagnostic, row: str, masked: str) -> tuple[int, int, str]:
    """Return the comment that hides a problem: start and end, from 0, of what it replaces in a row, and the text.

    Args:
        problem: one that can be hidden.
        row: the line in which it begins.
        masked: the same without what is in strings and comments.
    """
    found = _pattern().search(row, len(masked.rstrip()))
    if found is None:
        end = len(row.rstrip())
        return end, len(row), f"{'  ' if end else ''}# {_MARK} ignore[{problem.code}]"
    codes = [*(found["codes"] or "").replace(",", " ").split(), problem.code]
    return found.start(), found.end(), f"# {_MARK} ignore[{', '.join(dict.fromkeys(codes))}]"


def _is_hidden(problem: Diagnostic, hidden: dict[int, frozenset[str]]) -> bool:
    codes = hidden.get(problem.line)
    return codes is not None and can_be_hidden(problem) and (not codes or problem.code in codes)


@cache
def _pattern() -> re.Pattern[str]:
    return re.compile(r"#\s*check:\s*ignore\b(?:\s*\[(?P<codes>[^\]]*)\])?")


@lru_cache(maxsize=8)
def _kept_suppressions(source: SourceFile) -> dict[int, frozenset[str]]:
    return _suppressions(source)


def _suppressions(source: SourceFile) -> dict[int, frozenset[str]]:
    """Return by line the codes that are hidden there; none means all of them."""
    pattern = _pattern()
    lexed = lex(source.text)
    found = {}
    for number, row in enumerate(source.lines, 1):
        if _MARK not in row:
            continue
        match = pattern.search(row)
        # Comments are blank in the masked text; what a string holds is not.
        if match and not lexed.masked_row(number)[match.start() :].strip():
            found[number] = frozenset((match["codes"] or "").replace(",", " ").split())
    return found
