"""Served robots whose programs talk to faulty devices: nothing stays open, and the journal plays the same again.

The server is a real one, with a kernel in this process and devices beside it; the ticks are counted, not timed.
"""

from __future__ import annotations

import asyncio
from random import Random
from typing import Any

import pytest

from elitescript.devices.channels.machine_faults import machine_fault
from elitescript.kernel import RobotOptions
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, Event
from elitescript.messages.inputs import AddFault, Do, EndFaults, Input, RunUnit
from elitescript.messages.machine import PauseTask, ResumeTask, StopTask
from elitescript.messages.outputs import Output
from elitescript.services.journal.replay import Replay
from elitescript.services.journal.writer import JournalReader
from elitescript.services.log import DEVICE, LogLine
from elitescript.services.robots import robot_link, served_robot
from elitescript.testing.world import World
from tests.invariants.random_devices import (
    CLEANUP,
    RPC_S,
    random_devices,
    random_faults,
    random_secondary,
    random_talk,
)

TICKS = 900
CLEANUP_TICKS = 1400
"""As long as anything may still be late."""


def script_of(seed: int) -> tuple[World, dict[int, list[Input]]]:
    """Devices, and what a served robot is asked at which tick."""
    chance = Random(f"served {seed}")
    world = World(devices=random_devices(chance), seed=seed)
    asked: dict[int, list[Input]] = {}

    def ask(tick: int, request: Input) -> None:
        asked.setdefault(tick, []).append(request)

    for fault in random_faults(chance):
        ask(2, AddFault("test", machine_fault(fault)))
    ask(3, RunUnit("test", "program", random_talk(chance)[0]))
    for _ in range(chance.randrange(8)):
        tick = chance.randrange(4, 700)
        request = chance.choice((PauseTask(), ResumeTask(), ResumeTask(), StopTask()))
        what = RunUnit("test", "secondary", random_secondary(chance)) if chance.random() < 0.5 else Do("test", request)
        ask(tick, what)
    if chance.random() < 0.3:
        ask(chance.randrange(200, 700), RunUnit("test", "program", random_talk(chance)[0]))
    ask(TICKS, Do("test", StopTask()))
    ask(TICKS + 1, EndFaults("test"))
    ask(TICKS + 2, RunUnit("test", "program", "def clean():\n  " + CLEANUP.replace("\n", "\n  ") + "\nend\n"))
    return world, asked


class Session:
    """One session of a served robot."""

    def __init__(self, seed: int, journal: Any) -> None:
        self.world, self.asked = script_of(seed)
        self.outputs: list[Output] = []
        self.said: list[Event | LogLine] = []
        asyncio.run(self._play(seed, journal))

    async def _play(self, seed: int, journal: Any) -> None:
        config = RobotOptions(power_on=True, seed=seed, rpc_timeout_s=RPC_S, firmware="2.14")
        link = robot_link(config, task_dir=None, in_process=True, is_jailed=False, journal=journal, is_lockstep=True)
        server = served_robot("CS66", link, lambda _, what: self.said.append(what), world=self.world)
        await server.boot()
        self.outputs.append(server.output)
        for tick in range(1, TICKS + CLEANUP_TICKS):
            server.post(self.asked.get(tick, []))
            await server.step()
            self.outputs.append(server.output)
        self.left_in_kernel = dict(link.robot.host.connections)  # type: ignore[attr-defined]
        assert server.devices is not None
        self.left_in_server = dict(server.devices._leads)
        self.left_in_world = self.world.network.open_channels
        await server.close()


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 40))])
def test_a_session_with_faults_leaves_nothing_open_and_plays_again(seed: int, tmp_path: Any) -> None:
    session = Session(seed, tmp_path / "first.journal")
    assert (session.left_in_kernel, session.left_in_server, session.left_in_world) == ({}, {}, 0)
    assert session.outputs[-1].snapshot.robot.task_state is TaskState.STOPPED
    assert [what for what in session.said if isinstance(what, LogLine) and what.kind != DEVICE] == []
    assert [what for what in session.said if isinstance(what, Alarm)] == []

    again = Session(seed, tmp_path / "second.journal")
    assert again.outputs == session.outputs

    replay = Replay(JournalReader(tmp_path / "first.journal"))
    assert list(replay.outputs()) == session.outputs
    assert replay.difference is None
    assert replay.checked_ticks
