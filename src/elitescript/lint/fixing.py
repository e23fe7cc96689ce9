"""Repairs a text where the meaning is certain."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.language.diagnostics import Diagnostic, Edit
from elitescript.language.text.source import SourceFile, apply_fixes
from elitescript.lint.engine import check_source
from elitescript.messages.profile import Profile
from elitescript.records import NamedTuple

_MOST_PASSES: Final = 20
"""Limit of passes; a repair may uncover the next mistake."""


class Repair(NamedTuple):
    """A repair that was made, with the place as it was when it was made."""

    line: int
    code: str
    title: str


def repaired(name: str, text: str, profile: Profile, *, strict: bool = False) -> tuple[str, tuple[Repair, ...]]:
    """Return a text with its safe fixes made, and the repairs; line ends and byte order mark stay as they are.

    A repair that would leave more errors than before is not made. Repairing the result again changes nothing.

    Args:
        name: of the text.
        text: as it stands in the file.
        profile: the firmware that it is for.
        strict: how it is checked.
    """
    done: list[Repair] = []
    refused: set[tuple[str, int, int]] = set()
    problems = check_source(SourceFile(name, text), profile, strict=strict)
    for _ in range(_MOST_PASSES):
        chosen = apart([problem for problem in problems if _key(problem) not in refused and _is_safe(problem)])
        if not chosen:
            break
        new = apply_fixes(text, [problem.fix for problem in chosen if problem.fix is not None])
        found = check_source(SourceFile(name, new), profile, strict=strict)
        if new == text or _errors(found) > _errors(problems):
            refused.update(map(_key, chosen))
            continue
        done += [Repair(problem.line, problem.code, problem.fix.title) for problem in chosen if problem.fix is not None]
        text, problems = new, found
    return text, tuple(done)


def _is_safe(problem: Diagnostic) -> bool:
    return problem.fix is not None and problem.fix.safe


def _key(problem: Diagnostic) -> tuple[str, int, int]:
    return problem.code, problem.line, problem.column


def _errors(problems: tuple[Diagnostic, ...]) -> int:
    return sum(problem.is_error for problem in problems)


def apart(problems: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return those whose fixes do not touch the same text; the others are left for the next pass."""
    taken: list[Edit] = []
    chosen = []
    for problem in problems:
        edits = problem.fix.edits if problem.fix is not None else ()
        if not any(_meet(edit, other) for edit in edits for other in taken):
            taken += edits
            chosen.append(problem)
    return chosen


def _meet(one: Edit, other: Edit) -> bool:
    return one[:2] <= other[2:4] and other[:2] <= one[2:4]
