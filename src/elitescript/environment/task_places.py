"""Places of a graphical program: lines of its file, its nodes, and lines of its script."""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property

from elitescript.environment.task_files import OpenedTask
from elitescript.program_tree import Row
from elitescript.records import NamedTuple


class FileSpan(NamedTuple):
    """Where a node stands in its file; lines and columns from 1, columns in characters, the end excluded.

    A node that was not read from the file has no lines: zeros.
    """

    line: int
    column: int
    end_line: int
    end_column: int


class TaskPlaces:
    """Finds places of an opened task.

    Args:
        task: as it was read.
    """

    def __init__(self, task: OpenedTask) -> None:
        self.task = task

    @property
    def rows(self) -> tuple[Row, ...]:
        """The rows of the tree; none if the file is no task."""
        return () if self.task.program is None else self.task.program.script.rows

    @cached_property
    def spans(self) -> tuple[FileSpan, ...]:
        """Where each row stands in the file, in the order of the rows."""
        program = self.task.program
        if program is None or program.task.document is None:
            return ()
        text = program.task.document.text
        starts = [0, *(place + 1 for place, sign in enumerate(text) if sign == "\n")]

        def place(offset: int) -> tuple[int, int]:
            line = bisect_right(starts, offset)
            return line, offset - starts[line - 1] + 1

        found = []
        for row in self.rows:
            first, last = program.task.span_of(row.node)
            found.append(FileSpan(*place(first), *place(last)) if first >= 0 else FileSpan(0, 0, 0, 0))
        return tuple(found)

    @cached_property
    def script_lines(self) -> dict[int, int]:
        """The first line of the script of each row that has one."""
        program = self.task.program
        found: dict[int, int] = {}
        for line, row in enumerate(() if program is None else program.script.line_rows, 1):
            if row:
                found.setdefault(row, line)
        return found

    def row_at(self, line: int) -> Row | None:
        """Return the row that a line of the file is about: the first that begins there, else the one around it."""
        around: Row | None = None
        for row, span in zip(self.rows, self.spans, strict=True):
            if span.line == line:
                return row
            if span.line <= line <= span.end_line:
                around = row
        return around

    def row_of(self, script_line: int) -> Row | None:
        """Return the row to which a line of the script belongs."""
        program = self.task.program
        if program is None or not 1 <= script_line <= len(program.script.line_rows):
            return None
        number = program.script.line_rows[script_line - 1]
        return self.rows[number - 1] if number else None

    def file_line(self, script_line: int) -> int:
        """Return the line of the file of the node to which a line of the script belongs; 1 if it belongs to none."""
        row = self.row_of(script_line)
        return (self.spans[row.number - 1].line if row is not None else 0) or 1

    def script_line(self, line: int) -> int:
        """Return the first line of the script of the node that a line of the file is about; 0: it has none."""
        row = self.row_at(line)
        return 0 if row is None else self.script_lines.get(row.number, 0)
