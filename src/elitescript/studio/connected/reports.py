"""Messages of the primary port as events of the page, which has them as `run --json` does."""

from __future__ import annotations

from typing import Any, Final

from elitescript.client.primary_messages import RobotText
from elitescript.protocol.primary.messages import ERROR, FATAL, INFO, KEY, POPUP, ROBOT_ERROR, SCRIPT_EXCEPTION, TEXT

_LEVELS: Final = {INFO: "info", ERROR: "error", FATAL: "error"}
_STATES: Final = {"STARTED": "started", "PAUSED": "paused", "STOPPED": "stopped"}
ALARM_CODE: Final = "controller"
"""Stands where alarms of our own runs have their code."""


def report_of(message: RobotText, t: float, line_offset: int) -> dict[str, Any] | None:
    """Return the event of a message; None for a kind that says nothing.

    Args:
        message: of the controller.
        t: time of the page at which it came, s: the unit of its own time is not the same everywhere.
        line_offset: lines that the controller counts in front of the text of the page.
    """
    text = message.texts.get("text", "")
    if message.kind == TEXT.name:
        return {"type": "log", "t": t, "level": "info", "text": text}
    if message.kind == POPUP.name:
        level = "error" if message.values.get("is error") else "warning" if message.values.get("is warning") else "info"
        title = message.texts.get("title", "")
        blocking = bool(message.values.get("is blocking"))
        return {"type": "popup", "t": t, "level": level, "title": title, "text": text, "blocking": blocking}
    if message.kind == ROBOT_ERROR.name:
        code, sub_code = message.values.get("code", 0), message.values.get("sub-code", 0)
        level = _LEVELS.get(message.values.get("level"), "warning")  # type: ignore[arg-type]
        place = f"C{code}A{sub_code}: " if code else ""
        return {"type": "log", "t": t, "level": level, "text": f"{place}{text}"}
    if message.kind == SCRIPT_EXCEPTION.name:
        line, column = message.values.get("line", 0), message.values.get("column", 0)
        assert isinstance(line, int) and isinstance(column, int)
        return {
            "type": "alarm",
            "t": t,
            "code": ALARM_CODE,
            "class": text.partition(":")[0] if ":" in text else "",
            "text": text,
            "line": max(line - line_offset, 0),
            "column": max(column - (1 if line_offset else 0), 0),
            "thread": "main",
        }
    if message.kind == KEY.name:
        state = _STATES.get(message.texts.get("title", "").rpartition("_")[2])
        return None if state is None else {"type": "task", "t": t, "state": state, "name": text}
    return {"type": "log", "t": t, "level": "info", "text": text} if text else None
