"""A computer controls the arm over sockets, in virtual time."""

from __future__ import annotations

from math import dist

import pytest

from elitescript.devices.memory import MemoryEnvironment
from elitescript.messages.events import Alarm, Popup, TextMessage
from elitescript.robot import VirtualRobot
from tests.external_control.control import PROGRAM
from tests.external_control.pc import (
    COMMANDS,
    FREEDRIVE,
    IDLE,
    POSE,
    REVERSE,
    SERVOJ,
    SERVOJ_QUEUE,
    SPEEDJ,
    SPEEDL,
    TRAJECTORY,
    TRAJECTORY_MODE,
    Pc,
)


class Session:
    """A robot under the control of a computer."""

    def __init__(self, program=PROGRAM):
        self.pc = Pc()
        self.events = []
        self.robot = VirtualRobot(world=MemoryEnvironment(channels=self.pc.channels), on_event=self.events.append)
        self.run = self.robot.start(program)
        self.wait(0.05)

    def wait(self, duration_s):
        self.robot.advance(duration_s)

    def end(self):
        """Let the computer end the program; the events."""
        self.pc.stop()
        self.wait(0.3)
        assert (self.run.state, self.run.alarms) == ("finished", [])
        return self.events

    def follow(self, points, *, is_cartesian=False):
        """Send a trajectory: points, seconds, blend radii."""
        self.pc.action(TRAJECTORY_MODE, 1, len(points), 200)
        for values, time_s, radius in points:
            self.pc.point(values, time_s, radius, is_cartesian=is_cartesian)

    def wait_for_results(self, count, limit_s):
        """Keep the connection alive until so many results have come; the time it took."""
        before_s = self.robot.time_s
        while len(self.pc.results) < count and self.robot.time_s < before_s + limit_s:
            self.pc.action(TRAJECTORY_MODE, 0, 0, 200)
            self.wait(0.1)
        return self.robot.time_s - before_s

    @property
    def q(self):
        return self.robot.state.q_actual

    @property
    def pose(self):
        return self.robot.state.tcp_pose_actual


@pytest.fixture
def session():
    return Session()


def test_the_three_connections_are_opened_in_order(session):
    assert session.pc.accepted == [REVERSE, TRAJECTORY, COMMANDS]
    session.end()


def test_the_end_closes_them_within_a_few_ticks(session):
    session.pc.stop()
    session.wait(0.02)
    assert [port for port, _ in session.pc.closed] == [REVERSE, TRAJECTORY, COMMANDS]


class TestServo:
    def test_the_arm_follows_joints(self, session):
        start = session.q
        for step in range(250):
            session.pc.command(SERVOJ, [*start[:5], start[5] + 0.0005 * step], 100)
            session.wait(0.004)
        assert session.robot.state.qd_actual[5] == pytest.approx(0.125, rel=1e-3)
        assert 0.1 < session.q[5] - start[5] < 0.1245
        session.end()
        assert not any(session.robot.state.qd_actual)

    def test_it_goes_on_at_its_speed_between_two_targets(self, session):
        start = session.q
        for step in range(50):
            session.pc.command(SERVOJ, [*start[:5], start[5] + 0.0025 * step], 100)
            session.wait(0.02)
        assert session.q[5] - start[5] == pytest.approx(0.1125, abs=0.01)
        session.end()

    def test_the_arm_follows_poses(self, session):
        start = session.pose
        for step in range(250):
            session.pc.command(POSE, [*start[:2], start[2] - 0.00004 * step, *start[3:]], 100)
            session.wait(0.004)
        assert session.robot.state.tcp_speed_actual[2] == pytest.approx(-0.01, rel=0.02)
        assert session.pose[0] == pytest.approx(start[0], abs=1e-5)
        session.end()

    def test_points_that_wait_in_a_queue_are_followed_in_their_own_time(self, session):
        start = session.q
        for step in range(100):
            session.pc.command(SERVOJ_QUEUE, [*start[:5], start[5] + 0.001 * step], 0)
        session.wait(2.0)
        assert session.q[5] - start[5] == pytest.approx(0.099, abs=1e-4)
        session.end()

    def test_a_jump_is_shown_and_not_followed(self, session):
        start = session.q
        session.pc.command(SERVOJ, start, 500)
        session.wait(0.02)
        session.pc.command(SERVOJ, [*start[:5], start[5] + 1.0], 500)
        session.wait(0.1)
        assert session.q == pytest.approx(start, abs=1e-6)
        assert [event.title for event in session.end() if isinstance(event, Popup)] == ["Control"]


