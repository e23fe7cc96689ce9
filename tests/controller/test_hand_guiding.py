"""Hand guiding on the whole machine: how far a push goes, locked axes, ends, inputs, and that time may leap."""

from random import Random

import pytest

from elitescript.controller.force.hand_guiding import FRICTION_N_S_M, MASS_KG
from elitescript.errors import MotionError, ScriptStateError
from elitescript.kinematics.rotations import rotate, rotation_from_rpy, transpose
from elitescript.messages.enums import RobotMode
from elitescript.messages.events import YieldingChanged
from elitescript.messages.machine import (
    PauseTask,
    PowerDown,
    ResetInputActions,
    ResumeTask,
    SetInputAction,
    SetTcp,
    WriteSignal,
)
from elitescript.messages.motion import MoveJ, MoveL, SpeedJ, StopJ
from elitescript.messages.timing import PERIOD_S
from elitescript.messages.yielding import EndFreedrive, ForceMode, Freedrive
from tests.controller.test_force_control import (
    BASE,
    HEIGHT,
    LIMITS,
    MODEL,
    Machine,
    only,
    require_smooth,
    table,
)

ALL = (True,) * 6


def guided(free=ALL, frame=BASE, **more):
    machine = Machine(**more)
    machine.ask(Freedrive(free, frame))
    return machine


def test_a_push_moves_the_arm_as_far_as_its_impulse_says():
    machine = guided()
    before = machine.pose
    machine.push(fx=20.0)
    machine.run(250)
    machine.push()
    machine.run(600)
    # Whatever the mass, friction eats the whole impulse: force * time / friction.
    assert machine.pose[0] - before[0] == pytest.approx(20.0 * 1.0 / FRICTION_N_S_M, abs=1e-4)
    assert machine.pose[1:3] == pytest.approx(before[1:3], abs=1e-9)
    require_smooth(machine.rows)


def test_it_begins_like_a_mass():
    machine = guided()
    machine.push(fy=20.0)
    machine.run(2)
    assert machine.twist[1] == pytest.approx(2 * PERIOD_S * 20.0 / MASS_KG, rel=0.05)


def test_the_call_returns_at_once_and_a_torque_turns_about_the_tcp():
    machine = Machine()
    machine.controller.request(SetTcp((0.0, 0.0, 0.1, 0.0, 0.0, 0.0)))
    before = machine.pose
    assert machine.controller.is_move_done(machine.ask(Freedrive(ALL)))
    machine.push(mx=2.0)
    machine.run(250)
    assert machine.twist[3] == pytest.approx(0.4, rel=1e-3)
    assert machine.pose[:3] == pytest.approx(before[:3], abs=1e-9)


@pytest.mark.parametrize("frame", [BASE, (0.4, 0.1, 0.2, 0.3, -0.2, 1.0)])
def test_locked_axes_hold(frame):
    machine = guided(only(0, 5), frame)
    before = machine.pose
    machine.push(fx=20.0, fy=-15.0, fz=30.0, mx=1.0, my=1.0, mz=1.0)
    machine.run(200)
    R = rotation_from_rpy(*frame[3:])
    moved = rotate(transpose(R), [b - a for a, b in zip(before[:3], machine.pose[:3], strict=True)])
    spin = rotate(transpose(R), machine.twist[3:])
    assert abs(moved[0]) > 0.02
    assert moved[1:] == pytest.approx((0.0, 0.0), abs=1e-9)
    assert abs(spin[2]) > 0.1
    assert spin[:2] == pytest.approx((0.0, 0.0), abs=1e-5)


def test_the_tool_frame_goes_with_the_tool():
    machine = guided(only(2), None)
    machine.push(fx=30.0, fz=10.0)
    machine.run(100)
    assert machine.twist[2] > 0.05
    assert machine.twist[:2] == pytest.approx((0.0, 0.0), abs=1e-6)


def test_while_nobody_pushes_time_leaps_and_a_later_push_is_felt_at_once():
    machine = guided()
    machine.run(2)
    assert machine.controller.next_tick() is None
    assert not machine.controller.is_moving
    machine.controller.put(100, WriteSignal("external_wrench", 0, 20.0))
    assert machine.controller.next_tick() == 100
    machine.run(103, leap=True)
    assert machine.twist[0] > 0.0


