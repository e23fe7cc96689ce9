"""Messages of pages: what is taken, and what is refused at which place."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from elitescript.conversation import messages
from elitescript.conversation.messages import (
    MESSAGES,
    Detail,
    GoOn,
    Guiding,
    Jog,
    JogEnd,
    Program,
    RunOptions,
    Save,
    Seek,
    Service,
    SetSignal,
    SignalInput,
    Step,
    Stop,
    ask_of,
    options_data,
    read_message,
)
from elitescript.errors import UsageError

CONTRACT = Path(__file__).parents[2] / "web/src/source/messages.ts"

TAKEN = [
    ({"type": "program", "version": 3, "text": "def p():\nend\n"}, Program(3, "def p():\nend\n")),
    (
        {
            "type": "program",
            "version": 4,
            "text": "",
            "options": {
                "robot": "CS63",
                "joints": [0, 0.5, 0, 0, 0, 1],
                "seed": 7,
                "until_s": 60,
                "may_connect": True,
                "inputs": [{"name": "standard_digital_in[2]", "value": True, "at_s": 1.5}],
            },
        },
        Program(
            4,
            "",
            RunOptions(
                robot="CS63",
                joints=(0.0, 0.5, 0.0, 0.0, 0.0, 1.0),
                seed=7,
                until_s=60.0,
                may_connect=True,
                inputs=(SignalInput("standard_digital_in[2]", True, 1.5),),
            ),
        ),
    ),
    ({"type": "go_on", "run": 2, "until_s": 240}, GoOn(2, 240.0)),
    ({"type": "stop"}, Stop()),
    ({"type": "seek", "run": 2, "ask": 5, "t": 3.0}, Seek(2, 5, 3.0)),
    (
        {"type": "detail", "run": 2, "ask": 6, "from_s": 1, "to_s": 2, "step_s": 0.004},
        Detail(2, 6, 1.0, 2.0, 0.004),
    ),
    ({"type": "step", "run": 2, "ask": 7, "by": -1, "thread": "main", "t": 1}, Step(2, 7, -1, "main", 1.0)),
    (
        {"type": "service", "ask": 8, "service": "completion", "version": 3, "line": 2, "column": 4, "trigger": "."},
        Service(8, "completion", 3, 2, 4, {"trigger": "."}),
    ),
    ({"type": "save", "ask": 9, "text": "x", "seen": "abc", "force": True}, Save(9, "x", "abc", True)),
    ({"type": "signal", "ask": 1, "name": "flag[3]", "value": False}, SetSignal(1, "flag[3]", False)),
    ({"type": "jog", "frame": "tool", "axis": 2, "direction": -1, "speed": 0.5}, Jog("tool", 2, -1, 0.5)),
    ({"type": "jog_end"}, JogEnd()),
    ({"type": "guiding"}, Guiding()),
]

REFUSED = [
    ("[]", "the message is no object"),
    ("{", "the message is no JSON"),
    ('{"type": "seek", "run": 1, "ask": 1, "t": NaN}', "the message is no JSON: NaN is no JSON"),
    ("{}", "type: there is no such message"),
    ({"type": "sek"}, "type: there is no such message; did you mean 'seek'?"),
    ({"type": "seek", "run": 1, "t": 1}, "seek.ask: is missing"),
    ({"type": "seek", "run": 1, "ask": 2, "t": 1, "thread": ""}, "seek.thread: there is no such field"),
    ({"type": "seek", "run": 1, "ask": True, "t": 1}, "seek.ask: must be a whole number from 0 to"),
    ({"type": "seek", "run": 1, "ask": 1.5, "t": 1}, "seek.ask: must be a whole number from 0 to"),
    ('{"type": "seek", "run": 1, "ask": 1, "t": 1e999}', "seek.t: must be a number"),
    ({"type": "seek", "run": 1, "ask": 1, "t": 10**400}, "seek.t: must be a number"),
    ({"type": "seek", "run": 1, "ask": 1, "t": "3"}, "seek.t: must be a number >= 0 and <= 86400 s, got '3'"),
    ({"type": "program", "version": 1, "text": 3}, "program.text: must be a text, got 3"),
    ({"type": "program", "version": 1, "text": "x" * 2_000_001}, "program.text: a text of 2000001 characters"),
    (
        {"type": "program", "version": 1, "text": "", "options": {"joints": [0, 0]}},
        "program.options.joints: a list of 2 items; it has 6",
    ),
    (
        {"type": "program", "version": 1, "text": "", "options": {"modell": "CS66"}},
        "program.options.modell: there is no such field",
    ),
    (
        {
            "type": "program",
            "version": 1,
            "text": "",
            "options": {
                "inputs": [
                    {"name": "flag[0]", "value": True, "at_s": 0},
                    {"name": "flag[1]", "value": True, "at_s": -1},
                ]
            },
        },
        "program.options.inputs[1].at_s: must be a number >= 0 and <= 86400 s, got -1",
    ),
    (
        {
            "type": "program",
            "version": 1,
            "text": "",
            "options": {"inputs": [{"name": "flag[0]", "value": 3.5, "at_s": 0}]},
        },
        "program.options.inputs[0]: flag[0] takes True or False, not 3.5",
    ),
    ({"type": "signal", "ask": 1, "name": "standard_digital_out[99]", "value": True}, "signal: "),
    (
        {"type": "detail", "run": 1, "ask": 1, "from_s": 2, "to_s": 1, "step_s": 0.04},
        "detail: from_s 2 s is after to_s 1 s",
    ),
    (
        {"type": "detail", "run": 1, "ask": 1, "from_s": 0, "to_s": 80000, "step_s": 0.004},
        "detail: more than 100000 rows",
    ),
    (
        {"type": "step", "run": 1, "ask": 1, "by": 2, "thread": "main", "t": 0},
        "step.by: must be one of 1, -1, got 2",
    ),
    ({"type": "control", "ask": 1, "action": "power_of"}, "control.action: must be one of power_on"),
    ({"type": "service", "ask": 1, "service": "hoover", "version": 1}, "service.service: must be one of"),
    ({"type": "jog", "frame": "tool", "axis": 6, "direction": 1, "speed": 1}, "jog.axis: must be a whole number"),
]


def as_text(message):
    return message if isinstance(message, str) else json.dumps(message)


class TestReadMessage:
    @pytest.mark.parametrize(("message", "expected"), TAKEN, ids=lambda value: str(value)[:30])
    def test_takes(self, message, expected):
        assert read_message(as_text(message)) == expected

    @pytest.mark.parametrize(("message", "text"), REFUSED, ids=lambda value: str(value)[:30])
    def test_refuses_with_the_place(self, message, text):
        with pytest.raises(UsageError) as caught:
            read_message(as_text(message))
        assert str(caught.value).startswith(text)
        assert len(str(caught.value)) < 1000

    def test_refuses_a_message_that_is_too_long(self):
        with pytest.raises(UsageError, match="a message of 16777217 characters"):
            read_message(" " * (messages.MESSAGE_BYTES_MAX + 1))

    def test_refuses_deep_nesting(self):
        with pytest.raises(UsageError, match="no JSON"):
            read_message("[" * 200_000)

    def test_keeps_lone_surrogates_of_a_text(self):
        assert read_message('{"type": "program", "version": 1, "text": "\\ud800"}').text == "\ud800"


class TestContract:
    def test_every_message_of_the_page_is_read(self):
        union = CONTRACT.read_text(encoding="utf-8").partition("export type ToSource =")[2].partition("// ------")[0]
        assert set(re.findall(r'readonly type: "(\w+)"', union)) == set(MESSAGES)

    @pytest.mark.parametrize(("name", "known"), [("Service", "SERVICES"), ("ControlAction", "ACTIONS")])
    def test_words_are_those_of_the_page(self, name, known):
        union = CONTRACT.read_text(encoding="utf-8").partition(f"export type {name} =")[2].partition(";")[0]
        assert tuple(re.findall(r'"(\w+)"', union)) == getattr(messages, known)


class TestAskOf:
    @pytest.mark.parametrize(
        ("text", "ask"),
        [('{"type": "sek", "ask": 4}', 4), ('{"ask": "4"}', None), ('{"ask": true}', None), ("[4]", None), ("{", None)],
    )
    def test_finds_the_number(self, text, ask):
        assert ask_of(text) == ask


def test_options_come_back_as_they_were():
    options = {
        "joints": [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        "inputs": [{"name": "flag[1]", "value": True, "at_s": 2.0}],
        "until_s": 5.0,
    }
    message = read_message(json.dumps({"type": "program", "version": 1, "text": "", "options": options}))
    assert options_data(message.options) == options
    assert options_data(RunOptions()) == {}
