"""The log of the controller as clients download it: `log_history.csv`, made from the events of a robot.

What a real controller writes there is not documented; columns and words are *assumed*.
"""

from __future__ import annotations

import csv
import io
import time
from collections import deque
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Final

from elitescript.messages.events import (
    Alarm,
    Event,
    Popup,
    RobotModeChanged,
    SafetyModeChanged,
    TaskLoaded,
    TaskStateChanged,
    TextMessage,
    Warned,
)

ROWS_MAX: Final = 5000
"""The oldest rows go first."""
TEXT_MAX: Final = 500
"""Characters of a text."""
COLUMNS: Final = ("time", "level", "source", "code", "text")


class ControllerHistory:
    """What the controller has logged.

    Args:
        clock: seconds since 1970.
    """

    __slots__ = ("_clock", "_rows", "_text")

    def __init__(self, clock: Callable[[], float] = time.time) -> None:
        self._clock = clock
        self._rows: deque[bytes] = deque(maxlen=ROWS_MAX)
        self._text = b""
        """The whole log; empty if a row has come since it was made."""

    def take(self, event: Event) -> None:
        """Write an event down, if it is one of those that the log has."""
        entry = _entry(event)
        if entry is not None:
            stamp = datetime.fromtimestamp(self._clock(), UTC).isoformat(" ", "milliseconds").removesuffix("+00:00")
            level, source, code, text = entry
            self._text = b""
            self._rows.append(_row((stamp, level, source, code, text[:TEXT_MAX])))

    def text(self) -> bytes:
        """Return the whole log: CSV in UTF-8 with a row of names; times are UTC."""
        self._text = self._text or b"".join((_row(COLUMNS), *self._rows))
        return self._text


def _row(cells: tuple[str, ...]) -> bytes:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerow(cells)
    return out.getvalue().encode(errors="replace")


def _entry(event: Event) -> tuple[str, str, str, str] | None:
    """Return the level, source, code and text; None for what the log does not have."""
    match event:
        case TextMessage(text=text, level=level):
            return level, "script", "", text
        case Popup(text=text, level=level):
            return level, "popup", "", text
        case Warned(text=text, code=code):
            return "warning", "script", code, text
        case Alarm(code=code, class_name=name, text=text, line=line):
            return "error", "script", code, f"{name} in line {line}: {text}"
        case TaskLoaded(name=name):
            return "info", "task", "", f"loaded: {name}"
        case TaskStateChanged(state=state, name=name):
            return "info", "task", "", f"{state.name.lower()}: {name}"
        case RobotModeChanged(mode=mode):
            return "info", "robot", "", f"robot mode {mode.name}"
        case SafetyModeChanged(mode=mode, reason=reason):
            level = "info" if mode.name == "NORMAL" else "error"
            return level, "safety", "", f"safety mode {mode.name}" + (f": {reason}" if reason else "")
    return None
