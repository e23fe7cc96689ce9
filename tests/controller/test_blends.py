"""Blends and chains as the controller runs them: when calls return, what follows, stops and pauses on the way."""

from itertools import pairwise
from math import dist
from random import Random

import pytest

from elitescript.controller.controller import Controller
from elitescript.controller.motion.move_sequencing import MoveSequencing
from elitescript.errors import MotionError, ScriptStateError
from elitescript.kinematics.transforms import pose_from_transform, position_of
from elitescript.messages.events import MotionEnded, MotionStarted, Warned
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale, SetTcp
from elitescript.messages.motion import MoveC, MoveJ, MoveL, MoveP, ServoJ, SpeedJ, StopJ, StopL
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from tests.invariants.cases import first_of

MODEL = load_model("CS66")
HOME = MODEL.home
START = pose_from_transform(MODEL.arm.forward(HOME))
R = 0.02


def shifted(pose, *offset):
    return tuple(a + b for a, b in zip(pose, (*offset, *(0.0,) * (6 - len(offset))), strict=True))


CORNER = shifted(START, 0.0, 0.08)
END = shifted(CORNER, 0.0, 0.0, -0.08)


class Machine:
    """A controller without scripts, run by hand."""

    def __init__(self):
        self.events = []
        self.returned = []
        self.controller = Controller(MODEL, epoch_s=0.0, on_event=self.events.append)

    def ask(self, request, line=1, thread="main"):
        return self.controller.request_motion(request, line, thread)

    def line(self, pose, v=0.1, r=0.0, line=1):
        return self.ask(MoveL(pose, 1.2, v, 0.0, r), line)

    def run(self, ticks, *, leap=False):
        end = self.controller.tick + ticks
        while self.controller.tick < end:
            self.controller.run_tick()
            due = self.controller.next_tick()
            step = end if due is None else min(due, end)
            self.controller.leap(step if leap else self.controller.tick + 1)
        self.controller.run_tick()

    def until_returned(self, number):
        while not self.controller.is_move_done(number):
            self.run(1)
        return self.controller.tick

    @property
    def q(self):
        return self.controller.joints().q_target

    @property
    def tcp(self):
        return position_of(MODEL.arm.forward(self.q))

    def events_of(self, kind):
        return [event for event in self.events if isinstance(event, kind)]


@pytest.fixture
def machine():
    return Machine()


def test_the_call_returns_in_the_first_period_in_the_sphere(machine):
    number = machine.line(CORNER, r=R)
    tick = machine.until_returned(number)
    assert dist(machine.tcp, CORNER[:3]) <= R
    assert dist(machine.tcp, CORNER[:3]) > R - 0.1 * PERIOD_S
    machine.controller.run_tick()
    assert machine.controller.is_moving
    assert tick * PERIOD_S == pytest.approx(0.06 / 0.1 + 0.05 / 1.2, abs=PERIOD_S)


def test_without_a_next_move_the_arm_stops_exactly_at_the_waypoint(machine):
    machine.until_returned(machine.line(CORNER, r=R))
    machine.run(500)
    assert not machine.controller.is_moving
    assert dist(machine.tcp, CORNER[:3]) < 1e-9
    assert [event.is_complete for event in machine.events_of(MotionEnded)] == [True]
    assert machine.events_of(Warned) == []


def test_a_move_in_the_same_tick_blends(machine):
    tick = machine.until_returned(machine.line(CORNER, r=R))
    assert machine.controller.target_waypoint == CORNER
    number = machine.line(END)
    assert machine.controller.target_waypoint == END
    assert [(event.tick, event.is_complete) for event in machine.events_of(MotionEnded)] == [(tick, True)]
    assert [event.tick for event in machine.events_of(MotionStarted)] == [0, tick]
    nearest, slowest = 1.0, 1.0
    while not machine.controller.is_move_done(number):
        before = machine.tcp
        machine.run(1)
        nearest = min(nearest, dist(machine.tcp, CORNER[:3]))
        if dist(machine.tcp, END[:3]) > 0.02:
            slowest = min(slowest, dist(before, machine.tcp) / PERIOD_S)
    # The parabola passes its corner at d / sqrt(8), at the speed v / sqrt(2).
    assert nearest == pytest.approx(R / 8**0.5, rel=0.02)
    assert slowest == pytest.approx(0.1 / 2**0.5, rel=0.01)
    assert dist(machine.tcp, END[:3]) < 1e-9
    assert machine.events_of(Warned) == []


