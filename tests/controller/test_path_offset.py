"""Path offsets beside every kind of motion: where the arm is, how it gets there, and that nothing jumps."""

from itertools import pairwise
from math import cos, pi, sin

import pytest

from elitescript.controller.controller import Controller
from elitescript.controller.tasks import NoProgram
from elitescript.errors import MotionError
from elitescript.kinematics.transforms import compose, pose_from_transform, transform_from_pose
from elitescript.messages.enums import SafetyMode
from elitescript.messages.events import MotionEnded, Warned
from elitescript.messages.machine import PauseTask, ResumeTask, SetTcp, WriteSignal
from elitescript.messages.motion import MoveJ, MoveL, MoveP, SpeedL, StopTracking, TrackLinear
from elitescript.messages.path_offset import (
    EnablePathOffset,
    FilterPathOffset,
    LimitPathOffset,
    OffsetFrame,
    SetPathOffset,
)
from elitescript.messages.timing import PERIOD_S
from elitescript.messages.yielding import EndForceMode, EndFreedrive, ForceMode, Freedrive
from elitescript.models.model import load_model

MODEL = load_model("CS66")
TCP = (0.02, -0.01, 0.15, 0.1, -0.2, 0.3)
EXACT = 1e-9
FRAMES = list(OffsetFrame)


class Blamed(NoProgram):
    """A program that keeps the alarms that end it."""

    def __init__(self):
        self.alarms = []

    def fail(self, alarm):
        self.alarms.append(alarm)


class Cell:
    """A controller without scripts, run by hand; keeps every target."""

    def __init__(self, tcp=TCP):
        self.events = []
        self.controller = Controller(MODEL, epoch_s=0.0, on_event=self.events.append)
        self.controller.attach(Blamed())
        self.controller.task_started("job")
        self.controller.request(SetTcp(tcp))
        self.rows = []
        self.look()
        self.home = self.pose

    def ask(self, request):
        return self.controller.request_motion(request, 7, "main")

    def shift(self, request):
        self.controller.request_path_offset(request, 9, "main")

    def enable(self, *requests):
        self.shift(EnablePathOffset())
        for request in requests:
            self.shift(request)

    def set(self, *offset, frame=OffsetFrame.BASE):
        self.shift(SetPathOffset((*offset, *(0.0,) * (6 - len(offset))), frame))

    def look(self):
        joints = self.controller.joints()
        self.rows.append((joints.q_target, joints.qd_target))

    def run(self, ticks=1):
        for _ in range(ticks):
            self.controller.leap(self.controller.tick + 1)
            self.controller.run_tick()
            self.look()

    def run_to_end(self, ticks=3000):
        """Until the nominal motion is over."""
        ended = sum(isinstance(event, MotionEnded) for event in self.events)
        for _ in range(ticks):
            self.run()
            if sum(isinstance(event, MotionEnded) for event in self.events) > ended:
                return
        raise AssertionError("the motion does not end")

    @property
    def pose(self):
        return self.controller.state().tcp_pose_target

    @property
    def path_pose(self):
        return self.controller.tcp_pose_along_path()

    def offset(self, frame=OffsetFrame.BASE):
        return self.controller.path_offset_along(frame)

    def beside(self, dx, dy, dz):
        x, y, z, rx, ry, rz = self.home
        return (x + dx, y + dy, z + dz, rx, ry, rz)

    @property
    def is_stopped(self):
        return self.controller.safety.mode is not SafetyMode.NORMAL

    @property
    def alarms(self):
        return self.controller.task.program.alarms

    @property
    def warnings(self):
        return [event.text for event in self.events if isinstance(event, Warned)]

    def check_smooth(self):
        for (q, qd), (q_next, qd_next) in pairwise(self.rows):
            for joint, (x, w, x_next, w_next) in enumerate(zip(q, qd, q_next, qd_next, strict=True)):
                limit = MODEL.joints[joint]
                assert abs(w_next - w) <= limit.qdd_max * PERIOD_S * (1 + 1e-9)
                assert abs(w_next) <= limit.qd_max * (1 + 1e-9)
                assert abs(x_next - x - 0.5 * (w + w_next) * PERIOD_S) <= 0.5 * limit.qdd_max * PERIOD_S**2


