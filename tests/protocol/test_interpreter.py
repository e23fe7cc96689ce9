"""Interpreter mode, 30020."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from elitescript.messages.enums import DiscardReason
from elitescript.messages.events import Alarm
from elitescript.messages.inputs import Interpret, InterpreterWord
from elitescript.messages.outcomes import (
    Done,
    InterpreterOutcome,
    SessionState,
    StatementAccepted,
    StatementDiscarded,
    StatementNumber,
)
from elitescript.messages.outputs import Reply
from elitescript.protocol.interpreter import LINE_LIMIT, LINES_PER_TICK, REASONS, WORDS, InterpreterConnection
from tests.protocol.line_peer import Peer
from tests.protocol.snapshots import description, output

DOCUMENTED_WORDS = [
    "skipbuffer",
    "abort",
    "statelastexecuted",
    "statelastinterpreted",
    "statelastcleared",
    "stateunexecuted",
    "state",
]


def test_a_function_on_several_lines_is_one_statement() -> None:
    client = InterpreterConnection("interpreter#2", description())
    text = "def f(n):\n  if n > 1:\n    state = n\n  end\n\n  textmsg(n)\nend"
    first, second = client.receive(f"{text}\r\nf(2)\n".replace("\n", "\r\n", 2).encode(), output())
    assert first == Interpret("interpreter#2/1", text)
    assert second == Interpret("interpreter#2/2", "f(2)")


def test_the_words_inside_a_function_are_its_lines() -> None:
    client = InterpreterConnection("interpreter#2", description())
    (only,) = client.receive(b"def f():\nstate\nend\n", output())
    assert only == Interpret("interpreter#2/1", "def f():\nstate\nend")


def test_a_function_on_one_line_is_a_line() -> None:
    client = InterpreterConnection("interpreter#2", description())
    line = "def f(n): ; textmsg(n) ; end;"
    assert client.receive(f"{line}\nstate\n".encode(), output()) == [
        Interpret("interpreter#2/1", line),
        InterpreterWord("interpreter#2/2", "state"),
    ]


def test_a_function_without_its_end_is_discarded_when_its_client_goes() -> None:
    client = InterpreterConnection("interpreter#2", description())
    assert client.receive(b"def f():\n  textmsg(1)\n", output()) == []
    (only,) = client.closed()
    assert isinstance(only, Interpret)
    assert only.problem == "line 1, column 1, the function has no `end` at the start of a line"
    assert only.text.startswith("def f():   textmsg(1)")


def test_a_function_that_never_ends_is_not_kept() -> None:
    client = InterpreterConnection("interpreter#2", description())
    inputs = client.receive(b"def f():\n", output())
    for tick in range(1001, 1001 + 40):
        inputs += client.receive(b"  x = 1" + b" " * 4000 + b"\n", output(tick))
    assert inputs == []
    assert sum(map(len, client._block)) < 66_000
    (only,) = client.receive(b"end\n", output(2000))
    assert isinstance(only, Interpret)
    assert only.problem == "line 18, column 1, the function is longer than 65536 bytes"


def test_a_line_becomes_a_statement_however_it_arrives() -> None:
    line = b'def f(n): ; textmsg("n", n) ; end;\r\n'
    expected = [Interpret("peer#1/1", 'def f(n): ; textmsg("n", n) ; end;')]
    whole, trickle = Peer(InterpreterConnection), Peer(InterpreterConnection)
    assert whole.greeting == []
    assert whole.send(line) == []
    assert whole.inputs == expected
    for byte in line:
        assert trickle.send(bytes([byte])) == []
    assert trickle.inputs == expected


def test_lines_keep_their_order_and_a_rest_waits() -> None:
    peer = Peer(InterpreterConnection)
    peer.send(b"a = 1\nskipbuffer\n\nb = 2\nc =")
    assert peer.inputs == [
        Interpret("peer#1/1", "a = 1"),
        InterpreterWord("peer#1/2", "skipbuffer"),
        Interpret("peer#1/3", "b = 2"),
    ]
    peer.send(b" 3\n")
    assert peer.inputs[-1] == Interpret("peer#1/4", "c = 3")


@pytest.mark.parametrize("word", DOCUMENTED_WORDS)
def test_words_do_not_wait_their_turn(word: str) -> None:
    peer = Peer(InterpreterConnection)
    peer.send(f" {word} \n{word}()\n".encode())
    assert peer.inputs == [InterpreterWord("peer#1/1", word), Interpret("peer#1/2", f"{word}()")]


def test_the_table_has_the_documented_words() -> None:
    assert list(WORDS) == DOCUMENTED_WORDS
    assert [reason.text for reason in REASONS] == [
        "Compile error",
        "Task is in an invalid state",
        "Too many interpreted messages",
        "Cleaned up before interpretation",
        "Cleaned up after end",
        "Cleaned up",
    ]


@pytest.mark.parametrize(
    ("outcome", "line"),
    [
        (StatementAccepted(1, "g = 5"), b"ack: 1: g = 5\n"),
        (StatementDiscarded(DiscardReason.TOO_MANY, "g = 5"), b"discard: Too many interpreted messages: g = 5\n"),
        (
            StatementDiscarded(DiscardReason.COMPILE_ERROR, "g =", "line 1\nat ;"),
            b"discard: Compile error:line 1 at ; : g =\n",
        ),
        (StatementNumber("statelastexecuted", 7), b"state: 7: statelastexecuted\n"),
        (SessionState(True), b"state: 0: running: state\n"),
        (SessionState(False), b"state: 0: stopped: state\n"),
    ],
)
def test_replies_have_their_form(outcome: InterpreterOutcome, line: bytes) -> None:
    assert Peer(InterpreterConnection).tick(Reply("peer#1/1", outcome)) == [line]


def test_every_client_hears_of_its_own_statements_alone() -> None:
    peer = Peer(InterpreterConnection, "interpreter#1")
    own, other = (
        Reply("interpreter#1/2", StatementAccepted(2, "b")),
        Reply("interpreter#12/1", StatementAccepted(1, "a")),
    )
    assert peer.tick(other, own, own) == [b"ack: 2: b\n"] * 2
    assert peer.tick() == []


def test_an_outcome_of_another_port_is_not_sent() -> None:
    peer = Peer(InterpreterConnection)
    assert peer.tick(Reply("peer#1/1", Done())) == []


def test_a_line_that_is_no_text_waits_its_turn_to_be_discarded() -> None:
    peer = Peer(InterpreterConnection)
    assert peer.send(b"a = '\xff'\n") == []
    assert peer.inputs == [Interpret("peer#1/1", "a = '\ufffd'", "the line is not UTF-8 at byte 5")]


def test_a_line_may_be_as_long_as_the_limit_and_no_longer() -> None:
    peer = Peer(InterpreterConnection)
    peer.send(b"a" * LINE_LIMIT + b"\n")
    peer.send(b"a" * (LINE_LIMIT + 1) + b"\nb\n")
    whole, long, short = peer.inputs
    assert whole == Interpret("peer#1/1", "a" * LINE_LIMIT)
    assert long == Interpret("peer#1/2", "a" * 60 + "...", f"the line is longer than {LINE_LIMIT} bytes")
    assert short == Interpret("peer#1/3", "b")


class TestRestart:
    """The robot is gone, and another one goes on in its place."""

    LOST = Alarm(1, "R132", "ControllerRestarted", "it hung", 0, 0, "", "")

    def restart(self, peer: Peer, *replies: Reply) -> list[bytes]:
        peer.output = replace(peer.output, tick=peer.output.tick + 1, replies=replies, events=(self.LOST,))
        peer.connection.publish(peer.output)
        peer.output = replace(peer.output, events=())
        return peer.connection.take()

    def test_every_line_without_a_reply_gets_one(self) -> None:
        peer = Peer(InterpreterConnection)
        peer.send(b"a = 1\nb = 2\n\xff\nskipbuffer\nstate\nstateunexecuted\n")
        assert self.restart(peer, Reply("peer#1/1", StatementAccepted(1, "a = 1"))) == [
            b"ack: 1: a = 1\n",
            b"discard: Task is in an invalid state: b = 2\n",
            "discard: Compile error:the line is not UTF-8 at byte 0 : \ufffd\n".encode(),
            b"state: 0: stopped: state\n",
            b"state: 0: stateunexecuted\n",
        ]

    def test_the_new_robot_is_not_heard_twice(self) -> None:
        peer = Peer(InterpreterConnection)
        peer.send(b"a = 1\n")
        self.restart(peer)
        again = Reply("peer#1/1", StatementDiscarded(DiscardReason.INVALID_STATE, "a = 1"))
        assert peer.tick(again) == []
        peer.send(b"b = 2\n")
        assert peer.tick(Reply("peer#1/2", StatementDiscarded(DiscardReason.INVALID_STATE, "b = 2"))) == [
            b"discard: Task is in an invalid state: b = 2\n"
        ]

    def test_what_was_answered_is_not_answered_again(self) -> None:
        peer = Peer(InterpreterConnection)
        peer.send(b"a = 1\n")
        peer.tick(Reply("peer#1/1", StatementAccepted(1, "a = 1")))
        assert self.restart(peer) == []


def test_lines_are_read_a_few_in_a_tick_and_the_rest_when_the_client_goes() -> None:
    peer = Peer(InterpreterConnection)
    peer.send(b"a = 1\n" * (3 * LINES_PER_TICK) + b"unfinished")
    assert len(peer.inputs) == LINES_PER_TICK
    assert peer.connection.is_busy
    peer.tick()
    assert len(peer.inputs) == 2 * LINES_PER_TICK
    left = peer.connection.closed()
    assert left == [Interpret(f"peer#1/{2 * LINES_PER_TICK + n}", "a = 1") for n in range(1, LINES_PER_TICK + 1)]
    assert not peer.connection.is_busy


def test_any_bytes_are_borne_and_cut_the_same_way_however_they_arrive() -> None:
    for seed in range(100):
        chance = random.Random(seed)
        data = b"".join(
            chance.choice([chance.randbytes(chance.randrange(40)), b"skipbuffer", b" g = 1 ", "µ".encode()])
            + chance.choice([b"", b"\n", b"\r\n"])
            for _ in range(10)
        )
        whole, trickle = Peer(InterpreterConnection), Peer(InterpreterConnection)
        assert whole.send(data) == []
        for byte in data:
            assert trickle.send(bytes([byte])) == []
        whole.tick()
        trickle.tick()
        assert whole.inputs == trickle.inputs, seed
        assert [item.origin for item in whole.inputs] == [f"peer#1/{n + 1}" for n in range(len(whole.inputs))]
