"""How joint motions and motions under way are slowed down to the reduced limits."""

import pytest

from elitescript.controller.force.compliance_control import ComplianceControl
from elitescript.controller.motion.control import MotionControl, motion_limits
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits
from elitescript.controller.safety.monitor import SafetyMonitor
from elitescript.controller.safety.reduced_speed import MARGIN, ReducedSpeed
from elitescript.controller.signals.image import SignalImage
from elitescript.controller.tool_setup import Setup
from elitescript.kinematics.transforms import IDENTITY
from elitescript.messages.motion import MoveJ, SpeedJ, SpeedL
from elitescript.models.model import load_model

MODEL = load_model("CS66")
HOME = MODEL.home
TURN = (HOME[0] + 1.0, *HOME[1:])
RADIUS = (MODEL.arm.forward(HOME)[9] ** 2 + MODEL.arm.forward(HOME)[10] ** 2) ** 0.5


@pytest.fixture
def motion():
    limits = motion_limits(MODEL)
    return MotionControl(MODEL.arm, limits, HOME, 8.0, 0.2, lambda event: None, lambda number, is_complete: None)


@pytest.fixture
def speed(motion):
    limits = SafetyLimits(reduced=SafetyBounds(tcp_speed_max=0.2))
    setup = Setup(MODEL)
    signals = SignalImage(lambda name, index, value, before: None)
    yielding = ComplianceControl(
        MODEL, motion.limits, setup, signals, None, lambda event: None, lambda number, is_complete: None
    )
    return ReducedSpeed(SafetyMonitor(MODEL.arm, limits), motion, yielding, setup, 1.0)


def run(speed, motion, ticks):
    """Speeds of the base at the ticks, in m/s of the TCP."""
    speeds = []
    for tick in ticks:
        motion.settle(tick)
        speed.slow_down(tick)
        speeds.append(abs(motion.sample(tick).qd[0]) * RADIUS)
    return speeds


def test_a_move_runs_as_planned_up_to_the_limit_and_then_at_the_limit(speed, motion):
    motion.request(MoveJ(TURN, 4.0, 1.5), 0, IDENTITY, 1, "main")
    ticks = range(900)
    speeds = run(speed, motion, ticks)
    until = int(MARGIN * 0.2 / RADIUS / 4.0 / 0.004)
    assert speeds[:until] == pytest.approx([4.0 * 0.004 * tick * RADIUS for tick in range(until)])
    assert speeds[until + 2 : 400] == pytest.approx([MARGIN * 0.2] * (400 - until - 2), rel=1e-3)
    # It brakes as it would in normal mode, without any speed that creeps.
    assert motion.source is None
    assert min(value for value in speeds if value) == pytest.approx(0.0, abs=0.01)
    assert sum(0.0 < value < 0.98 * MARGIN * 0.2 for value in speeds) < 2.5 * until


def test_a_move_under_way_is_slowed_however_often_it_is_asked_for_and_gets_its_speed_back(speed, motion):
    motion.request(MoveJ(TURN, 4.0, 1.5), 0, IDENTITY, 1, "main")
    motion.settle(80)
    for tick in (80, 80):
        speed.slow_down(tick)
    speeds = run(speed, motion, range(81, 200))
    assert speeds[50:] == pytest.approx([MARGIN * 0.2] * len(speeds[50:]), rel=1e-3)
    speed.set_scale(0.5, 200)
    run(speed, motion, range(200, 220))
    speed.release(220)
    motion.settle(220)
    assert motion.speed_scale == 0.5
    assert abs(motion.sample(290).qd[0]) == pytest.approx(0.5 * 1.5)


def test_the_speed_percentage_counts_where_it_is_lower_than_the_limit(speed, motion):
    speed.set_scale(0.1, 0)
    motion.request(MoveJ(TURN, 4.0, 1.5), 0, IDENTITY, 1, "main")
    speeds = run(speed, motion, range(1200))
    assert max(speeds) == pytest.approx(0.15 * RADIUS)


@pytest.mark.parametrize("request_", [MoveJ(TURN, 4.0, 1.5), SpeedJ((1.5, 0.0, 0.0, 0.0, 0.0, 0.0), 4.0)])
def test_a_motion_that_stands_at_the_moment_is_slowed_for_later(speed, motion, request_):
    motion.request(request_, 0, IDENTITY, 1, "main")
    motion.settle(20)
    motion.pause(20)
    run(speed, motion, range(20, 100))
    motion.resume(100)
    assert max(run(speed, motion, range(100, 400))) == pytest.approx(MARGIN * 0.2, rel=0.01)


def test_a_tool_motion_is_slowed_to_the_limit(speed, motion):
    motion.request(SpeedL((0.0, 0.5, 0.0, 0.0, 0.0, 0.0), 2.0, 2.0), 0, IDENTITY, 1, "main")
    motion.settle(60)
    assert speed.slow_down(60)
    assert motion.speed_scale == pytest.approx(MARGIN * 0.2 / 0.5)


def test_nothing_is_slowed_at_standstill(speed, motion):
    assert not speed.slow_down(3)
    assert motion.speed_scale == 1.0