def assert_same(pose, other, tolerance=EXACT):
    for a, b in zip(transform_from_pose(pose), transform_from_pose(other), strict=True):
        assert abs(a - b) < tolerance


def shifted(pose, offset, R=None):
    """A pose beside another one: translation in the base frame, rotation about axes of the base."""
    T = transform_from_pose(pose)
    turn = transform_from_pose((0.0, 0.0, 0.0, *offset[3:]))
    turned = compose(turn, (*T[:9], 0.0, 0.0, 0.0))
    return pose_from_transform((*turned[:9], *[a + b for a, b in zip(T[9:], offset[:3], strict=True)]))


class TestWhereTheArmIs:
    def test_beside_a_standing_pose_in_the_base_frame(self):
        cell = Cell()
        cell.enable()
        cell.set(0.01, -0.02, 0.03, 0.1, -0.05, 0.2)
        cell.run(200)
        assert_same(cell.pose, shifted(cell.home, (0.01, -0.02, 0.03, 0.1, -0.05, 0.2)))
        assert cell.offset() == pytest.approx((0.01, -0.02, 0.03, 0.1, -0.05, 0.2))
        assert_same(cell.path_pose, cell.home)
        cell.check_smooth()

    def test_beside_a_standing_pose_in_the_frame_of_the_tcp(self):
        cell = Cell()
        cell.enable()
        cell.set(0.01, -0.02, 0.03, 0.1, -0.05, 0.2, frame=OffsetFrame.TCP)
        cell.run(200)
        offset = transform_from_pose((0.01, -0.02, 0.03, 0.1, -0.05, 0.2))
        assert_same(cell.pose, pose_from_transform(compose(transform_from_pose(cell.home), offset)))
        assert cell.offset(OffsetFrame.TCP) == pytest.approx((0.01, -0.02, 0.03, 0.1, -0.05, 0.2))

    def test_across_a_path_in_the_frame_of_motion(self):
        cell = Cell(tcp=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0))
        cell.enable()
        cell.set(0.0, 0.01, 0.005, frame=OffsetFrame.MOTION)
        cell.ask(MoveL(cell.beside(0.0, 0.15, 0.0), 1.2, 0.1))
        cell.run(200)
        # Along y of the base with the tool down: y of the frame is against x of the base, z is up.
        assert cell.offset() == pytest.approx((-0.01, 0.0, 0.005, 0.0, 0.0, 0.0), abs=1e-6)
        cell.run_to_end()
        assert_same(cell.pose, shifted(cell.beside(0.0, 0.15, 0.0), (-0.01, 0.0, 0.005, 0, 0, 0)), 1e-6)
        cell.ask(MoveL(cell.home, 1.2, 0.1))
        cell.run(200)
        assert cell.offset() == pytest.approx((0.01, 0.0, 0.005, 0.0, 0.0, 0.0), abs=1e-6)
        cell.check_smooth()

    @pytest.mark.parametrize("frame", FRAMES)
    def test_exactly_where_a_smooth_offset_says_while_it_moves(self, frame):
        cell = Cell()
        cell.enable()
        cell.ask(MoveL(cell.beside(0.05, 0.15, -0.05), 1.2, 0.1))
        for k in range(1, 400):
            cell.set(0.0, 0.004 * sin(0.03 * k), 0.002 * (1 - cos(0.03 * k)), frame=frame)
            cell.run()
            if k > 20:
                asked = (0.0, 0.004 * sin(0.03 * k), 0.002 * (1 - cos(0.03 * k)), 0.0, 0.0, 0.0)
                assert cell.offset(frame) == pytest.approx(asked, abs=EXACT)
        assert cell.warnings == []
        cell.check_smooth()

    @pytest.mark.parametrize("tick", [1, 5, 40])
    def test_the_filter_goes_a_share_of_the_way_in_each_period(self, tick):
        cell = Cell()
        cell.enable(FilterPathOffset(0.1))
        cell.set(0.0, 0.0, 0.0005)
        cell.run(tick)
        assert cell.offset()[2] == pytest.approx(0.0005 * (1 - 0.9**tick), abs=EXACT)

    @pytest.mark.parametrize(
        "moves",
        [
            [MoveJ((0.3, -1.4, -1.5, -1.6, 1.5, 0.2), 1.4, 1.05)],
            [MoveL((0.45, -0.3, 0.35, 3.1, 0.1, -1.5), 1.2, 0.25)],
            [MoveP((0.45, -0.3, 0.35, 3.1, 0.1, -1.5), 1.2, 0.1)],
        ],
        ids=["movej", "movel", "movep"],
    )
    def test_a_move_ends_at_its_target_plus_the_offset(self, moves):
        cell = Cell()
        plain = Cell()
        cell.enable()
        cell.set(0.0, 0.0, 0.01, 0.0, 0.0, 0.1)
        for move in moves:
            plain.ask(move)
            plain.run_to_end()
            cell.ask(move)
            cell.run_to_end()
        assert_same(cell.path_pose, plain.pose)
        assert_same(cell.pose, shifted(plain.pose, (0.0, 0.0, 0.01, 0.0, 0.0, 0.1)))
        cell.check_smooth()

    def test_nothing_is_left_when_the_offset_is_taken_back(self):
        cell = Cell()
        plain = Cell()
        cell.enable(FilterPathOffset(0.2))
        cell.set(0.0, 0.01, 0.01, frame=OffsetFrame.MOTION)
        cell.run(150)
        cell.set(0.0)
        cell.run(300)
        assert cell.offset() == (0.0,) * 6
        assert not cell.controller.is_moving
        assert cell.controller.next_tick() is None
        for each in (cell, plain):
            each.ask(MoveJ((0.3, -1.4, -1.5, -1.6, 1.5, 0.2), 1.4, 1.05))
            each.run_to_end()
        assert cell.rows[-1] == plain.rows[-1]

    def test_another_frame_takes_over_without_a_jump(self):
        cell = Cell()
        cell.enable(FilterPathOffset(0.1))
        cell.set(0.0, 0.0, 0.01)
        cell.run(200)
        tool = cell.offset(OffsetFrame.TCP)
        cell.shift(SetPathOffset(tool, OffsetFrame.TCP))
        for _ in range(50):
            cell.run()
            assert cell.offset() == pytest.approx((0.0, 0.0, 0.01, 0.0, 0.0, 0.0), abs=1e-8)
        cell.check_smooth()

    def test_another_tcp_leaves_the_arm_where_it_is(self):
        cell = Cell()
        cell.enable()
        cell.set(0.0, 0.0, 0.01)
        cell.run(200)
        q = cell.rows[-1][0]
        cell.controller.request(SetTcp((0.0, 0.05, 0.2, 0.0, 0.3, 0.0)))
        cell.run(100)
        assert cell.rows[-1][0] == pytest.approx(q, abs=EXACT)
        cell.check_smooth()