def test_a_later_move_begins_at_the_waypoint_after_the_stop(machine):
    machine.until_returned(machine.line(CORNER, r=R))
    machine.run(10)
    number = machine.line(END)
    nearest = 1.0
    while not machine.controller.is_move_done(number):
        machine.run(1)
        nearest = min(nearest, dist(machine.tcp, CORNER[:3]))
    assert nearest < 1e-6
    assert dist(machine.tcp, END[:3]) < 1e-9
    assert [event.is_complete for event in machine.events_of(MotionEnded)] == [True, True]


@pytest.mark.parametrize("fraction", [0.1, 0.5])
def test_a_waiting_move_follows_a_changed_speed_and_a_pause(machine, fraction):
    machine.controller.task_started("test")
    machine.until_returned(machine.line(CORNER, r=R))
    machine.run(5)
    number = machine.line(END)
    machine.controller.request(SetSpeedScale(fraction))
    machine.run(10)
    machine.controller.request(PauseTask())
    machine.run(200)
    q = machine.q
    machine.run(300)
    assert machine.q == q
    machine.controller.request(ResumeTask())
    machine.until_returned(number)
    assert dist(machine.tcp, END[:3]) < 1e-9


@pytest.mark.parametrize("ticks", range(0, 16, 3))
def test_a_move_that_waits_stays_where_it_begins_when_the_one_before_arrives_in_a_pause(machine, ticks):
    machine.controller.task_started("test")
    turned = (HOME[0] + 1.0, *HOME[1:])
    number = machine.ask(MoveJ(turned, 40.0, 2.5, 0.0, 0.04))
    machine.run(90)
    machine.controller.request(SetSpeedScale(0.1))
    machine.until_returned(number)
    machine.controller.request(SetTcp((0.0, 0.0, 0.1, 0.0, 0.0, 0.0)))
    number = machine.ask(MoveJ(HOME, 8.0, 1.0))
    machine.run(ticks)
    machine.controller.request(PauseTask())
    places = []
    for _ in range(200):
        machine.run(1)
        places.append(machine.q)
    assert all(abs(b[0] - a[0]) <= 2.5 * PERIOD_S for a, b in pairwise(places))
    assert places[-1] == places[-100]
    machine.controller.request(SetSpeedScale(1.0))
    machine.controller.request(ResumeTask())
    machine.until_returned(number)
    assert machine.q == HOME


def test_a_task_that_ends_by_itself_lets_the_arm_arrive(machine):
    machine.controller.task_started("test")
    machine.until_returned(machine.line(CORNER, r=R))
    machine.controller.task_ended("finished")
    machine.run(500)
    assert dist(machine.tcp, CORNER[:3]) < 1e-9


def test_a_task_that_is_stopped_brakes_it_at_once(machine):
    machine.controller.task_started("test")
    machine.until_returned(machine.line(CORNER, r=R))
    machine.controller.task_ended()
    machine.run(500)
    assert not machine.controller.is_moving
    assert dist(machine.tcp, CORNER[:3]) > 0.005


