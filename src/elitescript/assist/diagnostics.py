"""Lists the findings of a text as editors show them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from typing import Final

from elitescript.assist.document import Document
from elitescript.assist.same_lines import same_lines
from elitescript.language.diagnostics import Diagnostic
from elitescript.lint.program import Span
from elitescript.lint.registry import codes_of_values
from elitescript.records import NamedTuple, record, replace

RULES_PAGE: Final = "https://github.com/elitescript/elitescript/blob/main/docs/reference/rules.md"
"""Page with what `check --explain` prints of each code. The public address of the repository is assumed."""


class Tag(StrEnum):
    """How an editor shows the text of a finding."""

    UNNECESSARY = "unnecessary"
    """Faded: it can be removed."""
    DEPRECATED = "deprecated"
    """Struck through: it belongs to Python 2 or to another language."""


TAGS: Final = {
    **dict.fromkeys(("W206", "W207", "W218"), Tag.UNNECESSARY),
    **dict.fromkeys(("E106", "E110", "E111", "E112", "E114", "W209", "W211"), Tag.DEPRECATED),
}
"""The codes whose findings have a tag."""


class Related(NamedTuple):
    """Another place that belongs to a finding, or what to do about it.

    Attributes:
        span: the place.
        text: what to do about the finding; or the line that its text names.
    """

    span: Span
    text: str


@record
class Problem:
    """A finding with what editors show beside it.

    Attributes:
        diagnostic: code, severity, place, text, hint and repair: what `check` prints.
        tags: how it is shown.
        related: the hint, at the place of the finding, and the lines that the text names.
        page: address of the explanation of its code, which is what `check --explain` prints.
    """

    diagnostic: Diagnostic
    tags: tuple[Tag, ...]
    related: tuple[Related, ...]
    page: str


def diagnostics(document: Document) -> tuple[Problem, ...]:
    """Return the findings of a text, in its order: the same as those of `check`.

    Raises:
        Outdated: there is a next version.
    """
    return tuple(_shown(document, found) for found in document.problems)


def quick_diagnostics(document: Document) -> tuple[Problem, ...]:
    """Return those of the findings of a text that need no values of expressions, in its order.

    Raises:
        Outdated: there is a next version.
    """
    return tuple(_shown(document, found) for found in document.quick_problems)


def kept(earlier: Sequence[str], findings: Iterable[Diagnostic], document: Document) -> tuple[Problem, ...]:
    """Return the findings of an earlier version that took values of expressions, of lines that have not changed since.

    Args:
        earlier: the lines of that version.
        findings: what was found in it.
        document: the text now, whose values are not known yet.
    """
    codes = codes_of_values()
    same = same_lines(earlier, document.source.lines)
    found = []
    for finding in findings:
        line, end_line = same.now(finding.line), same.now(finding.end_line)
        if finding.code in codes and line and end_line - line == finding.end_line - finding.line:
            found.append(replace(finding, line=line, end_line=end_line, fix=None))
    return tuple(_shown(document, finding) for finding in found)


def _shown(document: Document, found: Diagnostic) -> Problem:
    return Problem(
        found,
        (TAGS[found.code],) if found.code in TAGS else (),
        tuple(_related(document, found)),
        f"{RULES_PAGE}#{found.code.lower()}",
    )


def _related(document: Document, found: Diagnostic) -> Iterator[Related]:
    if found.hint:
        begin = document.place(document.offset(found.line, found.column))
        end = document.place(document.offset(found.end_line, found.end_column))
        yield Related(Span(*begin, *max(begin, end)), f"hint: {found.hint}")
    for named in dict.fromkeys(re.findall(r"\blines? (\d+)", found.text)):
        line = int(named)
        row = document.line(line)
        if line != found.line and row.strip():
            start = len(row) - len(row.lstrip()) + 1
            yield Related(Span(line, start, line, len(row.rstrip()) + 1), f"line {line}: {row.strip()}")
