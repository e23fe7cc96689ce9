"""Motions at a speed and streams under stops, pauses, speed changes and other motions, at random ticks."""

from itertools import pairwise
from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.controller.controller import Controller
from elitescript.errors import MotionError, ScriptStateError
from elitescript.messages.enums import SafetyMode
from elitescript.messages.events import Alarm, MotionEnded, MotionStarted, SafetyModeChanged
from elitescript.messages.machine import AskSafety, PauseTask, ResumeTask, SetSpeedScale
from elitescript.messages.motion import MoveJ, MoveL, ServoJ, SpeedJ, SpeedL, StopJ, StopL
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from tests.invariants.cases import first_of

MODEL = load_model("CS66")
HOME = MODEL.home
QD = (0.4, -0.2, 0.1, 0.0, 0.3, -0.4)
XD = (0.0, 0.08, -0.02, 0.0, 0.0, 0.1)
ZEROS = (0.0,) * 6
FAR = tuple(q + 0.3 for q in HOME)

DRIVES = [SpeedJ(QD, 2.0), SpeedL(XD, 0.5, 0.5), ServoJ(FAR, 0.4, 0.1, 300.0)]
drives = pytest.mark.parametrize("drive", DRIVES, ids=["speedj", "speedl", "servoj"])


class Machine:
    """A controller without scripts, run by hand tick by tick or by leaps."""

    def __init__(self):
        self.events = []
        self.controller = Controller(MODEL, epoch_s=0.0, on_event=self.events.append)

    def ask(self, request, thread="main"):
        return self.controller.request_motion(request, 3, thread)

    def run(self, ticks, *, leap=False):
        end = self.controller.tick + ticks
        while self.controller.tick < end:
            self.controller.run_tick()
            due = self.controller.next_tick()
            step = end if due is None else min(due, end)
            self.controller.leap(step if leap else self.controller.tick + 1)
        self.controller.run_tick()

    def unlock(self):
        self.run(1250, leap=True)
        self.controller.request(AskSafety("unlock_protective_stop"))
        self.run(1)

    @property
    def q(self):
        return self.controller.joints().q_target

    @property
    def qd(self):
        return self.controller.joints().qd_target

    @property
    def twist(self):
        return self.controller.state().tcp_speed_target

    def ticks_until_rest(self, ticks=2000):
        for tick in range(ticks):
            if not self.controller.is_moving:
                return tick
            self.run(1)
        raise AssertionError("the arm still moves")

    def kinds(self):
        return [type(event) for event in self.events]


@pytest.fixture
def machine():
    return Machine()


def test_speedj_returns_when_its_speeds_are_reached_and_the_arm_goes_on(machine):
    number = machine.ask(SpeedJ(QD, 2.0))
    machine.run(49)
    assert not machine.controller.is_move_done(number)
    machine.run(1)
    assert machine.controller.is_move_done(number)
    assert machine.qd == QD
    machine.run(200)
    assert machine.controller.is_moving
    assert machine.qd == QD
    assert MotionEnded not in machine.kinds()


def test_speedl_returns_when_its_velocity_is_reached_and_the_arm_goes_on(machine):
    number = machine.ask(SpeedL(XD, 0.5, 0.5))
    machine.run(49)
    assert not machine.controller.is_move_done(number)
    machine.run(1)
    assert machine.controller.is_move_done(number)
    machine.run(200)
    assert machine.twist == pytest.approx(XD, abs=1e-5)


