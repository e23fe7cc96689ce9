"""Which ticks a served robot runs: those in which something is due or is read, and no others."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from typing import Any

import pytest

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import Do, Input, RunUnit
from elitescript.messages.machine import WriteSignal
from elitescript.messages.outputs import TickResult
from elitescript.messages.snapshot_parts import ALL_PARTS, TIME
from elitescript.services.time.cycle import LEAP_MAX_TICKS, PERIOD_NS
from tests.protocol import modbus_client, rtsi_client
from tests.services.made_up_time import Line, WallClock, timed
from tests.services.served import Scene

MOVE = "def p():\n  movej([0.4, -1.4, -1.7, -1.6, 1.57, 0])\n  sleep(1)\n  textmsg('there')\nend\n"


class CountingKernel(Kernel):
    """Notes the ticks that it runs."""

    def __init__(self) -> None:
        super().__init__(RobotOptions(power_on=True))
        self.ran: list[int] = []

    def tick(self, inputs: Sequence[Input] = (), number: int | None = None) -> TickResult:
        result = super().tick(inputs, number)
        self.ran.append(result.tick)
        return result


class Moment:
    """A served robot, and its wall clock in ticks."""

    def __init__(self, scene: Scene, wall: WallClock, connect: Callable[[str], Line]) -> None:
        self.scene, self.server, self.wall, self.connect = scene, scene.server, wall, connect
        self.begin_ns = wall.now_ns

    async def at(self, tick: float) -> None:
        await self.wall.go_to(self.begin_ns + round(tick * PERIOD_NS))

    def ran(self) -> list[int]:
        """The ticks that have run since the last call."""
        ran, self.scene.robot.ran = self.scene.robot.ran, []
        return list(ran)


def play(patch: pytest.MonkeyPatch, body: Callable[[Moment], Any], **options: Any) -> None:
    async def run() -> None:
        async with timed(patch, CountingKernel(), **options) as (scene, wall, connect):
            await body(Moment(scene, wall, connect))

    asyncio.run(run())


def test_nothing_runs_while_nothing_is_due(monkeypatch: pytest.MonkeyPatch) -> None:
    async def body(moment: Moment) -> None:
        await moment.at(LEAP_MAX_TICKS - 0.5)
        assert moment.ran() == [0]
        assert moment.server.output.tick == LEAP_MAX_TICKS - 1
        assert not moment.server.output.has(TIME)
        await moment.at(LEAP_MAX_TICKS + 0.5)
        assert moment.ran() == [LEAP_MAX_TICKS]
        assert (moment.server.overruns, moment.server.left_out) == (0, 0)

    play(monkeypatch, body)


def test_an_input_goes_to_the_tick_that_is_next(monkeypatch: pytest.MonkeyPatch) -> None:
    async def body(moment: Moment) -> None:
        await moment.at(100.3)
        assert moment.server.post([Do("test", WriteSignal("flag", 2, True))]) == 101
        await moment.at(300)
        assert moment.ran() == [0, 101]
        assert moment.server.output.snapshot.signals["flag"][2]

    play(monkeypatch, body)


def test_a_program_runs_when_it_is_due(monkeypatch: pytest.MonkeyPatch) -> None:
    async def body(moment: Moment) -> None:
        await moment.at(9.5)
        moment.server.post([RunUnit("primary#1", "program", MOVE)])
        await moment.at(2000)
        ran = moment.ran()
        assert ran[:2] == [0, 10]
        assert len(ran) < 8
        (said,) = [event for event in moment.scene.said if getattr(event, "text", "") == "there"]
        assert said.tick == ran[-1] == ran[-2] + 250

    play(monkeypatch, body)


def test_ticks_run_for_what_reads_them(monkeypatch: pytest.MonkeyPatch) -> None:
    async def body(moment: Moment) -> None:
        await moment.at(5.5)
        stream = moment.connect("rtsi")
        # One that has not started may start at any time.
        await moment.at(20.5)
        assert moment.ran() == [0, *range(6, 21)]
        stream.send(rtsi_client.output_recipe(25.0, ["timestamp"]) + rtsi_client.message("S"))
        await moment.at(101)
        assert moment.ran() == [21, *range(30, 101, 10)]
        stream.send(rtsi_client.message("P"))
        stream.close()
        await moment.at(102.5)
        modbus = moment.connect("modbus")
        await moment.at(110.5)
        modbus.send(modbus_client.frame(1, modbus_client.read(3, 270, 6)))
        modbus.close()
        await moment.at(500)
        assert moment.ran() == list(range(102, 112))

    play(monkeypatch, body)


def test_each_output_is_given_to_followers(monkeypatch: pytest.MonkeyPatch) -> None:
    async def body(moment: Moment) -> None:
        await moment.at(50.5)
        taken: list[int] = []
        moment.server.follow(lambda output: taken.append(output.tick) or len(taken) < 5)  # type: ignore[func-returns-value]
        await moment.at(200.5)
        assert taken == [51, 52, 53, 54, 55]
        waiting = asyncio.create_task(moment.server.next_output())
        await moment.at(201.5)
        assert waiting.done()
        output = await waiting
        assert (output.tick, output.has(ALL_PARTS)) == (201, True)
        await moment.at(900)
        assert moment.ran() == [0, 51, 52, 53, 54, 55, 201]

    play(monkeypatch, body)


def test_in_lockstep_time_that_goes_by_the_wall_leaps_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    async def body(moment: Moment) -> None:
        await moment.at(20.5)
        assert moment.ran() == [0]
        assert moment.server.output.tick == 20

    play(monkeypatch, body, is_lockstep=True)
