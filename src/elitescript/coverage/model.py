"""What tests have run of one program: lines, branches, functions and handlers, each with its count."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from elitescript.records import field, record


@record
class Branch:
    """One way on from a line that decides.

    Attributes:
        line: the deciding line.
        to: first line of the statements on this way; None if it leads past the block.
        hits: how often it was taken; None if its line was never reached.
    """

    line: int
    to: int | None
    hits: int | None

    @property
    def text(self) -> str:
        """The way in short, as `12->14` or `12->exit`."""
        return f"{self.line}->{'exit' if self.to is None else self.to}"


@record
class Function:
    """A function of a program: qualified name, first and last line, number of calls."""

    name: str
    line: int
    last_line: int
    hits: int


@record
class Handler:
    """An `except` clause, and how often it was entered."""

    line: int
    text: str
    hits: int


@record
class NodeCoverage:
    """A node of a graphical program: where it is, as people say it, and how often it began."""

    place: str
    hits: int


@record
class ProgramCoverage:
    """What tests have run of one program.

    Attributes:
        path: of the program, relative to the root folder, with `/`.
        source: its lines.
        lines: how often each line that begins a statement ran.
        branches: in the order of the text.
        functions: in the order of the text.
        handlers: in the order of the text.
        places: of a graphical program, the node of each line.
        file_lines: of a graphical program, the line of its file in which the node of each line begins.
    """

    path: str
    source: tuple[str, ...]
    lines: Mapping[int, int] = field(default_factory=dict)
    branches: tuple[Branch, ...] = ()
    functions: tuple[Function, ...] = ()
    handlers: tuple[Handler, ...] = ()
    places: tuple[str, ...] = ()
    file_lines: tuple[int, ...] = ()

    @property
    def nodes(self) -> tuple[NodeCoverage, ...]:
        """The nodes of a graphical program that have statements, in the order of its script."""
        found: dict[str, int] = {}
        for line, hits in sorted(self.lines.items()):
            if place := self.place(line):
                # How often its first statement ran: that of a loop, not of its turns.
                found.setdefault(place, hits)
        return tuple(NodeCoverage(place, hits) for place, hits in found.items())

    def place(self, line: int) -> str:
        """Return the node of a line; empty for a program that is no tree, and a line that belongs to none."""
        return self.places[line - 1] if 0 < line <= len(self.places) else ""

    def in_file(self) -> ProgramCoverage:
        """Return it by lines of the file: of a graphical program, those in which its nodes begin.

        A line has the least count of its nodes, so that one that never ran shows.
        """
        if not self.file_lines:
            return self
        lines: dict[int, int] = {}
        seen: set[str] = set()
        for line, hits in sorted(self.lines.items()):
            place = self.place(line)
            if place and place not in seen:
                seen.add(place)
                there = self.file_lines[line - 1]
                lines[there] = min(lines.get(there, hits), hits)
        return ProgramCoverage(self.path, self.source, lines)

    @property
    def numbers(self) -> Numbers:
        """Counts and share of this program."""
        return Numbers(
            lines=len(self.lines),
            lines_hit=sum(map(bool, self.lines.values())),
            branches=len(self.branches),
            branches_hit=sum(bool(branch.hits) for branch in self.branches),
            functions=len(self.functions),
            functions_hit=sum(bool(function.hits) for function in self.functions),
        )

    @property
    def missed_lines(self) -> list[int]:
        """Lines that never ran."""
        return [line for line, hits in sorted(self.lines.items()) if not hits]

    def branches_of(self, line: int) -> list[Branch]:
        """Return the ways on from a line; empty if it decides nothing."""
        return [branch for branch in self.branches if branch.line == line]

    @property
    def missed_branches(self) -> list[Branch]:
        """Ways never taken from lines that were reached."""
        return [branch for branch in self.branches if branch.hits == 0]


@record
class Numbers:
    """How many lines, branches and functions there are, and how many of them tests have run."""

    lines: int = 0
    lines_hit: int = 0
    branches: int = 0
    branches_hit: int = 0
    functions: int = 0
    functions_hit: int = 0

    @property
    def percent(self) -> float:
        """Share of lines and branches together that were run, as coverage.py counts, 0 to 100; 100 of nothing."""
        all_of_them = self.lines + self.branches
        return 100.0 * (self.lines_hit + self.branches_hit) / all_of_them if all_of_them else 100.0


def total(programs: Iterable[ProgramCoverage]) -> Numbers:
    """Return the numbers of several programs together."""
    numbers = [program.numbers for program in programs]
    return Numbers(
        lines=sum(row.lines for row in numbers),
        lines_hit=sum(row.lines_hit for row in numbers),
        branches=sum(row.branches for row in numbers),
        branches_hit=sum(row.branches_hit for row in numbers),
        functions=sum(row.functions for row in numbers),
        functions_hit=sum(row.functions_hit for row in numbers),
    )


def percent_text(percent: float) -> str:
    """Return a share in whole percent; 0 and 100 stand for nothing and everything only."""
    return f"{0 if percent == 0 else 100 if percent == 100 else min(99, max(1, round(percent)))}%"
