"""Going along with belts and turntables: exactly above the part, without a jump, and to rest when it is over."""

from itertools import pairwise
from math import hypot, pi
from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.controller.controller import Controller
from elitescript.controller.motion.conveyor_encoders import RANGES
from elitescript.controller.tasks import NoProgram
from elitescript.errors import MotionError, ScriptStateError
from elitescript.kinematics.transforms import pose_from_transform, transform_from_pose
from elitescript.messages.events import MotionEnded, TrackingEnded, TrackingStarted
from elitescript.messages.machine import (
    AskSafety,
    PauseTask,
    PrepareEncoder,
    ResumeTask,
    SetEncoderCount,
    SetSpeedScale,
    SetTcp,
    WriteSignal,
)
from elitescript.messages.motion import MoveJ, MoveL, SpeedL, StopTracking, TrackCircular, TrackLinear
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.motion.corrections.conveyor import StraightConveyor, Turntable
from elitescript.motion.segment import Setpoint

MODEL = load_model("CS66")
HOME = MODEL.home
TCP = (0.02, -0.01, 0.15, 0.1, -0.2, 0.3)
DIRECTION = (0.3, 1.0, -0.1)
CENTER = (0.2, -0.5, 0.1, 0.05, -0.1, 0.3)
PER_M, PER_TURN = 2000.0, 5000.0
EXACT_M = 1e-9
"""Far below the 0.1 mm that a pick needs; what inverse kinematics leaves."""

BELT = (TrackLinear(DIRECTION, PER_M, 0), StraightConveyor(DIRECTION, PER_M))
TABLE = (TrackCircular(CENTER, PER_TURN, False, 0), Turntable(CENTER, PER_TURN, False))
TURNING = (TrackCircular(CENTER, PER_TURN, True, 0), Turntable(CENTER, PER_TURN, True))
CONVEYORS = [BELT, TABLE, TURNING]
conveyors = pytest.mark.parametrize(("request_", "conveyor"), CONVEYORS, ids=["belt", "table", "turning table"])


class Blamed(NoProgram):
    """A program that keeps the alarms that end it."""

    def __init__(self):
        self.alarms = []

    def fail(self, alarm):
        self.alarms.append(alarm)


class Cell:
    """A controller without scripts, run by hand; keeps every target."""

    def __init__(self, speed=0.0, encoder=0, model=MODEL):
        self.events = []
        self.model = model
        self.controller = Controller(model, epoch_s=0.0, on_event=self.events.append)
        self.controller.attach(Blamed())
        self.controller.task_started("job")
        self.controller.request(SetTcp(TCP))
        self.turn(speed, encoder)
        self.rows = []
        self.look()

    def turn(self, speed, encoder=0):
        self.controller.request(WriteSignal("encoder_speed", encoder, speed))

    def ask(self, request, thread="main"):
        return self.controller.request_motion(request, 7, thread)

    def look(self):
        joints = self.controller.joints()
        self.rows.append((joints.q_target, joints.qd_target))

    def run(self, ticks):
        for _ in range(ticks):
            self.controller.leap(self.controller.tick + 1)
            self.controller.run_tick()
            self.look()

    def run_to_rest(self, ticks=2000):
        for _ in range(ticks):
            if not self.controller.is_moving:
                return
            self.run(1)
        raise AssertionError("the arm still moves")

    @property
    def pose(self):
        return self.controller.state().tcp_pose_target

    @property
    def twist(self):
        return self.controller.state().tcp_speed_target

    def line_by(self, dx, dy, dz, v=0.25):
        x, y, z, rx, ry, rz = self.start
        return MoveL((x + dx, y + dy, z + dz, rx, ry, rz), 1.2, v)

    def track(self, request):
        self.start = self.pose
        self.tracked_tick = self.controller.tick
        assert self.ask(request) == 0

    def part(self, conveyor, counts, pose=None):
        """Where the part that lay at `pose` when tracking began is now."""
        way = counts * conveyor.way_per_count
        return pose_from_transform(conveyor.carried(transform_from_pose(pose or self.start), way))

    @property
    def alarms(self):
        return self.controller.program.alarms

    def unlock(self):
        self.run(1300)
        self.controller.request(AskSafety("unlock_protective_stop"))

    def check_smooth(self):
        for (q, qd), (q_next, qd_next) in pairwise(self.rows):
            for joint, (x, w, x_next, w_next) in enumerate(zip(q, qd, q_next, qd_next, strict=True)):
                limit = self.model.joints[joint]
                assert abs(w_next - w) <= limit.qdd_max * PERIOD_S * (1 + 1e-9)
                assert abs(w_next) <= limit.qd_max * (1 + 1e-9)
                # The speeds are those of the positions: what is left is a change of the acceleration within the tick.
                assert x_next - x == pytest.approx(0.5 * (w + w_next) * PERIOD_S, abs=1e-4)