class TestSpeed:
    def test_of_joints_until_the_next_one(self, session):
        start = session.q[5]
        session.pc.command(SPEEDJ, [0, 0, 0, 0, 0, -0.1])
        session.wait(2.0)
        assert session.q[5] - start == pytest.approx(-0.2, abs=0.002)
        session.pc.command(SPEEDJ, [0, 0, 0, 0, 0, 0.1])
        session.wait(2.0)
        assert session.q[5] == pytest.approx(start, abs=0.002)
        session.end()

    def test_of_the_tool(self, session):
        start = session.pose
        session.pc.command(SPEEDL, [0, 0, -0.02, 0, 0, 0])
        session.wait(2.0)
        assert session.pose[2] - start[2] == pytest.approx(-0.04, abs=0.001)
        assert dist(session.pose[:2], start[:2]) < 1e-6
        session.end()

    def test_another_mode_stops_the_arm_first(self, session):
        session.pc.command(SPEEDJ, [0, 0, 0, 0, 0, -0.1])
        session.wait(0.5)
        session.pc.command(IDLE)
        session.wait(0.1)
        assert not any(session.robot.state.qd_actual)
        session.end()


class TestTrajectory:
    def test_joints_are_reached_in_their_time_and_success_is_told(self, session):
        goal = (*session.q[:3], session.q[3] + 0.5, *session.q[4:])
        session.follow([(goal, 3.0, 0.0)])
        assert session.wait_for_results(1, 5.0) == pytest.approx(3.0, abs=0.11)
        assert session.pc.results == [0]
        assert session.q == pytest.approx(goal, abs=1e-6)
        session.end()

    def test_lines_with_blends(self, session):
        # Away from the outstretched home, whose lines would lead out of reach.
        goal = (0.0, -1.57, -1.57, -1.07, 1.57, 0.0)
        session.follow([(goal, 1.0, 0.0)])
        session.wait_for_results(1, 3.0)
        start = session.pose
        down = (*start[:2], start[2] - 0.1, *start[3:])
        aside = (start[0], start[1] - 0.1, *down[2:])
        session.follow([(down, 3.0, 0.02), (aside, 3.0, 0.02), (start, 3.0, 0.0)], is_cartesian=True)
        assert session.wait_for_results(2, 12.0) < 8.9
        assert session.pc.results == [0, 0]
        assert session.pose == pytest.approx(start, abs=1e-5)
        session.end()

    def test_cancelling_stops_the_arm_and_drops_the_other_points(self, session):
        start = session.q
        points = [((*start[:5], start[5] + 0.1 * n), 1.0, 0.0) for n in range(1, 6)]
        session.follow(points)
        session.wait(0.1)
        session.pc.action(TRAJECTORY_MODE, -1, 0, 200)
        session.wait(0.1)
        assert session.pc.results == [1]
        assert not any(session.robot.state.qd_actual)
        session.follow([(start, 1.0, 0.0)])
        session.wait_for_results(2, 3.0)
        assert session.pc.results == [1, 0]
        assert session.q == pytest.approx(start, abs=1e-6)
        session.end()

    def test_another_mode_cancels_it(self, session):
        start = session.q
        session.follow([((*start[:5], start[5] + 0.1 * n), 1.0, 0.0) for n in range(1, 6)])
        session.wait(0.1)
        session.pc.command(IDLE)
        session.wait(0.1)
        assert session.pc.results == [1]
        session.end()

    def test_points_that_do_not_come_count_as_done(self, session):
        session.pc.action(TRAJECTORY_MODE, 1, 2)
        session.wait(1.1)
        assert session.pc.results == [0]
        session.end()


