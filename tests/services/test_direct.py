"""Clients that time waits for are read past the event loop, and nobody else is held up by it."""

from __future__ import annotations

import asyncio
import select
import selectors
import socket
import struct
import sys
from collections.abc import Callable, Coroutine, Iterator
from itertools import pairwise
from typing import Any

import pytest

from elitescript.messages.inputs import Do, VariablesArrived
from elitescript.services.clients.direct import DirectReading, WatchableLoop
from elitescript.services.clients.tcp import Client
from elitescript.services.time import lockstep
from tests.protocol import rtsi_client
from tests.services.served import LIMIT_S, Scene, serving

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="no event loop can be polled there")


class CountingSelector(selectors.EpollSelector if sys.platform == "linux" else object):  # type: ignore[misc]
    """Counts the turns of a loop."""

    def __init__(self) -> None:
        super().__init__()
        self.turns = 0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        self.turns += 1
        found: list[tuple[selectors.SelectorKey, int]] = super().select(timeout)
        return found


def run_watchable(test: Coroutine[Any, Any, None], selector: CountingSelector) -> None:
    with asyncio.Runner(loop_factory=lambda: WatchableLoop(selector)) as runner:
        runner.run(asyncio.wait_for(test, LIMIT_S))


class HeldClient:
    """What `DirectReading` sees of a client: one end of a pair of sockets."""

    def __init__(self, end: socket.socket) -> None:
        self.origin = "rtsi#1"
        self.end = end
        self.read: list[bytes] = []
        self.held = 0

    def hold(self) -> int:
        self.held += 1
        return self.end.fileno()

    def read_held(self) -> bool:
        self.read.append(self.end.recv(100))
        return bool(self.read[-1])

    def give_back(self) -> None:
        self.held -= 1


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    one, two = socket.socketpair()
    with one, two:
        yield one, two


def test_a_client_is_read_as_often_as_it_sends_and_given_back_once(pair: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = pair

    async def test() -> None:
        direct, client = DirectReading(), HeldClient(ours)
        for data in (b"a", b"b"):
            theirs.send(data)
            assert direct.read(client, 1000)
            assert not direct.is_loop_due
        assert client.read == [b"a", b"b"] and client.held == 1
        assert not direct.read(client, 0)
        direct.release()
        assert client.held == 0
        direct.release()
        assert client.held == 0

    run_watchable(test(), CountingSelector())


def test_what_the_loop_has_to_do_ends_the_wait(pair: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = pair

    async def test() -> None:
        one, two = socket.socketpair()
        with one, two:
            asyncio.get_running_loop().add_reader(one, lambda: one.recv(100))
            two.send(b"x")
            direct, client = DirectReading(), HeldClient(ours)
            assert direct.read(client, 1_000_000)
            assert direct.is_loop_due and not client.read
            theirs.send(b"a")
            assert direct.read(client, 1_000_000)
            assert direct.is_loop_due and client.read == [b"a"]
            direct.release()
            assert not direct.is_loop_due
            asyncio.get_running_loop().remove_reader(one)

    run_watchable(test(), CountingSelector())


@pytest.mark.parametrize("is_shut", [True, False])
def test_the_end_of_a_client_is_left_to_the_loop(pair: tuple[socket.socket, socket.socket], is_shut: bool) -> None:
    ours, theirs = pair

    async def test() -> None:
        direct = DirectReading()
        if is_shut:
            theirs.shutdown(socket.SHUT_WR)
        else:
            theirs.close()
        assert direct.read(HeldClient(ours), 1000)
        assert direct.is_loop_due

    run_watchable(test(), CountingSelector())


def test_a_loop_that_cannot_be_polled_keeps_its_clients(pair: tuple[socket.socket, socket.socket]) -> None:
    async def test() -> None:
        client = HeldClient(pair[0])
        pair[1].send(b"a")
        assert not DirectReading().read(client, 1000)
        assert not client.held and not client.read

    asyncio.run(test())


class Quick:
    """A client in lockstep whose answer is there as soon as time waits for it: it acts within the robot's ticks."""

    def __init__(self, scene: Scene, frequency_hz: float = 250.0) -> None:
        self.scene = scene
        self.socket = socket.create_connection(("127.0.0.1", scene.server.ports["rtsi"]))
        self.socket.setblocking(False)
        self.send(rtsi_client.input_recipe(["input_int_register0"]))
        self.send(rtsi_client.output_recipe(frequency_hz, ["timestamp"]) + rtsi_client.message("S"))

    def send(self, data: bytes) -> None:
        self.socket.send(data)

    def answer(self, value: int = 0) -> None:
        self.send(rtsi_client.package(1, ["INT32"], [value]))

    def taken(self) -> bytes:
        """What has arrived."""
        try:
            return self.socket.recv(1 << 20)
        except BlockingIOError:
            return b""

    async def exchanges(self, count: int, act: Callable[[int], object]) -> None:
        """Answer so many packages, each in the tick that sends it; `act` is called before the answer."""
        number, is_over = 0, asyncio.get_running_loop().create_future()

        def on_tick(tick: int) -> None:
            nonlocal number
            if number == count:
                self.scene.robot.on_tick = lambda tick: None
                is_over.set_result(None)
                return
            number += 1
            act(number)
            self.answer(number)

        while not self.taken():
            await self.scene.ticks()
        self.scene.robot.on_tick = on_tick
        await is_over


def test_an_exchange_takes_no_turn_of_the_event_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lockstep, "TURN_S", 1e9)
    selector, turns = CountingSelector(), list[int]()

    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            client = Quick(scene)
            await client.exchanges(300, lambda number: turns.append(selector.turns))
            with client.socket:
                arrived = [item for _, item in scene.robot.heard if isinstance(item, VariablesArrived)]
                assert len(arrived) == 300

    run_watchable(test(), selector)
    # The client takes part from its first answer on, which the loop reads; a timer of the cycle may expire once more.
    assert turns[-1] - turns[2] < 10


def test_after_a_time_the_event_loop_has_its_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lockstep, "TURN_S", 0.0)
    selector, turns = CountingSelector(), list[int]()

    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            client = Quick(scene)
            await client.exchanges(30, lambda number: turns.append(selector.turns))
            client.socket.close()

    run_watchable(test(), selector)
    assert all(later > earlier for earlier, later in pairwise(turns))


