"""Force control on the whole machine: equilibrium, axes, frames, ends, pauses, and that nothing jumps."""

from itertools import pairwise
from math import hypot
from random import Random

import pytest

from elitescript.controller.controller import Controller
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.motion.control import motion_limits
from elitescript.errors import MotionError
from elitescript.messages.events import Warned, YieldingChanged
from elitescript.messages.machine import (
    PauseTask,
    ResumeTask,
    SetForceDamping,
    SetForceGain,
    SetPayload,
    SetTcp,
    WriteSignal,
    ZeroForceSensor,
)
from elitescript.messages.motion import MoveL, SpeedL, StopL, StopTracking, TrackLinear
from elitescript.messages.timing import PERIOD_S
from elitescript.messages.yielding import EndForceMode, ForceMode, Freedrive
from elitescript.models.model import load_model
from tests.invariants.cases import first_of

MODEL = load_model("CS66")
LIMITS = motion_limits(MODEL)
BASE = (0.0,) * 6
HEIGHT = 0.4975
"""Of the TCP at home, m; it looks straight down."""


def only(*axes):
    return tuple(axis in axes for axis in range(6))


def wrench(**parts):
    return tuple(parts.get(name, 0.0) for name in ("fx", "fy", "fz", "mx", "my", "mz"))


Z = only(2)


def press(force=20.0, *, selection=Z, frame=BASE, mode=0, v=0.05, turn=0.5):
    return ForceMode(frame, selection, wrench(fz=-force), mode, (v,) * 3 + (turn,) * 3)


def table(depth=0.01, stiffness=1e4, **more):
    return ContactConfig((Plane((0.0, 0.0, HEIGHT - depth), (0.0, 0.0, 1.0), stiffness, **more),))


class Machine:
    """A controller without scripts, run by hand tick by tick or by leaps; keeps the joints of every tick."""

    def __init__(self, contact=None, model=MODEL, home=None):
        self.events = []
        self.controller = Controller(model, epoch_s=0.0, on_event=self.events.append, contact=contact, home=home)
        self.rows = []
        self.controller.task_started("test")

    def ask(self, request):
        return self.controller.request_motion(request, 3, "main")

    def push(self, **parts):
        for index, value in enumerate(wrench(**parts)):
            self.controller.request(WriteSignal("external_wrench", index, value))

    def run(self, ticks, *, leap=False):
        controller = self.controller
        end = controller.tick + ticks
        while controller.tick < end:
            controller.run_tick()
            due = controller.next_tick()
            step = end if due is None else min(due, end)
            step = step if leap else controller.tick + 1
            self.rows += [controller.joints_at(tick) for tick in range(controller.tick, step)]
            controller.leap(step)
        controller.run_tick()

    def until_rest(self, ticks=3000):
        for count in range(ticks):
            if not self.controller.is_moving:
                return count
            self.run(1)
        raise AssertionError("the arm still moves")

    @property
    def pose(self):
        return self.controller.state().tcp_pose_target

    @property
    def twist(self):
        return self.controller.state().tcp_speed_target

    @property
    def force(self):
        return self.controller.tcp_wrench(True)

    @property
    def warnings(self):
        return [event for event in self.events if isinstance(event, Warned)]


def require_smooth(rows, limits=LIMITS):
    """Limits are kept, and positions are the integrals of the speeds, but for a braking that ends within a tick."""
    for before, after in pairwise(rows):
        for q0, w0, q1, w1, top, a_top in zip(
            before.q_target,
            before.qd_target,
            after.q_target,
            after.qd_target,
            limits.qd_max,
            limits.qdd_max,
            strict=True,
        ):
            assert abs(w1) <= top * (1 + 1e-9)
            assert abs(w1 - w0) <= a_top * PERIOD_S * (1 + 1e-6)
            assert q1 - q0 == pytest.approx(0.5 * PERIOD_S * (w0 + w1), abs=5e-5)


