"""Offers repairs of findings and small rewritings."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import SequenceMatcher
from enum import StrEnum

from elitescript.assist.cursor import Cursor
from elitescript.assist.document import Document
from elitescript.language.diagnostics import Diagnostic, Edit
from elitescript.lint.fixing import apart, repaired
from elitescript.lint.program import Span
from elitescript.lint.suppression import can_be_hidden, hiding
from elitescript.records import record


class ActionKind(StrEnum):
    """Kind of an action, as the protocol of editors names it."""

    QUICK_FIX = "quickfix"
    REWRITE = "refactor.rewrite"
    FIX_ALL = "source.fixAll"


@record
class CodeAction:
    """One action.

    Attributes:
        title: what the menu shows.
        kind: of the action.
        edits: what changes, all at once: they do not overlap, and none counts on another.
        problems: the findings that it repairs.
        is_preferred: it is the repair that is certainly meant.
    """

    title: str
    kind: ActionKind
    edits: tuple[Edit, ...]
    problems: tuple[Diagnostic, ...] = ()
    is_preferred: bool = False


def code_actions(document: Document, span: Span) -> tuple[CodeAction, ...]:
    """Return repairs and rewritings for a range, the preferred ones first; `fix_all` is apart. Never raises.

    Args:
        document: the text.
        span: the range. An empty one, a cursor, stands for its whole line where it touches no finding.
    """
    return tuple(sorted(_actions(document, span), key=lambda action: not action.is_preferred))


def fix_all(document: Document) -> CodeAction | None:
    """Return the action that makes every safe fix of the text, as `check --fix`; None if there is none.

    It checks the text several times, so it is only made when it is asked for.
    """
    if not any(problem.fix is not None and problem.fix.safe for problem in document.problems):
        return None
    settings = document.settings
    text = document.source.text
    new, repairs = repaired(document.name, text, settings.profile, strict=settings.strict)
    if not repairs:
        return None
    problems = tuple(problem for problem in document.problems if problem.fix is not None and problem.fix.safe)
    count = len(repairs)
    title = f"Make {count} safe repair{'' if count == 1 else 's'}"
    return CodeAction(title, ActionKind.FIX_ALL, _changed_lines(text, new), problems)


def _actions(document: Document, span: Span) -> Iterator[CodeAction]:
    here = [problem for problem in document.problems if _meets(problem, span)]
    if not here and span[:2] == span[2:]:
        here = [problem for problem in document.problems if problem.line == span.line]
    for problem in here:
        if problem.fix is not None:
            yield CodeAction(
                _capital(problem.fix.title), ActionKind.QUICK_FIX, problem.fix.edits, (problem,), problem.fix.safe
            )
    for code in dict.fromkeys(problem.code for problem in here if problem.fix is not None):
        alike = apart([problem for problem in document.problems if problem.code == code and problem.fix is not None])
        if len(alike) > 1:
            edits = tuple(edit for problem in alike if problem.fix is not None for edit in problem.fix.edits)
            yield CodeAction(f"Repair all {len(alike)} of {code}", ActionKind.QUICK_FIX, edits, tuple(alike))
    yield from _missing_ends(document, span, here)
    for code, problem in {problem.code: problem for problem in reversed(here)}.items():
        edit = _suppression(document, problem)
        if edit is not None:
            yield CodeAction(f"Ignore {code} in line {problem.line}", ActionKind.QUICK_FIX, (edit,), (problem,))


def _meets(problem: Diagnostic, span: Span) -> bool:
    """Return whether a finding and a range have a place in common; touching is enough."""
    start, end = (problem.line, problem.column), (problem.end_line, problem.end_column)
    return start <= span[2:] and span[:2] <= end


def _missing_ends(document: Document, span: Span, here: list[Diagnostic]) -> Iterator[CodeAction]:
    """Yield the insertion of `end` for blocks that begin in the range and have none."""
    repaired_lines = {problem.line for problem in here if problem.code == "W216"}
    for block in document.translation.ends:
        line, last = block.opener.line, block.last.last_line
        if block.has_end or not block.word or not span.line <= line <= span.end_line or line in repaired_lines:
            continue
        row = document.line(line)
        column = len(document.line(last)) + 1
        edit = Edit(last, column, last, column, f"\n{row[: len(row) - len(row.lstrip())]}end")
        yield CodeAction(f"Close the `{block.word}` with `end`", ActionKind.REWRITE, (edit,))


def _suppression(document: Document, problem: Diagnostic) -> Edit | None:
    """Return the edit that adds the comment which hides a finding; None where none can stand or none would help."""
    row = document.line(problem.line)
    is_inside = Cursor(document, problem.line, len(row) + 1).string is not None or row.rstrip().endswith("\\")
    if is_inside or not can_be_hidden(problem):
        return None
    start, end, text = hiding(problem, row, document.code_line(problem.line))
    return Edit(problem.line, start + 1, problem.line, end + 1, text)


def _changed_lines(old: str, new: str) -> tuple[Edit, ...]:
    """Return edits of whole lines that make one text of another."""
    before, after = old.split("\n"), new.split("\n")
    edits = []
    for what, first, last, begin, end in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if what == "equal":
            continue
        lines = "".join(f"{row}\n" for row in after[begin:end])
        if last < len(before):
            edits.append(Edit(first + 1, 1, last + 1, 1, lines))
        elif first:
            text = "".join(f"\n{row}" for row in after[begin:end])
            edits.append(Edit(first, len(before[first - 1]) + 1, last, len(before[last - 1]) + 1, text))
        else:
            edits.append(Edit(1, 1, last, len(before[last - 1]) + 1, new))
    return tuple(edits)


def _capital(title: str) -> str:
    return title[:1].upper() + title[1:]
