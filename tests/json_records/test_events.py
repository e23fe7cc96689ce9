"""The record of each event in `--json`, written down by hand."""

import inspect
import io
from typing import get_args

import pytest

from elitescript.cli.output.report import TextRunReport, parse_logs
from elitescript.errors import UsageError
from elitescript.json_records.events import RECORDS, record_of
from elitescript.messages import events
from elitescript.messages.events import ChannelActivity, Event, SignalChanged, Warned
from tools.events_page import EXAMPLES, events_page, field_texts

PARTS = "template values hint_template hint_values"
EXPECTED = {
    "TextMessage": ("log", "t level text thread line"),
    "Printed": ("print", "t text thread line"),
    "Popup": ("popup", "t level title text blocking confirmed thread line"),
    "Warned": ("warning", "t text thread line code hint source severity " + PARTS),
    "DeviceNoted": ("device", "t level device text template values"),
    "Alarm": (
        "alarm",
        "t code class text line column thread command argument value limit unit hint " + PARTS,
    ),
    "SafetyModeChanged": ("safety", "t mode text template values"),
    "SignalChanged": ("signal", "t name value by line"),
    "ChannelActivity": ("channel", "t channel kind what data line thread"),
}


def test_every_kind_of_event_is_in_the_table_and_in_the_page():
    defined = {kind for _, kind in inspect.getmembers(events, inspect.isclass) if kind.__module__ == events.__name__}
    defined.remove(events.Happened)
    assert defined == set(get_args(Event)) == set(RECORDS)
    page = events_page()
    for kind in defined:
        assert f"\n## {kind.__name__}\n" in page
        assert all(field_texts(kind).values())


def test_what_json_has_of_each():
    found = {type(event).__name__: record_of(event) for event in EXAMPLES}
    assert {name: (record["type"], " ".join(list(record)[1:])) for name, record in found.items()} == EXPECTED
    assert {kind.__name__ for kind, make in RECORDS.items() if make is not None} == set(EXPECTED)


def test_a_field_that_nobody_explains_is_found():
    class Bare:
        """Something."""

        tick: int
        puzzle: int

    with pytest.raises(LookupError, match="puzzle"):
        field_texts(Bare)


def test_signals_and_channels():
    assert record_of(SignalChanged(25, "standard_digital_out[0]", True, "device")) == {
        "type": "signal",
        "t": 0.1,
        "name": "standard_digital_out[0]",
        "value": True,
        "by": "device",
        "line": 0,
    }
    assert record_of(ChannelActivity(25, "camera", "socket", "sent", "go\n", 39, "main")) == {
        "type": "channel",
        "t": 0.1,
        "channel": "camera",
        "kind": "socket",
        "what": "sent",
        "data": "go\n",
        "line": 39,
        "thread": "main",
    }


def test_a_warning_says_its_code_and_hint_if_it_has_them():
    assert record_of(Warned(0, "too fast", "main", 3, "W230", "give m/s")) == {
        "type": "warning",
        "t": 0.0,
        "text": "too fast",
        "source": "run",
        "severity": "warning",
        "thread": "main",
        "line": 3,
        "code": "W230",
        "hint": "give m/s",
        "template": "too fast",
        "values": {},
        "hint_template": "give m/s",
        "hint_values": {},
    }


@pytest.mark.parametrize(
    ("logs", "lines"),
    [
        ("", []),
        ("signals", ["0.100 s  [signal] flag[1] = True (line 7)", "0.104 s  [signal] flag[2] = True (client)"]),
        ("channels", ["0.100 s  [socket 'cam'] sent 'go\\n' (line 8)", "0.200 s  [socket 'cam'] closed"]),
    ],
)
def test_lines_for_people_have_them_when_asked(logs, lines):
    out = io.StringIO()
    report = TextRunReport(out, out, parse_logs(logs or None))
    for event in (
        SignalChanged(25, "flag[1]", True, "program", 7),
        ChannelActivity(25, "cam", "socket", "sent", "go\n", 8, "main"),
        SignalChanged(26, "flag[2]", True, "client"),
        ChannelActivity(50, "cam", "socket", "closed"),
    ):
        report.event(event)
    assert [line.strip() for line in out.getvalue().splitlines()] == lines


def test_a_log_that_is_none():
    assert parse_logs("channels, signals") == {"signals", "channels"}
    with pytest.raises(UsageError, match="'sockets'; there are signals, channels"):
        parse_logs("sockets")