@pytest.mark.parametrize(("stiffness", "seconds"), [(1e3, 8.0), (1e4, 3.0), (1e5, 2.0)])
def test_the_force_meets_its_target_on_any_surface(stiffness, seconds):
    machine = Machine(table(stiffness=stiffness))
    machine.ask(press(20.0))
    machine.run(round(seconds / PERIOD_S))
    # The TCP looks down: a force upwards is along its negative z axis.
    assert machine.force == pytest.approx((0.0, 0.0, -20.0, 0.0, 0.0, 0.0), abs=0.2)
    assert machine.pose[2] == pytest.approx(HEIGHT - 0.01 - 20.0 / stiffness, abs=0.2 / stiffness)
    require_smooth(machine.rows)


@pytest.mark.parametrize("stiffness", [1e3, 1e4, 1e5])
def test_it_overshoots_little_at_the_first_gain(stiffness):
    machine = Machine(table(stiffness=stiffness))
    machine.ask(press(20.0, v=0.02))
    forces = []
    for _ in range(600):
        machine.run(1)
        forces.append(-machine.force[2])
    assert max(forces) < 1.1 * 20.0


def test_a_gain_above_one_shakes_on_a_hard_surface():
    machine = Machine(table(stiffness=1e5))
    machine.controller.request(SetForceGain(1.5))
    machine.ask(press(20.0))
    machine.run(600)
    forces = []
    for _ in range(100):
        machine.run(1)
        forces.append(-machine.force[2])
    assert max(forces) - min(forces) > 5.0


def test_gain_and_damping_count_from_the_next_force_mode_on():
    machine = Machine()
    machine.ask(press(20.0, v=1.0))
    machine.run(100)
    assert machine.twist[2] == pytest.approx(-0.02)
    machine.controller.request(SetForceGain(0.4))
    machine.ask(press(20.0, v=1.0))
    machine.run(100)
    assert machine.twist[2] == pytest.approx(-0.02)
    machine.ask(EndForceMode())
    machine.until_rest()
    machine.ask(press(20.0, v=1.0))
    machine.run(100)
    assert machine.twist[2] == pytest.approx(-0.04)


