"""The law of lagging joints, against its closed forms."""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, exp
from random import Random

import pytest

from elitescript.controller.arm.plant import SETTLED_RAD, SETTLED_RAD_PER_S, LaggingJoints, friction_torques
from elitescript.messages.motion import Six
from elitescript.messages.plant import PlantConfig
from elitescript.messages.state import JointState
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.segment import Setpoint

QD_MAX = (2.0,) * 6
LAGS = (0.001, 0.01, 0.03, 0.2)


def six(value: float) -> Six:
    return (value,) * 6


def follow(
    config: PlantConfig, q: Callable[[float], float], qd: Callable[[float], float], ticks: int
) -> list[Setpoint]:
    """Actual joints of ticks 0 to `ticks`; all six do the same."""
    plant = LaggingJoints(config, QD_MAX)
    start = Setpoint(six(q(0.0)), six(0.0))
    target, found = start, [start]
    for tick in range(1, ticks + 1):
        now = JointState(*target, *found[-1])
        target = Setpoint(six(q(tick * PERIOD_S)), six(qd(tick * PERIOD_S)))
        actual = plant.peek(tick, target, now)
        assert plant.peek(tick, target, now) == actual
        plant.commit(tick, target, now)
        found.append(actual)
    return found


def ramp(speed: float) -> tuple[Callable[[float], float], Callable[[float], float]]:
    return lambda t: speed * t, lambda t: speed


@pytest.mark.parametrize("lag_s", LAGS)
@pytest.mark.parametrize("speed", [1.0, -0.3])
def test_a_ramp_is_followed_at_its_speed_times_the_lag(lag_s: float, speed: float) -> None:
    found = follow(PlantConfig(lag_s=lag_s), *ramp(speed), 1000)
    q, qd = found[-1]
    assert speed * 1000 * PERIOD_S - q[0] == pytest.approx(speed * lag_s, rel=1e-9, abs=1e-12)
    assert qd[3] == pytest.approx(speed)


@pytest.mark.parametrize("lag_s", LAGS)
def test_the_way_to_a_new_speed_is_the_closed_form(lag_s: float) -> None:
    # x'' = w^2 (t - x) - 2 w x' from rest: e = 2/w (1 - exp(-wt)) - t exp(-wt).
    w = 2.0 / lag_s
    for tick, (q, _) in enumerate(follow(PlantConfig(lag_s=lag_s), *ramp(1.0), 40)):
        t = tick * PERIOD_S
        assert t - q[0] == pytest.approx(2.0 / w * (1.0 - exp(-w * t)) - t * exp(-w * t), abs=1e-12)


@pytest.mark.parametrize("lag_s", LAGS)
def test_a_step_settles_without_overshoot_and_exactly(lag_s: float) -> None:
    ticks = int(15.0 * lag_s / PERIOD_S) + 3
    found = follow(PlantConfig(lag_s=lag_s), lambda t: 1.0 if t else 0.0, lambda t: 0.0, ticks)
    positions = [q[0] for q, _ in found]
    assert positions == sorted(positions)
    assert found[-1] == Setpoint(six(1.0), six(0.0))


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_it_is_settled_when_it_is_there_and_not_before(friction: float) -> None:
    plant = LaggingJoints(PlantConfig(lag_s=0.02, coulomb_friction=friction, viscous_friction=friction), QD_MAX)
    assert plant.is_settled
    target = actual = Setpoint(six(0.5), six(0.0))
    for tick in range(1, 200):
        now = JointState(*target, *actual)
        speed = 0.4 if tick < 50 else 0.0
        target = Setpoint(six(0.5 + 0.4 * min(tick, 50) * PERIOD_S), six(speed))
        actual = plant.peek(tick, target, now)
        plant.commit(tick, target, now)
        assert plant.is_settled == (actual == target and tick > 50)
    assert plant.is_settled


def test_friction_drags_a_lagging_joint_further_behind() -> None:
    lag_s, speed = 0.02, 0.5
    config = PlantConfig(lag_s=lag_s, coulomb_friction=0.1, viscous_friction=0.2, rated_acceleration=15.0)
    for direction in (1.0, -1.0):
        q, qd = follow(config, *ramp(direction * speed), 500)[-1]
        # At a constant speed the drive has to pull for both parts: (0.1 + 0.2 * 0.5 / 2) of 15 rad/s^2.
        behind = speed * lag_s + 0.15 * 15.0 * (lag_s / 2.0) ** 2
        assert direction * (direction * speed * 500 * PERIOD_S - q[0]) == pytest.approx(behind, rel=1e-9)
        assert qd[0] == pytest.approx(direction * speed)


