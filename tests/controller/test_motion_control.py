"""The active move under speed changes, pauses and stops; positions sampled as the trace samples them."""

from itertools import pairwise
from random import Random

import pytest

from elitescript.controller.controller import Controller
from elitescript.errors import MotionError, ScriptStateError
from elitescript.kinematics.transforms import pose_from_transform
from elitescript.messages.enums import RobotMode, TaskState
from elitescript.messages.events import MotionEnded, MotionStarted, RobotModeChanged, Warned
from elitescript.messages.machine import PauseTask, PowerDown, ResumeTask, SetSpeedScale
from elitescript.messages.motion import MoveJ, MoveL, StopJ, StopL
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model

MODEL = load_model("CS66")
HOME = MODEL.home
TARGET = (0.5, -1.2, -1.8, -1.4, 1.5, 0.3)


class Machine:
    """A controller without scripts, run by hand tick by tick or by leaps."""

    def __init__(self):
        self.events = []
        self.controller = Controller(MODEL, epoch_s=0.0, on_event=self.events.append)

    def run(self, ticks, *, leap=False):
        end = self.controller.tick + ticks
        while self.controller.tick < end:
            self.controller.run_tick()
            due = self.controller.next_tick()
            step = end if due is None else min(due, end)
            self.controller.leap(step if leap else self.controller.tick + 1)
        self.controller.run_tick()

    def movej(self, q=TARGET, a=1.4, v=1.05, t_s=0.0):
        return self.controller.request_motion(MoveJ(q, a, v, t_s), 3, "main")

    @property
    def q(self):
        return self.controller.joints().q_target

    def ended(self):
        return [(event.tick, event.is_complete) for event in self.events if isinstance(event, MotionEnded)]


@pytest.fixture
def machine():
    return Machine()


