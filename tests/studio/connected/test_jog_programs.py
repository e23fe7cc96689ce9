"""The programs that move the arm, in virtual time: what makes them move it, and what makes them stop."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.kinematics.pose import pose_inv, pose_trans
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile
from elitescript.studio.connected import jogging
from elitescript.studio.connected.jogging import (
    BASE,
    HAND,
    JOINT,
    STOP,
    TOOL,
    end_of_range,
    guide_program,
    jog_program,
    speeds_of,
)

REGISTER = 30
SESSION = 80
BEAT_S = 0.02


def robot_with(beats_until_s: float, orders: dict[float, tuple[int, tuple[float, ...]]], session: int = SESSION):
    """A robot whose registers a client writes: a heartbeat up to a time, and what to do from times on."""
    robot = VirtualRobot(joints=[0.0, -1.2, 1.0, -1.3, 1.4, 0.3])
    for beat in range(1, int(beats_until_s / BEAT_S)):
        robot.at(beat * BEAT_S, f"input_int_register[{REGISTER}]", beat)
    for time_s, (task, speeds) in orders.items():
        robot.at(time_s, f"input_int_register[{REGISTER + 1}]", session + task)
        for axis, speed in enumerate(speeds):
            robot.at(time_s, f"input_float_register[{REGISTER + axis}]", speed)
    return robot


def speeds_over_time(robot, program, until_s):
    """Time and joint speeds of each row of a run."""
    run = robot.run(program, until_s=until_s, trace=True)
    return run, [(row.t, row.qd, row.tcp_pose) for row in run.trace]


class TestJog:
    def test_joints_move_while_the_heart_beats(self):
        robot = robot_with(2.0, {0.1: (JOINT, (0.0, 0.0, 0.4, 0.0, 0.0, 0.0)), 1.0: (STOP, (0.0,) * 6)})
        run, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 3.0)
        assert run.state == "finished"
        assert max(qd[2] for _, qd, _ in rows) == pytest.approx(0.4)
        assert all(qd[axis] == 0.0 for _, qd, _ in rows for axis in (0, 1, 3, 4, 5))
        assert max(t for t, qd, _ in rows if any(qd)) < 1.0 + 0.1
        assert -53 <= run.signals[f"output_int_register[{REGISTER}]"] < -48, "the last number that was read"

    def test_it_stands_soon_after_the_last_beat(self):
        robot = robot_with(1.0, {0.1: (JOINT, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))})
        run, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 5.0)
        last_beat_s = (int(1.0 / BEAT_S) - 1) * BEAT_S
        moving = [t for t, qd, _ in rows if any(qd)]
        assert run.state == "finished"
        assert last_beat_s < max(moving) < last_beat_s + 0.3
        assert run.signals[f"output_int_register[{REGISTER}]"] == SESSION

    def test_the_highest_speeds_of_the_tcp_stop_as_soon(self):
        for axis in (0, 3):
            robot = robot_with(1.0, {0.1: (TOOL, speeds_of("tool", axis, -1, 1.0))})
            run, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 5.0)
            assert run.state == "finished"
            assert 0.98 < max(t for t, qd, _ in rows if any(qd)) < 0.98 + 0.3

    def test_the_base_frame(self):
        robot = robot_with(2.0, {0.1: (BASE, speeds_of("base", 1, -1, 0.4)), 1.0: (STOP, (0.0,) * 6)})
        _, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 3.0)
        first, last = rows[0][2], rows[-1][2]
        assert [b - a for a, b in zip(first, last, strict=True)] == pytest.approx([0, -0.09, 0, 0, 0, 0], abs=0.006)

    def test_the_tool_frame_is_that_of_the_controller(self):
        robot = robot_with(2.0, {0.1: (TOOL, speeds_of("tool", 0, 1, 0.4)), 1.0: (STOP, (0.0,) * 6)})
        _, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 3.0)
        moved = pose_trans(pose_inv(rows[0][2]), rows[-1][2])
        assert moved == pytest.approx([0.09, 0, 0, 0, 0, 0], abs=0.006)

    def test_values_of_another_session_move_nothing(self):
        robot = robot_with(0.5, {0.0: (JOINT, (0.5,) * 6)}, session=SESSION + jogging.SESSION_STEP)
        run, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 3.0)
        assert run.state == "finished"
        assert not any(any(qd) for _, qd, _ in rows)

    @pytest.mark.parametrize(
        ("task", "speeds"), [(JOINT, speeds_of("joint", 0, 1, 1.0)), (TOOL, speeds_of("tool", 0, 1, 1.0))]
    )
    @pytest.mark.parametrize("beats_until_s", [0.6, 5.0])
    def test_an_open_safeguard_is_its_end(self, task, speeds, beats_until_s):
        """What was held then is not to move the arm when the safeguard is closed."""
        robot = robot_with(beats_until_s, {0.1: (task, speeds)})
        robot.at(0.6, "safeguard_stop", value=True)
        robot.at(3.0, "safeguard_stop", value=False)
        run, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 5.0)
        assert run.state == "finished"
        assert max(abs(part) for t, qd, _ in rows for part in qd if t < 0.6) > 0.2
        assert max(abs(part) for t, qd, _ in rows for part in qd if t > 2.9) < 0.1
        assert max(t for t, qd, _ in rows if any(qd)) < 3.05

    def test_without_any_beat_it_ends_at_once(self):
        robot = robot_with(0.0, {0.0: (JOINT, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))})
        run, rows = speeds_over_time(robot, jog_program(REGISTER, SESSION), 5.0)
        assert run.state == "finished"
        assert max(t for t, qd, _ in rows if any(qd)) < 0.3


class TestGuiding:
    def test_it_ends_with_the_heart(self):
        robot = robot_with(1.0, {0.0: (HAND, (0.0,) * 6)})
        robot.at(0.2, "external_wrench[1]", 30.0)
        run = robot.run(guide_program(REGISTER, SESSION), until_s=5.0)
        assert run.state == "finished"
        assert 1.9 < run.time_s < 2.5
        assert run.joints != (0.0, -1.2, 1.0, -1.3, 1.4, 0.3)

    def test_it_ends_when_told(self):
        robot = robot_with(3.0, {0.0: (HAND, (0.0,) * 6), 0.5: (STOP, (0.0,) * 6)})
        assert 0.5 < robot.run(guide_program(REGISTER, SESSION), until_s=5.0).time_s < 0.7


class TestEnds:
    LOW, HIGH = (-1.0,) * 6, (1.0,) * 6

    @pytest.mark.parametrize(
        ("q", "speed", "number"),
        [(0.0, 0.5, 0), (0.9, 0.5, 3), (0.9, -0.5, 0), (-0.95, -0.5, 3), (1.5, 0.0, 0), (0.8, 0.1, 0)],
    )
    def test_a_joint_that_could_not_stop_in_its_range(self, q, speed, number):
        joints, speeds = [0.0] * 6, [0.0] * 6
        joints[2], speeds[2] = q, speed
        assert end_of_range(joints, speeds, self.LOW, self.HIGH) == number


def test_check_has_nothing_to_say_about_the_programs():
    for program in (jog_program(40, 8), guide_program(40, 8)):
        assert check_source(SourceFile("jog", program), profile()) == ()
