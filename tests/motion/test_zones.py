"""Where blends begin on lines, arcs, rotations and joint moves."""

from __future__ import annotations

from math import dist

import pytest

from elitescript.kinematics.transforms import position_of
from elitescript.messages.motion import MoveC, MoveJ, MoveL
from elitescript.motion.paths.zones import way_within, zone_before
from elitescript.motion.planner import Plan, plan_movec, plan_movej, plan_movel
from tests.motion.moves import ARM, LIMITS, Q_WORK, T_FLANGE_TCP, line_by, shifted, six

JOINTS = six(q + d for q, d in zip(Q_WORK, (0.4, 0.2, -0.3, 0.1, 0.2, 0.4), strict=True))
LINE = plan_movel(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, line_by(Q_WORK, 0.06, -0.08))
ARC = plan_movec(
    ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveC(shifted(Q_WORK, 0.05, 0.05), shifted(Q_WORK, 0.0, 0.1), 1.2, 0.25)
)
JOINT = plan_movej(ARM, LIMITS, Q_WORK, MoveJ(JOINTS, 1.0, 1.0), T_FLANGE_TCP)


def distance(plan: Plan, s: float, other_s: float) -> float:
    """Between the TCP at two path positions, m."""
    one, other = (position_of(ARM.forward_tcp(plan.segment.path.q(place), T_FLANGE_TCP)) for place in (s, other_s))
    return dist(one, other)


@pytest.mark.parametrize("r", [1e-4, 0.003, 0.03])
@pytest.mark.parametrize("plan", [LINE, ARC, JOINT], ids=["line", "arc", "joint"])
def test_a_zone_begins_where_the_tcp_is_a_radius_away(plan: Plan, r: float) -> None:
    path = plan.segment.path
    zone = zone_before(path, r, ARM, T_FLANGE_TCP)
    assert (zone.radius, zone.is_shortened) == (r, False)
    assert distance(plan, zone.begin, path.length) == pytest.approx(r, abs=1e-8)
    # From there on the TCP stays inside.
    assert all(
        distance(plan, zone.begin + (path.length - zone.begin) * k / 20, path.length) <= r * (1.0 + 1e-6)
        for k in range(21)
    )


@pytest.mark.parametrize("r", [1e-4, 0.003, 0.03])
@pytest.mark.parametrize("plan", [LINE, ARC, JOINT], ids=["line", "arc", "joint"])
def test_a_path_is_within_a_radius_of_its_start_up_to_there(plan: Plan, r: float) -> None:
    way = way_within(plan.segment.path, r, ARM, T_FLANGE_TCP)
    assert distance(plan, 0.0, way) == pytest.approx(r, abs=1e-8)


@pytest.mark.parametrize("plan", [LINE, ARC, JOINT], ids=["line", "arc", "joint"])
def test_a_zone_is_half_of_the_move_at_most_and_says_what_is_left_of_the_radius(plan: Plan) -> None:
    path = plan.segment.path
    zone = zone_before(path, 5.0, ARM, T_FLANGE_TCP)
    assert zone.is_shortened
    assert zone.begin == pytest.approx(0.5 * path.length)
    assert zone.radius == pytest.approx(distance(plan, zone.begin, path.length), abs=1e-9)
    assert way_within(path, 5.0, ARM, T_FLANGE_TCP) == 0.5 * path.length


def test_a_rotation_on_the_spot_blends_over_half_of_its_angle_and_is_not_called_shortened() -> None:
    request = line_by(Q_WORK, 0.0, 0.0, 0.0, 0.0, 0.0, 0.6)
    plan = plan_movel(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveL(request.p_target, 1.2, 0.25, 0.0, 0.01))
    assert plan.zone is not None
    assert plan.zone.begin == pytest.approx(0.5 * plan.segment.path.length)
    assert plan.notes == ()


def test_a_move_without_a_radius_has_no_zone() -> None:
    assert LINE.zone is None
