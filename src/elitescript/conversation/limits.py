"""How much of a run a page is given: a program may write without end, and a page keeps what it gets.

Long texts are cut, with the number of characters that are missing beside them; events beyond the limits are counted.
Of those the last few are kept until the run rests, since the end of a long list is what people look for.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from itertools import islice
from operator import itemgetter
from typing import Any, Final

Record = dict[str, Any]

LONG_LINES: Final = 1000
"""Lines of a text of which what needs no values of expressions is told first, and all in a second message."""
EVENTS_MAX: Final = 50_000
"""Events of one run."""
BYTES_MAX: Final = 8 << 20
"""Bytes of their texts and numbers, about: characters, and `_BESIDE` for each event."""
LAST_EVENTS: Final = 500
LAST_BYTES: Final = 1 << 20
"""Most events of the end of a run that went beyond the limits, and their bytes."""
ALARMS_MAX: Final = 1000
"""Alarms beyond the limits."""
TEXT_MAX: Final = 4000
"""Characters of a text; a row of a list shows half of them."""
DEPTH_MAX: Final = 4
ITEMS_MAX: Final = 200
"""Depth and length of what an alarm tells of values."""
VARIABLES_MAX: Final = 1000
"""Program globals of a moment."""
VARIABLES_BYTES_MAX: Final = 256 << 10
"""Characters of their names and values."""
NAME_MAX: Final = 200
"""Characters of a name."""
THREADS_MAX: Final = 500
"""Threads of a moment."""
RUN_FINDINGS_MAX: Final = 200
"""What a run itself has found."""
FINDINGS_MAX: Final = 1000
"""Findings of a text."""
FINDINGS_BYTES_MAX: Final = 1 << 20
"""Bytes of their texts and repairs, about."""
FIX_BYTES_MAX: Final = 16 << 10
"""Bytes of one repair, about."""
PLACES_MAX: Final = 100
"""Places to which a run has tried to connect in vain."""

MARKS_MAX: Final = 50_000
"""Times at which nodes of a graphical program began; beyond them the first one of each node."""

_BESIDE: Final = 64
"""Bytes of a record beside its texts."""


def cut(text: str, most: int = TEXT_MAX) -> tuple[str, int]:
    """Return the begin of a text, and how many characters are left out."""
    return (text, 0) if len(text) <= most else (text[:most], len(text) - most)


def cut_text(text: str) -> str:
    """Return a text that a page shows whole, cut with an ellipsis."""
    return text if len(text) <= TEXT_MAX else f"{text[:TEXT_MAX]}…"


def cut_name(name: str) -> str:
    """Return a name that a page shows, cut with an ellipsis."""
    return name if len(name) <= NAME_MAX else f"{name[:NAME_MAX]}…"


def bounded(record: Mapping[str, Any]) -> Record:
    """Return a record with its texts cut; `cut` is how many characters are left out, if any are."""
    left_out = [0]
    found = {str(name): _bounded(value, left_out, 0) for name, value in record.items()}
    return found | {"cut": left_out[0]} if left_out[0] else found


def _bounded(value: Any, left_out: list[int], depth: int) -> Any:
    if isinstance(value, str):
        text, more = cut(value)
        left_out[0] += more
        return text
    if isinstance(value, dict):
        if depth >= DEPTH_MAX:
            return "…"
        return {cut_name(name): _bounded(item, left_out, depth + 1) for name, item in islice(value.items(), ITEMS_MAX)}
    if isinstance(value, list | tuple):
        return "…" if depth >= DEPTH_MAX else [_bounded(item, left_out, depth + 1) for item in value[:ITEMS_MAX]]
    return value


def size_of(value: Any) -> int:
    """Return about how many bytes a record takes."""
    if isinstance(value, str):
        return len(value)
    if isinstance(value, dict):
        return _BESIDE + sum(len(name) + size_of(item) for name, item in value.items())
    if isinstance(value, list | tuple):
        return 8 * len(value) + sum(map(size_of, value))
    return 8


class EventBudget:
    """Decides which events of one run a page is given, and counts the others.

    Args:
        events_max: events up to which all are given.

    Attributes:
        events: how many are left out.
        bytes: characters of all that is left out, those that were cut off texts included.
        from_s: time of the first event that is left out, s.
    """

    __slots__ = ("_alarms", "_bytes", "_events", "_events_max", "_last", "_last_bytes", "bytes", "events", "from_s")

    def __init__(self, events_max: int = EVENTS_MAX) -> None:
        self._events_max = events_max
        self._events = 0
        self._bytes = 0
        self._alarms: list[tuple[int, Record]] = []
        self._last: deque[tuple[int, Record]] = deque()
        """Those that wait, each with its number, by which both are put in order again."""
        self._last_bytes = 0
        self.events = 0
        self.bytes = 0
        self.from_s = 0.0

    def take(self, records: Iterable[Mapping[str, Any]]) -> list[Record]:
        """Return those of further events that the page is given now."""
        given: list[Record] = []
        for whole in records:
            record = bounded(whole)
            size = size_of(record)
            if self._events < self._events_max and self._bytes + size <= BYTES_MAX:
                self._events += 1
                self._bytes += size
                self.bytes += record.get("cut", 0)
                given.append(record)
            else:
                self._wait(record, size)
        return given

    def miss(self, events: int) -> None:
        """Count events that had gone before anything was said of them."""
        self.events += events

    def last(self) -> list[Record]:
        """Return what waits for the end: the last events and the alarms, which are given now."""
        found = [record for _, record in sorted([*self._alarms, *self._last], key=itemgetter(0))]
        self.events -= len(found)
        self.bytes -= sum(map(size_of, found))
        self._alarms.clear()
        self._last.clear()
        self._last_bytes = 0
        return found

    def _wait(self, record: Record, size: int) -> None:
        """Keep an event until the end; the first of those that are no alarms goes."""
        if not self.events:
            self.from_s = float(record.get("t", 0.0))
        self.events += 1
        self.bytes += size + record.get("cut", 0)
        if record["type"] == "alarm" and len(self._alarms) < ALARMS_MAX:
            self._alarms.append((self.events, record))
            return
        self._last.append((self.events, record))
        self._last_bytes += size
        while len(self._last) > LAST_EVENTS or self._last_bytes > LAST_BYTES:
            self._last_bytes -= size_of(self._last.popleft()[1])


class MarkBudget:
    """Chooses the line marks that a page is given, as they come."""

    __slots__ = ("_count", "_known")

    def __init__(self) -> None:
        self._count = 0
        self._known: set[int] = set()

    def take(self, marks: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
        """Return those of marks, each a tick and the number of a node, that are given."""
        given = []
        for mark in marks:
            is_first = mark[1] not in self._known
            if self._count < MARKS_MAX or (is_first and self._count < 2 * MARKS_MAX):
                self._count += 1
                self._known.add(mark[1])
                given.append(mark)
        return given
