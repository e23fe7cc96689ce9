"""The geometry of a corner: it touches both paths, and its slope is its derivative."""

from __future__ import annotations

import pytest

from elitescript.kinematics.transforms import compose, inverse, position_of
from elitescript.messages.motion import MoveC, MoveJ, MoveL, MoveRequest
from elitescript.motion.paths.corner import Corner, JointCorner
from elitescript.motion.paths.track import JointTrack, follow
from elitescript.motion.planner import plan_movec, plan_movej, plan_movel
from elitescript.motion.segment import JointPath
from tests.motion.moves import ARM, LIMITS, Q_WORK, T_FLANGE_TCP, largest_difference, line_by, shifted, six

FIRST: dict[str, MoveRequest] = {
    "line": line_by(Q_WORK, 0.05, -0.06, 0.01),
    "turning line": line_by(Q_WORK, 0.05, -0.06, 0.01, 0.2, 0.1, -0.3),
    "rotation": line_by(Q_WORK, 0.0, 0.0, 0.0, 0.2, 0.1, -0.3),
    "arc": MoveC(shifted(Q_WORK, 0.05, 0.05), shifted(Q_WORK, 0.0, 0.1), 1.2, 0.25),
}


def laid(request: MoveRequest, q: tuple[float, ...]) -> JointTrack:
    q_start = six(q)
    if isinstance(request, MoveC):
        path: JointPath = plan_movec(ARM, LIMITS, q_start, T_FLANGE_TCP, request).segment.path
    else:
        assert isinstance(request, MoveL)
        path = plan_movel(ARM, LIMITS, q_start, T_FLANGE_TCP, request).segment.path
    assert isinstance(path, JointTrack)
    return path


def second_of(q: tuple[float, ...]) -> dict[str, MoveRequest]:
    q = six(q)
    return {
        "line": line_by(q, -0.04, -0.03, 0.02),
        "turning line": line_by(q, -0.04, -0.03, 0.02, -0.1, 0.2, 0.1),
        "rotation": line_by(q, 0.0, 0.0, 0.0, -0.1, 0.2, 0.1),
        "free arc": MoveC(
            shifted(q, 0.03, -0.03), shifted(q, 0.0, -0.06, 0.0, 0.1), 1.2, 0.25, is_orientation_fixed=False
        ),
    }


@pytest.fixture(
    params=[(first, second) for first in FIRST for second in ("line", "turning line", "rotation", "free arc")]
)
def tracks(request: pytest.FixtureRequest) -> tuple[JointTrack, JointTrack]:
    first, second = request.param
    one = laid(FIRST[first], Q_WORK)
    return one, laid(second_of(one.q_end)[second], one.q_end)


def test_a_corner_leaves_one_path_and_joins_the_other(tracks: tuple[JointTrack, JointTrack]) -> None:
    one, other = tracks
    d1, d2, T = 0.3 * one.length, 0.2 * other.length, 0.7
    corner = Corner(one.path, other.path, d1, d2, T, "s", T_FLANGE_TCP)
    for s, path, place, rate in (
        (0.0, one.path, one.length - d1, 2.0 * d1 / T),
        (T, other.path, d2, 2.0 * d2 / T),
    ):
        T_flange = path.flange(place)
        assert largest_difference(corner.flange(s), T_flange) < 1e-9
        slope = [rate * x for x in path.flange_slope(place, T_flange)]
        assert largest_difference(corner.flange_and_slope(s)[1], slope) < 1e-8


def test_its_slope_is_the_derivative_of_its_pose(tracks: tuple[JointTrack, JointTrack]) -> None:
    one, other = tracks
    corner = Corner(one.path, other.path, 0.3 * one.length, 0.2 * other.length, 0.7, "s", T_FLANGE_TCP)
    h = 1e-6
    for k in range(1, 10):
        s = 0.07 * k
        before, here, after = corner.flange(s - h), corner.flange(s), corner.flange(s + h)
        T_base_flange, (vx, vy, vz, wx, wy, wz) = corner.flange_and_slope(s)
        assert T_base_flange == here
        numeric = [(b - a) / (2.0 * h) for a, b in zip(position_of(before), position_of(after), strict=True)]
        assert largest_difference((vx, vy, vz), numeric) < 1e-7
        turn = compose(after, inverse(before))
        numeric = [(turn[a] - turn[b]) / (4.0 * h) for a, b in ((7, 5), (2, 6), (3, 1))]
        assert largest_difference((wx, wy, wz), numeric) < 1e-7
        numeric = [(b - a) / (2.0 * h) for a, b in zip(corner.point(s - h), corner.point(s + h), strict=True)]
        assert largest_difference(corner.velocity(s), numeric) < 1e-7


def test_a_corner_is_followed_like_any_path(tracks: tuple[JointTrack, JointTrack]) -> None:
    one, other = tracks
    d1, d2 = 0.3 * one.length, 0.2 * other.length
    corner = Corner(one.path, other.path, d1, d2, 0.7, "s", T_FLANGE_TCP)
    track = follow(ARM, LIMITS, corner, one.q(one.length - d1), 1.0, 0.0)
    assert largest_difference(track.q_end, other.q(d2)) < 1e-9
    assert largest_difference(ARM.forward_tcp(track.q_end, T_FLANGE_TCP), track.T_base_tcp_end) < 1e-9
    assert "blend" in corner.place(0.3)


def test_a_joint_corner_adds_joints() -> None:
    q_waypoint = six(q + 0.2 for q in Q_WORK)
    one = plan_movej(ARM, LIMITS, Q_WORK, MoveJ(q_waypoint, 1.0, 1.0), T_FLANGE_TCP).segment.path
    other = laid(second_of(q_waypoint)["turning line"], q_waypoint)
    d1, d2, T = 0.05, 0.02, 0.4
    corner = JointCorner(ARM, T_FLANGE_TCP, one, other, d1, d2, T)
    assert largest_difference(corner.q_start, one.q(one.length - d1)) < 1e-12
    assert largest_difference(corner.q_end, other.q(d2)) < 1e-12
    h = 1e-6
    for k in range(1, 10):
        s = 0.04 * k
        numeric = [(b - a) / (2.0 * h) for a, b in zip(corner.q(s - h), corner.q(s + h), strict=True)]
        assert largest_difference(corner.q_and_slope(s)[1], numeric) < 1e-7
    assert largest_difference(corner.q_and_slope(0.0)[1], [2.0 * d1 / T] * 6) < 1e-9