class TestLimits:
    def test_a_step_is_made_as_quickly_as_half_of_the_joints_allows_and_said(self):
        cell = Cell()
        cell.enable()
        cell.set(0.0, 0.0, 0.05)
        cell.run(100)
        assert cell.offset()[2] == pytest.approx(0.05, abs=EXACT)
        assert [text for text in cell.warnings if "faster than the arm can follow" in text] == cell.warnings
        assert len(cell.warnings) == 1
        highest = max(q[2] for q in [cell.controller.tcp_pose(q) for q, _ in cell.rows])
        assert highest <= cell.home[2] + 0.05 + 1e-6
        cell.check_smooth()

    def test_elements_above_the_limit_count_as_the_limit(self):
        cell = Cell()
        cell.enable(LimitPathOffset(0.02, 0.1))
        for _ in range(3):
            cell.set(0.0, 0.03, -0.01, 0.0, 0.5, 0.0)
            cell.run(100)
        assert cell.offset() == pytest.approx((0.0, 0.02, -0.01, 0.0, 0.1, 0.0), abs=1e-8)
        limited = [text for text in cell.warnings if "limited" in text]
        assert limited == ["the path offset is limited: y = 0.03 m is above 0.02 m (path_offset_set_max_offset)"]

    def test_first_limits(self):
        cell = Cell()
        cell.enable()
        cell.set(0.0, 0.0, -0.2, 1.0, 0.0, 0.0)
        cell.run(400)
        assert cell.offset() == pytest.approx((0.0, 0.0, -0.1, 0.52, 0.0, 0.0), abs=1e-8)

    def test_a_lower_limit_counts_for_the_present_offset(self):
        cell = Cell()
        cell.enable()
        cell.set(0.0, 0.0, 0.05)
        cell.run(200)
        cell.shift(LimitPathOffset(0.01, 0.1))
        cell.run(200)
        assert cell.offset()[2] == pytest.approx(0.01, abs=EXACT)

    def test_the_end_of_reach_is_a_protective_stop(self):
        cell = Cell(tcp=(0.0,) * 6)
        cell.ask(MoveJ((0.0, -0.5, -0.55, -1.5, 1.5708, 0.0), 3.0, 2.0))
        cell.run_to_end()
        cell.home = cell.pose
        cell.enable(LimitPathOffset(1.0, 1.0))
        for k in range(600):
            cell.set(-0.0005 * k)
            cell.run()
            if cell.is_stopped:
                break
        cell.run(2)
        assert [alarm.code for alarm in cell.alarms] == ["R140"]
        assert "the path offset leads into the elbow singularity" in str(cell.alarms[0])
        cell.run(500)
        assert cell.rows[-1][1] == (0.0,) * 6
        cell.check_smooth()

    def test_the_end_of_a_joint_range_is_a_protective_stop(self):
        cell = Cell(tcp=(0.0,) * 6)
        cell.ask(MoveJ((0.0, -1.5708, -1.5708, -1.5708, 1.5708, 6.27), 3.0, 3.0))
        cell.run_to_end()
        cell.enable()
        for k in range(300):
            cell.set(0.0, 0.0, 0.0, 0.0, 0.0, 0.001 * k, frame=OffsetFrame.TCP)
            cell.run()
            if cell.is_stopped:
                break
        cell.run(2)
        assert [alarm.code for alarm in cell.alarms] == ["R140"]
        assert "joint wrist3" in str(cell.alarms[0])
        cell.run(300)
        assert max(q[5] for q, _ in cell.rows) <= MODEL.joints[5].q_max
        cell.check_smooth()


