"""Who is read in a tick: with a clock that counts what the test says, and with clients in memory."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from elitescript.messages.inputs import AddLog, Input
from elitescript.messages.outputs import Output
from elitescript.protocol.connection import Connection
from elitescript.protocol.ports import SERVICES
from elitescript.services.clients import tcp
from elitescript.services.clients.shares import READ_BUDGET_NS, READ_MAX, READ_MIN, SHARE_NS, Shares
from elitescript.services.clients.tcp import POSTED_MAX, Client
from tests.protocol.snapshots import description, output

QUERY = next(row for row in SERVICES if row.name == "query")


class Clock:
    """Processor time, as the test counts it."""

    def __init__(self) -> None:
        self.ns = 0

    def thread_time_ns(self) -> int:
        return self.ns


class Dear(Connection):
    """Every byte takes time; every `bytes_per_input` bytes are an input."""

    def __init__(self, origin: str, clock: Clock, ns_per_byte: int, bytes_per_input: int = 0) -> None:
        super().__init__(origin, description())
        self.clock, self.ns_per_byte, self.bytes_per_input = clock, ns_per_byte, bytes_per_input
        self.read = 0
        self.is_working = False

    @property
    def is_busy(self) -> bool:
        return self.is_working

    def receive(self, data: bytes, output: Output) -> list[Input]:
        self.clock.ns += self.ns_per_byte * len(data)
        self.read += len(data)
        count = len(data) // self.bytes_per_input if self.bytes_per_input else 0
        return [AddLog(self.origin, "x")] * count

    def publish(self, output: Output) -> None:
        if self.is_working:
            self.clock.ns += 200_000


class Wire:
    """The transport of a client, and what waits in its socket."""

    def __init__(self) -> None:
        self.waiting = 0
        self.is_paused = self.is_closed = False

    def pause_reading(self) -> None:
        self.is_paused = True

    def resume_reading(self) -> None:
        self.is_paused = False

    def is_closing(self) -> bool:
        return self.is_closed

    def get_write_buffer_size(self) -> int:
        return 0

    def get_extra_info(self, name: str) -> None:
        return None

    def set_write_buffer_limits(self, high: int, low: int) -> None:
        """Nothing is written."""


class Hub:
    """A robot with clients in memory; a tick takes no time but what the test counts."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.clock = Clock()
        monkeypatch.setattr(tcp, "time", self.clock)
        self.output = output(0)
        self.shares = Shares()
        self.posted: list[Input] = []
        self.owed: dict[str, int] = {}
        self.clients: list[tuple[Client, Wire]] = []
        self.spent: list[int] = []

    def post(self, inputs: list[Input]) -> None:
        self.posted += inputs

    def waiting_of(self, origin: str) -> int:
        return self.owed.get(origin, 0)

    def wake(self) -> None:
        """Time does not wait here."""

    def make_due(self) -> None:
        """Every tick runs here."""

    def note(self, kind: str, text: str, **details: Any) -> None:
        """Nobody reads the log."""

    def connect(self, ns_per_byte: int, bytes_per_input: int = 0) -> SimpleNamespace:
        connection = Dear(f"query#{len(self.clients) + 1}", self.clock, ns_per_byte, bytes_per_input)
        client, wire = Client(self, QUERY, connection, lambda origin: None, lambda why: None), Wire()
        client.connection_made(wire)
        self.clients.append((client, wire))
        return SimpleNamespace(client=client, wire=wire, connection=connection)

    def tick(self, *, is_late: bool = False) -> None:
        """Publish, then let the event loop read whoever has something and is not held back."""
        for client, _ in self.clients:
            client.publish(self.output)
        before_ns = self.clock.ns
        self.shares.begin_tick(is_late=is_late)
        while True:
            ready = [(client, wire) for client, wire in self.clients if wire.waiting and not wire.is_paused]
            if not ready:
                break
            for client, wire in ready:
                size = min(len(client.get_buffer(-1)), wire.waiting)
                wire.waiting -= size
                client.buffer_updated(size)
        self.spent.append(self.clock.ns - before_ns)


@pytest.fixture
def hub(monkeypatch):
    return Hub(monkeypatch)


