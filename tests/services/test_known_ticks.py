"""Ticks whose output the child has given ahead: clients get what they get of a robot in this process, at its times."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from itertools import pairwise
from random import Random
from typing import Any

import pytest

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import Do, RunUnit
from elitescript.messages.machine import WriteSignal
from elitescript.services.child import frames, transport
from elitescript.services.child.link import ChildLink
from elitescript.services.time.cycle import OUTLET_NS, PERIOD_NS
from tests.protocol import rtsi_client
from tests.services import served
from tests.services.kernel_child import KernelChild
from tests.services.made_up_time import Line, WallClock, timed
from tests.services.served import Scene

OPTIONS = RobotOptions(power_on=True)
NAMES = ["timestamp", "actual_joint_positions", "actual_TCP_pose", "joint_temperatures", "input_int_register0"]
MOVE = "def p():\n  movej([0.4, -1.4, -1.7, -1.6, 1.57, 0])\n  sleep(0.3)\n  movel([-0.4, -0.3, 0.5, 3.1, 0, 0])\nend\n"
SYNCS = "def p():\n  for i in range(150):\n    sync()\n  end\nend\n"
Body = Callable[[Scene, WallClock, Callable[[str], Line]], Any]


@pytest.fixture
def children(monkeypatch: pytest.MonkeyPatch) -> list[KernelChild]:
    KernelChild.made = []
    monkeypatch.setattr(transport, "ChildProcess", KernelChild)
    return KernelChild.made


def play(patch: pytest.MonkeyPatch, body: Body, *, in_child: bool) -> Any:
    """Return what the body returns for a robot in a child, or in this process."""

    async def run() -> Any:
        with patch.context() as inner:
            if in_child:
                inner.setattr(served, "InProcessLink", lambda _: ChildLink(OPTIONS, grace_s=1.0))
            async with timed(inner, Kernel(OPTIONS)) as (scene, wall, connect):
                return await body(scene, wall, connect)

    return asyncio.run(run())


def stream(connect: Callable[[str], Line], frequency_hz: float = 250.0) -> Line:
    line = connect("rtsi")
    line.send(rtsi_client.output_recipe(frequency_hz, NAMES) + rtsi_client.message("S"))
    return line


def test_an_arm_at_rest_needs_few_messages(monkeypatch: pytest.MonkeyPatch, children: list[KernelChild]) -> None:
    async def body(scene: Scene, wall: WallClock, connect: Callable[[str], Line]) -> list[int]:
        begin_ns = wall.now_ns
        line = stream(connect)
        await wall.go_to(begin_ns + 200 * PERIOD_NS)
        packages = [at_ns for at_ns, data in line.written if data[2:3] == b"U"]
        assert [(at_ns - begin_ns - OUTLET_NS) / PERIOD_NS for at_ns in packages[-150:]] == list(range(50, 200))
        return [tick for tick in children[0].sent if tick >= 50]

    sent = play(monkeypatch, body, in_child=True)
    assert {later - tick for tick, later in pairwise(sent)} == {frames.AHEAD_TICKS + 1}


@pytest.mark.parametrize("part", [0.1, 0.25, 0.3, 0.999])
def test_what_comes_in_goes_to_the_tick_that_begins_next(
    monkeypatch: pytest.MonkeyPatch, children: list[KernelChild], part: float
) -> None:
    async def body(scene: Scene, wall: WallClock, connect: Callable[[str], Line]) -> Any:
        begin_ns = wall.now_ns
        stream(connect)
        seen = []
        for tick in (104, 105, 117, 118, 130, 163):
            await wall.go_to(begin_ns + round((tick + part) * PERIOD_NS))
            seen.append(scene.server.post([Do("a", WriteSignal("flag", tick % 16, True))]))
            await wall.go_to(begin_ns + round((tick + 1.1) * PERIOD_NS))
            seen.append(scene.server.output.tick)
            await wall.go_to(begin_ns + round((tick + 1.3) * PERIOD_NS))
            seen.append((scene.server.output.tick, scene.server.output.snapshot.signals["flag"][tick % 16]))
        return seen

    found = play(monkeypatch, body, in_child=True)
    assert found == play(monkeypatch, body, in_child=False)
    assert found[0] == 105
    assert len(children[0].sent) < 40


def test_rows_are_asked_for_now_and_then_while_every_tick_is_due(
    monkeypatch: pytest.MonkeyPatch, children: list[KernelChild]
) -> None:
    async def body(scene: Scene, wall: WallClock, connect: Callable[[str], Line]) -> list[int]:
        begin_ns = wall.now_ns
        stream(connect)
        scene.server.post(
            [RunUnit("primary#9", "program", "def p():\n  for i in range(150):\n    sync()\n  end\nend\n")]
        )
        await wall.go_to(begin_ns + 250 * PERIOD_NS)
        return children[0].asked_ahead

    asked = play(monkeypatch, body, in_child=True)
    assert 140 < len([tick for tick in children[0].sent if tick < 150]) <= 151
    assert len([tick for tick in asked if 20 < tick < 140]) <= 120 // frames.AHEAD_TICKS + 1
    # The arm rests again.
    assert len([tick for tick in children[0].sent if tick > 180]) < 12


def test_a_child_that_takes_the_place_of_another_comes_up_while_every_tick_is_read(
    monkeypatch: pytest.MonkeyPatch, children: list[KernelChild]
) -> None:
    async def body(scene: Scene, wall: WallClock, connect: Callable[[str], Line]) -> None:
        begin_ns = wall.now_ns
        line = stream(connect)
        await wall.go_to(begin_ns + 100 * PERIOD_NS)
        KernelChild.says_later = True
        children[0].end("it is gone")
        await wall.go_to(begin_ns + 400 * PERIOD_NS)
        assert len(children) == 2
        assert children[1].sent
        assert len([at_ns for at_ns, data in line.written if data[2:3] == b"U"]) > 350

    monkeypatch.setattr(KernelChild, "says_later", False)
    play(monkeypatch, body, in_child=True)


@pytest.mark.parametrize("seed", range(3))
def test_clients_cannot_tell(monkeypatch: pytest.MonkeyPatch, children: list[KernelChild], seed: int) -> None:
    async def body(scene: Scene, wall: WallClock, connect: Callable[[str], Line]) -> Any:
        chance = Random(seed)
        begin_ns = wall.now_ns
        lines = [stream(connect, frequency_hz) for frequency_hz in (250.0, 125.0, 33.3)]
        lines += [connect("readonly"), connect("dashboard")]
        lines[0].send(rtsi_client.input_recipe(["input_int_register0"]))
        acts = {60: lambda: scene.server.post([RunUnit("primary#9", "program", MOVE)])}
        for _ in range(25):
            acts[chance.randrange(50, 700)] = chance.choice(
                (
                    lambda: lines[0].send(rtsi_client.message("U", b"\1\0\0\0\7")),
                    lambda: lines[1].send(rtsi_client.output_recipe(10.0, ["elbow_position"])),
                    lambda: lines[4].send(b"robotMode\n"),
                    lambda: lines.append(stream(connect)),
                )
            )
        for tick in sorted(acts):
            await wall.go_to(begin_ns + round((tick + chance.choice((0.0, 0.1, 0.25, 0.3, 0.9))) * PERIOD_NS))
            acts[tick]()
            await wall.settle()
        await wall.go_to(begin_ns + 750 * PERIOD_NS)
        assert (scene.server.overruns, scene.server.left_out) == (0, 0)
        return [line.written for line in lines]

    found = play(monkeypatch, body, in_child=True)
    assert len(children[0].sent) < 400
    assert found == play(monkeypatch, body, in_child=False)
