"""A served robot leaps over ticks in which nothing is due: nobody can tell it from one that runs every tick."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Callable, Sequence
from random import Random
from typing import Any

import pytest

from elitescript.devices.channels.machine_faults import machine_fault
from elitescript.environment.memory import MemoryFiles
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import (
    AddFault,
    AddLog,
    ChannelData,
    ChannelOpened,
    Do,
    Input,
    Interpret,
    Lag,
    PlayTask,
    Query,
    RunUnit,
)
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale, StopTask, WriteSignal
from elitescript.messages.outputs import TickResult
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.services.log import LogLine
from elitescript.services.robot_server import RobotServer
from elitescript.testing.world import Wire, World
from tests.invariants.cases import CASES
from tests.invariants.random_devices import random_devices, random_faults, random_secondary, random_talk
from tests.invariants.random_programs import random_program
from tests.protocol import modbus_client, rtsi_client
from tests.services.made_up_time import Line, timed
from tests.services.served import Scene

COUNT = max(CASES // 4, 3)
TICKS = 1500
PERIOD_NS = 4_000_000


def random_options(chance: Random) -> RobotOptions:
    return RobotOptions(power_on=chance.random() < 0.9, seed=chance.randrange(100), rpc_timeout_s=1.5)


def random_inputs(chance: Random) -> dict[int, list[Input]]:
    """What a robot is given, by tick."""
    given: dict[int, list[Input]] = {2: [AddFault("a", machine_fault(fault)) for fault in random_faults(chance)]}

    def give(request: Input) -> None:
        given.setdefault(chance.randrange(3, TICKS), []).append(request)

    program = random_program(chance) if chance.random() < 0.5 else random_talk(chance)[0]
    given[3] = [RunUnit("primary#1", "program", program)]
    for _ in range(chance.randrange(25)):
        give(
            chance.choice(
                (
                    Do("a", PauseTask(), is_answered=True),
                    Do("a", ResumeTask()),
                    Do("a", SetSpeedScale(chance.choice((0.1, 0.7, 1.0)))),
                    Do("a", WriteSignal("standard_digital_in", chance.randrange(4), chance.random() < 0.5)),
                    Do("a", StopTask()),
                    RunUnit("primary#1", "secondary", random_secondary(chance)),
                    RunUnit("primary#2", "line", "nonsense"),
                    Interpret("interpreter#1", "x = 1"),
                    Query("query#1/1", "get_actual_joint_positions()"),
                    PlayTask("dashboard#1"),
                    AddLog("rtsi#1", "text"),
                    Lag("CS66", chance.randrange(3)),
                    ChannelOpened(chance.randrange(1, 6), chance.random() < 0.8),
                    ChannelData(chance.randrange(1, 6), b"x 42\n"),
                )
            )
        )
    return given


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(COUNT))
def test_a_kernel_that_leaps_gives_the_same_as_one_that_runs_every_tick(seed: int, finding: Any) -> None:
    chance = Random(f"kernel {seed}")
    options, given = random_options(chance), random_inputs(chance)
    looks = {tick for tick in range(TICKS) if chance.random() < 0.01}

    def kernel() -> Kernel:
        return Kernel(options, RequestEnvironment(MemoryFiles({})))

    stepped, leaping = kernel(), kernel()
    due: int | None = 0
    ran = shown_ahead = 0
    ahead: dict[int, Snapshot] = {}
    """Rows that the leaping one has given ahead; what comes in ends them."""
    for tick in range(TICKS):
        inputs = given.get(tick, ())
        result, shown, state = stepped.tick(inputs), stepped.snapshot(), stepped.discrete_state()
        if tick == due or inputs or tick in looks:
            assert leaping.tick(inputs, tick) == result, tick
            assert leaping.snapshot() == shown, tick
            assert leaping.discrete_state() == state, tick
            due = leaping.due_tick()
            ran += 1
            before = state
            ticks = leaping.ticks_ahead(TICKS if due is None else due, chance.randrange(40))
            ahead = {row.tick: row.snapshot for row in leaping.rows(ticks, ALL_PARTS)}
        else:
            assert result == TickResult(tick, (), (), ()), tick
            assert state == before, tick
            shown_ahead += tick in ahead
            assert ahead.get(tick, shown) == shown, tick
    assert ran < TICKS
    assert shown_ahead
    finding("served ticks", f"{COUNT} sessions of {TICKS} ticks", f"leaping runs {ran} of them, with the same outputs")


# What clients do, each at a time of the wall clock.


class Session:
    """A session of clients, devices and programs that a seed decides on, by a wall clock that is made up."""

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self.said: list[Any] = []
        self.written: dict[str, list[tuple[int, bytes]]] = {}
        self.ran: list[int] = []
        self.plan: list[tuple[int, str, Callable[[Scene, Line], None]]] = []

    def play(self) -> Session:
        with pytest.MonkeyPatch.context() as patch:
            asyncio.run(self._play(patch))
        return self

    async def _play(self, patch: pytest.MonkeyPatch) -> None:
        chance = Random(f"server {self.seed}")
        session = self

        class Watched(Kernel):
            def tick(self, inputs: Sequence[Input] = (), number: int | None = None) -> TickResult:
                result = super().tick(inputs, number)
                session.ran.append(result.tick)
                return result

        kernel = Watched(random_options(chance), RequestEnvironment(MemoryFiles({})))
        devices = [
            *random_devices(chance),
            Wire(when="standard_digital_out[0]", then="standard_digital_in[1]", after_s=0.3),
        ]
        world = World(devices, seed=self.seed)
        async with timed(patch, kernel, world=world) as (scene, wall, connect):
            begin_ns = wall.now_ns
            lines: dict[str, Line] = {}
            for _ in range(chance.randrange(5, 60)):
                # Between two ticks, just before, at and behind the time of one.
                tick, part = chance.randrange(1, TICKS), chance.choice((0, 1, 600_000, 1_000_000, 3_999_999))
                name = chance.choice(("primary", "readonly", "rtsi", "dashboard", "interpreter", "query", "modbus"))
                self._plan(tick * PERIOD_NS + part, name, chance)
            for at_ns, name, act in sorted(self.plan, key=lambda row: row[0]):
                await wall.go_to(begin_ns + at_ns)
                if name in lines and lines[name].is_over:
                    del lines[name]
                if name not in lines:
                    lines[name] = connect(name)
                    self.written[f"{name} {at_ns}"] = lines[name].written
                    await wall.settle()
                act(scene, lines[name])
                await wall.settle()
                self.said.append((at_ns, scene.server.output.tick))
            await wall.go_to(begin_ns + TICKS * PERIOD_NS)
            self.said += [(what.tick, what.text) if isinstance(what, LogLine) else what for what in scene.said]
            self.last = scene.server.output.tick, kernel.discrete_state(), scene.server.overruns
            assert not scene.notes("bug")

    def _plan(self, at_ns: int, name: str, chance: Random) -> None:
        if name == "primary":
            program = random_program(chance) if chance.random() < 0.5 else random_talk(chance)[0]
            data = chance.choice((program, "set_standard_digital_out(0, True)\n", "nonsense\n", "half a line")).encode()
        elif name == "rtsi":
            data = chance.choice(
                (
                    rtsi_client.output_recipe(
                        chance.choice((1.0, 10.0, 25.0, 33.3, 125.0)), ["timestamp", "actual_TCP_pose"]
                    )
                    + rtsi_client.message("S"),
                    rtsi_client.message("S"),
                    rtsi_client.message("P"),
                    rtsi_client.text("hello"),
                    rtsi_client.input_recipe(["input_int_register0"]),
                    rtsi_client.message("U", b"\1" + struct.pack(">i", chance.randrange(5))),
                )
            )
        elif name == "modbus":
            data = modbus_client.frame(1, modbus_client.read(3, 270, 6))
        else:
            data = {
                "readonly": b"",
                "dashboard": chance.choice((b"robotMode\n", b"speed\n", b"play\n", b"pause\n", b"stop\n", b"status\n")),
                "interpreter": chance.choice((b"x = 1\n", b"sleep(0.2)\n", b"clear_interpreter()\n")),
                "query": b"req 7 get_actual_joint_positions()\n",
            }[name]
        closes = chance.random() < (0.5 if name == "modbus" else 0.2)

        def act(scene: Scene, line: Line) -> None:
            if data:
                line.send(data)
            if closes:
                line.client.eof_received()
                line.close()

        self.plan.append((at_ns, name, act))


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(COUNT))
def test_clients_cannot_tell(seed: int, finding: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    leaping = Session(seed).play()
    monkeypatch.setattr(RobotServer, "_ticks_on", lambda self: 1)
    stepped = Session(seed).play()
    assert stepped.ran == list(range(stepped.ran[-1] + 1))
    assert leaping.written == stepped.written
    assert leaping.said == stepped.said
    assert leaping.last == stepped.last
    finding("served ticks", f"{COUNT} sessions with clients", f"leaping runs {len(leaping.ran)} of {TICKS} ticks")
