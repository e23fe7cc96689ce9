"""Coverage as a table for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from elitescript.coverage.model import Numbers, ProgramCoverage, percent_text, total
from elitescript.coverage.unmet import Unmet
from elitescript.shown import shown, shown_word

HEADER = ("Program", "Lines", "Missed", "Branches", "Missed", "Functions", "Cover")


def table(programs: Sequence[ProgramCoverage], *, shows_missing: bool = False) -> list[str]:
    """Return the lines of the table: a row for each program, and one for all.

    Args:
        programs: what was run of them.
        shows_missing: name the lines that never ran and the ways that were never taken.
    """
    rows = [(shown_word(program.path), *_cells(program.numbers)) for program in programs]
    rows.append(("TOTAL", *_cells(total(programs))))
    widths = [max(len(row[column]) for row in (HEADER, *rows)) for column in range(len(HEADER))]
    out = []
    for row in (HEADER, *rows):
        cells = [row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]
        out.append("   ".join(cells))
    if shows_missing:
        out[0] += "   Missing"
        for index, program in enumerate(programs, 1):
            if text := missing_text(program):
                out[index] += f"   {text}"
    rule = "-" * len(out[0])
    return [out[0], rule, *out[1:-1], rule, out[-1]] if programs else []


def _cells(numbers: Numbers) -> tuple[str, ...]:
    return (
        str(numbers.lines),
        str(numbers.lines - numbers.lines_hit),
        str(numbers.branches),
        str(numbers.branches - numbers.branches_hit),
        f"{numbers.functions_hit}/{numbers.functions}",
        percent_text(numbers.percent),
    )


def missing_text(program: ProgramCoverage) -> str:
    """Return the lines that never ran, and the ways never taken from lines that ran: `3-5, 9->11`.

    Of a graphical program, the nodes that never ran, and those with such a way: `4 MoveJ > 5 W1, 7 If (12->14)`.
    """
    if program.places:
        return ", ".join(shown(text) for text in _missing_nodes(program))
    parts = [(first, str(first) if first == last else f"{first}-{last}") for first, last in _spans(program)]
    parts += [(branch.line, branch.text) for branch in program.missed_branches]
    return ", ".join(text for _, text in sorted(parts))


def _missing_nodes(program: ProgramCoverage) -> Iterator[str]:
    yield from (node.place for node in program.nodes if not node.hits)
    for branch in program.missed_branches:
        if place := program.place(branch.line):
            yield f"{place} ({branch.text})"


def _spans(program: ProgramCoverage) -> Iterator[tuple[int, int]]:
    """Return first and last line of each row of lines that never ran, with nothing that ran between them."""
    first = last = 0
    for line, hits in sorted(program.lines.items()):
        if not hits:
            first, last = first or line, line
        elif first:
            yield first, last
            first = 0
    if first:
        yield first, last


def unmet_lines(unmet: Unmet) -> list[str]:
    """Return what no test has met, as lines of text; empty if there is nothing."""
    out: list[str] = []
    for title, items in unmet.sections():
        if items:
            out += [f"{title}:", *(f"  {shown(item)}" for item in items)]
    return out
