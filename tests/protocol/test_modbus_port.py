"""The controller's own Modbus TCP server, with a kernel behind it."""

from __future__ import annotations

import random
from typing import Any, NamedTuple

import pytest

from elitescript.kernel import Kernel, KernelConfig
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.inputs import Do, Input, SetRemote
from elitescript.messages.machine import SetRunstateChoice, WritePortRegisters
from elitescript.messages.outputs import Reply
from elitescript.protocol.connection import ProtocolError
from elitescript.protocol.modbus_port import REQUESTS_PER_TICK, ModbusConnection, ModbusPort
from elitescript.protocol.query import RESTARTED
from tests.protocol import modbus_client as client
from tests.protocol.line_peer import picture


class Site:
    """One robot and its clients."""

    def __init__(self, **config: Any) -> None:
        self.kernel = Kernel(KernelConfig(**config))
        self.port = ModbusPort(self.kernel.description)
        self.output = self.kernel.tick()
        self.waiting: list[Input] = []
        self.peers: list[Peer] = []

    def connect(self) -> Peer:
        self.peers.append(Peer(self, f"modbus#{len(self.peers) + 1}"))
        return self.peers[-1]

    def tick(self, *inputs: Input) -> None:
        taken, self.waiting = [*inputs, *self.waiting], []
        self.output = self.kernel.tick(taken)
        for peer in self.peers:
            peer.connection.publish(self.output)
            self.waiting += peer.connection.due()
            peer.collect()


class Peer:
    """One client."""

    def __init__(self, site: Site, origin: str) -> None:
        self.site = site
        self.connection = ModbusConnection(origin, site.kernel.description, site.port)
        self.answers: list[tuple[int, int, bytes]] = []

    def send(self, data: bytes) -> None:
        self.site.waiting += self.connection.receive(data, self.site.output)
        self.collect()

    def collect(self) -> None:
        for message in self.connection.take():
            self.answers += client.frames(message)

    def ask(self, pdu: bytes, unit: int = 255, ticks: int = 1) -> bytes:
        """Send one request; return its answer."""
        self.answers.clear()
        self.send(client.frame(7, pdu, unit))
        for _ in range(ticks):
            if not self.answers:
                self.site.tick()
        assert [answer[:2] for answer in self.answers] == [(7, unit)]
        return self.answers[0][2]


@pytest.fixture
def site() -> Site:
    return Site()


@pytest.fixture
def peer(site: Site) -> Peer:
    return site.connect()


def test_reads_are_answered_at_once(peer: Peer) -> None:
    assert client.words(peer.ask(client.read(3, 63, 8), ticks=0)) == [2, 14, 0, 3, 0, 0, 0, 0]
    assert client.words(peer.ask(client.read(4, 63, 2), ticks=0)) == [2, 14]
    assert client.levels(peer.ask(client.read(1, 0, 128), ticks=0), 128) == [False] * 128
    assert client.levels(peer.ask(client.read(2, 60, 3), ticks=0), 3) == [False] * 3


def test_values_are_live() -> None:
    site = Site(power_on=True, signals=(("standard_digital_in[3]", True), ("general_register[4]", 77)))
    peer = site.connect()
    assert client.words(peer.ask(client.read(3, 0, 1))) == [8]
    assert client.words(peer.ask(client.read(3, 66, 2))) == [7, 1]
    assert client.words(peer.ask(client.read(3, 260, 1))) == [77]
    assert client.levels(peer.ask(client.read(2, 0, 8)), 8) == [index == 3 for index in range(8)]


@pytest.mark.parametrize(
    ("request_", "answer", "check", "found"),
    [
        (client.write(5, 33, 0xFF00), "050021ff00", client.read(3, 2, 1), [2]),
        (client.write(5, 33, 0), "0500210000", client.read(3, 2, 1), [0]),
        (client.write(6, 256, 0xABCD), "060100abcd", client.read(3, 256, 1), [0xABCD]),
        (client.write_coils(46, [True] * 4), "0f002e0004", client.read(3, 2, 2), [0xC000, 0x0003]),
        (client.write_registers(256, [1, 2, 3]), "1001000003", client.read(3, 255, 5), [0, 1, 2, 3, 0]),
        (client.write_registers(10, [12, 0]), "10000a0002", client.read(3, 10, 2), [12, 0]),
    ],
)
def test_writes_are_answered_by_the_robot(peer: Peer, request_: bytes, answer: str, check: bytes, found: Any) -> None:
    peer.send(client.frame(1, request_))
    assert peer.answers == []
    assert peer.connection.is_busy
    assert peer.connection.is_expecting
    peer.site.tick()
    assert peer.answers == [(1, 255, bytes.fromhex(answer))]
    assert not peer.connection.is_expecting
    assert client.words(peer.ask(check)) == found


