"""All events have a time and a line; `typed_user.py` beside this file is what type checkers find."""

from __future__ import annotations

from typing import get_args

import pytest

from elitescript import VirtualRobot
from elitescript.messages.events import Event, Happened


@pytest.mark.parametrize("kind", get_args(Event))
def test_every_event_has_a_time_and_a_line(kind):
    assert issubclass(kind, Happened)
    assert isinstance(kind.__dict__.get("line", Happened.line), property) or "line" in kind.__annotations__


def test_time_and_line_of_events():
    run = VirtualRobot().run("def f():\n  sleep(0.1)\n  textmsg(1)\nend\n")
    found = [(type(event).__name__, event.t, event.line) for event in run.events]
    assert found == [("TaskStateChanged", 0.0, 0), ("TextMessage", 0.1, 3), ("TaskStateChanged", 0.1, 0)]
