"""A child that is late: clients get what each tick gave once, in order, and the child is not replaced."""

from __future__ import annotations

import asyncio
import os
import random
from collections.abc import Awaitable, Callable

import pytest

from elitescript.kernel import RobotOptions
from elitescript.messages.outputs import REPEAT_AFTER_S, Output
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.protocol.rtsi.connection import RtsiConnection
from elitescript.protocol.rtsi.recipes import RtsiPort
from elitescript.services.child import buffers
from elitescript.services.child import link as child_link
from elitescript.services.child.buffers import DELAY_MAX_TICKS, REPEAT_AFTER_TICKS
from elitescript.services.child.link import ChildLink
from tests.protocol import rtsi_client
from tests.protocol.snapshots import description
from tests.services.far_child import FarChild, far_children

__all__ = ["far_children"]

pytestmark = pytest.mark.skipif(os.name != "posix", reason="children inherit a socket, as POSIX has it")
LIMIT_S = 30.0


def with_link(body: Callable[[ChildLink], Awaitable[None]], *, grace_s: float = 0.0) -> None:
    async def run() -> None:
        link = ChildLink(RobotOptions(), is_jailed=False, grace_s=grace_s)
        await link.open()
        try:
            await body(link)
        finally:
            await link.close()

    asyncio.run(asyncio.wait_for(run(), LIMIT_S))


class Reader:
    """An RTSI client of one recipe that writes down the ticks of its packages."""

    def __init__(self, frequency_hz: float = 250.0) -> None:
        self.connection = RtsiConnection("rtsi#1", description(), RtsiPort())
        self._recipe = rtsi_client.output_recipe(frequency_hz, ["timestamp"])
        self.ticks: list[int] = []
        self.texts: list[str] = []

    def start(self, output: Output) -> None:
        self.connection.receive(self._recipe + rtsi_client.message("S"), output)
        self._take()

    def publish(self, output: Output) -> None:
        self.connection.publish(output)
        self._take()

    def _take(self) -> None:
        for data in self.connection.take():
            if data[2:3] == b"U":
                self.ticks.append(round(rtsi_client.values(data[3:], ["DOUBLE"])[0] * 250))
            elif data[2:3] == b"M":
                self.texts.append(data[4:].decode())


async def turns(count: int = 4) -> None:
    for _ in range(count):
        await asyncio.sleep(0)


async def answer_all(child: FarChild) -> None:
    """Answer what it has been asked for, two ticks at a time: more are never under way."""
    child.read()
    while child.waiting:
        child.answer(len(child.waiting))
        await turns()


