from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError, MotionError
from elitescript.messages.motion import MoveC, MoveJ, MoveL, MoveP, StopJ, StopL

Q = [0.1, -1.5, 1.2, -1.3, -1.57, 0.3]
P = [0.4, -0.2, 0.4, 3.14, 0.0, 0.0]
VIA = [0.4, 0.0, 0.5, 3.14, 0.0, 0.0]


def test_movej_asks_for_the_documented_defaults(call: Any, robot: Any) -> None:
    assert call("movej", Q) is None
    assert robot.asked == [MoveJ(tuple(Q), 1.396263, 1.047197, 0.0, 0.0)]


def test_movej_passes_every_argument_on(call: Any, robot: Any) -> None:
    call("movej", Q, 1.4, 1.05, t=2, r=0.05)
    assert robot.asked == [MoveJ(tuple(Q), 1.4, 1.05, 2.0, 0.05)]


def test_zero_for_a_or_v_takes_the_default_of_the_machine(call: Any, robot: Any) -> None:
    call("movej", Q, 0, 0)
    call("movej", Q, a=0, v=0.5)
    call("movel", P, 0, 0)
    call("movec", VIA, P, 0.7, 0)
    call("movep", P, 0, 0)
    joint_a, joint_v, tool_a, tool_v = robot.machine.default_motion
    requested = [(asked.a, asked.v) for asked in robot.asked if isinstance(asked, (MoveJ, MoveL, MoveC, MoveP))]
    assert requested == [(joint_a, joint_v), (joint_a, 0.5), (tool_a, tool_v), (0.7, tool_v), (tool_a, tool_v)]


def test_a_radius_that_generators_write_for_no_rounding_is_none_and_is_warned_of(call: Any, robot: Any) -> None:
    call("movej", Q, 1.4, 1.05, r=-0.001)
    warning, move = robot.asked
    assert warning[:2] == ("warn_once", "negative radius")
    assert move == MoveJ(tuple(Q), 1.4, 1.05, 0.0, 0.0)
    with pytest.raises(ArgumentRangeError, match=r"-0\.001"):
        call("movel", P, r=-0.002)


def test_movel_takes_its_target_under_both_names(call: Any, robot: Any) -> None:
    call("movel", p=P)
    call("movel", pose=P)
    assert robot.asked == [MoveL(tuple(P), 1.2, 0.25, 0.0, 0.0)] * 2


@pytest.mark.parametrize(("mode", "is_fixed"), [(0, True), (1, False), (-7, False), (False, True)])
def test_movec_keeps_the_orientation_only_in_mode_0(call: Any, robot: Any, mode: int, is_fixed: bool) -> None:
    call("movec", VIA, P, 1.2, 0.25, 0.01, mode)
    assert robot.asked == [MoveC(tuple(VIA), tuple(P), 1.2, 0.25, 0.01, is_fixed)]


def test_stops_ask_for_their_deceleration(call: Any, robot: Any) -> None:
    call("stopj", 3)
    call("stopl", a=0.5)
    assert robot.asked == [StopJ(3.0), StopL(0.5)]


def test_a_refusal_of_the_machine_names_the_command_and_keeps_its_code(call: Any, robot: Any) -> None:
    robot.refusal = MotionError("joint 2 would reach 7.1 rad, at most 6.283 rad is possible", code="R110")
    with pytest.raises(MotionError, match=r"^movej: joint 2 would reach 7\.1 rad") as caught:
        call("movej", Q)
    assert (caught.value.code, caught.value.command) == ("R110", "movej")
