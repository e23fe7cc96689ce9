"""Bytes between a client and its connection in ticks."""

from __future__ import annotations

from typing import Any

from elitescript.messages.inputs import AddLog
from elitescript.protocol.connection import Connection, ProtocolError
from elitescript.protocol.transport import READ_MAX, MemoryTransport
from tests.protocol.snapshots import description, output


class Echo(Connection):
    """Says what it gets, one piece in a tick; `!` makes no sense, `.` ends it."""

    __slots__ = ("got", "is_full", "ticks")

    def __init__(self) -> None:
        super().__init__("echo#1", description())
        self.got: list[bytes] = []
        self.ticks: list[int] = []
        self.is_full = False
        self.send(b"hello ")

    @property
    def is_busy(self) -> bool:
        return self.is_full

    def receive(self, data: bytes, output: Any) -> list[Any]:
        if b"!" in data:
            raise ProtocolError("no exclamation marks")
        self.is_full = True
        self.is_over = b"." in data
        self.got.append(data)
        self.send(data)
        return [AddLog("echo#1", "got")]

    def posted(self, tick: int) -> None:
        self.ticks.append(tick)

    def publish(self, output: Any) -> None:
        self.is_full = False

    def closed(self) -> list[Any]:
        self.send(b" bye")
        return [AddLog("echo#1", "closed")]


def texts(inputs: list[Any]) -> list[str]:
    return [item.text for item in inputs]


def test_what_is_sent_goes_in_at_the_next_tick_and_its_answer_comes_out():
    transport = MemoryTransport(Echo())
    transport.send(b"a")
    assert transport.has_sent
    assert transport.next_tick(6) == 7
    assert transport.receive() == b"hello "
    assert texts(transport.take_in(7, output(6))) == ["got"]
    assert transport.receive() == b"a"
    assert transport.connection.ticks == [7]


def test_a_busy_connection_gets_no_more_until_it_has_worked():
    transport = MemoryTransport(Echo())
    transport.send(b"a" * READ_MAX + b"b")
    transport.take_in(1, output(0))
    assert transport.connection.got == [b"a" * READ_MAX]
    transport.take_in(2, output(1))
    assert len(transport.connection.got) == 1
    assert transport.has_sent
    transport.publish(output(2))
    transport.take_in(3, output(2))
    assert transport.connection.got[1:] == [b"b"]
    assert not transport.has_sent


def test_what_was_sent_before_the_end_arrives_first():
    transport = MemoryTransport(Echo())
    transport.send(b"a")
    transport.close()
    assert transport.is_open
    assert texts(transport.take_in(1, output(0))) == ["got", "closed"]
    assert not transport.is_open
    assert transport.receive() == b"hello a bye"
    assert transport.next_tick(1) is None
    assert transport.end() == []


def test_a_mistake_ends_it_with_its_text():
    transport = MemoryTransport(Echo())
    transport.send(b"!")
    assert texts(transport.take_in(1, output(0))) == ["closed"]
    assert (transport.is_open, transport.error) == (False, "no exclamation marks")


def test_the_connection_ends_it_once_all_is_said():
    transport = MemoryTransport(Echo())
    transport.send(b".")
    transport.take_in(1, output(0))
    assert (transport.is_open, transport.error) == (False, "")
    assert transport.receive() == b"hello . bye"


def test_without_bytes_nothing_is_due():
    transport = MemoryTransport(Echo())
    assert not transport.has_sent
    assert transport.next_tick(5) is None
    assert transport.receive(3) == b"hel"
    assert transport.receive() == b"lo "