def assert_same(pose, other, tolerance=EXACT_M):
    for a, b in zip(transform_from_pose(pose), transform_from_pose(other), strict=True):
        assert abs(a - b) < tolerance


@conveyors
class TestOnEveryConveyor:
    def test_stays_exactly_above_the_part_once_it_has_caught_up(self, request_, conveyor):
        cell = Cell(300.0)
        cell.track(request_)
        cell.run(250)
        for _ in range(50):
            cell.run(1)
            assert_same(cell.pose, cell.part(conveyor, 1.2 * cell.controller.tick))
        cell.check_smooth()

    def test_a_pick_from_the_moving_conveyor_ends_on_the_part(self, request_, conveyor):
        cell = Cell(-250.0)
        cell.track(request_)
        move = cell.line_by(0.02, 0.03, -0.1)
        number = cell.ask(move)
        while not cell.controller.is_move_done(number):
            cell.run(1)
        assert_same(cell.pose, cell.part(conveyor, -1.0 * cell.controller.tick, move.p_target))
        cell.check_smooth()

    def test_speed_changes_reversal_and_standstill_are_caught_up(self, request_, conveyor):
        cell = Cell(200.0)
        cell.track(request_)
        counts = 0.0
        for speed in (200.0, -150.0, 0.0, 320.0, 0.0):
            cell.turn(speed)
            cell.run(220)
            counts += 220 * speed * PERIOD_S
            assert_same(cell.pose, cell.part(conveyor, counts))
        assert hypot(*cell.twist) < 1e-12
        cell.check_smooth()

    def test_moves_are_relative_to_the_conveyor(self, request_, conveyor):
        cell, still = Cell(300.0), Cell()
        for one in (cell, still):
            one.track(request_)
            one.run(250)
            one.ask(one.line_by(0.05, -0.04, -0.06))
        for _ in range(120):
            cell.run(1)
            still.run(1)
            assert_same(cell.pose, cell.part(conveyor, 1.2 * cell.controller.tick, still.pose))
        cell.check_smooth()

    def test_the_end_leaves_the_arm_at_rest_where_it_is(self, request_, conveyor):
        cell = Cell(300.0)
        cell.track(request_)
        cell.run(250)
        number = cell.ask(StopTracking())
        assert not cell.controller.is_move_done(number)
        while not cell.controller.is_move_done(number):
            cell.run(1)
        rest = cell.pose
        assert hypot(*cell.twist) < 1e-12
        assert not cell.controller.is_moving
        cell.run(50)
        assert_same(cell.pose, rest, 1e-15)
        cell.start = rest
        cell.ask(cell.line_by(0.0, 0.0, 0.05))
        cell.run_to_rest()
        assert_same(cell.pose, (*rest[:2], rest[2] + 0.05, *rest[3:]))
        cell.check_smooth()

    def test_the_end_of_the_program_brings_the_arm_to_rest(self, request_, conveyor):
        cell = Cell(300.0)
        cell.track(request_)
        cell.ask(cell.line_by(0.05, -0.04, -0.06))
        cell.run(60)
        cell.controller.task_ended()
        cell.run_to_rest(250)
        assert hypot(*cell.twist) < 1e-12
        cell.check_smooth()

    def test_a_pause_brings_it_to_rest_and_afterwards_it_catches_up_again(self, request_, conveyor):
        cell = Cell(120.0)
        cell.track(request_)
        cell.run(60)
        move = cell.line_by(0.02, 0.03, -0.08)
        number = cell.ask(move)
        cell.run(40)
        cell.controller.request(PauseTask())
        cell.run(100)
        assert hypot(*cell.twist) < 1e-12
        rest = cell.pose
        cell.run(50)
        assert_same(cell.pose, rest, 1e-12)
        cell.controller.request(ResumeTask())
        cell.run(500)
        assert cell.controller.is_move_done(number)
        assert_same(cell.pose, cell.part(conveyor, 0.48 * cell.controller.tick, move.p_target))
        cell.check_smooth()