def test_function_23_reads_what_it_wrote(peer: Peer) -> None:
    assert client.words(peer.ask(client.read_write(255, 4, 256, [7, 8]))) == [0, 7, 8, 0]


@pytest.mark.parametrize("unit", [0, 1, 17, 255])
def test_any_unit_is_answered(peer: Peer, unit: int) -> None:
    assert peer.ask(client.read(3, 63, 1), unit) == bytes.fromhex("03020002")


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        (bytes([7]), 1),
        (bytes([43, 14, 1, 0]), 1),
        (client.read(3, 512, 1), 2),
        (client.read(3, 500, 13), 2),
        (client.read(1, 120, 9), 2),
        (client.read(3, 65535, 2), 2),
        (client.write(5, 0, 0xFF00), 2),
        (client.write(5, 31, 0xFF00), 2),
        (client.write(5, 128, 0xFF00), 2),
        (client.write(6, 0, 1), 2),
        (client.write(6, 17, 1), 2),
        (client.write(6, 73, 1), 2),
        (client.write_registers(383, [1, 1]), 2),
        (client.read_write(512, 1, 256, [1]), 2),
        (client.read_write(0, 1, 0, [1]), 2),
        (client.read(3, 0, 0), 3),
        (client.read(3, 0, 126), 3),
        (client.read(1, 0, 2001), 3),
        (client.write(5, 60, 1), 3),
        (client.write(6, 16, 13), 3),
        (client.write(6, 11, 2), 3),
        (client.write(6, 3, 0x1000), 3),
        (client.write(5, 59, 0xFF00), 3),
        (client.write(6, 10, 10001), 3),
        (client.read(3, 0, 1) + b"\0", 3),
        (client.write_registers(256, [1])[:-1], 3),
    ],
)
def test_wrong_requests_get_their_exception(peer: Peer, request_: bytes, code: int) -> None:
    before = peer.site.output.snapshot.signals
    assert peer.ask(request_) == bytes([request_[0] | 0x80, code])
    assert peer.site.output.snapshot.signals == before
    assert client.words(peer.ask(client.read(3, 63, 1))) == [2]


def test_what_the_robot_refuses_is_in_its_log_too(peer: Peer) -> None:
    peer.ask(client.write(6, 16, 13))
    (warning,) = [event for event in peer.site.output.events if isinstance(event, Warned)]
    assert "the tool voltage is 0, 12 or 24 V, got 13" in warning.text


def test_pipelined_requests_are_answered_in_order(peer: Peer) -> None:
    numbers = range(100, 100 + 3 * REQUESTS_PER_TICK)
    data = b"".join(
        client.frame(number, client.write(6, 256, number) if number % 2 else client.read(3, 256, 1))
        for number in numbers
    )
    peer.send(data)
    for _ in numbers:
        peer.site.tick()
    assert [transaction for transaction, _, _ in peer.answers] == list(numbers)
    assert [client.words(pdu) for number, _, pdu in peer.answers if number % 2 == 0] == [
        [0 if number == 100 else number - 1] for number in numbers if number % 2 == 0
    ]


