"""Lines of `serve`."""

from __future__ import annotations

import io
import json

import pytest

from elitescript.cli.serve import ServeLog
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Event, TaskStateChanged


def printed(*events: Event, is_json: bool) -> list[str]:
    out = io.StringIO()
    log = ServeLog(out, out, ["CS66"], is_json=is_json)
    log._held = None
    for event in events:
        log.take("CS66", event)
    return out.getvalue().splitlines()


@pytest.mark.parametrize("is_json", [False, True])
def test_what_replaced_a_program_is_named(is_json: bool) -> None:
    replaced = TaskStateChanged(250, TaskState.STOPPED, "p63", "stopped", "`def p64():` of primary#2")
    stopped = TaskStateChanged(500, TaskState.STOPPED, "p64", "stopped")
    lines = printed(replaced, stopped, is_json=is_json)
    if is_json:
        first, second = map(json.loads, lines)
        assert (first["name"], first["replaced_by"]) == ("p63", "`def p64():` of primary#2")
        assert "replaced_by" not in second
    else:
        assert lines == [
            "     1.000 s  [stopped] p63, replaced by `def p64():` of primary#2",
            "     2.000 s  [stopped] p64",
        ]