@pytest.mark.parametrize("range_id", range(5))
@pytest.mark.parametrize("speed", [400.0, -400.0])
class TestOverTheEndOfTheRange:
    def prepared(self, range_id, speed):
        limits = RANGES[range_id]
        cell = Cell()
        cell.controller.request(PrepareEncoder(0, range_id))
        first = limits.high - 100 if speed > 0 else limits.low + 100
        cell.controller.request(SetEncoderCount(0, float(first)))
        return cell, limits, first

    def test_of_a_simulated_encoder(self, range_id, speed):
        cell, limits, first = self.prepared(range_id, speed)
        cell.turn(speed)
        cell.track(BELT[0])
        cell.run(250)
        assert cell.controller.encoder_count(0) == limits.wrapped(first + speed)
        assert abs(cell.controller.encoder_count(0) - first) != abs(speed) or range_id == 1
        assert_same(cell.pose, cell.part(BELT[1], speed))
        cell.check_smooth()

    def test_of_counts_that_are_set_every_20_ms(self, range_id, speed):
        cell, limits, first = self.prepared(range_id, speed)
        cell.track(BELT[0])
        for k in range(1, 51):
            cell.run(5)
            cell.controller.request(SetEncoderCount(0, limits.wrapped(first + speed * 0.02 * k)))
        assert_same(cell.pose, cell.part(BELT[1], speed))
        cell.check_smooth()


def test_the_tool_gets_up_to_speed_with_a_bounded_acceleration_and_catches_up_once():
    cell = Cell(600.0)
    cell.track(TrackLinear((0.0, 1.0, 0.0), PER_M, 0))
    speeds = []
    for _ in range(150):
        cell.run(1)
        speeds.append(cell.twist[1])
    steps = [abs(b - a) / PERIOD_S for a, b in pairwise([0.0, *speeds])]
    assert max(steps) == pytest.approx(MODEL.tracking_acceleration, rel=1e-6)
    assert max(speeds) == pytest.approx(0.3 * (1 + 0.5**0.5), rel=0.01)
    assert speeds[-1] == pytest.approx(0.3, abs=1e-12)
    # Time-optimal: one plus root two times the time to get up to speed.
    settled = max(k for k, speed in enumerate(speeds) if abs(speed - 0.3) > 1e-9) + 2
    assert settled * PERIOD_S == pytest.approx(0.3 / 3.0 * (1 + 2**0.5), abs=2 * PERIOD_S)


def test_a_quick_belt_is_caught_up_with_no_more_than_the_tracking_speed_above_its_own():
    cell = Cell(-1600.0)
    cell.track(TrackLinear((0.0, -1.0, 0.0), PER_M, 0))
    speeds = []
    for _ in range(145):
        cell.run(1)
        speeds.append(cell.twist[1])
    assert max(speeds) == pytest.approx(0.8 + MODEL.tracking_speed, abs=1e-9)
    assert not cell.alarms


