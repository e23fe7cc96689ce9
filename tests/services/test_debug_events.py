"""What a debugger on a ctl connection hears: of a process that is not trusted, only what makes sense."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any, cast

import pytest

from elitescript.messages.inputs import Debug
from elitescript.messages.outcomes import Debugged, Done
from elitescript.messages.outputs import Reply
from elitescript.services.control.debug_events import TEXT_MAX, UNREAD_MAX, DebugEvents, debug_result
from elitescript.services.control.verbs import VERBS, VerbRequest
from tests.protocol.snapshots import description, output


class Transport:
    """A connection whose client reads or does not."""

    unread = 0
    is_aborted = False

    def get_write_buffer_size(self) -> int:
        return self.unread

    def abort(self) -> None:
        self.is_aborted = True


class Bench:
    """The events of a debugger, without a robot or a socket."""

    def __init__(self) -> None:
        self.posted: list[Any] = []
        self.link = SimpleNamespace(restarts=0)
        self.server = SimpleNamespace(observers=[], link=self.link, post=self.posted.extend)
        self.transport = Transport()
        self.written: list[bytes] = []
        writer = SimpleNamespace(transport=self.transport, write=self.written.append)
        self.events = DebugEvents(cast("Any", self.server), "ctl#1", cast("Any", writer))

    def tick(self, *replies: Reply) -> list[Any]:
        """A tick with replies; return the lines that the debugger got."""
        self.written.clear()
        for observe in tuple(self.server.observers):
            observe(output(replies=replies))
        return [json.loads(line) for line in self.written]


def said(text: str, origin: str = "ctl#1") -> Reply:
    return Reply(origin, Debugged(text))


def test_a_debugger_hears_its_own_events() -> None:
    bench = Bench()
    assert bench.tick(said('{"event": "stopped"}')) == []
    bench.events.open()
    bench.events.open()
    assert bench.tick(said('{"event": "stopped"}'), said('{"event": "ended"}', "ctl#2"), Reply("ctl#1", Done())) == [
        {"event": "stopped"}
    ]


def test_it_leaves_once() -> None:
    bench = Bench()
    bench.events.close()
    assert bench.posted == []
    bench.events.open()
    bench.events.close()
    bench.events.close()
    assert bench.posted == [Debug("ctl#1/end", "ctl#1", '{"do": "detach"}')]
    assert bench.server.observers == []


def test_it_hears_of_a_robot_that_was_replaced() -> None:
    bench = Bench()
    bench.events.open()
    bench.link.restarts = 1
    assert [event["event"] for event in bench.tick()] == ["detached"]
    assert bench.tick() == []


SENSELESS = [
    "",
    "{",
    "[]",
    '"event"',
    '{"result": 1}',
    '{"event": ' + "[" * 100_000,
    '{"event": ' + "[" * 50_000 + "]" * 50_000 + "}",
    '{"event": "' + "x" * TEXT_MAX + '"}',
]


@pytest.mark.parametrize("text", SENSELESS, ids=range(len(SENSELESS)))
def test_what_makes_no_sense_is_left_out(text: str) -> None:
    bench = Bench()
    bench.events.open()
    assert bench.tick(said(text)) == []
    assert debug_result([Debugged(text)])["result"] in ({}, {"result": 1})


def test_one_that_does_not_read_is_hung_up_on() -> None:
    bench = Bench()
    bench.events.open()
    bench.transport.unread = UNREAD_MAX + 1
    assert bench.tick(said('{"event": "output"}')) == []
    assert bench.transport.is_aborted


def test_a_request_names_the_connection() -> None:
    request = VerbRequest("ctl#7/3", (), {"do": "next", "thread": 1}, output().snapshot, description())
    order = VERBS["debug"].order
    assert order is not None
    assert order(request).inputs == (Debug("ctl#7/3", "ctl#7", '{"do": "next", "thread": 1}'),)
    words = request._replace(arguments=('{"do":', '"threads"}'), values={})
    assert order(words).inputs == (Debug("ctl#7/3", "ctl#7", '{"do": "threads"}'),)
