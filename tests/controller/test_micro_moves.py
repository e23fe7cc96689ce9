"""`moveml` on the machine: rates, pauses and stops in the middle of a file."""

from __future__ import annotations

from array import array
from itertools import pairwise
from math import cos, pi, sin
from typing import Any

import pytest

from elitescript.controller.controller import Controller
from elitescript.errors import MotionError
from elitescript.messages.events import MotionEnded, MotionStarted, Warned
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale, SetTcp
from elitescript.messages.motion import MicroLine, MoveJ, MoveML, StopJ
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model

MODEL = load_model("CS66")
HOME = MODEL.home
QDD_MAX = 40.0


def swing(count: int = 500, size: float = 0.2, rate: float = 2.0) -> list[tuple[float, ...]]:
    return [
        tuple(q + size * sin(rate * (1.0 + 0.1 * j) * k * PERIOD_S) for j, q in enumerate(HOME)) for k in range(count)
    ]


def there_and_back(count: int = 501) -> list[tuple[float, ...]]:
    return [tuple(q + 0.2 * (1.0 - cos(2.0 * pi * k / (count - 1))) for q in HOME) for k in range(count)]


def request(rows: list[tuple[float, ...]], *, is_cartesian: bool = False) -> MoveML:
    numbers = array("d", [number for row in rows for number in row]).tobytes()
    lines = array("I", range(1, len(rows) + 1)).tobytes()
    return MoveML(MicroLine("path.txt", PERIOD_S, is_cartesian, numbers, lines), 1, len(rows), 1.4, 1.05)


class Machine:
    """A controller without scripts."""

    def __init__(self) -> None:
        self.events: list[Any] = []
        self.controller = Controller(MODEL, epoch_s=0.0, on_event=self.events.append)
        self.rows: list[Any] = []

    def ask(self, wanted: Any) -> int:
        return self.controller.request_motion(wanted, 7, "main")

    def run(self, ticks: int, *, leap: bool = False) -> None:
        end = self.controller.tick + ticks
        while self.controller.tick < end:
            self.controller.run_tick()
            due = self.controller.next_tick()
            step = min(due or end, end) if leap else self.controller.tick + 1
            for tick in range(self.controller.tick, step):
                joints = self.controller.state_at(tick)
                self.rows.append((joints.q_target, joints.qd_target))
            self.controller.leap(step)
        self.controller.run_tick()

    def of(self, kind: type) -> list[Any]:
        return [event for event in self.events if isinstance(event, kind)]


def check_smooth(machine: Machine, braking: float = 1.0) -> None:
    """No joint is accelerated harder than its limit, times what time scaling may add."""
    for (q, qd), (q_next, qd_next) in pairwise(machine.rows):
        for a, b, v, w in zip(q, q_next, qd, qd_next, strict=True):
            assert abs(w - v) <= braking * QDD_MAX * PERIOD_S * (1.0 + 1e-6)
            assert abs(b - a - 0.5 * (v + w) * PERIOD_S) <= QDD_MAX * PERIOD_S * PERIOD_S


@pytest.fixture
def machine() -> Machine:
    return Machine()


def test_points_are_played_at_their_ticks(machine: Machine) -> None:
    rows = there_and_back()
    number = machine.ask(request(rows))
    assert machine.of(MotionStarted)[0].duration_s == 500 * PERIOD_S
    machine.run(499)
    assert not machine.controller.is_move_done(number)
    machine.run(1)
    assert machine.controller.is_move_done(number)
    for (q, _), row in zip(machine.rows, rows, strict=False):
        assert q == pytest.approx(row, abs=1e-12)
    assert machine.controller.joints().q_target == rows[-1]
    assert [(event.tick, event.is_complete) for event in machine.of(MotionEnded)] == [(500, True)]
    check_smooth(machine)


def test_a_file_that_begins_and_ends_at_a_speed(machine: Machine) -> None:
    machine.ask(request(swing()))
    machine.run(520)
    assert machine.controller.joints().q_target == swing()[-1]
    check_smooth(machine)