def test_a_slow_belt_is_caught_up_gently():
    cell = Cell(40.0)
    cell.track(TrackLinear((0.0, 1.0, 0.0), PER_M, 0))
    cell.run(50)
    assert cell.pose[1] - cell.start[1] == pytest.approx(40.0 * 0.2 / PER_M, abs=EXACT_M)
    assert cell.twist[1] == pytest.approx(0.02, abs=1e-12)


def test_the_other_encoder_is_another_conveyor():
    cell = Cell(300.0)
    cell.turn(-80.0, 1)
    cell.track(TrackLinear((1.0, 0.0, 0.0), 1000.0, 1))
    cell.run(250)
    assert cell.pose[0] - cell.start[0] == pytest.approx(-0.08, abs=EXACT_M)
    assert (cell.controller.encoder_count(0), cell.controller.encoder_count(1)) == (300.0, -80.0)
    number = cell.ask(StopTracking())
    while not cell.controller.is_move_done(number):
        cell.run(1)
    begun = cell.controller.tick
    cell.track(BELT[0])
    cell.run(250)
    assert_same(cell.pose, cell.part(BELT[1], 1.2 * (cell.controller.tick - begun)))


def test_a_belt_that_stands_changes_nothing_to_the_last_bit():
    cell, plain = Cell(), Cell()
    cell.track(BELT[0])
    plain.start = plain.pose
    for one in (cell, plain):
        one.ask(one.line_by(0.05, 0.05, -0.1))
        one.run(200)
    assert cell.rows == plain.rows


def test_counts_go_by_while_nothing_is_tracked():
    cell = Cell(300.0)
    cell.run(1000)
    cell.track(BELT[0])
    cell.run(250)
    assert_same(cell.pose, cell.part(BELT[1], 300.0))


def test_the_speed_percentage_leaves_the_conveyor_alone():
    cell = Cell(300.0)
    cell.controller.request(SetSpeedScale(0.1))
    cell.track(BELT[0])
    cell.run(200)
    cell.controller.request(SetSpeedScale(0.0))
    cell.run(50)
    assert_same(cell.pose, cell.part(BELT[1], 300.0))


def test_a_table_may_turn_by_more_than_half_a_turn():
    cell = Cell(2000.0)
    center = (*cell.pose[:2], 0.0, 0.0, 0.0, 0.0)
    cell.track(TrackCircular(center, 5000.0, True, 0))
    cell.run(500)
    assert abs(cell.rows[-1][0][5] - HOME[5]) == pytest.approx(2 * pi * 0.8, abs=0.6)
    assert_same(cell.pose, cell.part(Turntable(center, 5000.0, True), 4000.0))
    assert not cell.alarms
    cell.check_smooth()


class TestCountsThatAreSet:
    def stream(self, counts_at, ticks, period=5):
        cell = Cell()
        cell.controller.request(PrepareEncoder(0, 0))
        cell.controller.request(SetEncoderCount(0, counts_at(0)))
        cell.track(TrackLinear((0.0, 1.0, 0.0), 10000.0, 0))
        twists = []
        for _ in range(ticks):
            cell.run(1)
            twists.append(cell.twist[1])
            if cell.controller.tick % period == 0:
                cell.controller.request(SetEncoderCount(0, counts_at(cell.controller.tick)))
        return cell, twists

    def test_whole_counts_every_20_ms_do_not_make_the_tool_jump(self):
        cell, twists = self.stream(lambda tick: float(int(3.31 * tick)), 400)
        steps = [abs(b - a) / PERIOD_S for a, b in pairwise(twists)]
        assert max(steps[100:]) < 0.15
        assert cell.pose[1] - cell.start[1] == pytest.approx(3.31 * 400 / 10000, abs=1e-4)
        assert max(abs(w - 0.08275) for w in twists[200:]) < 0.001

    def test_one_jump_of_the_count_is_a_smooth_way(self):
        cell, twists = self.stream(lambda tick: 0.0 if tick < 100 else 1000.0, 500)
        assert max(abs(b - a) for a, b in pairwise(twists)) <= 3.0 * PERIOD_S * (1 + 1e-6)
        assert cell.pose[1] - cell.start[1] == pytest.approx(0.1, abs=EXACT_M)

    def test_when_no_more_come_the_arm_stands_where_the_belt_was_seen_last(self):
        cell, _ = self.stream(lambda tick: 3.0 * tick, 100)
        cell.run(300)
        assert hypot(*cell.twist) < 1e-12
        assert cell.pose[1] - cell.start[1] == pytest.approx(300 / 10000, abs=EXACT_M)


