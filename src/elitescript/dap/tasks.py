"""Breakpoints in the file of a graphical program: its lines are those of XML, what runs is the script of its tree."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from elitescript.dap.messages import Arguments
from elitescript.dap.sources import is_same_path
from elitescript.debugger.api import BreakpointState, LineBreakpoint, Place
from elitescript.environment.task_files import opened_task
from elitescript.environment.task_places import TaskPlaces
from elitescript.language.diagnostics import Diagnostic
from elitescript.records import replace

NO_NODE: Final = "no node of the tree stands here"
NO_SCRIPT: Final = "{place} writes no line of the script"

SetLines = Callable[[Sequence[LineBreakpoint]], tuple[BreakpointState, ...]]


class DebuggedTask:
    """A graphical program that is debugged.

    Args:
        path: of its file.
        task_dir: the task folder; None: that of the file.

    Raises:
        UsageError: a file cannot be read.
    """

    def __init__(self, path: str, task_dir: str | None = None) -> None:
        self.path = str(Path(path).absolute())
        self.places = TaskPlaces(opened_task(path, task_dir))
        self.task = self.places.task

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """What keeps it from running, in lines of its file."""
        if self.task.program is None:
            return self.task.errors
        return tuple(self._in_file(found) for found in self.task.errors)

    def _in_file(self, found: Diagnostic) -> Diagnostic:
        line = self.places.file_line(found.line)
        place = self.task.source.place(found.line)
        text = f"{place}: {found.text}" if place else found.text
        return replace(found, line=line, column=1, end_line=line, end_column=2, text=text)

    def is_file(self, source: Arguments) -> bool:
        """Return whether a `Source` of a client is its file."""
        return not source.number("sourceReference", 0) and is_same_path(source.text("path", ""), self.path)

    def node(self, line: int) -> str:
        """Return the node of a line of the script as people say it; empty: it belongs to none."""
        return self.task.source.place(line)

    def set_lines(self, requests: Sequence[LineBreakpoint], apply: SetLines) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints in its file; return what became of each, with lines of the file.

        Args:
            requests: lines of the file: a node is meant that begins there, else the innermost around it.
            apply: sets breakpoints of the script.
        """
        lines = [self.places.script_line(request.line) for request in requests]
        moved = [replace(request, line=line, column=0) for request, line in zip(requests, lines, strict=True) if line]
        states = iter(apply(moved))
        return tuple(
            self._state(next(states), request.line) if line else self._refused(request.line)
            for request, line in zip(requests, lines, strict=True)
        )

    def _state(self, state: BreakpointState, line: int) -> BreakpointState:
        row = self.places.row_at(line)
        here = self.places.spans[row.number - 1].line if row is not None else line
        return BreakpointState(state.id, state.verified, state.message, here)

    def _refused(self, line: int) -> BreakpointState:
        row = self.places.row_at(line)
        text = NO_NODE if row is None else NO_SCRIPT.format(place=f"{row.number} {row.mark}")
        return BreakpointState(0, False, text, line)

    def locations(self, line: int, end_line: int) -> tuple[Place, ...]:
        """Return where nodes with a script begin in lines of its file, the last line included."""
        return tuple(
            Place(*span)
            for row, span in zip(self.places.rows, self.places.spans, strict=True)
            if line <= span.line <= end_line and row.number in self.places.script_lines
        )
