"""How joint motions and motions under way are slowed down to the reduced limits."""

import pytest

from elitescript.controller.arm_state import ArmState
from elitescript.controller.model_limits import motion_limits
from elitescript.controller.motion_control import MotionControl
from elitescript.controller.reduced_speed import MARGIN, ReducedSpeed
from elitescript.controller.safety_limits import SafetyBounds, SafetyLimits
from elitescript.controller.safety_monitor import SafetyMonitor
from elitescript.controller.setup import Setup
from elitescript.kinematics.transforms import IDENTITY
from elitescript.messages.motion import MoveJ, MoveL, SpeedJ, SpeedL
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
    return ReducedSpeed(SafetyMonitor(MODEL.arm, limits), motion, ArmState(motion), Setup(MODEL), 1.0)


def test_a_turn_of_the_base_is_as_fast_as_the_radius_allows(speed):
    slower = speed.prepared(MoveJ(TURN, 2.0, 1.5), 0)
    assert slower.v == pytest.approx(MARGIN * 0.2 / RADIUS)
    assert slower.a == 2.0


def test_a_duration_is_lengthened_so_that_no_profile_is_too_fast(speed):
    slower = speed.prepared(MoveJ(TURN, 2.0, 1.5, 1.0), 0)
    assert slower.t_s == pytest.approx(2.0 * RADIUS / 0.2 / MARGIN)
    assert speed.prepared(MoveJ(TURN, 2.0, 1.5, 60.0), 0).t_s == 60.0


@pytest.mark.parametrize(
    "request_",
    [
        MoveJ(TURN, 2.0, 0.1),
        MoveJ(HOME, 2.0, 1.5),
        MoveJ((*HOME[:5], HOME[5] + 1.0), 2.0, 1.5),
        MoveL((0.4, 0.0, 0.3, 0.0, 0.0, 0.0), 1.0, 1.0),
        SpeedJ((1.0,) * 6, 2.0),
    ],
)
def test_what_is_slow_enough_or_limited_elsewhere_stays_as_it_is(speed, request_):
    assert speed.prepared(request_, 0) == request_


def test_a_motion_under_way_is_slowed_until_it_is_over(speed, motion):
    motion.request(MoveJ(TURN, 4.0, 1.5), 0, IDENTITY, 1, "main")
    motion.settle(50)
    speed.slow_down(50)
    peak = max(abs(motion.sample(tick).qd[0]) for tick in range(120, 200))
    assert peak * RADIUS <= 0.2
    assert peak * RADIUS == pytest.approx(MARGIN * 0.2, rel=0.05)
    speed.set_scale(0.5, 200)
    assert motion.speed_scale < 0.2
    speed.release(210)
    assert motion.speed_scale == 0.5


def test_a_motion_is_slowed_once_however_often_it_is_asked_for(speed, motion):
    motion.request(MoveJ(TURN, 4.0, 1.5), 0, IDENTITY, 1, "main")
    for tick in (50, 50, 51, 60):
        motion.settle(tick)
        speed.slow_down(tick)
    peak = max(abs(motion.sample(tick).qd[0]) for tick in range(120, 200))
    assert peak * RADIUS == pytest.approx(MARGIN * 0.2, rel=0.05)


@pytest.mark.parametrize("request_", [MoveJ(TURN, 4.0, 1.5), SpeedJ((1.5, 0.0, 0.0, 0.0, 0.0, 0.0), 4.0)])
def test_a_motion_that_is_slow_or_stands_at_the_moment_is_slowed_for_later(speed, motion, request_):
    motion.request(request_, 0, IDENTITY, 1, "main")
    motion.settle(20)
    motion.pause(20)
    speed.slow_down(100)
    motion.resume(100)
    peak = max(abs(motion.sample(tick).qd[0]) for tick in range(100, 600))
    assert peak * RADIUS == pytest.approx(MARGIN * 0.2, rel=0.05)


def test_a_tool_motion_is_slowed_to_the_limit(speed, motion):
    motion.request(SpeedL((0.0, 0.5, 0.0, 0.0, 0.0, 0.0), 2.0, 2.0), 0, IDENTITY, 1, "main")
    motion.settle(60)
    speed.slow_down(60)
    assert motion.speed_scale == pytest.approx(MARGIN * 0.2 / 0.5)


def test_nothing_is_slowed_at_standstill(speed, motion):
    speed.slow_down(3)
    assert motion.speed_scale == 1.0