def test_after_a_push_the_arm_comes_to_rest_for_good():
    machine = guided()
    machine.push(fx=20.0)
    machine.run(100)
    machine.push()
    machine.until_rest()
    place = machine.pose
    machine.run(1000, leap=True)
    assert machine.pose == place


def test_letting_go_in_the_moment_of_standstill_does_not_move_the_arm():
    machine = guided(only(0))
    machine.push(fx=20.0)
    machine.run(100)
    machine.push(fy=20.0)
    machine.run(1000)
    assert machine.twist == BASE
    place = machine.pose
    machine.push()
    machine.run(5)
    assert machine.pose == place


@pytest.mark.parametrize("move", [MoveJ(MODEL.home, 1.0, 1.0), MoveL((0.4,) * 6, 1.0, 1.0), SpeedJ((0.1,) * 6, 1.0)])
def test_moves_are_refused_until_it_has_ended(move):
    machine = guided()
    with pytest.raises(MotionError, match="guided by hand") as caught:
        machine.ask(move)
    assert caught.value.code == "R114"
    assert "end_freedrive_mode" in caught.value.hint


def test_a_move_after_the_end_begins_where_the_hand_left_the_arm():
    machine = guided()
    machine.push(fx=20.0)
    machine.run(100)
    call = machine.ask(EndFreedrive())
    assert not machine.controller.is_move_done(call)
    machine.until_rest()
    assert machine.controller.is_move_done(call)
    machine.push()
    machine.ask(MoveJ(MODEL.home, 1.0, 1.0))
    machine.until_rest()
    assert machine.controller.joints().q_target == MODEL.home
    require_smooth(machine.rows)


def test_a_stop_command_ends_it():
    machine = guided()
    machine.push(fx=20.0)
    machine.run(100)
    call = machine.ask(StopJ(8.0))
    machine.until_rest()
    assert machine.controller.is_move_done(call)
    machine.ask(MoveJ(MODEL.home, 1.0, 1.0))


def test_its_end_without_it_has_no_effect():
    machine = Machine()
    assert machine.controller.is_move_done(machine.ask(EndFreedrive()))


def test_it_does_not_begin_while_the_arm_moves_or_presses():
    machine = Machine()
    machine.ask(SpeedJ((0.1,) * 6, 1.0))
    machine.run(10)
    with pytest.raises(MotionError, match="while the arm moves"):
        machine.ask(Freedrive(ALL))
    machine = Machine()
    machine.ask(ForceMode(BASE, only(2), BASE, 0, (0.1,) * 6))
    with pytest.raises(MotionError, match="in force mode"):
        machine.ask(Freedrive(ALL))


@pytest.mark.parametrize("is_moving", [True, False])
def test_the_end_of_the_program_ends_it(is_moving):
    machine = guided()
    if is_moving:
        machine.push(fx=20.0)
        machine.run(100)
    machine.controller.task_ended()
    machine.until_rest()
    place = machine.pose
    machine.push(fx=50.0)
    machine.run(50)
    assert machine.pose == place
    require_smooth(machine.rows)


def test_a_pause_holds_the_arm():
    machine = guided()
    machine.run(3)
    machine.controller.request(PauseTask())
    place = machine.pose
    machine.push(fx=50.0)
    machine.run(50)
    assert machine.pose == place
    machine.controller.request(ResumeTask())
    machine.run(50)
    assert machine.pose[0] > place[0] + 0.01
    require_smooth(machine.rows)


def test_a_table_stops_the_hand():
    machine = guided(contact=table(0.02, stiffness=1e5))
    machine.push(fz=-40.0)
    machine.run(500)
    assert machine.pose[2] == pytest.approx(HEIGHT - 0.02 - 40.0 / 1e5, abs=1e-6)
    require_smooth(machine.rows)


def test_the_end_of_a_joint_range_is_a_wall():
    home = (LIMITS.q_max[0] - 0.1, *MODEL.home[1:])
    machine = guided(only(0, 1), home=home)
    x, y = machine.pose[:2]
    machine.push(fx=-40.0 * y / 0.51, fy=40.0 * x / 0.51)
    machine.run(700)
    assert LIMITS.q_max[0] - 0.02 < machine.controller.joints().q_target[0] <= LIMITS.q_max[0]
    assert max(map(abs, machine.controller.joints().qd_target)) < 0.1
    assert len(machine.warnings) == 1
    require_smooth(machine.rows)
    machine.push(fx=40.0 * y / 0.51, fy=-40.0 * x / 0.51)
    machine.run(100)
    assert machine.controller.joints().q_target[0] < LIMITS.q_max[0] - 0.03