class TestWhatCannotGoOn:
    def test_an_arm_that_gets_too_long_lets_the_part_go_and_says_why(self):
        cell = Cell(200.0)
        cell.track(TrackLinear((1.0, 0.0, 0.0), 1000.0, 0))
        number = cell.ask(cell.line_by(0.0, 0.0, -0.05, v=0.002))
        cell.run_to_rest()
        assert cell.controller.is_move_done(number)
        (alarm,) = cell.alarms
        assert alarm.text.startswith("conveyor tracking leads into the elbow singularity, ")
        assert (alarm.code, alarm.line, alarm.thread) == ("R140", 7, "main")
        assert [event.is_complete for event in cell.events if isinstance(event, MotionEnded)] == [False]
        cell.check_smooth()
        cell.unlock()
        cell.start = cell.pose
        cell.ask(cell.line_by(-0.1, 0.0, 0.0))
        cell.run_to_rest()
        assert_same(cell.pose, (cell.start[0] - 0.1, *cell.start[1:]))

    def test_the_end_of_a_joint_range(self):
        cell = Cell(2000.0)
        center = (*cell.pose[:2], 0.0, 0.0, 0.0, 0.0)
        cell.track(TrackCircular(center, 5000.0, True, 0))
        cell.run_to_rest(2000)
        (alarm,) = cell.alarms
        assert "joint wrist3" in alarm.text and "end of its range" in alarm.text
        assert abs(cell.rows[-1][0][5]) <= 2 * pi
        cell.check_smooth()

    def test_a_joint_that_would_have_to_be_quicker_than_it_can(self):
        cell = Cell(100.0)
        center = (*cell.pose[:2], 0.0, 0.0, 0.0, 0.0)
        cell.track(TrackCircular(center, 100.0, True, 0))
        cell.run_to_rest(2000)
        (alarm,) = cell.alarms
        assert "would make joint wrist3 turn with" in alarm.text and "it can 4.014 rad/s" in alarm.text
        cell.check_smooth()

    def test_a_place_beyond_reach_is_said_in_numbers(self):
        cell = Cell(100.0)
        cell.track(TrackLinear((1.0, 0.0, 0.0), 1000.0, 0))
        found = cell.controller.tracking._carried(Setpoint(HOME, ZERO_SIX), HOME, 0.6, 0.1)
        assert (found.code, found.joint) == ("R111", -1)
        assert found.text.startswith("conveyor tracking takes the tool out of reach: too far by 0.")

    def test_the_end_that_is_asked_for_after_that_is_there_already(self):
        cell = Cell(200.0)
        cell.track(TrackLinear((1.0, 0.0, 0.0), 1000.0, 0))
        cell.run_to_rest()
        cell.unlock()
        assert cell.controller.is_move_done(cell.ask(StopTracking()))

    def test_while_the_arm_brakes_no_move_is_taken_and_it_can_go_home_later(self):
        cell = Cell(200.0)
        cell.track(TrackLinear((1.0, 0.0, 0.0), 1000.0, 0))
        while not cell.alarms:
            cell.run(1)
        with pytest.raises(ScriptStateError, match="protective stop"):
            cell.ask(MoveJ(HOME, 1.4, 1.0))
        cell.run_to_rest()
        cell.unlock()
        number = cell.ask(MoveJ(HOME, 1.4, 1.0))
        cell.run_to_rest()
        assert cell.controller.is_move_done(number)
        assert cell.rows[-1][0] == HOME
        cell.check_smooth()


