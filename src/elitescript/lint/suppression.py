"""Hides findings on lines with `# check: ignore`.

`# check: ignore` hides every finding on its line, `# check: ignore[W203, E305]` those with these codes. What
keeps the program from starting cannot be hidden.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from elitescript.language.diagnostics import Diagnostic
from elitescript.language.text.lexer import lex
from elitescript.language.text.source import SourceFile

_MARK = "check:"


def without_suppressed(problems: Iterable[Diagnostic], source: SourceFile) -> list[Diagnostic]:
    """Return the problems that no comment hides."""
    found = list(problems)
    if _MARK not in source.text:
        return found
    hidden = _suppressions(source)
    return [problem for problem in found if not _is_hidden(problem, hidden)]


def _is_hidden(problem: Diagnostic, hidden: dict[int, frozenset[str]]) -> bool:
    codes = hidden.get(problem.line)
    if codes is None or (problem.is_error and problem.code[:2] in ("E0", "E1")):
        return False
    return not codes or problem.code in codes


def _suppressions(source: SourceFile) -> dict[int, frozenset[str]]:
    """Return by line the codes that are hidden there; none means all of them."""
    pattern = re.compile(r"#\s*check:\s*ignore\b(?:\s*\[(?P<codes>[^\]]*)\])?")
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
