"""Time waits for the clients of the RTSI port."""

from __future__ import annotations

import asyncio

import pytest

from tests.protocol import rtsi_client
from tests.services.served import Peer, Scene, run, serving


class Partner:
    """A client that takes part."""

    def __init__(self, peer: Peer, ident: int, types: list[str]) -> None:
        self.peer = peer
        self.ident = ident
        self.types = types

    @classmethod
    async def join(cls, scene: Scene, name: str = "input_int_register0", frequency_hz: float = 250.0) -> Partner:
        peer = await scene.connect("rtsi")
        peer.send(rtsi_client.input_recipe([name]))
        ident, types = rtsi_client.set_up((await peer.rtsi("I"))[1])
        peer.send(rtsi_client.output_recipe(frequency_hz, ["timestamp"]) + rtsi_client.message("S"))
        await peer.rtsi("S")
        return cls(peer, ident, types)

    async def take(self) -> int:
        """The tick of the next package."""
        return round(rtsi_client.values((await self.peer.rtsi("U"))[1], ["DOUBLE"])[0] * 250)

    def answer(self, value: int = 0) -> None:
        self.peer.send(rtsi_client.package(self.ident, self.types, [value]))


async def wall_time() -> None:
    """So long that a paced robot would have gone on."""
    await asyncio.sleep(0.02)


def test_time_stands_still_until_the_client_has_answered() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner = await Partner.join(scene)
            begin = await partner.take()
            await wall_time()
            assert scene.station.output.tick == begin
            assert scene.station.waits_for == "rtsi#1"
            for number in range(1, 100):
                partner.answer(number)
                assert await partner.take() == begin + number
            await wall_time()
            assert scene.station.output.tick == begin + 99

    run(test())


def test_a_slower_recipe_makes_longer_steps() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner = await Partner.join(scene, frequency_hz=50.0)
            begin = await partner.take()
            for number in range(1, 10):
                partner.answer()
                assert await partner.take() == begin + 5 * number

    run(test())


def test_time_waits_for_all_who_take_part() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            one = await Partner.join(scene)
            begin = await one.take()
            two = await Partner.join(scene, "input_int_register1")
            assert await two.take() == begin
            one.answer()
            await wall_time()
            assert scene.station.output.tick == begin
            two.answer()
            assert await one.take() == await two.take() == begin + 1

    run(test())


def test_who_only_listens_is_not_asked_and_misses_nothing() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            listener = await scene.connect("rtsi")
            listener.send(rtsi_client.output_recipe(250.0, ["timestamp"]) + rtsi_client.message("S"))
            await listener.rtsi("U")
            partner = await Partner.join(scene)
            begin = await partner.take()
            for _ in range(200):
                partner.answer()
                end = await partner.take()
            assert end == begin + 200
            ticks = []
            while not ticks or ticks[-1] < end:
                ticks.append(round(rtsi_client.values((await listener.rtsi("U"))[1], ["DOUBLE"])[0] * 250))
            assert ticks == list(range(ticks[0], end + 1))

    run(test())


def test_time_goes_on_by_itself_before_and_after() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            await scene.ticks(3)
            partner = await Partner.join(scene)
            await partner.take()
            await scene.stands()
            partner.peer.send(rtsi_client.message("P"))
            await partner.peer.rtsi("P")
            # The pause is an answer as good as any: nobody takes part any more.
            await scene.ticks(3)
            partner.peer.send(rtsi_client.message("S"))
            await partner.take()
            await scene.stands()
            partner.peer.reset()
            await scene.ticks(3)

    run(test())


@pytest.mark.parametrize("farewell", [b"", rtsi_client.message("U", b"\x01")[:1], b"\x00\x00\x00"])
def test_time_does_not_wait_for_who_has_ended_its_half_or_is_closed(farewell: bytes) -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner = await Partner.join(scene)
            await partner.take()
            await scene.stands()
            partner.peer.send(farewell)
            partner.peer.half_close()
            await scene.ticks(3)

    run(test())


def test_others_are_read_while_time_stands_still() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner = await Partner.join(scene)
            await partner.take()
            dashboard = await scene.connect("dashboard")
            await dashboard.reader.readuntil(b"NAME.\r\n")
            for _ in range(300):
                dashboard.send(b"robotMode\n" * 10)
                for _ in range(10):
                    assert await dashboard.line() == "robotMode: RUNNING\r\n"

    run(test())


def test_a_robot_that_fails_ends_its_time_and_not_the_client() -> None:
    async def test() -> None:
        async with serving(is_lockstep=True) as scene:
            partner = await Partner.join(scene)
            begin = await partner.take()

            def fail(tick: int) -> None:
                raise RuntimeError("a mistake of ours")

            scene.robot.on_tick = fail
            partner.answer()
            with pytest.raises(RuntimeError, match="a mistake of ours"):
                await scene.station.task
            assert scene.station.output.tick == begin
            assert not scene.notes("gone")

    run(test())
