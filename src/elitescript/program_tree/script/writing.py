"""The text of a script while it is written: lines with the row that each belongs to, blocks, and what went wrong."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

from elitescript.program_tree.cells import Expression, Pose, UnknownCell, number_text
from elitescript.program_tree.configuration import Configuration
from elitescript.program_tree.nodes import Move
from elitescript.program_tree.rows import Row
from elitescript.records import record
from elitescript.said import said

LOOPS_MAX: Final = 20
"""Loops in each other that Python compiles."""
BLOCKS_MAX: Final = 98
"""Blocks in each other."""


@record
class Problem:
    """Why a node cannot be generated, or what is not known about its text.

    Attributes:
        row: number of the row; 0: the task as a whole.
        text: what is wrong.
        is_error: the task cannot run.
        hint: what to do.
        code: of the rule that found it; empty: it was found while the script was written.
    """

    row: int
    text: str
    is_error: bool = True
    hint: str = ""
    code: str = ""


class Script:
    """A script that is being written.

    Attributes:
        name: of the task, as a name of the language.
        lines, rows: the lines and the number of the row of each; 0: none.
        problems: found on the way.
        move: the move around what is written now.
        body: writes the nodes of rows, one after the other.
        shared: returns the variables of the task that a node, or one in it, sets.
    """

    __slots__ = (
        "body",
        "codes",
        "configuration",
        "has_direction",
        "level",
        "lines",
        "loops",
        "move",
        "name",
        "problems",
        "rows",
        "shared",
        "title",
    )

    def __init__(
        self, name: str, title: str, configuration: Configuration, body: Callable[[Script, tuple[Row, ...]], None]
    ) -> None:
        self.name = name
        self.body = body
        self.shared: Callable[[Row], tuple[str, ...]] = lambda row: ()
        self.title = title
        self.configuration = configuration
        self.lines: list[str] = []
        self.rows: list[int] = []
        self.problems: list[Problem] = []
        self.level = 0
        self.loops = 0
        self.codes = 0
        """Statements so far."""
        self.move = Move()
        self.has_direction = False

    # ------------------------------------------------------------ lines

    def line(self, text: str, row: Row | None = None) -> None:
        """Write a statement."""
        self.codes += 1
        self.comment(text, row)

    def comment(self, text: str, row: Row | None = None) -> None:
        """Write a line that is no statement."""
        self.lines.append(f"{'  ' * self.level}{text}")
        self.rows.append(row.number if row is not None else 0)

    def mark(self, row: Row, *, is_after: bool = False) -> None:
        """Write the mark of a row; `is_after`: a stop at this row is behind its motion."""
        text = row.mark.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ")
        after = ', "after"' if is_after else ""
        self.comment(f'$ LINE: ({row.number}, "{text}"{after})', row)

    def text(self, text: str, row: Row) -> None:
        """Write text of a user: each line with the indentation in front, also an empty one."""
        text = text.replace("\r\n", "\n").replace("\r", "\n").removesuffix("\n")
        for line in text.split("\n"):
            self.comment(line, row)
            self.codes += bool(line.strip()) and not line.lstrip().startswith("#")

    @contextmanager
    def block(self, head: str, row: Row | None, *, is_loop: bool = False, end: bool = True) -> Iterator[None]:
        """Write a block: its head, what is written inside, and `end`; `pass`, if that holds no statement."""
        self.line(head, row)
        with self.inside(row, is_loop=is_loop):
            yield
        if end:
            self.comment("end", row)

    @contextmanager
    def inside(self, row: Row | None, *, is_loop: bool = False) -> Iterator[None]:
        """Write what stands in a block."""
        loops, codes = self.loops, self.codes
        self.level += 1
        self.loops += is_loop
        if row is not None:
            if self.loops == LOOPS_MAX + 1 and is_loop:
                self.refuse(row, said("more than {limit} loops stand in each other", limit=LOOPS_MAX))
            elif self.level == BLOCKS_MAX + 1:
                self.refuse(row, said("more than {limit} blocks stand in each other", limit=BLOCKS_MAX))
        yield
        if self.codes == codes:
            self.line("pass", row)
        self.level -= 1
        self.loops = loops

    @contextmanager
    def function(self, head: str, row: Row | None) -> Iterator[None]:
        """Write a function: loops around it do not count."""
        loops, self.loops = self.loops, 0
        with self.block(head, row):
            yield
        self.loops = loops

    # ------------------------------------------------------------ problems

    def refuse(self, row: Row, text: str, hint: str = "") -> None:
        """Note that a node cannot be generated."""
        self.problems.append(Problem(row.number, text, hint=hint))

    def note(self, row: Row | None, text: str, hint: str = "") -> None:
        """Note what is not known and keeps nothing from running."""
        self.problems.append(Problem(row.number if row is not None else 0, text, is_error=False, hint=hint))

    # ------------------------------------------------------------ values

    def expression(self, expression: Expression, row: Row, meaning: str = "expression") -> str:
        """Return the text of an expression; an empty one, or one with a cell that gives no text, is a problem."""
        for cell in expression.cells:
            if isinstance(cell, UnknownCell):
                self.refuse(
                    row, said("the {meaning} has a cell that is not known: {kind}", meaning=meaning, kind=cell.kind)
                )
        text = expression.text(lambda pin: self.pin(pin, row))
        if not text.strip():
            self.refuse(row, said("the {meaning} is empty", meaning=meaning))
            return "None"
        return text

    def pin(self, name: str, row: Row, value: str | None = None) -> str:
        """Return the call that reads a pin, or that writes a value to it."""
        found = _STANDARD.fullmatch(name.strip())
        if found is not None:
            group, number = f"standard_{found[1]}", int(found[2])
        else:
            named = self.configuration.pins.find(name.strip())
            if named is None:
                self.refuse(row, said("no input or output has the name {name!r}", name=name))
                return "None"
            group, number = named
        if "register" in group:
            if value is None:
                return f"read_{group}({number})"
            if group.startswith("input"):
                self.refuse(row, said("{name!r} is an input", name=name))
            return f"write_{group}({number}, {value})"
        if value is None:
            return f"get_{group}({number})"
        if group.endswith("_in"):
            self.refuse(row, said("{name!r} is an input", name=name))
        return f"set_{group}({number}, {value})"


_STANDARD: Final = re.compile(r"(digital_in|digital_out|analog_in|analog_out)\[([0-9]{1,3})\]")


def identifier(text: str) -> str:
    """Return a name as one of the language: what cannot stand in it becomes `_`."""
    if text.isidentifier():
        return text
    made = "".join(sign if f"a{sign}".isidentifier() else "_" for sign in text) or "_"
    return made if made.isidentifier() else f"_{made}"


def quoted(text: str) -> str:
    """Return a text as a literal of the language."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\r", "").replace("\n", "\\n")
    return f'"{escaped}"'


def listed(numbers: Pose) -> str:
    """Return six numbers as a literal of the language."""
    return f"[{', '.join(number_text(number) for number in numbers)}]"
