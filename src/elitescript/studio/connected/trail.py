"""The last minute of a controller as rows of samples, in runs that begin anew when the controller does."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import Any, Final

from elitescript.conversation.rows import frames
from elitescript.messages.timing import TICKS_PER_S
from elitescript.studio.connected.picture import PICTURE_HZ, Picture

KEPT_S: Final = 60.0
RUN_S: Final = 600.0
"""After which a run begins that has the last minute only, so that pages do not keep all that they ever saw."""
RENEW_S: Final = 10.0
"""Shortest run that ends because pages have got too much of it."""
ROWS_A_FRAME: Final = 5
"""Rows that are sent together."""

Row = tuple[int, dict[str, float]]


class Trail:
    """Rows of pictures.

    Attributes:
        run: number of the present run; 0 as long as nothing came.
    """

    __slots__ = ("_began_tick", "_is_full", "_rows", "_waiting", "run")

    def __init__(self) -> None:
        self.run = 0
        self._began_tick = 0
        self._is_full = False
        self._rows: deque[Row] = deque(maxlen=round(KEPT_S * PICTURE_HZ))
        self._waiting: list[Row] = []

    def renew(self) -> None:
        """Begin a new run with the next picture, if this one is `RENEW_S` old by then: pages have enough of it."""
        self._is_full = True

    def take(self, picture: Picture) -> list[dict[str, Any] | bytes]:
        """Take a picture; return what pages get because of it."""
        found: list[dict[str, Any] | bytes] = []
        last = self._rows[-1][0] if self._rows else None
        if self.run == 0 or (last is not None and picture.begins_anew(last)):
            self.run += 1
            self._rows.clear()
            self._waiting.clear()
            picture.begin()
            self._began_tick = 0
            found.append(self._began())
        elif picture.tick - self._began_tick > (RENEW_S if self._is_full else RUN_S) * TICKS_PER_S:
            self.run += 1
            self._is_full = False
            self._began_tick = picture.tick
            self._waiting.clear()
            found += self.all()
        columns = picture.columns()
        if not columns or (self._rows and picture.tick <= self._rows[-1][0]):
            return found
        row = (picture.tick, columns)
        self._rows.append(row)
        self._waiting.append(row)
        if len(self._waiting) >= ROWS_A_FRAME:
            found += _frames(self.run, self._waiting)
            self._waiting = []
        return found

    def all(self) -> list[dict[str, Any] | bytes]:
        """Return what a page that has just come gets."""
        return [self._began(), *_frames(self.run, self._rows)] if self.run else []

    def _began(self) -> dict[str, Any]:
        return {"type": "run_began", "run": self.run, "version": 0, "same_until_s": 0.0, "options": {}}


def _frames(run: int, rows: Iterable[Row]) -> list[bytes]:
    """Return frames of rows; those in a row that have the same columns go together."""
    found: list[bytes] = []
    group: list[Row] = []
    for row in rows:
        if group and row[1].keys() != group[0][1].keys():
            found += _packed(run, group)
            group = []
        group.append(row)
    return found + _packed(run, group) if group else found


def _packed(run: int, rows: list[Row]) -> list[bytes]:
    names = rows[0][1]
    return list(frames(run, [tick for tick, _ in rows], {name: [row[name] for _, row in rows] for name in names}))
