"""What is known of a controller, from what its ports said."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from elitescript.recorder.recording import Message

CONFIGURATION: Final = "configuration"
CARTESIAN: Final = "cartesian"
ROBOT_MODE: Final = "robot mode"
SAFETY: Final = "safety"
ANSWER: Final = "answer"
CONNECTED: Final = "connected"
CLOCK: Final = "clock"
"""Types of messages."""

STATES: Final = (CONFIGURATION, CARTESIAN, ROBOT_MODE, SAFETY)
"""Types of messages of the primary port that hold until the next of the same type."""

QUESTIONS: Final = {
    "robot -t": "model",
    "robot -s": "serial",
    "version": "version",
    "task": "task",
}
"""Questions to the dashboard whose answers are facts, with their names."""


def facts_of(messages: Iterable[Message]) -> dict[str, Any]:
    """Return the facts; of what was said more than once, the first."""
    found: dict[str, Any] = {}
    for message in messages:
        for name, value in _facts(message.data).items():
            found.setdefault(name, value)
    return found


def task_of(answer: str) -> str:
    """Return the path of a task from the answer of the dashboard; empty if none is loaded."""
    return answer.partition(":")[2].strip()


def _facts(data: Any) -> dict[str, Any]:
    kind = data.get("type")
    if kind == CONFIGURATION:
        limits, maxima = data["joint limits"], data["joint maxima"]
        return {
            "lengths": {"a": data["DH a"], "d": data["DH d"], "alpha": data["DH alpha"]},
            "limits": {
                "q_min": limits[0::2],
                "q_max": limits[1::2],
                "qd_max": maxima[0::2],
                "qdd_max": maxima[1::2],
            },
            "defaults": {
                "joint_speed": data["default joint velocity"],
                "joint_acceleration": data["default joint acceleration"],
                "tool_speed": data["default tool velocity"],
                "tool_acceleration": data["default tool acceleration"],
            },
        }
    if kind == CARTESIAN:
        return {"tcp_offset": data["TCP offset"]}
    if kind == ANSWER and data.get("question") in QUESTIONS:
        name = QUESTIONS[data["question"]]
        answer = data["answer"]
        return {name: task_of(answer) if name == "task" else answer}
    if kind == CONNECTED and "version" in data:
        return {"version": data["version"]}
    if kind == CLOCK:
        return {"clock_offset_s": data["offset_s"]}
    return {}
