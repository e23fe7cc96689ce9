"""The curve through the points of a file against SciPy's spline with the same speeds at its ends."""

from __future__ import annotations

import random
from importlib.metadata import version

import pytest

from elitescript.motion.paths.spline import JointSpline
from tests.findings import Finding

interpolate = pytest.importorskip("scipy.interpolate")
pytestmark = pytest.mark.peers

CASES = 50


def test_scipy_finds_the_same_curve_through_the_points(finding: Finding) -> None:
    rng = random.Random(13)
    places = speeds = 0.0
    for _ in range(CASES):
        interval_s, count = rng.uniform(0.002, 0.1), rng.randrange(4, 60)
        columns = [[rng.uniform(-1.0, 1.0) for _ in range(count)] for _ in range(6)]
        ours = JointSpline(columns, interval_s)
        times = [interval_s * index for index in range(count)]
        first, last = ours.q_and_speed(0.0)[1], ours.q_and_speed(ours.duration_s)[1]
        for joint, column in enumerate(columns):
            theirs = interpolate.CubicSpline(times, column, bc_type=((1, first[joint]), (1, last[joint])))
            for share in (0.01, 0.3, 0.5, 0.77, 0.99):
                q, qd = ours.q_and_speed(share * ours.duration_s)
                places = max(places, abs(q[joint] - theirs(share * ours.duration_s)))
                speeds = max(speeds, interval_s * abs(qd[joint] - theirs(share * ours.duration_s, 1)))
    assert places < 1e-12
    assert speeds < 1e-12
    peer = f"SciPy {version('scipy')}, {CASES} point files"
    finding("curve through the points of a file", peer, f"{places:.1e} rad, {speeds:.1e} rad per interval")
