"""Rows ahead: what ticks will show in which nothing is due, if nothing is given to the robot by then."""

from __future__ import annotations

import pytest

from elitescript.controller.arm.thermal_model import LOOK_TICKS
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import Do
from elitescript.messages.machine import WriteSignal
from elitescript.messages.plant import PlantConfig
from elitescript.messages.snapshot_parts import ALL_PARTS, JOINTS, TIME
from tests.kernel.machine import READY, program

NEVER = 10**9
MOVES = (
    "set_payload(1.5, [0.01, 0, 0.05])",
    "movej([0.2, -1.4, -1.7, -1.6, 1.57, 0.4], a=1.4, v=1.05, r=0.02)",
    "movel(pose_trans(get_actual_tcp_pose(), [0, 0, 0.02, 0, 0, 0]), a=1.2, v=0.25)",
    "sleep(0.2)",
    "set_standard_digital_out(1, True)",
    "sleep(0.1)",
)


def due_of(kernel: Kernel) -> int:
    due = kernel.due_tick()
    return NEVER if due is None else due


def test_rows_show_what_the_ticks_show_when_they_run() -> None:
    stepped, ahead = Kernel(READY), Kernel(READY)
    begin = [program(*MOVES)]
    stepped.tick_and_snapshot(begin), ahead.tick_and_snapshot(begin)
    compared = 0
    while stepped.next_tick < 600:
        rows = list(ahead.rows(ahead.ticks_ahead(due_of(ahead), 12), ALL_PARTS))
        for row in rows:
            assert repr(stepped.tick_and_snapshot()) == repr(row)
        compared += len(rows)
        expected = stepped.tick_and_snapshot()
        assert repr(ahead.tick((), stepped.controller.tick).with_snapshot(ahead.snapshot())) == repr(expected)
    assert compared > 400


def test_rows_end_before_what_is_due_and_before_the_heat_of_the_joints_is_sampled() -> None:
    kernel = Kernel(READY)
    kernel.tick()
    kernel.tick()
    assert kernel.ticks_ahead(NEVER, 3) == range(2, 5)
    assert kernel.ticks_ahead(4, 12) == range(2, 4)
    assert not kernel.ticks_ahead(2, 12)
    assert not kernel.ticks_ahead(NEVER, 0)
    kernel.tick((), LOOK_TICKS - 3)
    assert kernel.ticks_ahead(NEVER, 12) == range(LOOK_TICKS - 2, LOOK_TICKS + 1)


def test_what_comes_in_after_rows_acts_as_if_there_had_been_none() -> None:
    plain, ahead = Kernel(READY), Kernel(READY)
    for kernel in (plain, ahead):
        kernel.tick_and_snapshot([program(*MOVES)])
        kernel.tick((), 20)
    assert len(list(ahead.rows(ahead.ticks_ahead(due_of(ahead), 12), JOINTS | TIME))) == 12
    given = [Do("a", WriteSignal("standard_digital_in", 0, True))]
    for tick, inputs in ((23, given), (24, ())):
        found, expected = ahead.tick(inputs, tick), plain.tick(inputs, tick)
        assert repr(found.with_snapshot(ahead.snapshot(0), 0)) == repr(expected.with_snapshot(plain.snapshot(0), 0))
        assert repr(ahead.snapshot()) == repr(plain.snapshot())


def test_what_is_not_read_is_as_in_the_last_snapshot_that_had_it() -> None:
    kernel = Kernel(READY)
    kernel.tick_and_snapshot([program(*MOVES)])
    for tick in (20, 60, 100):
        kernel.tick((), tick)
        shown = kernel.snapshot()
        rows = list(kernel.rows(kernel.ticks_ahead(due_of(kernel), 3), TIME))
        assert [row.snapshot.robot.tick for row in rows] == [tick + 1, tick + 2, tick + 3]
        for row in rows:
            assert row.snapshot.robot.q_actual == shown.robot.q_actual
            assert row.snapshot.joint_torques == shown.joint_torques


@pytest.mark.parametrize("plant", [PlantConfig(lag_s=0.03), PlantConfig(noise_rad=1e-4)])
def test_an_arm_with_a_plant_gives_none(plant: PlantConfig) -> None:
    kernel = Kernel(RobotOptions(power_on=True, plant=plant))
    kernel.tick()
    kernel.tick()
    assert not kernel.ticks_ahead(NEVER, 12)
