"""What sources say has the form that was recorded for the tests of the page."""

from __future__ import annotations

import pytest

from tests.conversation import conversations as held
from tests.conversation.conversations import FOLDER, forms

NAMES = ("live_edits", "live_alarm", "connected", "recorded")


@pytest.fixture(scope="module")
def now():
    return held.conversations()


@pytest.mark.parametrize("name", NAMES)
def test_what_is_said_now_has_the_recorded_form(now, name):
    """If this fails on purpose: `python -m tests.conversation.conversations`, and `web/src/source/messages.ts`."""
    assert forms(now[name]) == forms(held.read(name))


def test_every_recording_is_looked_at():
    assert {path.stem for path in FOLDER.glob("*.jsonl")} == set(NAMES)


def test_the_compiler_compares_messages_of_every_recorded_form():
    found = (FOLDER / "examples.ts").read_text(encoding="utf-8")
    assert found == held.examples({name: held.read(name) for name in NAMES})


def test_a_field_of_another_name_or_type_is_another_form():
    message = {"type": "cycle", "run": 1, "table": [{"line": 3, "moving_s": 1.0, "standing_s": 0.0, "visits": 1}]}
    (row,) = message["table"]
    renamed = {**row, "standing": row["standing_s"]}
    del renamed["standing_s"]
    for other in ([renamed], [{**row, "line": "3"}], [{**row, "line": None}]):
        assert forms([{"source": message}]) != forms([{"source": {**message, "table": other}}])