def test_speed_in_free_space_is_limited():
    machine = Machine()
    machine.ask(press(500.0, v=0.03))
    machine.run(200)
    assert machine.twist == pytest.approx((0.0, 0.0, -0.03, 0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize(("damping", "is_still"), [(0.0, False), (1.0, True)])
def test_damping_is_what_stops_an_axis_that_nothing_touches(damping, is_still):
    machine = Machine()
    machine.controller.request(SetForceDamping(damping))
    machine.ask(press(0.0, selection=only(0)))
    machine.push(fx=20.0)
    machine.run(100)
    assert machine.twist[0] == pytest.approx(0.02)
    machine.push()
    machine.run(50)
    assert machine.twist[0] == pytest.approx(0.0 if is_still else 0.02, abs=1e-9)


def test_axes_that_are_not_selected_do_not_move():
    machine = Machine()
    before = machine.pose
    machine.ask(press(0.0, selection=only(1)))
    machine.push(fx=30.0, fy=20.0, fz=-40.0, mx=1.0, my=2.0, mz=3.0)
    machine.run(300)
    x, y, z = machine.pose[:3]
    assert y > before[1] + 0.01
    assert (x, z) == pytest.approx((before[0], before[2]), abs=1e-12)
    assert machine.controller.state().tcp_speed_target[3:] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_a_torque_turns_about_the_tcp():
    machine = Machine()
    before = machine.pose
    machine.ask(ForceMode(BASE, only(5), BASE, 0, (0.1,) * 3 + (0.2,) * 3))
    machine.push(mz=1.0)
    machine.run(100)
    assert machine.twist == pytest.approx((0.0, 0.0, 0.0, 0.0, 0.0, 0.1), abs=1e-9)
    assert machine.pose[:3] == pytest.approx(before[:3], abs=1e-9)


def test_a_move_goes_on_along_the_other_axes_while_the_arm_presses():
    machine = Machine(table(friction=0.3))
    x, y, z, *turn = machine.pose
    machine.ask(press(20.0))
    machine.run(800)
    number = machine.ask(MoveL((x + 0.1, y, z, *turn), 1.0, 0.1))
    forces = []
    while not machine.controller.is_move_done(number):
        machine.run(1)
        forces.append(-machine.force[2])
    assert machine.pose[:2] == pytest.approx((x + 0.1, y), abs=1e-9)
    assert min(forces) > 19.8
    assert max(forces) < 20.2
    machine.ask(EndForceMode())
    machine.until_rest()
    machine.ask(MoveL((x, y, z, *turn), 1.0, 0.1))
    machine.until_rest()
    assert machine.pose[:3] == pytest.approx((x, y, z), abs=1e-9)
    require_smooth(machine.rows)


def test_a_leaning_frame_presses_along_its_own_axis():
    machine = Machine()
    frame = (0.0, 0.0, 0.0, 0.0, 0.0, 0.5)
    before = machine.pose
    machine.ask(ForceMode(frame, only(0), wrench(fx=20.0), 0, (0.05,) * 3 + (0.5,) * 3))
    machine.run(100)
    dx, dy = machine.pose[0] - before[0], machine.pose[1] - before[1]
    assert dy / dx == pytest.approx(0.5463, abs=1e-4)


def test_mode_1_goes_to_and_from_the_point():
    machine = Machine()
    x, y, z, *_ = machine.pose
    machine.ask(ForceMode((x + 0.3, y + 0.4, z, 0.0, 0.0, 0.0), only(1), wrench(fy=20.0), 1, (0.05,) * 3 + (0.5,) * 3))
    machine.run(500)
    dx, dy = machine.pose[0] - x, machine.pose[1] - y
    assert dx > 0.01
    assert dy / dx == pytest.approx(4.0 / 3.0, abs=1e-6)


def test_mode_2_has_its_x_axis_along_the_travel():
    machine = Machine()
    x, y, z, *turn = machine.pose
    machine.ask(MoveL((x - 0.06, y + 0.08, z, *turn), 1.0, 0.02))
    machine.run(50)
    # Its y axis is horizontal and across the travel, to the left.
    machine.ask(ForceMode(BASE, only(1), wrench(fy=5.0), 2, (0.05,) * 3 + (0.5,) * 3))
    before = machine.pose
    machine.run(200)
    dx, dy = machine.pose[0] - before[0], machine.pose[1] - before[1]
    across = (-0.8 * dx, -0.6 * dy)
    assert sum(across) == pytest.approx(200 * PERIOD_S * 0.005, rel=0.02)
    along = -0.6 * dx + 0.8 * dy
    assert along == pytest.approx(200 * PERIOD_S * 0.02, rel=1e-3)


def test_mode_3_is_the_frame_of_the_tool():
    machine = Machine()
    machine.ask(ForceMode(BASE, only(2), wrench(fz=20.0), 3, (0.05,) * 3 + (0.5,) * 3))
    machine.run(100)
    assert machine.twist[2] == pytest.approx(-0.02)


def test_the_end_brakes_without_a_jump_and_the_arm_stays():
    machine = Machine()
    machine.ask(press(500.0, v=0.1))
    machine.run(100)
    call = machine.ask(EndForceMode())
    assert not machine.controller.is_move_done(call)
    ticks = machine.until_rest()
    assert ticks > 1
    assert machine.controller.is_move_done(call)
    place = machine.pose
    assert machine.controller.next_tick() is None
    machine.run(100, leap=True)
    assert machine.pose == place
    require_smooth(machine.rows)


def test_the_end_of_force_mode_without_force_mode_has_no_effect():
    machine = Machine()
    assert machine.controller.is_move_done(machine.ask(EndForceMode()))
    assert not machine.controller.is_moving


def test_beginning_change_and_end_are_told():
    machine = Machine()
    requests = [press(20.0), press(30.0), EndForceMode()]
    for request in [*requests, EndForceMode()]:
        machine.ask(request)
    told = [event for event in machine.events if isinstance(event, YieldingChanged)]
    assert [event.request for event in told] == requests
    assert {(event.line, event.thread) for event in told} == {(3, "main")}


def test_force_mode_may_end_while_a_move_goes_on():
    machine = Machine()
    x, y, z, *turn = machine.pose
    number = machine.ask(MoveL((x + 0.1, y, z - 0.1, *turn), 1.0, 0.1))
    machine.run(50)
    machine.ask(press(0.0, selection=only(2)))
    machine.run(100)
    call = machine.ask(EndForceMode())
    while not machine.controller.is_move_done(call):
        machine.run(1)
    assert not machine.controller.is_move_done(number)
    machine.until_rest()
    assert machine.pose[0] == pytest.approx(x + 0.1, abs=1e-6)
    require_smooth(machine.rows)
    assert machine.warnings == []


def test_the_end_of_the_program_ends_it():
    machine = Machine(table())
    machine.ask(press(20.0))
    machine.run(400)
    machine.controller.task_ended()
    machine.until_rest()
    place = machine.pose
    machine.push(fz=100.0)
    machine.run(50)
    assert machine.pose == place
    require_smooth(machine.rows)


def test_a_pause_holds_the_arm_and_the_force_comes_back():
    machine = Machine(table())
    machine.ask(press(20.0))
    machine.run(80)
    machine.controller.request(PauseTask())
    machine.run(60)
    place = machine.pose
    machine.run(60)
    assert machine.pose == place
    machine.controller.request(ResumeTask())
    machine.run(800)
    assert machine.force[2] == pytest.approx(-20.0, abs=0.2)
    require_smooth(machine.rows)


def test_calling_it_again_changes_the_target():
    machine = Machine(table())
    machine.ask(press(20.0))
    machine.run(600)
    machine.ask(press(35.0))
    machine.run(600)
    assert machine.force[2] == pytest.approx(-35.0, abs=0.35)


def test_it_is_no_use_while_the_arm_is_guided_by_hand():
    machine = Machine()
    machine.ask(Freedrive(only(0)))
    with pytest.raises(MotionError, match="guided by hand") as caught:
        machine.ask(press())
    assert caught.value.code == "R114"


def test_force_mode_counts_from_the_zero_of_the_sensor():
    machine = Machine()
    machine.push(fz=-15.0)
    machine.controller.request(ZeroForceSensor())
    machine.ask(press(0.0))
    machine.run(100)
    assert machine.twist == BASE


def test_the_end_of_a_joint_range_stops_the_arm_and_says_so_once():
    home = (*MODEL.home[:5], LIMITS.q_max[5] - 0.2)
    machine = Machine(home=home)
    machine.ask(ForceMode(BASE, only(5), BASE, 0, (0.1,) * 3 + (0.5,) * 3))
    # The tool looks down, so joint 6 turns against the base's z axis.
    machine.push(mz=-5.0)
    machine.run(1000)
    assert LIMITS.q_max[5] - 0.02 < machine.controller.joints().q_target[5] <= LIMITS.q_max[5]
    (warning,) = machine.warnings
    assert "force_mode takes joint wrist3" in warning.text
    assert (warning.line, warning.thread) == (3, "main")
    require_smooth(machine.rows)
    machine.push(mz=5.0)
    machine.run(200)
    assert machine.controller.joints().q_target[5] < LIMITS.q_max[5] - 0.1


def test_a_singularity_stops_the_arm():
    machine = Machine()
    machine.ask(ForceMode(BASE, only(2), wrench(fz=100.0), 0, (0.25,) * 3 + (0.5,) * 3))
    machine.run(1500)
    assert [event.text.split(",")[0] for event in machine.warnings] == ["force_mode leads into the elbow singularity"]
    assert max(map(abs, machine.controller.joints().qd_target)) < 0.01
    require_smooth(machine.rows)


@pytest.mark.parametrize("is_force_first", [True, False])
def test_the_arm_presses_on_a_part_that_a_belt_carries(is_force_first):
    machine = Machine(table(friction=0.1))
    y = machine.pose[1]
    machine.controller.request(WriteSignal("encoder_speed", 0, 2000.0))
    machine.ask(TrackLinear((0.0, 1.0, 0.0), 20000.0, 0))
    machine.run(200)
    machine.ask(press(20.0))
    machine.run(500)
    assert machine.force[2] == pytest.approx(-20.0, abs=0.2)
    assert machine.twist[1] == pytest.approx(0.1, abs=1e-6)
    assert machine.pose[1] == pytest.approx(y + 700 * PERIOD_S * 0.1, abs=1e-4)
    ends = [EndForceMode(), StopTracking()]
    for request in ends if is_force_first else reversed(ends):
        machine.ask(request)
        machine.run(30)
    machine.until_rest()
    machine.ask(MoveL((0.487, y, HEIGHT, *machine.pose[3:]), 1.0, 0.2))
    machine.until_rest()
    assert machine.pose[:3] == pytest.approx((0.487, y, HEIGHT), abs=1e-6)
    require_smooth(machine.rows)


def test_an_arm_beside_a_belt_comes_to_rest_after_the_nominal_motion_without_a_jump():
    machine = Machine()
    machine.controller.request(WriteSignal("encoder_speed", 0, -150.0))
    machine.ask(TrackLinear((-0.72, 0.39, 0.0), 1000.0, 0))
    machine.ask(ForceMode(BASE, Z, wrench(fz=30.0), 0, (0.2,) * 6))
    machine.run(250)
    machine.ask(EndForceMode())
    machine.run(400)
    machine.until_rest()
    require_smooth(machine.rows)


def test_a_belt_is_not_taken_up_while_the_arm_presses():
    machine = Machine()
    machine.ask(press(20.0))
    with pytest.raises(MotionError, match="in force mode") as caught:
        machine.ask(TrackLinear((0.0, 1.0, 0.0), 20000.0, 0))
    assert caught.value.code == "R114"


@pytest.mark.parametrize("seed", first_of(range(12), 5))
def test_nothing_jumps_and_leaping_is_stepping_whatever_happens(seed):
    def story(machine, leap):
        random = Random(seed)
        x, y, z, *turn = machine.pose
        is_paused = False
        for _ in range(14):
            what = random.randrange(8)
            try:
                if what in (0, 1):
                    selection = tuple(random.random() < 0.5 for _ in range(6))
                    target = tuple(random.uniform(-30, 30) for _ in range(3)) + tuple(
                        random.uniform(-1, 1) for _ in range(3)
                    )
                    mode = random.randrange(4)
                    frame = tuple(random.uniform(-0.5, 0.5) for _ in range(6))
                    machine.ask(ForceMode(frame, selection, target, mode, (0.1,) * 3 + (0.5,) * 3))
                elif what == 2:
                    machine.ask(EndForceMode())
                elif what == 3 and not is_paused:
                    dx, dy = random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)
                    machine.ask(MoveL((x + dx, y + dy, z, *turn), 1.0, 0.1))
                elif what == 4 and not is_paused:
                    machine.ask(SpeedL((0.02, 0.03, 0.0, 0.0, 0.0, 0.1), 0.5, 0.5, 0.1))
                elif what == 5:
                    machine.ask(StopL(2.0))
                elif what == 6:
                    machine.controller.request(ResumeTask() if is_paused else PauseTask())
                    is_paused = not is_paused
                else:
                    machine.push(fx=random.uniform(-20, 20), fz=random.uniform(-20, 20), mz=random.uniform(-1, 1))
            except MotionError:
                pass
            machine.run(random.randrange(1, 120), leap=leap)
        if random.random() < 0.5:
            machine.controller.task_ended()
            machine.run(200, leap=leap)

    stepped, leapt = Machine(table(0.02, 2e4)), Machine(table(0.02, 2e4))
    story(stepped, False)
    story(leapt, True)
    assert stepped.rows == leapt.rows
    assert stepped.events == leapt.events
    require_smooth(stepped.rows)


class TestSensor:
    def test_nothing_touches_a_free_arm(self):
        machine = Machine(table())
        assert machine.force == BASE
        assert machine.controller.tcp_wrench(False) == BASE

    def test_planes_are_watched_while_the_arm_moves_and_let_time_leap_while_it_rests(self):
        machine = Machine(table())
        machine.controller.run_tick()
        assert machine.controller.next_tick() is None
        machine.ask(MoveL((0.487, -0.1475, HEIGHT - 0.012, *machine.pose[3:]), 1.0, 0.05))
        machine.controller.run_tick()
        assert machine.controller.next_tick() == machine.controller.tick + 1
        machine.run(500, leap=True)
        assert machine.force[2] == pytest.approx(-1e4 * 0.002)

    def test_what_pushes_is_read_in_the_frame_of_the_tool(self):
        machine = Machine()
        machine.push(fx=1.0, fy=2.0, fz=3.0, mz=4.0)
        # At home the tool's x axis is the base's -y, its y axis the base's -x, its z axis points down.
        assert machine.force == pytest.approx((-2.0, -1.0, -3.0, 0.0, 0.0, -4.0))

    def test_the_weight_of_the_payload_is_in_the_raw_wrench_alone(self):
        machine = Machine()
        machine.controller.request(SetPayload(2.0, (0.03, 0.0, 0.05)))
        machine.push(fz=5.0)
        fx, fy, fz, mx, my, mz = machine.controller.tcp_wrench(False)
        weight = 2.0 * 9.82
        assert (fx, fy, fz) == pytest.approx((0.0, 0.0, weight - 5.0), abs=1e-9)
        assert (mx, my, mz) == pytest.approx((0.0, -0.03 * weight, 0.0), abs=1e-9)
        assert machine.force == pytest.approx((0.0, 0.0, -5.0, 0.0, 0.0, 0.0))

    def test_moments_are_about_the_tcp(self):
        machine = Machine()
        machine.controller.request(SetTcp((0.1, 0.0, 0.2, 0.0, 0.0, 0.0)))
        machine.controller.request(SetPayload(1.0, (0.0, 0.0, 0.0)))
        assert machine.controller.tcp_wrench(False) == pytest.approx((0.0, 0.0, 9.82, 0.0, 0.982, 0.0))

    def test_inertia_of_the_payload_is_in_the_raw_wrench(self):
        machine = Machine()
        machine.controller.request(SetPayload(2.0, (0.0, 0.0, 0.0), (0.1, 0.1, 0.1, 0.0, 0.0, 0.0)))
        machine.ask(SpeedL((0.0, 0.0, 1.0, 0.0, 0.0, 0.0), 3.0, 1.0, 0.2))
        machine.run(10)
        assert machine.controller.tcp_wrench(False)[2] == pytest.approx(2.0 * (9.82 + 3.0), rel=1e-3)
        assert machine.force == BASE

    def test_taring_replaces_the_zero(self):
        machine = Machine()
        for push in (7.0, 9.0):
            machine.push(fx=push)
            machine.controller.request(ZeroForceSensor())
            assert machine.force == BASE
        machine.push(fx=10.0)
        assert hypot(*machine.force[:3]) == pytest.approx(1.0)
        assert hypot(*machine.controller.tcp_wrench(False)[:3]) == pytest.approx(10.0)

    def test_the_zero_outlasts_the_program(self):
        machine = Machine()
        machine.push(fx=7.0)
        machine.controller.request(ZeroForceSensor())
        machine.controller.task_ended()
        machine.run(10)
        machine.controller.task_started("next")
        assert machine.force == BASE