class TestRefusals:
    def test_two_conveyors_at_once(self):
        cell = Cell(100.0)
        cell.track(BELT[0])
        with pytest.raises(MotionError, match="tracks a conveyor already, since line 7") as caught:
            cell.ask(TABLE[0])
        assert caught.value.code == "R114"
        assert "stop_conveyor_tracking" in caught.value.hint

    def test_an_arm_in_a_singularity(self):
        cell = Cell(100.0)
        cell.ask(MoveJ((*HOME[:4], 0.0, 0.0), 5.0, 2.0))
        cell.run_to_rest()
        with pytest.raises(MotionError, match="wrist singularity") as caught:
            cell.ask(BELT[0])
        assert caught.value.code == "R112"
        assert not cell.controller.is_moving

    def test_an_arm_without_power(self):
        events = []
        controller = Controller(MODEL, epoch_s=0.0, on_event=events.append)
        controller.power.apply("engage_brakes")
        with pytest.raises(ScriptStateError) as caught:
            controller.request_motion(BELT[0], 1, "main")
        assert caught.value.code == "R115"


def test_the_end_brakes_a_motion_at_a_speed_too():
    cell = Cell(200.0)
    cell.track(BELT[0])
    cell.ask(SpeedL((0.0, 0.0, -0.05, 0.0, 0.0, 0.0), 0.5, 0.5))
    cell.run(200)
    number = cell.ask(StopTracking())
    cell.run(100)
    assert cell.controller.is_move_done(number)
    assert not cell.controller.is_moving
    cell.check_smooth()


def test_a_pause_without_a_conveyor_is_no_pause_of_the_next_one():
    cell = Cell(300.0)
    tracking = cell.controller.tracking
    tracking.pause(0)
    tracking.stop(0)
    tracking.resume(0)
    assert not tracking.is_active
    cell.track(BELT[0])
    cell.run(250)
    assert_same(cell.pose, cell.part(BELT[1], 300.0))


@pytest.mark.parametrize("name", ["CS63", "CS612", "CS616", "CS620", "CS625"])
def test_every_other_arm_does_it_too(name):
    for request, conveyor in ((BELT[0], BELT[1]), (TURNING[0], TURNING[1])):
        cell = Cell(100.0, model=load_model(name))
        cell.track(request)
        cell.ask(cell.line_by(0.02, 0.0, -0.03))
        cell.run(250)
        x, y, z, *rotation = cell.start
        assert_same(cell.pose, cell.part(conveyor, 100.0, (x + 0.02, y, z - 0.03, *rotation)))
        cell.check_smooth()


def test_another_tcp_meanwhile_is_no_jump():
    for request, _ in CONVEYORS:
        cell = Cell(300.0)
        cell.track(request)
        cell.run(100)
        cell.controller.request(SetTcp((0.0, 0.1, 0.3, 0.0, 0.4, 0.0)))
        cell.run(100)
        cell.check_smooth()


def test_a_move_through_a_singularity_beside_its_nominal_way_is_given_up():
    cell = Cell(300.0)
    cell.track(BELT[0])
    cell.run(150)
    number = cell.ask(MoveJ((*HOME[:4], -HOME[4], HOME[5]), 2.0, 1.0))
    cell.run_to_rest()
    assert cell.controller.is_move_done(number)
    (alarm,) = cell.alarms
    assert "through a singularity, and on the conveyor beside it: joint shoulder would jump by " in alarm.text
    cell.check_smooth()