@pytest.mark.parametrize("flooders", [1, 8, 64, 400])
@pytest.mark.parametrize("ns_per_byte", [30, 600, 5_000])
def test_floods_take_no_more_than_their_time(hub, flooders, ns_per_byte):
    floods = [hub.connect(ns_per_byte) for _ in range(flooders)]
    for _ in range(400):
        for one in floods:
            one.wire.waiting = 1_000_000
        hub.tick()
    # What the first bytes of a client cost is not known before, and is paid later.
    once_ns = max(SHARE_NS, READ_MIN * ns_per_byte, READ_BUDGET_NS)
    assert hub.spent[0] <= READ_BUDGET_NS + SHARE_NS + 1000 * ns_per_byte + flooders * READ_MIN * ns_per_byte
    assert sum(hub.spent) <= 400 * READ_BUDGET_NS + once_ns
    assert max(hub.spent[1:]) <= READ_BUDGET_NS + once_ns


def test_floods_share_alike(hub):
    floods = [hub.connect(200) for _ in range(20)]
    for _ in range(500):
        for one in floods:
            one.wire.waiting = 1_000_000
        hub.tick()
    read = [one.connection.read for one in floods]
    assert min(read) > 0.6 * max(read)


def test_who_sends_little_is_read_at_once_whoever_floods(hub):
    floods = [hub.connect(300) for _ in range(30)]
    good = hub.connect(500)
    delays = []
    for _ in range(300):
        for one in floods:
            one.wire.waiting = 1_000_000
        good.wire.waiting += 60
        hub.tick()
        delays.append(good.wire.waiting // 60)
    assert max(delays[100:]) <= 1
    assert sum(delays[100:]) < 20


def test_somebody_alone_is_read_as_fast_as_its_share_allows(hub):
    one = hub.connect(10)
    one.wire.waiting = 1_000_000
    ticks = 0
    while one.wire.waiting:
        hub.tick()
        ticks += 1
    assert ticks <= 1_000_000 * 10 // SHARE_NS + 1


def test_who_posts_more_than_the_robot_does_waits_until_it_is_done(hub):
    one = hub.connect(1, bytes_per_input=10)
    hub.owed["query#1"] = POSTED_MAX
    one.wire.waiting = 100_000
    for _ in range(10):
        hub.tick()
    read = one.connection.read
    assert 0 < read <= READ_MAX
    hub.owed["query#1"] = POSTED_MAX - 1
    hub.tick()
    assert one.connection.read > read


def test_work_that_is_done_later_is_paid_for_too(hub):
    working = [hub.connect(1) for _ in range(20)]
    idle = hub.connect(1)
    for one in working:
        one.connection.is_working = True
    idle.wire.waiting = 10
    hub.tick()
    assert hub.shares.spent_ns > READ_BUDGET_NS
    assert idle.connection.read == 10, "who waits for nothing is read when it sends"


def test_who_has_gone_takes_no_turn(hub):
    floods = [hub.connect(300) for _ in range(30)]
    for one in floods:
        one.wire.waiting = 1_000_000
    hub.tick()
    hub.tick()
    for one in floods[:29]:
        one.wire.is_closed, one.wire.waiting = True, 0
        one.client.connection_lost(None)
    read = floods[29].connection.read
    for _ in range(20):
        hub.tick()
    assert floods[29].connection.read > read
    assert hub.shares.waiting <= 1


def test_who_floods_waits_while_ticks_begin_late(hub):
    floods = [hub.connect(300) for _ in range(10)]
    spent = []
    for is_late in (False, True):
        for number in range(100):
            for one in floods:
                one.wire.waiting = 1_000_000
            hub.tick(is_late=is_late)
            if number == 20:
                before_ns = hub.clock.ns
        spent.append(hub.clock.ns - before_ns)
    assert 0 < spent[1] < 0.2 * spent[0]


def test_robots_of_one_process_share_its_time(hub):
    hub.shares.robots = 3
    floods = [hub.connect(300) for _ in range(10)]
    for _ in range(300):
        for one in floods:
            one.wire.waiting = 1_000_000
        hub.tick()
    assert 0.9 * READ_BUDGET_NS / 3 <= sum(hub.spent[100:]) / 200 <= 1.1 * READ_BUDGET_NS / 3


def test_debts_are_not_for_ever():
    shares = Shares()
    shares.charge(10**12)
    for _ in range(300):
        shares.begin_tick()
    assert shares.spent_ns == 0


def test_as_many_bytes_are_read_as_a_share_pays_for():
    shares = Shares()
    assert shares.size_for(0.0) == READ_MAX
    assert shares.size_for(SHARE_NS / 1000) == 1000
    assert shares.size_for(1e9) == READ_MIN
    shares.charge(READ_BUDGET_NS + 1)
    assert shares.size_for(0.0) == READ_MIN