@pytest.mark.parametrize("t_s", [0.001, 0.02, 1.0])
@drives
def test_a_call_with_a_time_takes_that_time(machine, drive, t_s):
    request = type(drive)(**{**{n: getattr(drive, n) for n in drive.__slots__}, "t_s": t_s})
    number = machine.ask(request)
    ticks = max(1, -int(-t_s / PERIOD_S // 1))
    machine.run(ticks - 1)
    assert not machine.controller.is_move_done(number)
    machine.run(1)
    assert machine.controller.is_move_done(number)


@pytest.mark.parametrize("request_", [SpeedJ(QD, 2.0), SpeedL(XD, 0.5, 0.5)])
def test_the_speed_percentage_lowers_the_speed_at_once_and_later(machine, request_):
    machine.controller.request(SetSpeedScale(0.5))
    number = machine.ask(request_)
    machine.run(100)
    assert machine.controller.is_move_done(number)
    seen, wanted = (machine.qd, QD) if isinstance(request_, SpeedJ) else (machine.twist, XD)
    assert seen == pytest.approx([0.5 * value for value in wanted], abs=1e-5)
    machine.controller.request(SetSpeedScale(1.0))
    machine.run(100)
    seen = machine.qd if isinstance(request_, SpeedJ) else machine.twist
    assert seen == pytest.approx(wanted, abs=1e-5)


def test_speeds_of_zero_bring_the_arm_to_rest_for_good(machine):
    machine.ask(SpeedJ(QD, 2.0))
    machine.run(100)
    machine.ask(SpeedJ(ZEROS, 2.0))
    assert machine.ticks_until_rest() == 50
    machine.ask(SpeedL(XD, 0.5, 0.5))
    machine.run(100)
    machine.ask(SpeedL(ZEROS, 0.5, 0.5, 1.0))
    assert machine.ticks_until_rest() == 250


@pytest.mark.parametrize("ticks", [3, 60, 300])
@drives
def test_a_stop_comes_to_rest_within_the_time_of_its_deceleration(drive, ticks):
    for stop in (StopJ(2.0), StopL(0.4)):
        machine = Machine()
        machine.ask(drive)
        machine.run(ticks)
        if not machine.controller.is_moving:
            continue
        vx, vy, vz, wx, wy, wz = machine.twist
        joint_s = max(map(abs, machine.qd)) / 2.0
        tool_s = max((vx**2 + vy**2 + vz**2) ** 0.5, (wx**2 + wy**2 + wz**2) ** 0.5) / 0.4
        expected = (joint_s if isinstance(stop, StopJ) else tool_s) / PERIOD_S
        number = machine.ask(stop)
        assert not machine.controller.is_move_done(number)
        assert machine.ticks_until_rest() == pytest.approx(expected, abs=2.001)
        assert machine.controller.is_move_done(number)
        assert machine.qd == ZEROS


def test_stopl_brakes_a_velocity_on_its_line(machine):
    machine.ask(SpeedL((0.0, 0.1, 0.0, 0.0, 0.0, 0.0), 0.5, 0.5))
    machine.run(100)
    x, y, z, *_ = machine.controller.state().tcp_pose_target
    machine.ask(StopL(0.5))
    machine.ticks_until_rest()
    x_end, y_end, z_end, *_ = machine.controller.state().tcp_pose_target
    assert (x_end, z_end) == pytest.approx((x, z), abs=1e-6)
    assert y_end - y == pytest.approx(0.1**2 / (2 * 0.5), abs=1e-5)


@drives
def test_a_planned_move_is_refused_while_the_arm_is_driven(machine, drive):
    machine.ask(drive)
    machine.run(30)
    with pytest.raises(MotionError, match=r"goes on after its call") as caught:
        machine.ask(MoveJ(HOME, 1.0, 1.0))
    assert caught.value.code == "R114"
    assert "stopj or stopl" in caught.value.hint
    machine.ask(StopJ(8.0))
    machine.ticks_until_rest()
    machine.ask(MoveJ(HOME, 1.0, 1.0))
    machine.run(1000)
    assert machine.q == HOME


@drives
def test_a_drive_takes_over_from_a_move_and_ends_it(machine, drive):
    move = machine.ask(MoveJ(FAR, 1.0, 1.0), "other")
    machine.run(60)
    machine.ask(drive)
    assert machine.controller.is_move_done(move)
    assert [event.is_complete for event in machine.events if isinstance(event, MotionEnded)] == [False]
    assert isinstance(machine.events[-1], MotionStarted)


@drives
def test_a_pause_stands_still_and_holds_the_time_of_the_call(machine, drive):
    request = type(drive)(**{**{n: getattr(drive, n) for n in drive.__slots__}, "t_s": 0.4})
    machine.controller.task_started("test")
    number = machine.ask(request)
    machine.run(50)
    machine.controller.request(PauseTask())
    machine.run(200)
    q = machine.q
    assert machine.controller.next_tick() is None
    machine.run(200)
    assert machine.q == q
    machine.controller.request(ResumeTask())
    machine.run(49)
    assert not machine.controller.is_move_done(number)
    machine.run(1)
    assert machine.controller.is_move_done(number)
    machine.run(300)
    assert machine.q != q


@drives
def test_the_end_of_the_task_and_a_cancelled_call_brake_the_arm(drive):
    for is_cancelled in (False, True):
        machine = Machine()
        machine.controller.task_started("test")
        number = machine.ask(drive)
        machine.run(40)
        fastest = max(map(abs, machine.qd))
        if is_cancelled:
            machine.controller.cancel_move(number)
        else:
            machine.controller.task_ended()
        expected = fastest / MODEL.stop_joint_deceleration / PERIOD_S
        assert machine.ticks_until_rest() == pytest.approx(expected, abs=1.001)


def test_a_joint_stops_at_the_end_of_its_range_with_the_reason_and_goes_no_further(machine):
    machine.ask(SpeedJ((1.5, 0.3, 0.0, 0.0, 0.0, 0.0), 3.0))
    machine.run(3000, leap=True)
    assert not machine.controller.is_moving
    q_max = MODEL.joints[0].q_max
    assert q_max - 0.01 < machine.q[0] <= q_max
    (stop,) = [event for event in machine.events if isinstance(event, SafetyModeChanged)]
    assert stop.mode is SafetyMode.PROTECTIVE_STOP
    assert "joint base" in stop.reason
    with pytest.raises(ScriptStateError, match="unlock it"):
        machine.ask(SpeedJ((-1.5, 0.0, 0.0, 0.0, 0.0, 0.0), 3.0))
    machine.unlock()
    for _ in range(5):
        try:
            machine.ask(SpeedJ((1.5, 0.0, 0.0, 0.0, 0.0, 0.0), 3.0, 0.1))
        except MotionError as error:
            assert error.code == "R110"
            break
        machine.run(500)
        assert machine.q[0] <= q_max + 1e-9
        machine.unlock()
    else:
        raise AssertionError("never refused")
    machine.ask(SpeedJ((-1.5, 0.0, 0.0, 0.0, 0.0, 0.0), 3.0))
    machine.run(100)
    assert machine.q[0] < q_max - 0.2


def test_a_target_of_servoj_outside_the_range_is_refused(machine):
    with pytest.raises(MotionError) as caught:
        machine.ask(ServoJ((7.0, *HOME[1:]), 0.004, 0.1, 300.0))
    assert caught.value.code == "R110"
    assert not machine.controller.is_moving


def test_a_stream_ends_at_its_last_target_when_nothing_more_comes(machine):
    for k in range(1, 51):
        machine.ask(ServoJ(tuple(q + 0.002 * k for q in HOME), 0.004, 0.1, 300.0))
        machine.run(1)
    machine.ticks_until_rest()
    assert machine.q == tuple(q + 0.002 * 50 for q in HOME)
    assert machine.kinds().count(MotionStarted) == 1


@pytest.mark.parametrize("seed", range(4))
def test_a_program_that_only_waits_ends_when_the_driven_arm_has_come_to_its_end(seed):
    call = ("speedj([1, 0, 0, 0, 0, 0], 2)", "speedl([0.1, 0, 0, 0, 0, 0], 1)", "speedj([0, 0, 0, 0, 0, 1], 2, 0.1)")
    program = f"def p():\n  import queue\n  box = queue.Queue()\n  {call[seed % 3]}\n  box.get()\nend\n"
    robot = VirtualRobot("CS66", speed=0.0 if seed == 3 else 1.0)
    run = robot.run(program, until_s=60.0)
    assert run.state == ("stuck" if seed == 3 else "alarm")
    assert (run.time_s > 2.0) == (seed != 3)
    assert run.alarms[0].code == ("R130" if seed == 3 else "R140")


def test_a_program_that_sleeps_while_the_arm_is_driven_is_not_stuck():
    run = VirtualRobot("CS66").run("def p():\n  speedj([0.1, 0, 0, 0, 0, 0], 2)\n  sleep(3)\nend\n")
    assert run.state == "finished"
    assert not [event for event in run.events if isinstance(event, Alarm)]
    assert run.joints[0] == pytest.approx(HOME[0] + 0.1 * 3.02, abs=0.003)


def test_a_thread_that_is_stopped_in_its_call_brakes_the_arm():
    program = (
        "def p():\n  def w():\n    while True:\n      speedj([0.5, 0, 0, 0, 0, 0], 2, 0.1)\n    end\n  end\n"
        "  h = start_thread(w, ())\n  sleep(0.53)\n  stop_thread(h)\n  sleep(0.5)\n"
        "  textmsg(get_target_joint_speeds())\n  movej([0, -1.57, -1.57, -1.57, 1.57, 0])\nend\n"
    )
    run = VirtualRobot("CS66").run(program)
    assert run.state == "finished"
    assert run.log == ["[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]"]


@drives
def test_a_change_between_two_advances_counts_from_the_tick_that_is_reached(drive):
    rests = []
    for step_s in (0.004, 0.1):
        robot = VirtualRobot("CS66")
        robot.controller.power_up()
        robot.controller.request_motion(drive, 1, "main")
        for fraction in (1.0, 0.3, 0.0, 0.8):
            robot.set_speed(fraction)
            for _ in range(round(0.2 / step_s)):
                robot.advance(step_s)
        robot.controller.request_motion(StopL(0.7), 1, "main")
        robot.advance(2.0)
        assert not robot.controller.is_moving
        rests.append(robot.state.q_target)
    assert rests[0] == rests[1]


def random_session(seed, *, leap):
    """Motions of all kinds with speed changes, pauses, stops at random ticks; every tick's joints, and the events."""
    chance = Random(seed)
    machine = Machine()
    controller = machine.controller
    controller.task_started("test")
    rows = [(machine.q, machine.qd)]
    actions = ("movej", "movel", "speedj", "speedl", "servoj", "speed", "pause", "resume", "stop", "cancel", "none")
    for _ in range(80):
        action = chance.choice(actions)
        t_s = chance.choice((None, chance.uniform(0.001, 0.5)))
        try:
            if action == "movej":
                machine.ask(MoveJ(tuple(q + chance.uniform(-0.5, 0.5) for q in HOME), chance.uniform(0.5, 9), 1.5))
            elif action == "movel":
                pose = list(controller.state().tcp_pose_target)
                pose[chance.randrange(3)] += chance.uniform(-0.06, 0.06)
                machine.ask(MoveL(tuple(pose), 1.2, chance.uniform(0.05, 0.5)))
            elif action == "speedj":
                machine.ask(SpeedJ(tuple(chance.uniform(-3, 3) for _ in range(6)), chance.uniform(0.5, 30), t_s))
            elif action == "speedl":
                xd = [chance.uniform(-0.4, 0.4) for _ in range(3)] + [chance.uniform(-1, 1) for _ in range(3)]
                machine.ask(SpeedL(tuple(xd), chance.uniform(0.2, 10), chance.uniform(0.2, 10), t_s))
            elif action == "servoj":
                target = tuple(q + chance.uniform(-0.5, 0.5) for q in machine.q)
                machine.ask(ServoJ(target, t_s or 0.004, chance.uniform(0.03, 0.2), chance.uniform(100, 2000)))
            elif action == "speed":
                controller.request(SetSpeedScale(chance.choice((0.0, 0.1, 0.7, 1.0, 1.0))))
            elif action == "pause":
                controller.request(PauseTask())
            elif action == "resume":
                controller.request(ResumeTask())
            elif action == "stop":
                machine.ask(chance.choice((StopJ(8.0), StopL(2.0), StopJ(0.7))))
            elif action == "cancel":
                controller.cancel_move(chance.randrange(1, 30))
        except (MotionError, ScriptStateError):
            pass
        ticks = chance.randrange(1, 90)
        if leap:
            machine.run(ticks, leap=True)
        else:
            for _ in range(ticks):
                machine.run(1)
                rows.append((machine.q, machine.qd))
    return rows, machine.events, machine.q


@pytest.mark.parametrize("seed", first_of(range(40), 15))
def test_position_and_speed_never_jump_and_limits_hold(seed):
    rows, _, _ = random_session(seed, leap=False)
    # A stop or pause may add its own deceleration to that of a planned move.
    change_max = (40.0 * 1.07 + 2 * MODEL.stop_joint_deceleration) * PERIOD_S
    for (q, qd), (q_after, qd_after) in pairwise(rows):
        for joint, limit in enumerate(MODEL.joints):
            assert limit.q_min - 1e-6 <= q_after[joint] <= limit.q_max + 1e-6
            assert abs(qd_after[joint]) <= limit.qd_max * 1.002
            assert abs(qd_after[joint] - qd[joint]) <= change_max
            mean = 0.5 * (qd[joint] + qd_after[joint])
            assert abs(q_after[joint] - q[joint] - mean * PERIOD_S) <= 0.5 * change_max * PERIOD_S


@pytest.mark.parametrize("seed", first_of(range(40), 15))
def test_a_session_leaps_as_it_steps(seed):
    _, stepped_events, stepped_q = random_session(seed, leap=False)
    _, leaped_events, leaped_q = random_session(seed, leap=True)
    assert stepped_events == leaped_events
    assert stepped_q == leaped_q