def test_hand_guiding_begins_and_ends(session):
    session.pc.action(FREEDRIVE, 1, 0, 100)
    session.robot.signals["external_wrench[0]"] = 20.0
    start = session.pose
    for _ in range(40):
        session.wait(0.01)
        session.pc.action(FREEDRIVE, 0, 0, 100)
    assert session.pose[0] - start[0] > 0.01
    session.robot.signals["external_wrench[0]"] = 0.0
    session.pc.action(FREEDRIVE, -1, 0, 100)
    session.end()


class TestEquipment:
    def test_payload(self, session):
        session.pc.script_command(1, [1.5, 0.01, 0.02, 0.03])
        session.wait(0.02)
        assert session.robot.state.payload.mass_kg == 1.5
        assert session.robot.state.payload.cog == (0.01, 0.02, 0.03)
        session.end()

    def test_tool_voltage(self, session):
        session.pc.script_command(2, [24])
        session.wait(0.02)
        assert session.robot.controller.non_default_signals()["tool_voltage"] == 24
        session.end()

    def test_force_control_begins_and_ends(self, session):
        session.pc.script_command(0)
        session.pc.force_mode([0] * 6, [0, 0, 1, 0, 0, 0], [0, 0, -5, 0, 0, 0], 0, [0.1] * 6)
        session.wait(0.5)
        assert session.robot.state.tcp_speed_actual[2] < -0.001
        session.pc.script_command(4)
        session.wait(0.2)
        assert not any(session.robot.state.qd_actual)
        session.end()

    def test_meaningless_force_numbers_end_nothing(self, session):
        odd = [1.1, 1.2, 1.3, 1.4, 1.5, 1.6]
        session.pc.force_mode(odd, [1, 2, 3, 4, 5, 6], odd, 2, odd)
        session.wait(0.1)
        start = session.q
        for _ in range(20):
            session.pc.command(SERVOJ, start, 100)
            session.wait(0.004)
        session.pc.script_command(4)
        session.wait(0.1)
        session.end()


class TestTheLink:
    def test_silence_longer_than_announced_ends_the_program(self, session):
        session.pc.command(SERVOJ, session.q, 100)
        session.wait(0.2)
        assert session.run.state == "finished"
        assert [port for port, _ in session.pc.closed] == [REVERSE, TRAJECTORY, COMMANDS]
        assert "no command in time: 0" in [event.text for event in session.events if isinstance(event, TextMessage)]

    def test_a_client_that_goes_away_ends_it_too(self, session):
        session.pc.command(SPEEDJ, [0, 0, 0, 0, 0, 0.1])
        session.wait(0.2)
        for link in session.pc.links.values():
            link.close()
        session.wait(0.2)
        assert session.run.state == "finished"
        assert not any(session.robot.state.qd_actual)

    def test_a_stop_from_outside_closes_the_connections_at_once(self, session):
        session.pc.command(SPEEDJ, [0, 0, 0, 0, 0, 0.1])
        session.wait(0.2)
        before_s = session.robot.time_s
        session.robot.stop()
        session.wait(0.02)
        assert len(session.pc.closed) == 3
        assert all(time_s <= before_s + 0.012 for _, time_s in session.pc.closed)

    def test_an_alarm_closes_them_too(self, session):
        session.pc.command(POSE, [5.0, 0, 0, 0, 0, 0])
        session.wait(0.02)
        assert [event.class_name for event in session.events if isinstance(event, Alarm)] != []
        assert len(session.pc.closed) == 3

    def test_a_hundred_sessions_leave_nothing_behind(self, session):
        session.end()
        unit = session.robot.compile(PROGRAM)
        for number in range(2, 101):
            session.run = session.robot.start(unit)
            session.wait(0.02)
            session.pc.stop()
            session.wait(0.02)
            assert session.run.state == "finished"
            assert len(session.pc.accepted) == len(session.pc.closed) == 3 * number
        assert session.robot.threads() == ()
