"""Random moves of three models: limits, continuity, exact ends, exact paths, stops from anywhere.

`ELITESCRIPT_INVARIANTS` sets how many cases are tried (10 if unset). Start points are spread over
the whole joint range, so that many lines are refused and many pass near singularities.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from itertools import islice
from math import cos, dist, hypot, pi, sin, sqrt
from typing import NamedTuple

import pytest

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.rotations import multiply, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import (
    Transform,
    compose,
    interpolate,
    pose_from_transform,
    position_of,
    rotation_of,
    transform_from_pose,
)
from elitescript.messages.motion import MoveC, MoveJ, MoveL, Six
from elitescript.models.model import load_model
from elitescript.motion.limits import MotionLimits
from elitescript.motion.planner import MoveNoteKind, Plan, plan_movec, plan_movej, plan_movel
from elitescript.motion.segment import Segment
from elitescript.motion.timing.timescale import TimeScale, stop_ramp
from tests.findings import Finding
from tests.invariants.cases import CASES
from tests.motion.moves import limits_of, six

pytestmark = pytest.mark.invariants

COUNT = CASES
SEED = 7
MODELS = ("CS63", "CS66", "CS620")
SAMPLES = 60
PERIOD_S = 0.004

JOINT_TOLERANCE = 1e-9
"""Relative, for moves in joint space: rounding only."""
SPEED_TOLERANCE = 2e-3
"""Relative, for Cartesian moves; the limits are kept at grid points and almost kept between them."""
ACCELERATION_TOLERANCE = 0.06
"""Relative, for Cartesian moves, and the error of the differences."""
RANGE_TOLERANCE_RAD = 1e-6
POSE_TOLERANCE = 1e-9
"""m and elements of the rotation matrix."""
LAW_TOLERANCE = 0.01
"""Relative deviation from the trapezoid law where no limit binds."""


class Case(NamedTuple):
    """A random arm at a random place with a random tool."""

    arm: Arm
    limits: MotionLimits
    q_start: Six
    T_flange_tcp: Transform
    rng: random.Random

    @property
    def T_base_tcp(self) -> Transform:
        return self.arm.forward_tcp(self.q_start, self.T_flange_tcp)


def cases(kind: str, joint_acceleration: float | None = None) -> Iterator[Case]:
    rng = random.Random(f"{SEED} {kind}")
    models = {}
    for name in MODELS:
        limits = limits_of(name) if joint_acceleration is None else limits_of(name, qdd_max=(joint_acceleration,) * 6)
        models[name] = load_model(name).arm, limits
    for _ in range(COUNT):
        arm, limits = models[rng.choice(MODELS)]
        q_start = six(rng.uniform(-2.0 * pi, 2.0 * pi) for _ in range(6))
        tool = [rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(0.0, 0.3)]
        T_flange_tcp = transform_from_pose(tool + [rng.uniform(-pi, pi) for _ in range(3)])
        yield Case(arm, limits, q_start, T_flange_tcp, rng)


def speed_and_acceleration(rng: random.Random) -> tuple[float, float]:
    return 10 ** rng.uniform(-1, 1), 10 ** rng.uniform(-2, 0.3)


class Shares:
    """The largest shares of the joint limits that a test has met."""

    def __init__(self) -> None:
        self.speed = 0.0
        self.acceleration = 0.0

    def __str__(self) -> str:
        return f"speed {100 * self.speed:.2f} %, acceleration {100 * self.acceleration:.2f} % of the joint limits"


def check_joints(
    segment: Segment, limits: MotionLimits, tolerance: float, acceleration_tolerance: float, shares: Shares
) -> None:
    """Ranges, speeds, accelerations, continuity and the exact ends of a segment."""
    duration_s = segment.duration_s
    assert segment.sample(0.0) == segment.q_start
    assert segment.sample(duration_s) == segment.q_end
    if duration_s == 0.0:
        return
    step_s = min(1e-5, 1e-4 * duration_s)
    for k in range(SAMPLES):
        t_s = (duration_s - step_s) * (k + 0.5) / SAMPLES
        q, qd = segment.setpoint(t_s)
        q_next, qd_next = segment.setpoint(t_s + step_s)
        for joint in range(6):
            assert limits.q_min[joint] - RANGE_TOLERANCE_RAD <= q[joint] <= limits.q_max[joint] + RANGE_TOLERANCE_RAD
            assert abs(qd[joint]) <= limits.qd_max[joint] * (1.0 + tolerance)
            change = abs(qd_next[joint] - qd[joint])
            shares.speed = max(shares.speed, abs(qd[joint]) / limits.qd_max[joint])
            shares.acceleration = max(shares.acceleration, (change - 1e-11) / (limits.qdd_max[joint] * step_s))
            assert change <= limits.qdd_max[joint] * step_s * (1.0 + acceleration_tolerance) + 1e-11
            # Position is the integral of speed: no jump, and the speed is not made up.
            mean = 0.5 * (qd[joint] + qd_next[joint])
            assert q_next[joint] - q[joint] == pytest.approx(
                mean * step_s, abs=limits.qdd_max[joint] * step_s**2 + 1e-10
            )


def check_law(plan: Plan, length: float, v: float, a: float) -> None:
    """Without a note the duration is that of the trapezoid."""
    if plan.notes or length == 0.0:
        return
    law = length / v + v / a if length >= v * v / a else 2.0 * sqrt(length / a)
    assert plan.segment.duration_s == pytest.approx(law, rel=LAW_TOLERANCE)


def test_movej_keeps_limits_path_law_and_end(finding: Finding) -> None:
    shares = Shares()
    for case in cases("movej"):
        rng, limits = case.rng, case.limits
        q_target = six(q if rng.random() < 0.2 else rng.uniform(-2.0 * pi, 2.0 * pi) for q in case.q_start)
        a, v = speed_and_acceleration(rng)
        t_s = 10 ** rng.uniform(-2, 1.5) if rng.random() < 0.3 else 0.0
        plan = plan_movej(case.arm, limits, case.q_start, MoveJ(q_target, a, v, t_s), case.T_flange_tcp)
        segment = plan.segment
        assert segment.q_end == q_target
        check_joints(segment, limits, JOINT_TOLERANCE, JOINT_TOLERANCE + 1e-6, shares)
        displacement = [b - a for a, b in zip(case.q_start, q_target, strict=True)]
        length = max(map(abs, displacement))
        if t_s:
            assert plan.notes or segment.duration_s == t_s
            assert not plan.notes or segment.duration_s > t_s
        elif length:
            v_leading = min(
                [v] + [top * length / abs(d) for top, d in zip(limits.qd_max, displacement, strict=True) if d]
            )
            a_leading = min(
                [a] + [top * length / abs(d) for top, d in zip(limits.qdd_max, displacement, strict=True) if d]
            )
            check_law(plan, length, v_leading, a_leading)
        for k in range(SAMPLES):
            q = segment.sample(segment.duration_s * k / SAMPLES)
            done = max(abs(b - a) for a, b in zip(case.q_start, q, strict=True)) / length
            expected = [a + done * d for a, d in zip(case.q_start, displacement, strict=True)]
            assert max(abs(a - b) for a, b in zip(q, expected, strict=True)) < 1e-12
    finding("`movej` alone", f"{COUNT} moves of three arms", str(shares))


@pytest.mark.parametrize("joint_acceleration", [None, 5.0], ids=["strong", "weak"])
def test_movel_keeps_limits_line_law_and_end(joint_acceleration: float | None, finding: Finding) -> None:
    outcomes: Counter[str] = Counter()
    shares = Shares()
    for case in cases("movel", joint_acceleration):
        rng = case.rng
        near = [rng.gauss(0.0, 0.2) for _ in range(3)] + [
            rng.gauss(0.0, 0.5) if rng.random() < 0.5 else 0.0 for _ in range(3)
        ]
        if rng.random() < 0.1:
            near[:3] = [0.0, 0.0, 0.0]
        p_target = pose_from_transform(compose(case.T_base_tcp, transform_from_pose(near)))
        a, v = speed_and_acceleration(rng)
        t_s = 10 ** rng.uniform(-1, 1.5) if rng.random() < 0.3 else 0.0
        request = MoveL(p_target, a, v, t_s)
        try:
            plan = plan_movel(case.arm, case.limits, case.q_start, case.T_flange_tcp, request)
        except MotionError as error:
            outcomes[check_refusal(error)] += 1
            continue
        outcomes["accepted"] += 1
        outcomes.update(note.kind for note in plan.notes)
        segment = plan.segment
        check_joints(segment, case.limits, SPEED_TOLERANCE, ACCELERATION_TOLERANCE, shares)
        T_start, T_end = case.T_base_tcp, transform_from_pose(p_target)
        check_pose(case, segment.q_end, T_end)
        length = segment.path.length
        if length == 0.0:
            assert segment.duration_s == t_s
            continue
        if t_s:
            assert plan.notes or segment.duration_s == t_s
            assert not plan.notes or segment.duration_s > t_s
        else:
            check_law(plan, length, v, a)
        for k in range(SAMPLES):
            t = segment.duration_s * k / SAMPLES
            share = segment.profile.at(t)[0] / length
            check_pose(case, segment.sample(t), interpolate(T_start, T_end, share))
    check_variety(outcomes)
    what = "`movel` alone" + (f", joints limited to {joint_acceleration:g} rad/s²" if joint_acceleration else "")
    finding(what, how_often(outcomes), str(shares))


@pytest.mark.parametrize("is_orientation_fixed", [True, False], ids=["fixed", "free"])
def test_movec_keeps_limits_circle_law_and_end(is_orientation_fixed: bool, finding: Finding) -> None:
    outcomes: Counter[str] = Counter()
    shares = Shares()
    for case in cases(f"movec {is_orientation_fixed}"):
        rng = case.rng
        radius, end = 10 ** rng.uniform(-2, -0.5), rng.uniform(0.1, 6.2)
        via = rng.uniform(0.1, 0.9) * end
        # A circle in the x-y plane of a randomly turned frame at the tool.
        T_tcp_circle = transform_from_pose((0, 0, 0, *(rng.uniform(-pi, pi) for _ in range(3))))

        def on_circle(
            angle: float, turn: Transform, T: Transform = T_tcp_circle, case: Case = case, r: float = radius
        ) -> Transform:
            offset = transform_from_pose((r * cos(angle) - r, r * sin(angle), 0, 0, 0, 0))
            x, y, z = position_of(compose(compose(case.T_base_tcp, T), offset))
            return (*rotation_of(compose(case.T_base_tcp, turn)), x, y, z)

        turn = transform_from_pose((0, 0, 0, *(rng.gauss(0.0, 0.5) for _ in range(3))))
        T_end = on_circle(end, turn)
        a, v = speed_and_acceleration(rng)
        p_via, p_end = pose_from_transform(on_circle(via, turn)), pose_from_transform(T_end)
        try:
            plan = plan_movec(
                case.arm,
                case.limits,
                case.q_start,
                case.T_flange_tcp,
                MoveC(p_via, p_end, a, v, is_orientation_fixed=is_orientation_fixed),
            )
        except MotionError as error:
            outcomes[check_refusal(error)] += 1
            continue
        outcomes["accepted"] += 1
        outcomes.update(note.kind for note in plan.notes)
        segment = plan.segment
        check_joints(segment, case.limits, SPEED_TOLERANCE, ACCELERATION_TOLERANCE, shares)
        assert segment.path.length == pytest.approx(radius * end, rel=1e-6)
        check_law(plan, radius * end, min(v, sqrt(case.limits.tool_acceleration_max * radius)), a)
        T_circle_base = compose(case.T_base_tcp, T_tcp_circle)
        whole = angle_between(case.T_base_tcp, T_end)
        for k in range(SAMPLES):
            t = segment.duration_s * k / SAMPLES
            T = case.arm.forward_tcp(segment.sample(t), case.T_flange_tcp)
            angle = segment.profile.at(t)[0] / segment.path.length * end
            assert dist(position_of(T), position_of(on_circle(angle, turn))) < POSE_TOLERANCE
            if is_orientation_fixed:
                # What the tangent sees of the tool does not change.
                tangent = [b * cos(angle) - a * sin(angle) for a, b in zip(*axes(T_circle_base)[:2], strict=True)]
                seen = [sum(x * y for x, y in zip(axis, tangent, strict=True)) for axis in axes(T)]
                seen_first = [
                    sum(x * y for x, y in zip(axis, axes(T_circle_base)[1], strict=True))
                    for axis in axes(case.T_base_tcp)
                ]
                assert seen == pytest.approx(seen_first, abs=POSE_TOLERANCE)
            else:
                assert angle_between(case.T_base_tcp, T) == pytest.approx(whole * angle / end, abs=1e-8)
    check_variety(outcomes)
    finding(f"`movec` alone, mode {0 if is_orientation_fixed else 1}", how_often(outcomes), str(shares))


def test_stop_pause_and_rescale_at_random_ticks_never_jump() -> None:
    rng = random.Random(f"{SEED} scales")
    for limits, segment in islice(random_segments(), COUNT):
        scale = TimeScale.start(0.0, rng.choice([1.0, rng.random()]))
        tick = 0
        q, qd = segment.q_start, (0.0,) * 6
        rate_before = scale.rate(0.0)
        for _ in range(rng.randrange(1, 6)):
            change_tick = tick + rng.randrange(1, 60)
            while tick < change_tick:
                tick += 1
                t_s = tick * PERIOD_S
                path_s, rate = scale.path_time(t_s), scale.rate(t_s)
                setpoint = segment.setpoint(path_s)
                qd_now = six(rate * speed for speed in setpoint.qd)
                for joint in range(6):
                    top = limits.qd_max[joint] * (1.0 + SPEED_TOLERANCE)
                    assert abs(setpoint.q[joint] - q[joint]) <= top * PERIOD_S
                    allowed = limits.qdd_max[joint] * (1.0 + ACCELERATION_TOLERANCE)
                    ramp = abs(rate - rate_before) * top
                    assert abs(qd_now[joint] - qd[joint]) <= allowed * PERIOD_S + ramp + 1e-9
                q, qd, rate_before = setpoint.q, qd_now, rate
            t_s = tick * PERIOD_S
            rate = scale.rate(t_s)
            ramp_s = max(PERIOD_S, stop_ramp(segment, scale.path_time(t_s), rate, 8.0))
            following = scale.with_target(t_s, rng.choice([0.0, 1.0, rng.random()]), ramp_s)
            assert following.path_time(t_s) == scale.path_time(t_s)
            assert following.rate(t_s) == rate
            scale = following
        scale = scale.with_target(
            t_s, 0.0, max(PERIOD_S, stop_ramp(segment, scale.path_time(t_s), scale.rate(t_s), 8.0))
        )
        rest_s = scale.settled_s
        assert scale.rate(rest_s) == 0.0
        assert scale.path_time(rest_s) == scale.path_time(rest_s + 100.0)
        # However it was stopped, the arm stands on its path.
        path_s = scale.path_time(rest_s)
        assert segment.sample(path_s) == segment.sample(scale.path_time(rest_s + 1.0))
        assert scale.time_of(path_s) <= rest_s
        # And goes on to the end.
        resumed = scale.with_target(rest_s + 1.0, 1.0, 0.2)
        assert segment.sample(resumed.path_time(resumed.time_of(segment.duration_s) + PERIOD_S)) == segment.q_end


def random_segments() -> Iterator[tuple[MotionLimits, Segment]]:
    """Accepted moves, in joint space and on lines, with the limits of their arms, without end."""
    rng = random.Random(f"{SEED} segments")
    arms = {name: (load_model(name).arm, limits_of(name)) for name in MODELS}
    while True:
        arm, limits = arms[rng.choice(MODELS)]
        q_start = six(rng.uniform(-pi, pi) for _ in range(6))
        q_target = six(q + rng.gauss(0.0, 0.3) for q in q_start)
        a, v = speed_and_acceleration(rng)
        if rng.random() < 0.4:
            yield limits, plan_movej(arm, limits, q_start, MoveJ(q_target, a, v)).segment
            continue
        T_flange_tcp = transform_from_pose((0.0, 0.05, 0.1, 0.1, 0.2, 0.3))
        p_target = pose_from_transform(arm.forward_tcp(q_target, T_flange_tcp))
        try:
            yield limits, plan_movel(arm, limits, q_start, T_flange_tcp, MoveL(p_target, a, v)).segment
        except MotionError:
            continue


def check_pose(case: Case, q: Six, T_expected: Transform) -> None:
    T = case.arm.forward_tcp(q, case.T_flange_tcp)
    assert max(abs(a - b) for a, b in zip(T, T_expected, strict=True)) < POSE_TOLERANCE


def check_refusal(error: MotionError) -> str:
    """A refusal says what, where, how much, in which unit."""
    assert error.code in {"R110", "R111", "R112"}
    assert error.value is not None
    assert error.hint
    text = str(error)
    assert ("from the start of the" in text) or ("at the start" in text)
    return error.code


def how_often(outcomes: Counter[str]) -> str:
    """How many moves were tried, and what became of them."""
    slowed = outcomes[MoveNoteKind.SPEED_LOWERED_NEAR_SINGULARITY]
    return f"{COUNT} moves of three arms: {outcomes['accepted']} accepted, {slowed} of them slowed near a singularity"


def check_variety(outcomes: Counter[str]) -> None:
    """The sample has met what it is for."""
    assert outcomes["accepted"] > 0.1 * COUNT
    if COUNT >= 300:
        assert outcomes["R110"] and outcomes["R111"]
        assert outcomes[MoveNoteKind.SPEED_LOWERED_NEAR_SINGULARITY]


def axes(T: Transform) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    return T[0:9:3], T[1:9:3], T[2:9:3]


def angle_between(T_a: Transform, T_b: Transform) -> float:
    return hypot(*rotvec_from_rotation(multiply(transpose(rotation_of(T_a)), rotation_of(T_b))))
