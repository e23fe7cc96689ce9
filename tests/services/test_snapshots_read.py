"""At which ticks a served robot makes a snapshot: only those of which something reads more than the discrete state."""

from __future__ import annotations

import asyncio
import contextlib
import struct
import tempfile
from collections.abc import AsyncIterator
from itertools import pairwise
from pathlib import Path

import pytest

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import Do, RunUnit, SetRemote
from elitescript.messages.machine import SetSpeedScale, WriteSignal
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS, TCP_SPEEDS, TIME, WRENCHES
from elitescript.services.control.channel import ControlChannel, ask
from elitescript.services.time.cycle import OUTLET_NS, PERIOD_NS
from tests.protocol import modbus_client, rtsi_client
from tests.services.made_up_time import timed
from tests.services.served import Scene, run, serving

MOVING = (
    "def p():\n  while True:\n    movej([0.4, -1.4, -1.7, -1.6, 1.57, 0])\n    movej([0, -1.4, -1.7, -1.6, 1.57, 0])\n"
)
TICKS = 60


class CountingKernel(Kernel):
    """Notes the ticks of which a snapshot is made."""

    def __init__(self) -> None:
        super().__init__(RobotOptions(power_on=True))
        self.shown: list[int] = []
        self.parts = 0
        """Of all of them, as bits."""

    def snapshot(self, parts: int = ALL_PARTS) -> Snapshot:
        made = super().snapshot(parts)
        self.shown.append(made.robot.tick)
        self.parts |= parts
        return made


@contextlib.asynccontextmanager
async def moving() -> AsyncIterator[Scene]:
    """A robot that moves, and that nothing reads."""
    async with serving(CountingKernel()) as scene:
        scene.server.post([RunUnit("primary#1", "program", MOVING)])
        await scene.until(lambda: scene.server.output.snapshot.robot.is_moving)
        yield scene


async def made_in(scene: Scene, ticks: int = TICKS) -> list[int]:
    """Of so many ticks those with a snapshot, counted from the first one."""
    begin = scene.server.output.tick + 1
    scene.robot.shown.clear()
    scene.robot.parts = 0
    while scene.server.output.tick < begin + ticks:
        await asyncio.sleep(0.001)
    return [tick - begin for tick in scene.robot.shown if tick < begin + ticks]


def test_without_clients_there_is_none() -> None:
    async def test() -> None:
        async with moving() as scene:
            assert await made_in(scene) == []

    run(test())


def test_a_recipe_is_read_when_it_is_due() -> None:
    async def test() -> None:
        async with moving() as scene:
            peer = await scene.connect("rtsi")
            peer.send(rtsi_client.output_recipe(25.0, ["timestamp"]) + rtsi_client.message("S"))
            await peer.rtsi("U")
            found = await made_in(scene)
            assert len(found) == TICKS // 10
            assert {later - tick for tick, later in pairwise(found)} == {10}
            assert scene.robot.parts == TIME
            # Every package is of its own tick.
            times = [int.from_bytes((await peer.rtsi("U"))[1][1:9]) for _ in range(3)]
            assert len(set(times)) == 3

    run(test())


def test_a_recipe_that_comes_while_packages_flow_begins_with_a_package_of_its_tick(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def test() -> None:
        async with timed(monkeypatch, CountingKernel()) as (_, wall, connect):
            begin_ns = wall.now_ns
            stream = connect("rtsi")
            stream.send(rtsi_client.output_recipe(1.0, ["timestamp"]) + rtsi_client.message("S"))
            # A tick is under way, of which nothing has asked for a snapshot.
            await wall.go_to(begin_ns + 100 * PERIOD_NS - 1)
            stream.client._hub.post([])
            await wall.go_to(begin_ns + 100 * PERIOD_NS + OUTLET_NS // 2)
            stream.send(rtsi_client.output_recipe(1.0, ["timestamp"]))
            stream.written.clear()
            await wall.go_to(begin_ns + 102 * PERIOD_NS)
            ((_, package),) = stream.written
            assert struct.unpack(">d", package[4:])[0] == 101 * 0.004

    run(test())


def test_clients_of_the_primary_port_read_ten_a_second() -> None:
    async def test() -> None:
        async with moving() as scene:
            peer = await scene.connect("primary")
            await peer.primary(16)
            assert len(await made_in(scene, 75)) == 3
            assert scene.robot.parts == ALL_PARTS & ~(TCP_SPEEDS | WRENCHES)

    run(test())


@pytest.mark.parametrize("service", ["dashboard", "interpreter", "query", "readonly"])
def test_other_clients_read_none_while_they_wait(service: str) -> None:
    async def test() -> None:
        async with moving() as scene:
            await scene.connect(service)
            await asyncio.sleep(0.02)
            assert len(await made_in(scene)) <= (3 if service == "readonly" else 0)

    run(test())


def test_what_changes_in_steps_is_always_shown() -> None:
    async def test() -> None:
        async with moving() as scene:
            dashboard = await scene.connect("dashboard")
            scene.server.post([Do("test", SetSpeedScale(0.25)), Do("test", WriteSignal("flag", 2, True))])
            scene.server.post([SetRemote("test", False)])
            await made_in(scene, 5)
            snapshot = scene.server.output.snapshot
            assert (snapshot.robot.speed_scale, snapshot.signals["flag"][2], snapshot.is_remote) == (0.25, True, False)
            dashboard.send(b"speed\n")
            while not (line := await dashboard.line()).startswith("Target Speed"):
                pass
            assert "25" in line
            assert not scene.server.output.has(ALL_PARTS)

    run(test())


def test_the_first_answers_of_a_new_client_are_not_old() -> None:
    async def test() -> None:
        async with moving() as scene:
            await made_in(scene, 30)
            before = scene.server.output.tick
            peer = await scene.connect("rtsi")
            peer.send(rtsi_client.output_recipe(250.0, ["timestamp"]) + rtsi_client.message("S"))
            _, body = await peer.rtsi("U")
            assert struct.unpack(">d", body[1:9])[0] >= before * 0.004
            await peer.close()
            await made_in(scene, 30)
            joints = scene.server.output.snapshot.robot.q_actual
            modbus = await scene.connect("modbus")
            modbus.send(modbus_client.frame(1, modbus_client.read(3, 270, 6)))
            await modbus.reader.readexactly(9)
            assert scene.server.output.snapshot.robot.q_actual != joints

    run(test())


def test_ctl_tells_where_the_arm_is_now(monkeypatch: pytest.MonkeyPatch) -> None:
    async def test() -> None:
        with tempfile.TemporaryDirectory(prefix="es") as folder:
            monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
            async with moving() as scene:
                channel = ControlChannel(scene.server, 0)
                await channel.open()
                await made_in(scene, 30)
                before = scene.server.output.tick
                state = (await asyncio.to_thread(ask, Path(channel.address), "state", [], {}))["result"]
                assert state["time_s"] >= before * 0.004
                assert state["time_s"] == pytest.approx(state["tick"] * 0.004)
                await channel.close()

    run(test())