def test_the_end_ends_the_move_of_another_thread_too():
    cell = Cell(200.0)
    cell.track(BELT[0])
    move = cell.ask(cell.line_by(0.0, 0.0, -0.2, v=0.05), "other")
    cell.run(150)
    number = cell.ask(StopTracking())
    cell.run(100)
    assert cell.controller.is_move_done(move)
    assert cell.controller.is_move_done(number)
    assert not cell.controller.is_moving
    cell.check_smooth()


def test_a_pause_while_it_ends_does_not_hold_the_end():
    cell = Cell(300.0)
    cell.track(BELT[0])
    cell.run(150)
    number = cell.ask(StopTracking())
    cell.run(2)
    cell.controller.request(PauseTask())
    cell.run(100)
    assert cell.controller.is_move_done(number)
    assert not cell.controller.is_moving
    cell.controller.request(ResumeTask())
    cell.run(20)
    assert not cell.controller.is_moving
    cell.check_smooth()


def test_both_ends_are_in_the_record():
    cell = Cell(300.0)
    cell.run(3)
    cell.track(BELT[0])
    cell.run(150)
    cell.ask(StopTracking())
    cell.run(100)
    started, ended, rested = cell.events[-3:]
    assert started == TrackingStarted(3, BELT[0], 7, "main")
    assert ended == TrackingEnded(153)
    assert isinstance(rested, MotionEnded)
    assert 153 < rested.tick < 180


def test_the_end_that_two_threads_ask_for_is_one():
    cell = Cell(300.0)
    cell.track(BELT[0])
    cell.run(150)
    assert cell.ask(StopTracking()) == cell.ask(StopTracking(), "other")


def test_nothing_to_end_is_no_wait():
    cell = Cell()
    assert cell.controller.is_move_done(cell.ask(StopTracking()))


@pytest.mark.parametrize("seed", range(12))
def test_whatever_happens_at_whatever_tick_nothing_jumps(seed):
    generator = Random(seed)
    cell = Cell(generator.uniform(-300.0, 300.0))
    request, _ = generator.choice(CONVEYORS)
    cell.track(request)
    is_paused = False
    for _ in range(14):
        cell.run(generator.randrange(1, 60))
        what = generator.randrange(5)
        if what == 0:
            cell.turn(generator.uniform(-300.0, 300.0))
        elif what == 1:
            cell.controller.request(ResumeTask() if is_paused else PauseTask())
            is_paused = not is_paused
        elif what == 2:
            cell.controller.request(SetSpeedScale(generator.random()))
        elif what == 3 and not is_paused:
            try:
                cell.ask(cell.line_by(*(generator.uniform(-0.05, 0.05) for _ in range(3))))
            except MotionError as error:
                assert error.code == "R114"
        else:
            cell.controller.joint_torques()
    cell.controller.task_ended()
    cell.run_to_rest(400)
    cell.check_smooth()


PROGRAM = """
def job():
  set_tcp([0, 0, 0.1, 0, 0, 0])
  sleep(0.3)
  home = get_target_tcp_pose()
  down = home.copy()
  down[2] = down[2] - 0.08
  for n in range(2):
    track_conveyor_linear([0, 1, 0, 0, 0, 0], 1000)
    movel(down, v=0.3)
    sleep(0.1)
    movel(home, v=0.3)
    stop_conveyor_tracking()
    movel(home)
  end
end
"""


def outcome(pace):
    robot = VirtualRobot("CS66")
    for time_s, speed in ((0.0, 50.0), (0.9, 80.0), (1.2, -40.0), (3.0, 0.0)):
        robot.at(time_s, "encoder_speed[0]", speed)
    robot.controller.put(200, PauseTask())
    robot.controller.put(240, ResumeTask())
    run = robot.run(PROGRAM, trace=True, trace_step_s=0.012, pace=pace)
    return run.state, run.time_s, run.events, run.trace, run.joints


def test_leaping_cannot_be_told_from_stepping():
    leaped, stepped = outcome(None), outcome(lambda tick: None)
    assert leaped == stepped
    assert leaped[0] == "finished"