class TestBeginAndEnd:
    def test_without_being_enabled_nothing_happens_but_a_warning(self):
        cell = Cell()
        cell.set(0.0, 0.0, 0.01)
        cell.set(0.0, 0.0, 0.02)
        cell.enable()
        cell.run(50)
        assert_same(cell.pose, cell.home)
        assert cell.warnings == ["path_offset_set has no effect: call path_offset_enable first"]

    def test_a_pause_brings_to_rest_and_goes_on(self):
        cell = Cell()
        cell.enable()
        cell.ask(MoveL(cell.beside(0.0, 0.1, 0.0), 1.2, 0.1))
        for k in range(50):
            cell.set(0.0, 0.0, 0.0004 * k)
            cell.run()
        cell.controller.request(PauseTask())
        cell.run(100)
        assert cell.rows[-1][1] == (0.0,) * 6
        held = cell.offset()
        cell.run(50)
        assert cell.offset() == held
        cell.controller.request(ResumeTask())
        cell.run_to_end()
        assert cell.offset()[2] == pytest.approx(0.0004 * 49, abs=EXACT)
        cell.check_smooth()

    def test_the_end_of_a_program_leaves_the_arm_where_it_rests(self):
        cell = Cell()
        cell.enable()
        cell.ask(MoveL(cell.beside(0.0, 0.1, 0.0), 1.2, 0.1))
        cell.set(0.0, 0.0, 0.01)
        cell.run(100)
        cell.controller.task_ended()
        cell.run(100)
        assert not cell.controller.is_moving
        assert cell.pose[2] == pytest.approx(cell.home[2] + 0.01, abs=1e-6)
        rest = cell.pose
        cell.run(20)
        assert_same(cell.pose, rest)
        assert_same(cell.path_pose, rest)
        cell.check_smooth()

    def test_the_next_program_begins_without_an_offset(self):
        cell = Cell()
        cell.enable(LimitPathOffset(0.01, 0.01), FilterPathOffset(0.01))
        cell.set(0.0, 0.0, 0.01)
        cell.ask(MoveL(cell.beside(0.0, 0.1, 0.0), 1.2, 0.1))
        cell.run(100)
        cell.controller.task_ended()
        cell.run(2)
        cell.controller.task_started("next")
        cell.run(200)
        rest = cell.pose
        assert not cell.controller.is_moving
        cell.enable()
        cell.run(20)
        assert_same(cell.pose, rest)
        cell.set(0.0, 0.0, 0.05)
        cell.run(200)
        assert cell.offset()[2] == pytest.approx(0.05, abs=EXACT)
        cell.check_smooth()

    def test_a_finished_program_arrives_beside_its_waypoint(self):
        cell = Cell()
        cell.enable()
        cell.set(0.0, 0.0, 0.01)
        cell.run(100)
        cell.ask(MoveL(cell.beside(0.0, 0.1, 0.0), 1.2, 0.1, r=0.02))
        move = cell.controller.motion.source.number
        while not cell.controller.is_move_done(move):
            cell.run()
        cell.controller.task_ended("finished")
        cell.run(300)
        assert not cell.controller.is_moving
        assert_same(cell.pose, cell.beside(0.0, 0.1, 0.01))
        cell.check_smooth()


