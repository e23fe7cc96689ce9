"""The query port, 40011."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from elitescript.messages.events import Alarm
from elitescript.messages.inputs import AddLog, Query
from elitescript.messages.outcomes import QueryFailed, ShownValue
from elitescript.messages.outputs import Reply
from elitescript.protocol.bursts import REPORTED_MAX
from elitescript.protocol.query import LINES_PER_TICK, WAITING_LIMIT, QueryConnection, reply_text, without_exponents
from tests.protocol.line_peer import Peer


@pytest.mark.parametrize(
    ("line", "ident", "text"),
    [
        (b"req 4 20 + 22\n", "4", "20 + 22"),
        (b"  req   007   f( 1, 2 )  \r\n", "007", "f( 1, 2 )"),
        (b"req 1pose_trans(a, b)\n", "1", "pose_trans(a, b)"),
        (b"req 1_x\n", "1", "_x"),
    ],
)
def test_a_request_becomes_an_input(line: bytes, ident: str, text: str) -> None:
    whole, trickle = Peer(QueryConnection), Peer(QueryConnection)
    assert whole.greeting == []
    assert whole.send(line) == []
    assert whole.inputs == [Query("peer#1/1", text)]
    for byte in line:
        trickle.send(bytes([byte]))
    assert trickle.inputs == whole.inputs


@pytest.mark.parametrize(
    ("line", "reply"),
    [
        (b"what?\n", b"[-1] [failure] : [parse failed]\n"),
        (b"req\n", b"[-1] [failure] : [parse failed]\n"),
        (b"req x f()\n", b"[-1] [failure] : [parse failed]\n"),
        (b"req -3 f()\n", b"[-1] [failure] : [parse failed]\n"),
        (b"req 3; f()\n", b"[-1] [failure] : [parse failed]\n"),
        ("req ٣ f()\n".encode(), b"[-1] [failure] : [parse failed]\n"),
        (b"req 1234567890123456789 f()\n", b"[-1] [failure] : [parse failed]\n"),
        (b"reqs 3 f()\n", b"[-1] [failure] : [parse failed]\n"),
        (b"req 5\n", b"[5] [failure] : [parse failed]\n"),
        (b"req 5 \xff\n", b"[5] [failure] : [parse failed]\n"),
        (b"req 5 " + b"x" * 20_000 + b"\n", b"[5] [failure] : [parse failed]\n"),
        (b"\xff\xfe\n", b"[-1] [failure] : [parse failed]\n"),
    ],
)
def test_a_request_that_cannot_be_read_fails(line: bytes, reply: bytes) -> None:
    peer = Peer(QueryConnection)
    assert peer.send(line) == [reply]
    assert peer.inputs == []


def test_empty_lines_and_unfinished_ones_are_not_answered() -> None:
    peer = Peer(QueryConnection)
    assert peer.send(b"\n \r\nreq 1 f()") == []
    assert peer.inputs == []


def test_replies_go_to_their_client_one_send_each() -> None:
    peer = Peer(QueryConnection)
    peer.send(b"req 1 a\nreq 2 b\nreq 3 c\n")
    assert peer.tick(
        Reply("peer#1/1", ShownValue("[0.0, 1.5]")),
        Reply("peer#10/1", ShownValue("0")),
        Reply("peer#1/2", QueryFailed(is_compiled=False)),
        Reply("peer#1/3", QueryFailed(is_compiled=True)),
    ) == [b"[1] [success] : [[0.0, 1.5]]\n", b"[2] [failure] : [parse failed]\n", b"[3] [failure] : [execute failed]\n"]


def test_replies_come_in_the_order_of_the_requests() -> None:
    peer = Peer(QueryConnection)
    assert peer.send(b"req 1 a\nwhat?\nreq 3\nreq 4 b\nreq 5 c\n") == []
    assert peer.tick(Reply("peer#1/2", ShownValue("4"))) == []
    assert peer.tick(Reply("peer#1/1", ShownValue("1"))) == [
        b"[1] [success] : [1]\n",
        b"[-1] [failure] : [parse failed]\n",
        b"[3] [failure] : [parse failed]\n",
        b"[4] [success] : [4]\n",
    ]
    assert peer.connection.is_expecting
    assert peer.send(b"what?\n") == []
    assert peer.tick(Reply("peer#1/3", ShownValue("5"))) == [
        b"[5] [success] : [5]\n",
        b"[-1] [failure] : [parse failed]\n",
    ]
    assert not peer.connection.is_expecting
    assert peer.send(b"what?\n") == [b"[-1] [failure] : [parse failed]\n"]


def test_a_value_with_a_line_break_stays_one_line() -> None:
    peer = Peer(QueryConnection)
    peer.send(b"req 1 a\n")
    assert peer.tick(Reply("peer#1/1", ShownValue("a\nb"))) == [b"[1] [success] : [a b]\n"]


def test_requests_that_wait_are_bounded() -> None:
    peer = Peer(QueryConnection)
    answers = peer.send(b"req 1 f()\n" * (WAITING_LIMIT + 1))
    while peer.connection.is_busy:
        answers += peer.tick()
    assert answers == [b"[1] [failure] : [execute failed]\n"]
    assert len(peer.inputs) == WAITING_LIMIT
    peer.tick(Reply("peer#1/1", ShownValue("0")))
    assert peer.send(b"req 2 f()\n") == []


def test_requests_are_read_a_few_in_a_tick() -> None:
    peer = Peer(QueryConnection)
    peer.send(b"req 1 f()\n" * (LINES_PER_TICK + 1))
    assert len(peer.inputs) == LINES_PER_TICK
    assert peer.connection.is_busy
    peer.tick()
    assert len(peer.inputs) == LINES_PER_TICK + 1
    assert not peer.connection.is_busy


def test_requests_fail_that_a_robot_did_not_live_to_answer() -> None:
    peer = Peer(QueryConnection)
    peer.send(b"req 1 f()\nreq 2 g()\n")
    peer.output = replace(peer.output, events=(Alarm(1, "R132", "ControllerRestarted", "it hung", 0, 0, "", ""),))
    assert peer.tick(Reply("peer#1/1", ShownValue("0"))) == [
        b"[1] [success] : [0]\n",
        b"[2] [failure] : [execute failed]\n",
    ]
    peer.output = replace(peer.output, events=())
    assert peer.tick(Reply("peer#1/2", ShownValue("0"))) == []
    assert not peer.connection.is_expecting


def test_any_bytes_are_borne() -> None:
    for seed in range(200):
        chance = random.Random(seed)
        peer = Peer(QueryConnection)
        for _ in range(5):
            data = bytes(chance.choice(b"req 19x\n\r\xff\x00(") for _ in range(chance.randrange(80)))
            for message in peer.send(data):
                assert message.endswith(b"] [failure] : [parse failed]\n"), seed
        assert all(isinstance(item, Query) and item.text for item in peer.inputs)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("[[0.0, -6.1e-17, 1.5]]", "[[0.0, -0.000000000000000061, 1.5]]"),
        ("1e+16", "10000000000000000.0"),
        ("-1.25e+20", "-125000000000000000000.0"),
        ("(1e-05+2e-06j)", "(0.00001+0.000002j)"),
        ("{'a1e5': 1e-07, \"it's 1e5\": b'2e9'}", "{'a1e5': 0.0000001, \"it's 1e5\": b'2e9'}"),
        (r"['\'1e5', 1e-07]", r"['\'1e5', 0.0000001]"),
        ("[True, None, inf, nan, 17]", "[True, None, inf, nan, 17]"),
        ("name_1e5", "name_1e5"),
        ("5e-324", "0." + "0" * 323 + "5"),
    ],
)
def test_numbers_have_no_exponent_and_texts_stay(value: str, shown: str) -> None:
    assert reply_text("1", ShownValue(value)) == f"[1] [success] : [{shown}]"


def test_every_float_keeps_its_value_without_an_exponent() -> None:
    chance = random.Random(1)
    for _ in range(500):
        value = chance.uniform(-10, 10) * 10.0 ** chance.randint(-30, 30)
        shown = without_exponents(repr(value))
        assert "e" not in shown
        assert float(shown) == value


def test_the_plain_form_is_that_of_the_article() -> None:
    peer = Peer(lambda origin, robot: QueryConnection(origin, replace(robot, query_form="plain")))
    assert peer.send(b"what?\n") == [b"-1 failure : parse failed\n"]
    peer.send(b"req 1 a\nreq 2 b\n")
    answers = peer.tick(Reply("peer#1/1", ShownValue("-6.1e-17")), Reply("peer#1/2", QueryFailed(is_compiled=True)))
    assert answers == [b"1 success : -6.1e-17\n", b"2 failure : execute failed\n"]


def warnings(peer: Peer) -> list[str]:
    return [item.text for item in peer.inputs if isinstance(item, AddLog)]


def test_the_log_says_why_a_request_failed() -> None:
    peer = Peer(QueryConnection)
    peer.send(b"req 1 nothing()\n")
    assert peer.tick(Reply("peer#1/1", QueryFailed(is_compiled=True, why="NameError: no")))
    assert warnings(peer) == ["peer#1: `nothing()` failed: NameError: no"]


def test_a_client_that_repeats_what_fails_does_not_fill_the_log() -> None:
    peer = Peer(QueryConnection)
    for number in range(1, 101):
        peer.send(b"req 1 f()\n")
        peer.tick(Reply(f"peer#1/{number}", QueryFailed(is_compiled=True, why="no")), ticks=1)
    for _ in range(300):
        peer.tick(ticks=1)
    assert len(warnings(peer)) == REPORTED_MAX + 1
    assert warnings(peer)[-1] == f"peer#1 sent {100 - REPORTED_MAX} more requests that failed"
    assert peer.connection.next_tick(1000) is None