def test_half_the_speed_takes_twice_as_long(machine: Machine) -> None:
    machine.controller.request(SetSpeedScale(0.5))
    machine.ask(request(there_and_back()))
    machine.run(1010, leap=True)
    (ended,) = machine.of(MotionEnded)
    assert ended.tick == 1000


def test_waypoint_is_the_pose_of_the_last_point(machine: Machine) -> None:
    rows = swing(100)
    machine.controller.request(SetTcp((0.0, 0.0, 0.1, 0.0, 0.0, 0.0)))
    machine.ask(request(rows))
    assert machine.controller.target_waypoint == pytest.approx(machine.controller.tcp_pose(rows[-1]))  # type: ignore[arg-type]


def test_poses_of_the_active_tcp(machine: Machine) -> None:
    machine.controller.request(SetTcp((0.0, 0.0, 0.1, 0.0, 0.0, 0.0)))
    x, y, z, *turn = machine.controller.tcp_pose(HOME)
    machine.ask(request([(x, y + 0.0002 * k, z, *turn) for k in range(200)], is_cartesian=True))
    machine.run(220)
    assert machine.controller.tcp_pose(machine.controller.joints().q_target)[:3] == pytest.approx((x, y + 0.0398, z))
    check_smooth(machine)


@pytest.mark.parametrize("tick", [1, 3, 77, 250, 498])
def test_a_stop_in_the_middle_rests_on_the_path(machine: Machine, tick: int) -> None:
    machine.ask(request(swing()))
    machine.run(tick)
    machine.ask(StopJ(5.0))
    machine.run(200)
    assert not machine.controller.is_moving
    check_smooth(machine)
    # Rest is between two points of the file, whichever.
    q = machine.controller.joints().q_target
    nearest = min(max(abs(a - b) for a, b in zip(q, row, strict=True)) for row in swing(5000)[:501])
    assert nearest < 0.003


@pytest.mark.parametrize("pause_tick", [2, 60, 333])
def test_a_pause_goes_on_where_it_was(machine: Machine, pause_tick: int) -> None:
    machine.controller.task_started("job")
    machine.ask(request(swing()))
    machine.run(pause_tick)
    machine.controller.request(PauseTask())
    machine.run(150)
    resting = machine.controller.joints()
    assert resting.qd_target == (0.0,) * 6
    machine.controller.request(ResumeTask())
    machine.run(700)
    assert machine.controller.joints().q_target == swing()[-1]
    check_smooth(machine, braking=1.5)


def test_leaping_and_stepping_are_the_same() -> None:
    stepped, leaped = Machine(), Machine()
    for machine, leap in ((stepped, False), (leaped, True)):
        machine.ask(request(swing()))
        machine.run(100, leap=leap)
        machine.controller.request(SetSpeedScale(0.3))
        machine.run(200, leap=leap)
        machine.controller.request(SetSpeedScale(1.0))
        machine.run(500, leap=leap)
    assert stepped.rows == leaped.rows
    assert stepped.events == leaped.events


def test_a_refusal_changes_nothing(machine: Machine) -> None:
    with pytest.raises(MotionError) as caught:
        machine.ask(request([tuple(q + 0.1 for q in HOME), HOME]))
    assert caught.value.code == "R116"
    assert not machine.controller.is_moving
    assert machine.events == []
    machine.ask(MoveJ(HOME, 1.0, 1.0))


def test_too_fast_a_file_warns_once_on_the_line_of_the_program(machine: Machine) -> None:
    fast = swing(400, size=0.5, rate=12.0)
    for _ in range(2):
        machine.ask(request(fast))
        machine.run(2000, leap=True)
        machine.ask(MoveJ(fast[0], 1.4, 1.0))  # type: ignore[arg-type]
        machine.run(2000, leap=True)
    (warning,) = machine.of(Warned)
    assert warning.line == 7
    assert "path.txt come faster than the arm can move" in warning.text
    check_smooth(machine)