def test_outputs_that_arrive_while_earlier_ones_are_read_keep_their_order(
    far_children: list[FarChild], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What waits goes on in the middle of reading, and reads again: nothing may be read twice then."""
    monkeypatch.setattr(child_link, "LAG_MAX", 3)

    async def body(link: ChildLink) -> None:
        await link.tick((), ALL_PARTS)
        (child,) = far_children
        child.is_prompt = False
        for _ in range(3):
            await link.tick((), ALL_PARTS)
        await turns()

        async def outlet() -> None:
            # No time has passed, but the child has answered.
            child.read()
            child.answer(1)

        asyncio.get_running_loop().call_soon(child.answer, 2)
        found = await link.tick((), ALL_PARTS, asks_due=False, outlet=outlet)
        rows = [row.tick for row in found.rows]
        child.is_prompt = True
        for _ in range(5):
            rows += [row.tick for row in (await link.tick((), ALL_PARTS)).rows]
            await turns()
        assert link.restarts == 0
        assert rows == list(range(1, 1 + len(rows)))
        assert rows[-1] >= 6

    with_link(body)


@pytest.mark.parametrize("seed", range(3))
def test_each_tick_is_a_row_once_whenever_its_output_comes(far_children: list[FarChild], seed: int) -> None:
    chance = random.Random(seed)

    async def body(link: ChildLink) -> None:
        readers = [Reader(250.0), Reader(125.0), Reader(30.0)]
        first = await link.tick((), ALL_PARTS)
        for reader in readers:
            reader.start(first)
        (child,) = far_children
        child.is_prompt = False
        for _ in range(150):

            async def outlet() -> None:
                await turns(chance.randrange(3))
                child.read()
                if chance.random() < 0.8:
                    child.answer(chance.randint(0, len(child.waiting)))

            parts = ALL_PARTS if any(reader.connection.reads(link._next) for reader in readers) else 0
            found = await link.tick((), parts, asks_due=False, outlet=chance.choice([outlet, None]))
            for reader in readers:
                reader.publish(found)
            await turns(chance.randrange(4))
            if chance.random() < 0.7:
                child.answer(chance.randint(0, len(child.waiting)))
        await answer_all(child)
        child.is_prompt = True
        for _ in range(100):
            found = await link.tick((), ALL_PARTS)
            for reader in readers:
                reader.publish(found)
            await turns()
        assert link.restarts == 0
        last = readers[0].ticks[-1]
        assert readers[0].ticks == list(range(last + 1))
        # Its own answers come in the turn after that in which they are asked for.
        assert found.tick - last <= DELAY_MAX_TICKS + 1
        assert readers[1].ticks == list(range(0, last + 1, 2))[: len(readers[1].ticks)]
        assert len(readers[1].ticks) >= last // 2
        steps = {later - earlier for earlier, later in zip(readers[2].ticks, readers[2].ticks[1:], strict=False)}
        assert steps == {8, 9}
        assert not any(reader.texts for reader in readers)

    with_link(body)


def test_a_client_that_starts_while_the_child_is_late_gets_each_tick_once(far_children: list[FarChild]) -> None:
    async def body(link: ChildLink) -> None:
        await link.tick((), ALL_PARTS)
        (child,) = far_children
        child.is_prompt = False
        early, late, later = Reader(), Reader(), Reader()
        found = await link.tick((), ALL_PARTS)
        assert found.rows == ()
        early.start(found)
        assert early.ticks == []
        for _ in range(5):
            await link.tick((), ALL_PARTS)
        await turns()
        await answer_all(child)
        found = await link.tick((), ALL_PARTS)
        early.publish(found)
        assert len(found.rows) > 1
        late.start(found)
        assert late.ticks == [found.rows[-1].tick]
        child.is_prompt = True
        child.read()
        await turns()
        for number in range(8):
            found = await link.tick((), ALL_PARTS)
            for reader in (early, late, later):
                reader.publish(found)
            if number == 3:
                later.start(found)
            await turns()
        for reader in (early, late, later):
            assert reader.ticks == list(range(reader.ticks[0], reader.ticks[0] + len(reader.ticks)))
        assert early.ticks[0] == 1

    with_link(body)


@pytest.fixture
def no_wall_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ticks follow one another at once here: only they count."""
    monkeypatch.setattr(buffers, "REPEAT_AFTER_S", 0.0)


@pytest.mark.usefixtures("no_wall_time")
def test_while_a_child_hangs_streams_repeat_their_last_row_and_leave_nothing_out(far_children: list[FarChild]) -> None:
    lateness = 3 * REPEAT_AFTER_TICKS

    async def body(link: ChildLink) -> None:
        fast, half, slow = Reader(250.0), Reader(125.0), Reader(5.0)
        readers = (fast, half, slow)

        async def ticks(count: int) -> Output:
            for _ in range(count):
                found = await link.tick((), ALL_PARTS)
                for reader in readers:
                    reader.publish(found)
                await turns()
            return found

        first = await link.tick((), ALL_PARTS)
        for reader in readers:
            reader.start(first)
        await ticks(9)
        (child,) = far_children
        child.is_prompt = False
        # What it has answered before.
        await ticks(1)
        last = fast.ticks[-1]
        await ticks(REPEAT_AFTER_TICKS)
        assert fast.ticks == list(range(last + 1))
        # The others of its ticks.
        await ticks(lateness - REPEAT_AFTER_TICKS)
        repeats = lateness - REPEAT_AFTER_TICKS
        assert fast.ticks[last + 1 :] == [last] * repeats
        assert half.ticks[last // 2 + 1 :] == [last // 2 * 2] * (repeats // 2)
        assert slow.ticks == [0, 0]
        child.read()
        while child.waiting:
            child.answer(min(len(child.waiting), 25))
            await turns()
        child.is_prompt = True
        found = await ticks(60)
        assert fast.ticks[last + 1 + repeats :] == list(range(last + 1, fast.ticks[-1] + 1))
        assert found.tick - fast.ticks[-1] <= DELAY_MAX_TICKS + 1
        news = list(dict.fromkeys(half.ticks))
        assert news == list(range(0, news[-1] + 1, 2))
        assert len(half.ticks) == len(news) + repeats // 2
        assert slow.ticks == [0, 0, 50, 100]
        assert not any(reader.texts for reader in readers)

    with_link(body)


def test_the_time_that_a_late_output_was_waited_for_counts(far_children: list[FarChild]) -> None:
    """A tick that waits leaves late; those after it are made up for at once."""

    async def body(link: ChildLink) -> None:
        await link.tick((), ALL_PARTS)
        far_children[0].is_prompt = False
        repeats = [(await link.tick((), ALL_PARTS)).repeats for _ in range(REPEAT_AFTER_TICKS + 1)]
        assert repeats == [False] * REPEAT_AFTER_TICKS + [True]

    with_link(body, grace_s=REPEAT_AFTER_S)


@pytest.mark.usefixtures("no_wall_time")
def test_a_client_that_starts_while_the_child_hangs_gets_the_last_row_at_once(far_children: list[FarChild]) -> None:
    async def body(link: ChildLink) -> None:
        await link.tick((), ALL_PARTS)
        (child,) = far_children
        child.is_prompt = False
        early, late = Reader(), Reader()
        for number in range(2 * REPEAT_AFTER_TICKS):
            found = await link.tick((), ALL_PARTS)
            early.publish(found)
            late.publish(found)
            if number == 2:
                early.start(found)
        late.start(found)
        for _ in range(4):
            late.publish(await link.tick((), ALL_PARTS))
        assert early.ticks == [0] * REPEAT_AFTER_TICKS
        # What nothing read before may be old for a tick more.
        assert late.ticks == [0] * 3
        await answer_all(child)
        child.is_prompt = True
        for _ in range(10):
            late.publish(await link.tick((), ALL_PARTS))
            await turns()
        assert late.ticks[3:] == list(range(1, late.ticks[-1] + 1))
        assert late.ticks[-1] > 2 * REPEAT_AFTER_TICKS

    with_link(body)
