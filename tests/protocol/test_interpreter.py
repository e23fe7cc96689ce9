"""Interpreter mode, 30020."""

from __future__ import annotations

import random

import pytest

from elitescript.messages.inputs import Interpret, InterpreterWord
from elitescript.messages.outputs import Reply
from elitescript.protocol import interpreter
from elitescript.protocol.interpreter import LINE_LIMIT, LINES_PER_TICK, REASONS, WORDS, InterpreterConnection
from tests.protocol.line_peer import Peer

DOCUMENTED_WORDS = [
    "skipbuffer",
    "abort",
    "statelastexecuted",
    "statelastinterpreted",
    "statelastcleared",
    "stateunexecuted",
    "state",
]


def test_a_line_becomes_a_statement_however_it_arrives() -> None:
    line = b'def f(n): ; textmsg("n", n) ; end;\r\n'
    expected = [Interpret("peer#1", 'def f(n): ; textmsg("n", n) ; end;')]
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
        Interpret("peer#1", "a = 1"),
        InterpreterWord("peer#1", "skipbuffer"),
        Interpret("peer#1", "b = 2"),
    ]
    peer.send(b" 3\n")
    assert peer.inputs[-1] == Interpret("peer#1", "c = 3")


@pytest.mark.parametrize("word", DOCUMENTED_WORDS)
def test_words_do_not_wait_their_turn(word: str) -> None:
    peer = Peer(InterpreterConnection)
    peer.send(f" {word} \n{word}()\n".encode())
    assert peer.inputs == [InterpreterWord("peer#1", word), Interpret("peer#1", f"{word}()")]


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
    ("text", "line"),
    [
        (interpreter.acknowledged(1, "g = 5"), b"ack: 1: g = 5\n"),
        (interpreter.discarded(interpreter.TOO_MANY, "g = 5"), b"discard: Too many interpreted messages: g = 5\n"),
        (interpreter.not_compiled("line 1\nat ;", "g ="), b"discard: Compile error:line 1 at ; : g =\n"),
        (interpreter.state_of(7, "statelastexecuted"), b"state: 7: statelastexecuted\n"),
        (interpreter.session_state(True), b"state: 0: running: state\n"),
        (interpreter.session_state(False), b"state: 0: stopped: state\n"),
    ],
)
def test_replies_have_their_form(text: str, line: bytes) -> None:
    assert Peer(InterpreterConnection).tick(Reply("peer#1", text)) == [line]


def test_every_client_hears_of_its_own_statements_alone() -> None:
    peer = Peer(InterpreterConnection, "interpreter#1")
    own, other = Reply("interpreter#1", "ack: 2: b"), Reply("interpreter#12", "ack: 1: a")
    assert peer.tick(other, own, own) == [b"ack: 2: b\n"] * 2
    assert peer.tick() == []


def test_a_line_that_is_no_text_is_discarded() -> None:
    peer = Peer(InterpreterConnection)
    assert peer.send(b"a = '\xff'\n") == [
        "discard: Compile error:the line is not UTF-8 at byte 5 : a = '\ufffd'\n".encode()
    ]
    assert peer.inputs == []


def test_a_line_may_be_as_long_as_the_limit_and_no_longer() -> None:
    peer = Peer(InterpreterConnection)
    assert peer.send(b"a" * LINE_LIMIT + b"\n") == []
    [reply] = peer.send(b"a" * (LINE_LIMIT + 1) + b"\nb\n")
    assert reply == f"discard: Compile error:the line is longer than {LINE_LIMIT} bytes : {'a' * 60}...\n".encode()
    assert [len(item.text) for item in peer.inputs if isinstance(item, Interpret)] == [LINE_LIMIT, 1]


def test_lines_are_read_a_few_in_a_tick_and_the_rest_when_the_client_goes() -> None:
    peer = Peer(InterpreterConnection)
    peer.send(b"a = 1\n" * (3 * LINES_PER_TICK) + b"unfinished")
    assert len(peer.inputs) == LINES_PER_TICK
    assert peer.connection.is_busy
    peer.tick()
    assert len(peer.inputs) == 2 * LINES_PER_TICK
    assert peer.connection.closed() == [Interpret("peer#1", "a = 1")] * LINES_PER_TICK
    assert not peer.connection.is_busy


def test_any_bytes_are_borne() -> None:
    for seed in range(200):
        chance = random.Random(seed)
        peer = Peer(InterpreterConnection)
        for _ in range(5):
            for message in peer.send(chance.randbytes(chance.randrange(80)) + chance.choice([b"", b"\n"])):
                assert message.startswith(b"discard: Compile error:"), seed
                assert message.count(b"\n") == 1, seed