def test_a_task_that_ends_in_a_drive_brakes_it(machine):
    machine.controller.task_started("test")
    machine.until_returned(machine.ask(SpeedJ((0.1, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0)))
    machine.controller.task_ended("finished")
    machine.run(100)
    assert not machine.controller.is_moving


@pytest.mark.parametrize("stop", [StopJ(8.0), StopL(2.0)])
@pytest.mark.parametrize("ticks", [3, 20, 60])
def test_a_stop_in_a_blend_stays_on_its_path(stop, ticks):
    def in_blend():
        machine = Machine()
        machine.until_returned(machine.line(CORNER, r=R))
        number = machine.line(END)
        machine.run(ticks)
        return machine, number

    machine, number = in_blend()
    assert machine.ask(stop) == number
    machine.run(500)
    assert machine.controller.is_move_done(number)
    other, _ = in_blend()
    nearest = 1.0
    for _ in range(400):
        other.run(1)
        nearest = min(nearest, max(abs(a - b) for a, b in zip(other.q, machine.q, strict=True)))
    # Half a period away from a sample of the path at most.
    assert nearest < 0.003


def test_a_stop_after_the_call_is_waited_for(machine):
    machine.until_returned(machine.line(CORNER, r=R))
    number = machine.ask(StopL(1.0))
    assert not machine.controller.is_move_done(number)
    machine.run(300)
    assert machine.controller.is_move_done(number)
    assert dist(machine.tcp, CORNER[:3]) > 0.005


def test_a_pause_that_ends_in_the_zone_still_blends(machine):
    machine.controller.task_started("test")
    number = machine.line(CORNER, v=0.3, r=0.04)
    while dist(machine.tcp, CORNER[:3]) > 0.041:
        machine.run(1)
    machine.controller.request(PauseTask())
    machine.run(200)
    assert dist(machine.tcp, CORNER[:3]) < 0.04
    assert not machine.controller.is_move_done(number)
    machine.controller.request(ResumeTask())
    machine.controller.run_tick()
    assert machine.controller.is_move_done(number)
    number = machine.line(END)
    nearest = 1.0
    while not machine.controller.is_move_done(number):
        machine.run(1)
        nearest = min(nearest, dist(machine.tcp, CORNER[:3]))
    assert nearest > 0.002
    assert dist(machine.tcp, END[:3]) < 1e-9


def test_a_new_speed_percentage_is_taken_on_within_the_blend(machine):
    machine.until_returned(machine.line(CORNER, v=0.2, r=0.03))
    machine.controller.request(SetSpeedScale(0.3))
    number = machine.line(END, v=0.2)
    speeds = []
    while not machine.controller.is_move_done(number):
        before = machine.tcp
        machine.run(1)
        speeds.append(dist(before, machine.tcp) / PERIOD_S)
    assert all(abs(b - a) < 2.5 * PERIOD_S for a, b in pairwise(speeds))
    assert max(speeds[100:]) == pytest.approx(0.06, rel=0.01)


def test_a_refused_second_move_leaves_the_first_alone(machine):
    machine.until_returned(machine.line(CORNER, r=R))
    with pytest.raises(MotionError):
        machine.line(shifted(CORNER, 3.0))
    machine.run(500)
    assert dist(machine.tcp, CORNER[:3]) < 1e-9


def test_a_changed_tcp_stops_the_arm_at_the_waypoint_and_says_so(machine):
    machine.until_returned(machine.line(CORNER, r=R))
    machine.controller.request(SetTcp((0.0, 0.0, 0.1, 0.0, 0.0, 0.0)))
    number = machine.ask(MoveJ(HOME, 1.4, 1.0))
    nearest = 1.0
    while not machine.controller.is_move_done(number):
        machine.run(1)
        nearest = min(nearest, dist(machine.tcp, CORNER[:3]))
    assert nearest < 1e-6
    assert machine.q == HOME
    assert "the TCP has changed" in machine.events_of(Warned)[0].text


def test_a_radius_below_the_braking_distance_is_warned_of_once_for_each_line(machine):
    machine.controller.task_started("test")
    pose = START
    for _ in range(3):
        for line in range(3, 6):
            pose = shifted(pose, 0.0, 0.02)
            number = machine.line(pose, v=0.3, r=0.005, line=line)
            machine.until_returned(number)
    first, *_ = warnings = machine.events_of(Warned)
    assert [warning.line for warning in warnings] == [3, 4, 5]
    assert "r = 0.005 m is less than its braking distance of 0.0469 m" in first.text
    assert "enters the blend at 0.0978 instead of 0.3 m/s and passes the waypoint at 0.0978 m/s" in first.text
    assert "movep" in first.text


@pytest.mark.parametrize(("lines", "looks"), [([3], 1), ([3, 4], 2), (range(1, 25), 10)])
def test_the_speed_in_a_corner_is_looked_for_only_where_the_warning_is_emitted(machine, monkeypatch, lines, looks):
    looked = []
    least_speed = MoveSequencing._least_speed
    monkeypatch.setattr(MoveSequencing, "_least_speed", lambda *args: looked.append(args) or least_speed(*args))
    machine.controller.task_started("test")
    pose = START
    for _ in range(2):
        for line in lines:
            pose = shifted(pose, 0.0, 0.002)
            machine.until_returned(machine.line(pose, v=0.3, r=0.0005, line=line))
    assert len(looked) == looks == len(machine.events_of(Warned))


def test_the_speed_in_the_corner_is_the_one_that_the_tool_has(machine):
    machine.until_returned(machine.line(CORNER, v=0.5, r=0.03))
    machine.line(END, v=0.5)
    (warning,) = machine.events_of(Warned)
    speeds = []
    for _ in range(60):
        before = machine.tcp
        machine.run(1)
        speeds.append(dist(before, machine.tcp) / PERIOD_S)
    told = float(warning.text.split("passes the waypoint at ")[1].split(" m/s")[0])
    assert told == pytest.approx(min(speeds), rel=0.02)


def test_a_long_move_is_told_the_radius_that_it_needs(machine):
    machine.until_returned(machine.line(CORNER, v=0.25, r=0.02))
    machine.line(END, v=0.25)
    (warning,) = machine.events_of(Warned)
    assert "choose r = 0.0326 m" in warning.text
    machine.run(500)
    machine.until_returned(machine.line(CORNER, v=0.25, r=0.0327))
    machine.line(END, v=0.25)
    assert machine.events_of(Warned) == [warning]


def test_a_chain_of_slow_blends_is_not_told_of_without_end(machine):
    machine.controller.task_started("test")
    pose = START
    for line in range(1, 25):
        pose = shifted(pose, 0.0, 0.004)
        machine.until_returned(machine.line(pose, v=0.3, r=0.001, line=line))
    warnings = machine.events_of(Warned)
    assert [warning.line for warning in warnings] == list(range(1, 11))
    assert ["further ones" in warning.text for warning in warnings] == [*[False] * 9, True]


def test_a_radius_of_half_of_the_move_in_rounded_numbers_is_not_shortened(machine):
    machine.line(shifted(START, 0.0, 0.0999995), r=0.05)
    assert machine.events_of(Warned) == []


@pytest.mark.parametrize("delay", range(0, 40, 7))
def test_a_stop_on_the_way_to_a_waypoint_keeps_to_its_deceleration(machine, delay):
    machine.until_returned(machine.line(CORNER, v=0.25, r=0.03))
    machine.run(delay)
    machine.ask(StopL(1.0))
    places = [machine.tcp]
    while machine.controller.is_moving:
        machine.run(1)
        places.append(machine.tcp)
    speeds = [dist(a, b) / PERIOD_S for a, b in pairwise(places)]
    assert max(a - b for a, b in pairwise(speeds)) / PERIOD_S <= 1.0 * 1.02
    # The plan alone needs 0.26 s from the entry on.
    assert len(speeds) <= 0.3 / PERIOD_S


def test_a_stream_after_a_blended_move_keeps_the_acceleration_limits(machine):
    machine.until_returned(machine.line(CORNER, v=0.25, r=0.03))
    rows = [machine.q]
    for _ in range(3):
        machine.run(1)
        rows.append(machine.q)
    machine.ask(ServoJ(machine.q, 0.004, 0.1, 300.0))
    for _ in range(60):
        machine.run(1)
        rows.append(machine.q)
    for a, b, c in zip(rows, rows[1:], rows[2:], strict=False):
        for joint in range(6):
            assert abs(c[joint] - 2.0 * b[joint] + a[joint]) / PERIOD_S**2 <= 40.0 * (1 + 1e-6)


def test_a_radius_longer_than_half_of_the_move_is_warned_of_on_its_line(machine):
    machine.line(CORNER, r=0.07, line=7)
    (warning,) = machine.events_of(Warned)
    assert warning.line == 7
    assert "r = 0.07 m is shortened to 0.04 m" in warning.text


def test_another_thread_is_refused_while_a_move_waits(machine):
    machine.until_returned(machine.line(CORNER, r=R))
    machine.run(3)
    machine.line(END)
    with pytest.raises(MotionError) as caught:
        machine.ask(MoveJ(HOME, 1.0, 1.0), thread="other")
    assert caught.value.code == "R114"


def test_two_hundred_short_lines_go_through_at_the_commanded_speed(machine):
    pose, v = START, 0.02
    speeds = []
    for index in range(200):
        pose = shifted(pose, 0.0, 0.0015)
        number = machine.line(pose, v=v, r=0.0005 if index < 199 else 0.0)
        while not machine.controller.is_move_done(number):
            before = machine.tcp
            machine.run(1)
            speeds.append(dist(before, machine.tcp) / PERIOD_S)
            assert abs(machine.tcp[0] - START[0]) < 1e-9
    assert machine.controller.tick * PERIOD_S == pytest.approx(0.3 / v + v / 1.2, rel=0.001)
    assert min(speeds[10:-10]) == pytest.approx(v, rel=1e-6)
    assert machine.events_of(Warned) == []


def test_steps_of_movep_are_fed_ahead_and_keep_their_speed(machine):
    pose, v, calls = START, 0.25, 0
    numbers = []
    while calls < 100:
        pose = shifted(pose, 0.0, 0.0015)
        numbers.append(machine.ask(MoveP(pose, 1.2, v)))
        calls += 1
        if calls == 10:
            # That much path is needed before anybody has to wait.
            assert machine.controller.tick == 0
        machine.until_returned(numbers[-1])
    machine.run(1)
    assert machine.controller.is_moving
    while machine.controller.is_moving:
        machine.run(1)
    assert dist(machine.tcp, pose[:3]) < 1e-9
    assert machine.controller.tick * PERIOD_S == pytest.approx(0.15 / v + v / 1.2, abs=3 * PERIOD_S)
    assert len(machine.events_of(MotionStarted)) == 100
    assert [event.is_complete for event in machine.events_of(MotionEnded)] == [True]


def test_a_movep_to_where_the_chain_ends_takes_one_tick(machine):
    pose = shifted(START, 0.0, 0.01)
    machine.until_returned(machine.ask(MoveP(pose, 1.2, 0.1)))
    tick = machine.controller.tick
    number = machine.ask(MoveP(pose, 1.2, 0.1))
    assert not machine.controller.is_move_done(number)
    assert machine.until_returned(number) == tick + 1


def test_a_line_after_a_chain_begins_at_its_end(machine):
    pose = shifted(START, 0.0, 0.01)
    machine.until_returned(machine.ask(MoveP(pose, 1.2, 0.05)))
    machine.until_returned(machine.line(END))
    assert dist(machine.tcp, END[:3]) < 1e-9


def test_a_chain_after_a_move_with_a_radius_begins_at_its_waypoint(machine):
    machine.until_returned(machine.line(CORNER, r=R))
    pose = CORNER
    for _ in range(5):
        pose = shifted(pose, 0.0, 0.0, -0.002)
        number = machine.ask(MoveP(pose, 1.2, 0.05))
        machine.until_returned(number)
    machine.run(200)
    assert dist(machine.tcp, pose[:3]) < 1e-9
    assert "a chain of movep begins at standstill" in machine.events_of(Warned)[0].text


def test_a_task_that_ends_by_itself_lets_a_chain_arrive(machine):
    machine.controller.task_started("test")
    pose = shifted(START, 0.0, 0.05)
    machine.until_returned(machine.ask(MoveP(pose, 1.2, 0.05)))
    machine.controller.task_ended("finished")
    machine.run(500)
    assert dist(machine.tcp, pose[:3]) < 1e-9


def random_session(seed, *, leap):
    """Moves with radii and chains, with all that may happen to them; returns every tick's joints, events, the end."""
    chance = Random(seed)
    machine = Machine()
    controller = machine.controller
    controller.task_started("test")
    rows = [machine.q]
    pose = START
    for _ in range(80):
        actions = ("line", "line", "arc", "joints", "chain", "chain", "speed", "pause", "resume", "stop", "none")
        action = chance.choice(actions)
        r = chance.choice((0.0, 0.001, 0.01, 0.05))
        try:
            number = 0
            if action in ("line", "chain"):
                size = 0.05 if action == "line" else 0.004
                target = shifted(controller.target_waypoint, *(chance.uniform(-size, size) for _ in range(3)))
                if dist(target[:3], pose[:3]) < 0.2:
                    if action == "line":
                        number = machine.line(target, chance.uniform(0.05, 0.5), r)
                    else:
                        number = machine.ask(MoveP(target, 1.2, chance.uniform(0.02, 0.3), r))
            elif action == "arc":
                via = shifted(controller.target_waypoint, 0.01, 0.01, 0.002)
                to = shifted(controller.target_waypoint, 0.0, 0.03, 0.0)
                number = machine.ask(MoveC(via, to, 1.2, chance.uniform(0.05, 0.3), r))
            elif action == "joints":
                q = tuple(a + chance.uniform(-0.3, 0.3) for a in HOME)
                number = machine.ask(MoveJ(q, chance.uniform(0.5, 9), chance.uniform(0.2, 3), 0.0, r))
            elif action == "speed":
                controller.request(SetSpeedScale(chance.choice((0.0, 0.1, 0.7, 1.0))))
            elif action == "pause":
                controller.request(PauseTask())
            elif action == "resume":
                controller.request(ResumeTask())
            elif action == "stop":
                machine.ask(chance.choice((StopJ(8.0), StopL(2.0))))
        except (MotionError, ScriptStateError):
            pass
        ticks = chance.randrange(1, 80)
        waits = chance.random() < 0.7
        while ticks and not (waits and number and controller.is_move_done(number)):
            if leap:
                due = controller.next_tick()
                step = ticks if due is None else min(ticks, due - controller.tick)
            else:
                step = 1
            machine.run(step, leap=leap)
            ticks -= step
            if not leap:
                rows.append(machine.q)
    return rows, machine.events, machine.q


@pytest.mark.parametrize("seed", first_of(range(25), 10))
def test_position_and_speed_never_jump_and_a_session_leaps_as_it_steps(seed):
    rows, stepped_events, stepped_q = random_session(seed, leap=False)
    previous = [0.0] * 6
    change_max = (40.0 + 2 * MODEL.stop_joint_deceleration) * PERIOD_S
    for before, after in pairwise(rows):
        speeds = [(b - a) / PERIOD_S for a, b in zip(before, after, strict=True)]
        for joint in range(6):
            assert abs(speeds[joint]) <= MODEL.joints[joint].qd_max * 1.001
            assert abs(speeds[joint] - previous[joint]) <= change_max
        previous = speeds
    _, leaped_events, leaped_q = random_session(seed, leap=True)
    assert stepped_events == leaped_events
    assert stepped_q == leaped_q