class TestOthersBeside:
    def test_on_a_conveyor(self):
        cell = Cell()
        cell.enable()
        cell.controller.request(WriteSignal("encoder_speed", 0, 200.0))
        cell.set(0.0, 0.0, 0.01)
        cell.run(20)
        assert cell.ask(TrackLinear((0.0, 1.0, 0.0), 2000.0, 0)) == 0
        start = cell.controller.tick
        cell.run(300)
        way = (cell.controller.tick - start) * PERIOD_S * 0.1
        assert_same(cell.pose, cell.beside(0.0, way, 0.01))
        cell.ask(StopTracking())
        cell.run(200)
        assert cell.offset()[2] == pytest.approx(0.01, abs=EXACT)
        cell.check_smooth()

    def test_an_obstacle_on_a_conveyor_stops_both(self):
        cell = Cell(tcp=(0.0,) * 6)
        cell.enable()
        cell.controller.request(WriteSignal("encoder_speed", 0, 400.0))
        cell.ask(TrackLinear((1.0, 0.0, 0.0), 2000.0, 0))
        cell.set(0.02)
        cell.run(1500)
        assert [alarm.code for alarm in cell.alarms] == ["R140"]
        assert cell.rows[-1][1] == (0.0,) * 6
        cell.check_smooth()

    def test_beside_a_motion_at_a_speed(self):
        cell = Cell()
        cell.enable()
        cell.set(0.0, 0.0, 0.01)
        cell.ask(SpeedL((0.0, 0.05, 0.0, 0.0, 0.0, 0.0), 1.2, 1.2))
        cell.run(200)
        assert cell.pose[2] == pytest.approx(cell.home[2] + 0.01, abs=1e-6)
        cell.check_smooth()

    def test_in_force_mode(self):
        cell = Cell()
        cell.enable()
        cell.set(0.0, 0.01, 0.0)
        cell.ask(ForceMode((0.0,) * 6, (False, False, True, False, False, False), (0.0,) * 6, 0, (0.1,) * 6))
        cell.run(200)
        assert cell.pose[1] == pytest.approx(cell.home[1] + 0.01, abs=1e-7)
        cell.ask(EndForceMode())
        cell.run(100)
        cell.set(0.0)
        cell.run(200)
        assert cell.pose[1] == pytest.approx(cell.home[1], abs=1e-7)
        cell.check_smooth()

    def test_not_while_the_arm_is_guided_by_hand(self):
        cell = Cell()
        cell.enable()
        cell.ask(Freedrive((True,) * 6))
        with pytest.raises(MotionError, match="guided by hand") as caught:
            cell.set(0.0, 0.0, 0.01)
        assert caught.value.code == "R114"
        cell.ask(EndFreedrive())
        cell.run(100)
        cell.set(0.0, 0.0, 0.01)
        with pytest.raises(MotionError, match="while the arm moves"):
            cell.ask(Freedrive((True,) * 6))


def test_turning_offsets_about_the_tcp_keep_it_in_place():
    cell = Cell()
    cell.enable()
    cell.ask(MoveL(cell.beside(0.0, 0.1, 0.0), 1.2, 0.05))
    for k in range(300):
        cell.set(0.0, 0.0, 0.0, 0.1 * sin(2 * pi * k / 150), 0.05, 0.2 * sin(2 * pi * k / 300), frame=OffsetFrame.TCP)
        cell.run()
        assert cell.pose[:3] == pytest.approx(cell.path_pose[:3], abs=EXACT)
    cell.check_smooth()