def test_friction_holds_a_joint_until_the_drive_pulls_hard_enough() -> None:
    config = PlantConfig(lag_s=0.1, coulomb_friction=0.5)
    found = follow(config, *ramp(0.05), 200)
    positions = [q[0] for q, _ in found]
    stuck = sum(position == 0.0 for position in positions)
    # It pulls with w^2 e = 400 * 0.05 t and holds 10 rad/s^2.
    assert 0.45 < stuck * PERIOD_S < 0.55
    assert positions == sorted(positions)


def test_friction_never_moves_a_joint_by_itself() -> None:
    config = PlantConfig(lag_s=0.02, coulomb_friction=0.3, viscous_friction=0.3)
    for acceleration in (0.5, 5.0):
        found = follow(config, lambda t, a=acceleration: 0.5 * a * t * t, lambda t, a=acceleration: a * t, 60)
        assert all(qd[0] >= 0.0 for _, qd in found)


def test_friction_leaves_no_error_at_rest() -> None:
    config = PlantConfig(lag_s=0.02, coulomb_friction=0.3, viscous_friction=0.3)
    found = follow(config, lambda t: min(t, 0.2), lambda t: float(t < 0.2), 250)
    assert found[-1] == Setpoint(six(0.2), six(0.0))


def test_friction_torque_goes_with_the_motion() -> None:
    config = PlantConfig(coulomb_friction=0.1, viscous_friction=0.2)
    effort = (100.0,) * 6
    torques = friction_torques(config, (2.0, -2.0, 1.0, 0.0, -0.0, -0.5), QD_MAX, effort)
    assert torques == pytest.approx((30.0, -30.0, 20.0, 0.0, 0.0, -15.0))


def one_joint(
    config: PlantConfig, r_now: float, r_next: float, rd_next: float, x: float, xd: float
) -> tuple[float, float]:
    """One period of one joint, as the formulas of the module read."""
    omega = 2.0 / config.lag_s
    decay = exp(-omega * PERIOD_S)
    per_qd = PERIOD_S * decay
    per_q = (1.0 - (1.0 + omega * PERIOD_S) * decay) / (omega * omega)
    coulomb = config.coulomb_friction * config.rated_acceleration
    viscous = config.viscous_friction * config.rated_acceleration / QD_MAX[0]
    slope = (r_next - r_now) / PERIOD_S
    stands = slope == 0.0 and rd_next == 0.0
    start = r_now - x - 2.0 * slope / omega
    rate = slope - xd + omega * start
    left = start + rate * PERIOD_S
    x_next = r_next - 2.0 * slope / omega - left * decay
    xd_next = slope - (rate - omega * left) * decay
    if coulomb > 0.0 and not stands:
        stopping = xd_next / per_qd
        if abs(stopping) <= coulomb:
            return (x if xd == 0.0 else x_next - stopping * per_q), 0.0
        x_next -= copysign(coulomb, stopping) * per_q
        xd_next -= copysign(coulomb, stopping) * per_qd
    if viscous > 0.0:
        xd_next /= 1.0 + viscous * per_qd
        x_next -= viscous * xd_next * per_q
    if stands and abs(r_next - x_next) < SETTLED_RAD and abs(xd_next) < SETTLED_RAD_PER_S:
        return r_next, 0.0
    return x_next, xd_next


@pytest.mark.parametrize("coulomb", [0.0, 0.1])
@pytest.mark.parametrize("viscous", [0.0, 0.1])
def test_every_bit_of_six_joints_is_that_of_one_by_one(coulomb: float, viscous: float) -> None:
    chance = Random(7)
    for _ in range(500):
        config = PlantConfig(lag_s=chance.choice(LAGS), coulomb_friction=coulomb, viscous_friction=viscous)
        r_now = [chance.uniform(-2, 2) for _ in range(6)]
        r_next = [r + chance.choice((0.0, 0.0, chance.uniform(-0.01, 0.01))) for r in r_now]
        rd_next = [chance.choice((0.0, -0.0, chance.uniform(-2, 2))) for _ in range(6)]
        x = [r + chance.choice((0.0, 1e-9, chance.uniform(-0.1, 0.1))) for r in r_now]
        xd = [chance.choice((0.0, 1e-7, chance.uniform(-2, 2))) for _ in range(6)]
        now = JointState(tuple(r_now), six(0.0), tuple(x), tuple(xd))  # type: ignore[arg-type]
        found = LaggingJoints(config, QD_MAX).peek(1, Setpoint(tuple(r_next), tuple(rd_next)), now)  # type: ignore[arg-type]
        expected = [one_joint(config, *joint) for joint in zip(r_now, r_next, rd_next, x, xd, strict=True)]
        assert repr(list(zip(*found, strict=True))) == repr(expected)
