"""Many clients of the Modbus server at once: what they see is as if one came after the other."""

from __future__ import annotations

import random
from typing import NamedTuple

import pytest

from tests.protocol import modbus_client as client
from tests.protocol.modbus_site import Site


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