def test_a_client_that_floods_takes_so_much_of_a_tick_and_no_more(peer: Peer) -> None:
    peer.send(b"".join(client.frame(number, client.read(3, 0, 100)) for number in range(300)))
    assert len(peer.answers) == REQUESTS_PER_TICK
    assert peer.connection.is_busy
    peer.site.tick()
    assert len(peer.answers) == 2 * REQUESTS_PER_TICK
    for _ in range(300 // REQUESTS_PER_TICK):
        peer.site.tick()
    assert [transaction for transaction, _, _ in peer.answers] == list(range(300))
    assert not peer.connection.is_busy


def test_while_no_tick_comes_reads_go_on_up_to_a_write(peer: Peer) -> None:
    requests = [client.read(3, 0, 1)] * (2 * REQUESTS_PER_TICK) + [client.write(6, 256, 1), client.read(3, 256, 1)]
    peer.send(b"".join(client.frame(number, pdu) for number, pdu in enumerate(requests)))
    for _ in range(5):
        peer.site.waiting += peer.connection.read_on(peer.site.output)
        peer.collect()
    assert len(peer.answers) == 2 * REQUESTS_PER_TICK
    peer.site.tick()
    assert client.words(peer.answers[-1][2]) == [1]


def test_a_stream_may_come_in_any_pieces() -> None:
    requests = [
        client.read(3, 60, 10),
        client.write_registers(256, [5, 6]),
        client.read(3, 256, 2),
        bytes([99]),
        client.write(5, 60, 0xFF00),
        client.read(1, 60, 1),
    ]
    data = b"".join(client.frame(number, pdu) for number, pdu in enumerate(requests))
    wanted = None
    for size in (1, 2, 3, 7, 11, len(data)):
        peer = Site().connect()
        for at in range(0, len(data), size):
            peer.send(data[at : at + size])
        for _ in requests:
            peer.site.tick()
        wanted = wanted or peer.answers
        assert len(peer.answers) == len(requests)
        assert peer.answers == wanted


def test_a_frame_of_another_protocol_is_left_out(peer: Peer) -> None:
    foreign = b"\0\1\0\5" + client.frame(1, client.read(3, 0, 1))[4:]
    peer.send(foreign + client.frame(2, client.read(3, 63, 1)))
    assert [transaction for transaction, _, _ in peer.answers] == [2]


@pytest.mark.parametrize("garbage", [b"GET / HTTP/1.1\r\n", b"\0\1\0\0\0\1\xff", b"\0\1\0\0\1\0\xff"])
def test_what_is_no_modbus_closes_the_connection_after_the_answers_due(peer: Peer, garbage: bytes) -> None:
    with pytest.raises(ProtocolError, match="this is no Modbus TCP"):
        peer.send(garbage)
    other = peer.site.connect()
    other.send(client.frame(1, client.write(6, 256, 5)) + garbage)
    assert other.answers == []
    with pytest.raises(ProtocolError, match="this is no Modbus TCP"):
        peer.site.tick()
    other.collect()
    assert other.answers == [(1, 255, client.write(6, 256, 5))]
    assert other.connection.is_over
    other.connection.publish(peer.site.output)


def test_random_bytes_are_answered_or_closed_and_nothing_else(site: Site) -> None:
    chance = random.Random(3)
    for _ in range(200):
        peer = site.connect()
        pdu = bytes([chance.choice([0, 1, 3, 5, 6, 15, 16, 23, chance.randrange(256)])]) + chance.randbytes(
            chance.randrange(20)
        )
        peer.send(client.frame(9, pdu))
        site.tick()
        assert [(transaction, unit) for transaction, unit, _ in peer.answers] == [(9, 255)]
        noise = site.connect()
        try:
            noise.send(chance.randbytes(chance.randrange(1, 300)))
            site.tick()
        except ProtocolError:
            assert noise.connection.is_over
        site.peers.clear()


def test_a_robot_that_is_started_anew_has_not_taken_what_waits(site: Site, peer: Peer) -> None:
    peer.send(client.frame(1, client.write(6, 256, 1)) + client.frame(2, client.read(3, 256, 1)))
    (asked,) = site.waiting
    assert asked == Do("modbus#1/1", WritePortRegisters(256, (1,)), is_answered=True)
    alarm = Alarm(1, RESTARTED, "Restarted", "", 0, 0, "", "")
    peer.connection.publish(picture(1, events=(alarm,)))
    peer.collect()
    assert [pdu for _, _, pdu in peer.answers] == [bytes([0x86, 4]), bytes.fromhex("03020000")]


def test_a_robot_that_shows_what_was_not_asked_for_has_failed(peer: Peer) -> None:
    for number, detail in enumerate(("", "00", "000x", "00000000"), 1):
        peer.answers.clear()
        peer.send(client.frame(1, client.read_write(256, 1, 256, [1])))
        reply = Reply(f"modbus#1/{number}", f"done: {detail}" if detail else "done")
        peer.connection.publish(picture(1, replies=(reply,)))
        peer.collect()
        assert peer.answers == [(1, 255, bytes([0x97, 4]))]


def test_an_answer_for_somebody_else_is_none(peer: Peer) -> None:
    peer.send(client.frame(1, client.write(6, 256, 1)))
    for origin in ("modbus#1", "modbus#1/2", "modbus#11/1"):
        peer.connection.publish(picture(1, replies=(Reply(origin, "done"),)))
    peer.collect()
    assert peer.answers == []


def test_local_control_makes_no_difference(peer: Peer) -> None:
    peer.site.tick(SetRemote("ctl", False))
    assert not peer.site.output.snapshot.is_remote
    assert peer.ask(client.write(5, 32, 0xFF00)) == client.write(5, 32, 0xFF00)


def test_an_output_that_is_tied_to_the_task_keeps_what_was_written(peer: Peer) -> None:
    site = peer.site
    from elitescript.messages.enums import RunstateChoice

    site.tick(Do("ctl", SetRunstateChoice("standard_digital_out", 0, RunstateChoice.HIGH_WHEN_STOPPED)))
    assert peer.ask(client.write(5, 32, 0)) == client.write(5, 32, 0)
    assert client.words(peer.ask(client.read(3, 2, 1))) == [1]
    site.tick(Do("ctl", SetRunstateChoice("standard_digital_out", 0, RunstateChoice.KEEP)))
    assert client.words(peer.ask(client.read(3, 2, 1))) == [0]


# ---------------------------------------------------------------------------------------- many clients at once


class Act(NamedTuple):
    """A request of a client with the moments at which it was sent and answered."""

    peer: int
    register: int
    wrote: int | None
    sent: int
    answered: int
    read: int | None


class Story:
    """Clients that read and write general registers in a random order, and what came of it."""

    REGISTERS = 3

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.site = Site()
        self.clients = [self.site.connect() for _ in range(self.chance.randrange(2, 6))]
        self.open: list[dict[int, tuple[int, int | None, int]]] = [{} for _ in self.clients]
        self.unsent = [b"" for _ in self.clients]
        self.moment = 0
        self.next_value = 0
        self.acts: list[Act] = []
        for _ in range(400):
            self.go_on()
        while any(self.unsent) or any(self.open):
            for index in range(len(self.clients)):
                self.flush(index, len(self.unsent[index]))
            self.tick()

    def go_on(self) -> None:
        index = self.chance.randrange(len(self.clients))
        what = self.chance.random()
        if what < 0.35:
            self.request(index)
        elif what < 0.75:
            self.flush(index, self.chance.randrange(1, 30))
        else:
            self.tick()

    def request(self, index: int) -> None:
        register, value = self.chance.randrange(self.REGISTERS), None
        self.moment += 1
        if self.chance.random() < 0.5:
            self.next_value += 1
            value = self.next_value
        address = 256 + register
        kind = self.chance.random()
        if value is None:
            pdu = client.read(self.chance.choice([3, 4]), address, 1)
        elif kind < 0.4:
            pdu = client.write(6, address, value)
        elif kind < 0.7:
            pdu = client.write_registers(address, [value])
        else:
            pdu = client.read_write(address, 1, address, [value])
        self.unsent[index] += client.frame(self.moment, pdu)
        self.open[index][self.moment] = (register, value, self.moment)

    def flush(self, index: int, size: int) -> None:
        piece, self.unsent[index] = self.unsent[index][:size], self.unsent[index][size:]
        if piece:
            self.clients[index].send(piece)
        self.note()

    def tick(self) -> None:
        self.site.tick()
        self.note()

    def note(self) -> None:
        for index, peer in enumerate(self.clients):
            for transaction, _, pdu in peer.answers:
                self.moment += 1
                assert transaction == next(iter(self.open[index])), "answers come in the order of requests"
                register, value, sent = self.open[index].pop(transaction)
                assert pdu[0] < 0x80
                read = client.words(pdu)[0] if pdu[0] in (3, 4, 23) else None
                self.acts.append(Act(index, register, value, sent, self.moment, read))
            peer.answers.clear()


@pytest.mark.parametrize("seed", range(40))
def test_reads_and_writes_of_many_clients_are_as_if_one_came_after_the_other(seed: int) -> None:
    story = Story(seed)
    assert len(story.acts) > 60
    writes = {act.wrote: act for act in story.acts if act.wrote is not None}
    for read in story.acts:
        if read.read is None:
            continue
        before = [act for act in writes.values() if act.register == read.register and act.answered < read.sent]
        if read.read == 0:
            assert not before, "a write that was answered is lost"
            continue
        source = writes[read.read]
        assert source.register == read.register
        assert source.sent < read.answered, "a value is read before it is written"
        assert not any(act.sent > source.answered for act in before), "an old value is read"
        if read.wrote is not None:
            assert read.read == read.wrote, "somebody came between the halves of function 23"
    # Reads that follow one another never go back.
    for first in story.acts:
        for second in story.acts:
            if (
                first.register == second.register
                and first.read
                and second.read
                and first.answered < second.sent
                and first.read != second.read
            ):
                assert not writes[second.read].answered < writes[first.read].sent


@pytest.mark.parametrize("seed", range(10))
def test_clients_that_write_coils_of_one_word_lose_none(seed: int) -> None:
    chance, site = random.Random(seed), Site()
    peers = [site.connect() for _ in range(8)]
    wanted = [False] * 16
    for _ in range(150):
        index = chance.randrange(len(peers))
        own = chance.randrange(2)
        wanted[2 * index + own] = level = chance.random() < 0.5
        address = 32 + 2 * index + own
        pdu = (
            client.write(5, address, 0xFF00 * level) if chance.random() < 0.5 else client.write_coils(address, [level])
        )
        peers[index].send(client.frame(1, pdu))
        if chance.random() < 0.3:
            site.tick()
    while any(peer.connection.is_expecting for peer in peers):
        site.tick()
    assert client.levels(peers[0].ask(client.read(1, 32, 16)), 16) == wanted