def test_power_down_waits_for_standstill():
    machine = guided()
    machine.controller.power_up()
    machine.push(fx=20.0)
    machine.run(100)
    machine.controller.task_ended()
    machine.controller.request(PowerDown())
    machine.run(200)
    assert machine.controller.robot_mode is RobotMode.POWER_OFF


class TestInput:
    BIND = SetInputAction("standard_digital_in", 4, is_freedrive=True)
    HIGH = WriteSignal("standard_digital_in", 4, True)
    LOW = WriteSignal("standard_digital_in", 4, False)

    def machine(self):
        machine = Machine()
        machine.controller.power_up()
        machine.controller.request(self.BIND)
        machine.push(fx=20.0)
        return machine

    def test_guides_while_it_is_high(self):
        machine = self.machine()
        place = machine.pose
        machine.run(10)
        assert machine.pose == place
        machine.controller.request(self.HIGH)
        machine.run(100)
        assert machine.pose[0] > place[0] + 0.02
        machine.controller.request(self.LOW)
        machine.until_rest()
        place = machine.pose
        machine.run(50)
        assert machine.pose == place
        require_smooth(machine.rows)

    def test_guides_when_it_is_bound_while_it_is_high_until_it_is_unbound(self):
        machine = self.machine()
        machine.controller.request(ResetInputActions())
        machine.controller.request(self.HIGH)
        machine.run(10)
        assert machine.twist == BASE
        machine.controller.request(self.BIND)
        machine.run(10)
        assert machine.twist[0] > 0.0
        machine.controller.request(ResetInputActions())
        machine.until_rest()

    def test_has_no_effect_while_the_arm_moves_and_says_so_once(self):
        machine = self.machine()
        machine.push()
        machine.ask(SpeedJ((0.1,) * 6, 1.0))
        machine.run(10)
        machine.controller.request(self.HIGH)
        machine.controller.request(WriteSignal("flag", 0, True))
        (warning,) = machine.warnings
        assert warning.text == "standard_digital_in[4] asks for hand guiding, but the arm moves already"

    def test_is_told_apart_from_the_program_by_its_line(self):
        machine = self.machine()
        machine.controller.request(self.HIGH)
        machine.run(10)
        machine.controller.request(self.LOW)
        told = [event for event in machine.events if isinstance(event, YieldingChanged)]
        assert [(event.tick, event.request, event.line) for event in told] == [
            (0, Freedrive(ALL), 0),
            (10, EndFreedrive(), 0),
        ]

    def test_does_not_end_what_the_program_began(self):
        machine = self.machine()
        machine.ask(Freedrive(ALL))
        machine.controller.request(self.HIGH)
        machine.controller.request(self.LOW)
        machine.run(50)
        assert machine.twist[0] > 0.0


@pytest.mark.parametrize("seed", range(8))
def test_leaping_is_stepping_whatever_the_hand_does(seed):
    def story(machine, leap):
        random = Random(seed)
        is_paused = False
        for _ in range(14):
            what = random.randrange(7)
            try:
                if what == 0:
                    frame = random.choice([None, BASE, (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)])
                    machine.ask(Freedrive(tuple(random.random() < 0.6 for _ in range(6)), frame))
                elif what == 1:
                    machine.ask(EndFreedrive())
                elif what == 2 and not is_paused:
                    machine.ask(MoveJ(tuple(q + random.uniform(-0.1, 0.1) for q in MODEL.home), 2.0, 1.0))
                elif what == 3:
                    machine.controller.request(ResumeTask() if is_paused else PauseTask())
                    is_paused = not is_paused
                elif what == 4:
                    machine.push()
                else:
                    machine.push(fx=random.uniform(-20, 20), fy=random.uniform(-20, 20), mz=random.uniform(-1, 1))
            except (MotionError, ScriptStateError):
                # Among them a stop by too much force: a move drives into the table.
                pass
            machine.run(random.randrange(1, 150), leap=leap)

    stepped, leapt = Machine(table(0.02, 2e4)), Machine(table(0.02, 2e4))
    story(stepped, False)
    story(leapt, True)
    assert stepped.rows == leapt.rows
    assert stepped.events == leapt.events
    require_smooth(stepped.rows)
