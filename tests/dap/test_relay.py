"""Between client and process: one answer for each request, whatever the process does. The process is played here."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.dap.framing import Decoder, framed
from elitescript.dap.messages import CANCELLED, ENDED, MALFORMED, event, response
from elitescript.dap.relay import ANSWER_S, END_S, PAUSE_S, PENDING_MAX, Relay


class Process:
    """A process that debugs, played by a test."""

    def __init__(self) -> None:
        self.received: list[dict[str, Any]] = []
        self.is_killed = False

    def send(self, message: dict[str, Any]) -> None:
        self.received.append(message)

    def kill(self) -> None:
        self.is_killed = True


class Session:
    """A client and a process, with the relay between them."""

    def __init__(self) -> None:
        self.process = Process()
        self.started = 0
        self.sent = bytearray()
        self.relay = Relay(self.sent.extend, self._start)

    def _start(self) -> Process:
        self.started += 1
        return self.process

    def client(self, *commands: str, now_s: float = 0.0, first: int = 1) -> None:
        for seq, command in enumerate(commands, first):
            self.raw({"seq": seq, "type": "request", "command": command}, now_s)

    def raw(self, message: dict[str, Any], now_s: float = 0.0) -> None:
        self.relay.receive(framed(message), now_s)

    def answer(self, command: str, body: dict[str, Any] | None = None) -> None:
        """Let the process answer its last request of a name."""
        seq = next(one["seq"] for one in reversed(self.process.received) if one["command"] == command)
        self.relay.worker_sent(response(seq, command, body))

    def taken(self) -> list[dict[str, Any]]:
        found = Decoder().feed(bytes(self.sent))
        self.sent.clear()
        return found


def brief(messages):
    """Return responses as (request, success) and events by their names."""
    return [
        one["event"] if one["type"] == "event" else (one["request_seq"], one["command"], one["success"])
        for one in messages
    ]


def test_requests_and_answers_pass_with_the_numbers_of_each_side():
    session = Session()
    session.raw({"seq": 70, "type": "request", "command": "threads", "arguments": {"x": 1}})
    assert session.process.received == [{"seq": 1, "type": "request", "command": "threads", "arguments": {"x": 1}}]
    session.answer("threads", {"threads": []})
    session.relay.worker_sent(event("stopped"))
    first, second = session.taken()
    assert first == {
        "seq": 1,
        "type": "response",
        "request_seq": 70,
        "success": True,
        "command": "threads",
        "body": {"threads": []},
    }
    assert second == {"seq": 2, "type": "event", "event": "stopped"}


@pytest.mark.parametrize(
    ("message", "text"),
    [
        ({}, "seq must be"),
        ({"seq": True, "type": "request", "command": "threads"}, "seq must be"),
        ({"seq": 0, "type": "request", "command": "threads"}, "seq must be"),
        ({"seq": 1 << 60, "type": "request", "command": "threads"}, "seq must be"),
        ({"seq": 5, "type": "event", "command": "threads"}, "type must be"),
        ({"seq": 5, "type": "request"}, "command must be"),
        ({"seq": 5, "type": "request", "command": ["x"]}, "command must be"),
        ({"seq": 5, "type": "request", "command": "cancel", "arguments": [1]}, "not an object"),
        ({"seq": 5, "type": "request", "command": "cancel", "arguments": {"requestId": "x"}}, "requestId must be"),
    ],
)
def test_what_is_no_request_is_answered_with_an_error_and_starts_nothing(message, text):
    session = Session()
    session.raw(message)
    (answer,) = session.taken()
    assert not answer["success"]
    assert text in answer["body"]["error"]["format"]
    assert answer["request_seq"] == (5 if message.get("seq") == 5 else 0)
    assert session.started == 0


def test_bytes_that_are_no_message_are_answered():
    session = Session()
    session.relay.receive(b"Content-Length: 3\r\n\r\n{x}", 0.0)
    (answer,) = session.taken()
    assert answer["body"]["error"]["id"] == MALFORMED


def test_a_process_that_cannot_be_started_is_an_error():
    def fail() -> Process:
        raise OSError("no more processes")

    sent = bytearray()
    relay = Relay(sent.extend, fail)
    relay.receive(framed({"seq": 1, "type": "request", "command": "initialize"}), 0.0)
    (answer,) = Decoder().feed(bytes(sent))
    assert "no more processes" in answer["message"]


class TestTime:
    def test_a_request_without_an_answer_gets_an_error_and_its_late_answer_is_dropped(self):
        session = Session()
        session.client("evaluate", "threads")
        assert session.relay.deadline_s() == ANSWER_S
        session.relay.pass_time(ANSWER_S - 0.01)
        assert session.taken() == []
        session.relay.pass_time(ANSWER_S)
        answers = session.taken()
        assert brief(answers) == [(1, "evaluate", False), (2, "threads", False)]
        assert answers[0]["body"]["error"]["id"] == ENDED
        session.answer("evaluate")
        assert session.taken() == []
        assert not session.process.is_killed
        assert session.relay.deadline_s() is None

    def test_launch_waits_for_the_client_once_it_is_initialized(self):
        session = Session()
        session.client("launch")
        session.relay.worker_sent(event("initialized"))
        assert session.relay.deadline_s() is None

    def test_a_launch_that_hangs_before_is_an_error(self):
        session = Session()
        session.client("launch")
        session.relay.pass_time(ANSWER_S)
        assert brief(session.taken()) == [(1, "launch", False)]

    def test_a_pause_without_a_stop_is_reported_once(self):
        session = Session()
        session.client("pause")
        session.answer("pause")
        session.taken()
        session.relay.pass_time(PAUSE_S)
        (found,) = session.taken()
        assert found["event"] == "output"
        assert "does not return" in found["body"]["output"]
        assert session.relay.deadline_s() is None

    def test_a_pause_with_a_stop_is_not(self):
        session = Session()
        session.client("pause")
        session.answer("pause")
        session.relay.worker_sent(event("stopped"))
        assert session.relay.deadline_s() is None

    def test_disconnect_kills_a_process_that_does_not_answer(self):
        session = Session()
        session.client("evaluate", "disconnect")
        session.relay.pass_time(END_S)
        assert brief(session.taken()) == [(1, "evaluate", False), (2, "disconnect", True)]
        assert session.process.is_killed
        assert session.relay.is_over

    def test_terminate_kills_it_too_and_reports_the_end(self):
        session = Session()
        session.client("launch")
        session.relay.worker_sent(event("initialized"))
        session.answer("launch")
        session.client("terminate", "evaluate", first=2)
        session.taken()
        session.relay.pass_time(END_S)
        assert brief(session.taken()) == [
            (2, "terminate", True),
            "output",
            (3, "evaluate", False),
            "exited",
            "terminated",
        ]
        assert session.process.is_killed
        assert not session.relay.is_over
        session.client("threads", "disconnect", first=4)
        assert brief(session.taken()) == [(4, "threads", False), (5, "disconnect", True)]
        assert session.relay.is_over


class TestEnd:
    def test_disconnect_answers_everything_and_ends(self):
        session = Session()
        session.client("threads", "disconnect", "threads")
        session.answer("disconnect")
        assert brief(session.taken()) == [(1, "threads", False), (3, "threads", False), (2, "disconnect", True)]
        assert session.relay.is_over
        assert session.process.is_killed

    def test_disconnect_before_anything_needs_no_process(self):
        session = Session()
        session.client("disconnect")
        assert brief(session.taken()) == [(1, "disconnect", True)]
        assert session.started == 0
        assert session.relay.is_over

    def test_a_process_that_ends_answers_everything_and_ends_the_session(self):
        session = Session()
        session.client("launch")
        session.relay.worker_sent(event("initialized"))
        session.answer("launch")
        session.client("evaluate", first=2)
        session.taken()
        session.relay.worker_ended("it crashed in line 3 of cell.script")
        messages = session.taken()
        assert brief(messages) == ["output", (2, "evaluate", False), "exited", "terminated"]
        assert "line 3 of cell.script" in messages[0]["body"]["output"]
        assert messages[2]["body"] == {"exitCode": 1}
        session.client("threads", first=3)
        (answer,) = session.taken()
        assert "line 3 of cell.script" in answer["message"]

    def test_a_process_that_ends_after_the_program_says_nothing_twice(self):
        session = Session()
        session.client("launch")
        for name in ("initialized", "exited", "terminated"):
            session.relay.worker_sent(event(name))
        session.taken()
        session.relay.worker_ended("it ended")
        assert brief(session.taken()) == ["output", (1, "launch", False)]

    def test_a_process_that_ends_before_a_launch_reports_no_program(self):
        session = Session()
        session.client("initialize", "disconnect")
        session.relay.worker_ended("it ended")
        assert brief(session.taken()) == ["output", (1, "initialize", False), (2, "disconnect", True)]
        assert session.relay.is_over

    def test_the_end_of_the_input_kills_the_process(self):
        session = Session()
        session.client("initialize")
        session.relay.close()
        assert session.process.is_killed
        assert session.relay.is_over


class TestCancel:
    def test_a_cancelled_request_is_answered_and_what_comes_later_is_dropped(self):
        session = Session()
        session.client("evaluate")
        session.raw({"seq": 2, "type": "request", "command": "cancel", "arguments": {"requestId": 1}})
        answers = session.taken()
        assert brief(answers) == [(1, "evaluate", False), (2, "cancel", True)]
        assert answers[0]["message"] == "cancelled"
        assert answers[0]["body"]["error"]["id"] == CANCELLED
        session.answer("evaluate")
        assert session.taken() == []

    def test_what_is_answered_or_unknown_cannot_be_cancelled(self):
        session = Session()
        session.client("evaluate")
        session.answer("evaluate")
        session.taken()
        session.raw({"seq": 2, "type": "request", "command": "cancel", "arguments": {"requestId": 1}})
        session.raw({"seq": 3, "type": "request", "command": "cancel"})
        assert brief(session.taken()) == [(2, "cancel", True), (3, "cancel", True)]


def test_too_many_requests_are_refused_but_the_session_can_be_ended():
    session = Session()
    session.client(*["threads"] * (PENDING_MAX + 1), "disconnect")
    (answer,) = session.taken()
    assert answer["request_seq"] == PENDING_MAX + 1
    assert "is refused" in answer["message"]
    assert session.process.received[-1]["command"] == "disconnect"
