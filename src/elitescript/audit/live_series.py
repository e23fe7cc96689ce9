"""The last part of a run that goes on: rows are put behind it and taken from its front."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Mapping

from elitescript.audit.series import STANDS_RAD_S, Change, Mark, Series
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value


class Window(Series):
    """The rows of a run from a mark on, and its marks; see `Series` for the rest.

    Args:
        edges: signals whose changes are marks.
        by_lines: whether changes of the line are; else those from standing to moving and back.
        has_speeds: whether slider and speed scaling are known.
        late_s: see `waited_s`; of the first row.

    Attributes:
        marks: in order; the first one is where the window begins.
    """

    __slots__ = ("_by_lines", "_edges", "_late_s", "_now", "marks")

    def __init__(
        self, edges: Collection[str], *, by_lines: bool, has_speeds: tuple[bool, bool], late_s: float = 0.0
    ) -> None:
        slider, scaling = (array("d") if is_known else None for is_known in has_speeds)
        self.changes: list[Change]
        super().__init__(
            array("d"),
            array("l"),
            [array("d") for _ in range(6)],
            [array("d") for _ in range(6)],
            slider=slider,
            scaling=scaling,
            changes=[],
            is_open=True,
        )
        self.marks: list[Mark] = []
        self._edges = edges
        self._by_lines = by_lines
        self._now: dict[str, Value] = {}
        self._late_s = late_s
        """`waited_s` of the first row."""

    def waited_s(self, row: int) -> float:
        """See `Series`."""
        return super().waited_s(row) if row else self._late_s

    @property
    def now(self) -> Mapping[str, Value]:
        """Signals in the last row."""
        return self._now

    def put(
        self,
        t: float,
        line: int,
        q: Six,
        qd: Six,
        changed: Mapping[str, Value],
        *,
        slider: float = 1.0,
        scaling: float = 1.0,
    ) -> list[Mark]:
        """Append a row; return the marks that it makes, which are in `marks` too.

        Args:
            t: s since the program's begin, later than the row before.
            line: of the main thread.
            q, qd: target joints and their speeds.
            changed: signals that may have another level than in the row before.
            slider, scaling: 0 to 1.
        """
        row = len(self.t)
        before = self.lines[-1] if row else line
        stood = not row or self.stands(row - 1)
        self.t.append(t)
        self.lines.append(line)
        for column, value in zip(self.q, q, strict=True):
            column.append(value)
        for column, value in zip(self.qd, qd, strict=True):
            column.append(value)
        if self.slider is not None:
            self.slider.append(slider)
        if self.scaling is not None:
            self.scaling.append(scaling)
        found: list[Mark] = []
        if not row:
            self.levels = dict(changed)
            self._now = dict(changed)
        else:
            for name, value in changed.items():
                if self._now.get(name) != value:
                    self._now[name] = value
                    self.changes.append(Change(row, name, value))
                    if name in self._edges:
                        found.append(Mark(row, (name, value), before))
            found.sort(key=lambda mark: mark.key[0])
        if self._by_lines:
            if not row or line != before:
                found.append(Mark(row, ("line", line), line))
        else:
            moves = max(map(abs, qd)) > STANDS_RAD_S
            if not row or moves == stood:
                found.append(Mark(row, ("moves", moves), line))
        self.marks += found
        return found

    def begin_at(self, mark: int) -> None:
        """Forget everything before a mark, which is the first one then."""
        row = self.marks[mark].row
        self._late_s = self.waited_s(row)
        del self.marks[:mark]
        self.drop(row)

    def drop(self, rows: int) -> None:
        """Forget so many rows; marks in them are in the first row then."""
        if rows <= 0:
            return
        columns = [self.t, *self.q, *self.qd]
        columns += [column for column in (self.slider, self.scaling) if column is not None]
        for column in columns:
            del column[:rows]
        del self.lines[:rows]
        kept: list[Change] = []
        for change in self.changes:
            if change.row <= rows:
                self.levels[change.name] = change.value
            else:
                kept.append(change._replace(row=change.row - rows))
        self.changes = kept
        self.marks = [mark._replace(row=max(mark.row - rows, 0)) for mark in self.marks]