def test_a_move_ends_exactly_at_its_target_at_the_tick_its_duration_says(machine):
    number = machine.movej()
    started = machine.events[-1]
    assert isinstance(started, MotionStarted)
    assert (started.line, started.thread) == (3, "main")
    end_tick = -int(-started.duration_s / PERIOD_S // 1)
    machine.run(end_tick - 1)
    assert not machine.controller.is_move_done(number)
    machine.run(1)
    assert machine.controller.is_move_done(number)
    assert machine.q == TARGET
    assert machine.ended() == [(end_tick, True)]


@pytest.mark.parametrize("ticks", range(60, 400, 7))
def test_a_duration_of_whole_ticks_ends_at_its_tick_exactly_on_the_target(machine, ticks):
    machine.controller.request(SetSpeedScale(0.3))
    machine.movej(t_s=ticks * 3 * PERIOD_S * 0.3 + 1.0)
    duration_s = machine.events[-1].duration_s
    machine.run(6000, leap=True)
    assert machine.q == TARGET
    ((tick, is_complete),) = machine.ended()
    assert is_complete
    assert tick == pytest.approx(duration_s / 0.3 / PERIOD_S, abs=1.001)


def test_leaping_and_stepping_end_at_the_same_tick():
    stepped, leaped = Machine(), Machine()
    for machine in (stepped, leaped):
        machine.movej()
    stepped.run(600)
    leaped.run(600, leap=True)
    assert stepped.events == leaped.events


def test_a_move_to_where_the_arm_is_takes_one_tick(machine):
    number = machine.movej(HOME)
    assert not machine.controller.is_move_done(number)
    machine.run(1)
    assert machine.controller.is_move_done(number)


def test_a_second_motion_is_refused_and_the_first_goes_on(machine):
    machine.movej()
    with pytest.raises(MotionError, match="'main'") as caught:
        machine.movej(HOME)
    assert caught.value.code == "R114"
    machine.run(1000)
    assert machine.q == TARGET


def test_half_the_speed_takes_twice_as_long(machine):
    machine.controller.request(SetSpeedScale(0.5))
    machine.movej()
    duration_s = machine.events[-1].duration_s
    machine.run(2000)
    ((tick, _),) = machine.ended()
    assert tick * PERIOD_S == pytest.approx(2 * duration_s, abs=PERIOD_S)


def test_speed_zero_stands_still_until_it_is_raised(machine):
    machine.controller.request(SetSpeedScale(0.0))
    machine.movej()
    machine.run(500)
    assert machine.q == HOME
    assert machine.controller.next_tick() is None
    machine.controller.request(SetSpeedScale(1.0))
    machine.run(1000)
    assert machine.q == TARGET


@pytest.mark.parametrize("request_", [StopJ(8.0), StopL(3.0)])
def test_a_stop_ends_the_move_on_its_path(machine, request_):
    number = machine.movej()
    machine.run(100)
    assert machine.controller.request_motion(request_, 9, "main") == number
    machine.run(200)
    ((tick, is_complete),) = machine.ended()
    assert not is_complete
    assert 100 < tick < 200
    fractions = [(q - start) / (end - start) for q, start, end in zip(machine.q, HOME, TARGET, strict=True)]
    assert max(fractions) - min(fractions) < 1e-12
    assert 0.0 < fractions[0] < 1.0


def test_a_stop_at_standstill_does_nothing(machine):
    assert machine.controller.request_motion(StopJ(8.0), 1, "main") == 0
    assert machine.controller.is_move_done(0)
    assert machine.events == []


def test_a_move_that_is_asked_for_while_the_arm_brakes_begins_at_standstill(machine):
    first = machine.movej()
    machine.run(100)
    machine.controller.cancel_move(first)
    second = machine.movej(HOME)
    assert not machine.controller.is_move_done(first)
    machine.run(1000)
    assert machine.controller.is_move_done(second)
    assert machine.q == HOME
    assert [is_complete for _, is_complete in machine.ended()] == [False, True]


def test_a_move_that_waits_for_standstill_does_not_begin_in_a_pause(machine):
    machine.controller.task_started("test")
    first = machine.movej()
    machine.run(100)
    machine.controller.cancel_move(first)
    machine.movej(HOME)
    machine.run(2)
    machine.controller.request(PauseTask())
    machine.run(100)
    q = machine.q
    machine.run(500)
    assert machine.q == q
    machine.controller.request(ResumeTask())
    machine.run(1000)
    assert machine.q == HOME


def test_the_power_goes_off_when_the_arm_stands(machine):
    machine.movej()
    machine.run(100)
    machine.controller.request(PowerDown())
    assert machine.controller.robot_mode is RobotMode.RUNNING
    with pytest.raises(ScriptStateError, match="switched off"):
        machine.movej(HOME)
    machine.run(200)
    assert machine.controller.robot_mode is RobotMode.POWER_OFF
    kinds = [type(event) for event in machine.events]
    assert kinds.index(MotionEnded) < kinds.index(RobotModeChanged)


def test_an_arm_that_is_switched_off_does_not_move(machine):
    machine.controller.request(PowerDown())
    with pytest.raises(ScriptStateError, match="switched off") as caught:
        machine.movej()
    assert caught.value.code == "R115"


def test_the_waypoint_is_the_target_of_the_last_move(machine):
    pose = pose_from_transform(MODEL.arm.forward(TARGET))
    machine.movej()
    assert machine.controller.target_waypoint == pose
    machine.run(1000)
    assert machine.controller.target_waypoint == pose


def random_session(seed, *, leap):
    """Moves with speed changes, pauses, stops at random ticks; returns every tick's joints, and the events."""
    chance = Random(seed)
    machine = Machine()
    controller = machine.controller
    controller.task_started("test")
    rows = [machine.q]
    for _ in range(60):
        action = chance.choice(("move", "move", "line", "speed", "pause", "resume", "stop", "cancel", "none"))
        try:
            if action == "move":
                machine.movej(
                    tuple(q + chance.uniform(-0.5, 0.5) for q in HOME), chance.uniform(0.5, 9), chance.uniform(0.2, 3)
                )
            elif action == "line":
                pose = list(controller.state().tcp_pose_target)
                pose[chance.randrange(3)] += chance.uniform(-0.06, 0.06)
                controller.request_motion(MoveL(tuple(pose), 1.2, chance.uniform(0.05, 0.5)), 1, "main")
            elif action == "speed":
                controller.request(SetSpeedScale(chance.choice((0.0, 0.1, 0.7, 1.0))))
            elif action == "pause":
                controller.request(PauseTask())
            elif action == "resume":
                controller.request(ResumeTask())
            elif action == "stop":
                controller.request_motion(chance.choice((StopJ(8.0), StopL(2.0))), 1, "main")
            elif action == "cancel":
                controller.cancel_move(chance.randrange(1, 20))
        except (MotionError, ScriptStateError):
            pass
        ticks = chance.randrange(1, 120)
        if leap:
            machine.run(ticks, leap=True)
        else:
            for _ in range(ticks):
                machine.run(1)
                rows.append(machine.q)
    return rows, machine.events, machine.q


@pytest.mark.parametrize("seed", range(12))
def test_position_and_speed_never_jump(seed):
    rows, _, _ = random_session(seed, leap=False)
    speed_max = [joint.qd_max for joint in MODEL.joints]
    previous = [0.0] * 6
    # Braking for a pause may add to the move's own deceleration; both are bounded.
    change_max = (40.0 + 2 * MODEL.stop_joint_deceleration) * PERIOD_S
    for before, after in pairwise(rows):
        speeds = [(b - a) / PERIOD_S for a, b in zip(before, after, strict=True)]
        for joint in range(6):
            assert abs(speeds[joint]) <= speed_max[joint] * 1.001
            assert abs(speeds[joint] - previous[joint]) <= change_max
        previous = speeds


@pytest.mark.parametrize("seed", range(12))
def test_a_session_leaps_as_it_steps(seed):
    _, stepped_events, stepped_q = random_session(seed, leap=False)
    _, leaped_events, leaped_q = random_session(seed, leap=True)
    assert stepped_events == leaped_events
    assert stepped_q == leaped_q


def test_what_is_not_quite_as_asked_is_said_once_for_each_line_of_a_program(machine):
    def say(line):
        machine.controller.request_motion(MoveJ(TARGET, 1.4, 1.05, 0.01), line, "main")
        machine.run(1000)
        machine.controller.request_motion(MoveJ(HOME, 1.4, 1.05), 99, "main")
        machine.run(1000)

    machine.controller.task_started("first")
    for line in (3, 3, 4):
        say(line)
    warnings = [event for event in machine.events if isinstance(event, Warned)]
    assert [warning.line for warning in warnings] == [3, 4]
    machine.controller.task_ended()
    machine.controller.task_started("second")
    say(3)
    assert len([event for event in machine.events if isinstance(event, Warned)]) == 3


def test_the_end_of_the_task_brakes_the_arm(machine):
    machine.controller.task_started("test")
    machine.movej()
    machine.run(100)
    machine.controller.task_ended()
    assert machine.controller.task_state is TaskState.STOPPED
    assert machine.controller.is_moving
    machine.run(200)
    assert not machine.controller.is_moving
    assert machine.ended()[0][1] is False