def test_what_others_have_sent_before_an_answer_is_in_its_tick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lockstep, "TURN_S", 1e9)

    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            client = Quick(scene)
            dashboard = socket.create_connection(("127.0.0.1", scene.server.ports["dashboard"]))
            with client.socket, dashboard:
                while not select.select([dashboard], [], [], 0)[0]:
                    await scene.ticks()
                sent: list[int] = []

                def act(number: int) -> None:
                    if number % 10 == 0:
                        sent.append(scene.robot._tick)
                        dashboard.send(b"speed -v %d\n" % number)

                await client.exchanges(100, act)
                asked = [tick for tick, item in scene.robot.heard if isinstance(item, Do) and "dash" in item.origin]
                assert asked == [tick + 1 for tick in sent] and len(sent) == 10

    run_watchable(test(), CountingSelector())


@pytest.mark.parametrize("farewell", ["close", "reset", "shut", "offend"])
def test_a_client_that_ends_in_the_middle_lets_time_go(farewell: str) -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            client = Quick(scene)

            def act(number: int) -> None:
                if number < 20:
                    return
                if farewell == "reset":
                    client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                if farewell == "shut":
                    client.socket.shutdown(socket.SHUT_WR)
                elif farewell == "offend":
                    client.send(b"\x00\x00\x00")
                else:
                    client.socket.close()
                scene.robot.on_tick = lambda tick: None
                client.answer = lambda value: None  # type: ignore[assignment, misc]
                ended.set_result(None)

            ended = asyncio.get_running_loop().create_future()
            exchanges = asyncio.ensure_future(client.exchanges(100, act))
            await ended
            await scene.ticks(5)
            exchanges.cancel()
            if farewell == "offend":
                assert scene.notes("offence")
            client.socket.close()
            while scene.server.listeners["rtsi"].clients:
                await scene.ticks()

    run_watchable(test(), CountingSelector())


def test_what_is_no_answer_is_read_at_the_expense_of_its_sender(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lockstep, "TURN_S", 1e9)
    held: list[str] = []
    ask: list[Callable[[], None]] = []

    def read_held(client: Client) -> bool:
        held.append(client.origin)
        is_read = read(client)
        if len(held) < 9:
            ask[0]()
        return is_read

    read = Client.read_held

    async def test() -> None:
        async with serving(is_lockstep=True, lockstep_timeout_s=1e9) as scene:
            client = Quick(scene)
            ask.append(lambda: client.send(rtsi_client.message("v")))
            with client.socket:
                await client.exchanges(5, lambda number: None)
                monkeypatch.setattr(Client, "read_held", read_held)
                # After the next answer the client only asks.
                scene.robot.on_tick = lambda tick: ask[0]()
                await scene.stands()
                client.taken()
                client.answer()
                while not (answers := client.taken()):
                    await asyncio.sleep(0)
                await scene.stands()
                assert rtsi_client.messages(answers)[0][0] == "U"
                assert scene.server.waits_for and len(held) == 1
                # Each package is a new chance.
                ask[0] = lambda: None
                scene.robot.on_tick = lambda tick: client.answer() if len(held) < 5 else None
                client.answer()
                while len(held) < 5:
                    await asyncio.sleep(0)

    run_watchable(test(), CountingSelector())


def test_a_tick_may_end_the_client_that_reads_on() -> None:
    mistakes: list[Any] = []

    async def test() -> None:
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: mistakes.append(context))
        async with serving(is_lockstep=True, lockstep_timeout_s=1e9) as scene:
            client = Quick(scene)
            with client.socket:
                await client.exchanges(5, lambda number: None)
                await scene.stands()
                (served,) = scene.server.listeners["rtsi"].clients.values()
                transport = served._transport
                assert transport is not None
                while transport.get_write_buffer_size() < 500_000:
                    transport.write(bytes(100_000))
                client.answer()
                while not served.is_behind or served.owes_input:
                    await asyncio.sleep(0)
                await scene.stands()
                # Time goes on as soon as the client reads.
                scene.robot.on_tick = lambda tick: served.close()
                while scene.server.listeners["rtsi"].clients:
                    client.taken()
                    await asyncio.sleep(0)
                await asyncio.sleep(0)

    run_watchable(test(), CountingSelector())
    assert not mistakes
