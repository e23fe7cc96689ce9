"""Closest distances against certificates: points of both bodies, and a direction in which nothing is nearer."""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt
from random import Random

import pytest

from elitescript.kinematics.rotations import rotation_from_rotvec
from elitescript.solids.bodies import ROUND_EXCESS, SIDES, Body
from elitescript.solids.distance import ball_distance, closest, least_distance

KINDS = ("box", "cylinder", "cone", "sphere", "capsule")


def random_body(draw, kind=None):
    kind = kind or draw.choice(KINDS)
    count = {"box": 3, "cylinder": 2, "cone": 3, "sphere": 1, "capsule": 2}[kind]
    return Body(kind, tuple(draw.uniform(0.02, 0.5) for _ in range(count)))


def random_place(draw, spread):
    """Half of the places are aligned with the axes, where faces and edges are parallel."""
    if draw.random() < 0.5:
        turn = tuple(draw.choice((0.0, pi / 2, pi)) if i == draw.randrange(3) else 0.0 for i in range(3))
        where = [draw.randrange(-4, 5) * 0.125 * spread for _ in range(3)]
    else:
        turn = tuple(draw.uniform(-2, 2) for _ in range(3))
        where = [draw.uniform(-spread, spread) for _ in range(3)]
    return (*rotation_from_rotvec(turn), *where)


def farthest(body, T, n):
    x, y, z = body.support(T, *n)
    return x * n[0] + y * n[1] + z * n[2] + body.margin


def is_inside(body, T, point, tolerance):
    """Whether no face of the body, or of the ball about a point of its core, has the point outside."""
    d = [point[i] - T[9 + i] for i in range(3)]
    u, v, w = (d[0] * T[i] + d[1] * T[3 + i] + d[2] * T[6 + i] for i in range(3))
    if body.is_box:
        return all(abs(c) <= h + tolerance for c, h in zip((u, v, w), body.half, strict=True))
    if body.is_slim:
        return hypot(u, v, w - max(-body.along, min(body.along, w))) <= body.margin + tolerance
    low, high, h = body.half
    radius = low + (high - low) * (w + h) / (2 * h)
    side = max(u * cos(2 * pi * k / SIDES) + v * sin(2 * pi * k / SIDES) for k in range(SIDES))
    return abs(w) <= h + tolerance and side <= radius * cos(pi / SIDES) + tolerance


def test_distances_apart_are_certain():
    draw = Random(1)
    apart = 0
    for _ in range(600):
        a, b = random_body(draw), random_body(draw)
        T_a, T_b = random_place(draw, 1.0), random_place(draw, 1.0)
        d, p, q = closest(a, T_a, b, T_b)
        assert least_distance(a, T_a, b, T_b) <= d + 1e-9
        if d > 0.0:
            assert ball_distance(T_a, a.bound, b, T_b) <= d + 1e-9
        assert closest(b, T_b, a, T_a)[0] == pytest.approx(d, abs=2e-8)
        if d <= 1e-6:
            continue
        apart += 1
        assert hypot(*(p[i] - q[i] for i in range(3))) == pytest.approx(d, abs=1e-8)
        assert is_inside(a, T_a, p, 1e-7)
        assert is_inside(b, T_b, q, 1e-7)
        n = tuple((q[i] - p[i]) / d for i in range(3))
        gap = -farthest(b, T_b, tuple(-c for c in n)) - farthest(a, T_a, n)
        assert gap == pytest.approx(d, abs=1e-7)
    assert apart > 200


def test_depths_are_the_shortest_way_out():
    draw = Random(2)
    directions = []
    while len(directions) < 150:
        n = [draw.gauss(0, 1) for _ in range(3)]
        length = hypot(*n)
        directions.append(tuple(c / length for c in n))
    inside = 0
    for _ in range(120):
        a, b = random_body(draw), random_body(draw)
        T_a, T_b = random_place(draw, 0.2), random_place(draw, 0.2)
        d, p, q = closest(a, T_a, b, T_b)
        if d > -1e-6:
            continue
        inside += 1
        assert hypot(*(p[i] - q[i] for i in range(3))) == pytest.approx(-d, abs=1e-8)
        n = tuple((p[i] - q[i]) / -d for i in range(3))
        # Out by this way: then they just touch.
        moved = (*T_b[:9], *(T_b[9 + i] - d * n[i] for i in range(3)))
        assert closest(a, T_a, b, moved)[0] == pytest.approx(0.0, abs=1e-6)
        for m in directions:
            assert farthest(a, T_a, m) + farthest(b, T_b, tuple(-c for c in m)) >= -d - 1e-9
    assert inside > 50


@pytest.mark.parametrize(
    ("a", "at", "b", "expected"),
    [
        (Body("sphere", (0.1,)), (0.5, 0.0, 0.0), Body("box", (0.4, 0.4, 0.4)), 0.2),
        (Body("sphere", (0.1,)), (0.5, 0.5, 0.0), Body("box", (0.4, 0.4, 0.4)), 0.3 * sqrt(2) - 0.1),
        (Body("sphere", (0.1,)), (0.15, 0.0, 0.0), Body("box", (0.4, 0.4, 0.4)), -0.15),
        (Body("box", (0.2, 0.2, 0.2)), (0.0, 0.0, 0.35), Body("box", (1.0, 1.0, 0.1)), 0.2),
        (Body("box", (0.2, 0.2, 0.2)), (0.0, 0.0, 0.14), Body("box", (1.0, 1.0, 0.1)), -0.01),
        (Body("capsule", (0.05, 0.4)), (0.3, 0.0, 0.0), Body("capsule", (0.1, 0.4)), 0.15),
        (Body("capsule", (0.05, 0.4)), (0.0, 0.0, 0.7), Body("capsule", (0.1, 0.4)), 0.15),
        (Body("capsule", (0.05, 0.4)), (0.1, 0.0, 0.0), Body("capsule", (0.1, 0.4)), -0.05),
        (Body("cylinder", (0.1, 0.2)), (0.0, 0.0, 0.5), Body("cylinder", (0.3, 0.2)), 0.3),
        (Body("cylinder", (0.1, 0.2)), (0.6, 0.0, 0.0), Body("box", (0.4, 0.4, 0.4)), 0.3),
        (Body("cone", (0.1, 0.05, 0.2)), (0.0, 0.0, 0.5), Body("box", (1.0, 1.0, 0.2)), 0.3),
    ],
)  # fmt: skip
def test_known_distances(a, at, b, expected):
    upright = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    found = closest(a, (*upright, *at), b, (*upright, 0.0, 0.0, 0.0))
    assert found.distance == pytest.approx(expected, abs=1e-9)


def test_round_bodies_stand_out_by_less_than_a_hundredth_of_their_radius():
    assert 0.0 < ROUND_EXCESS < 0.01
    upright = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    body = Body("cylinder", (0.1, 0.2))
    for step in range(360):
        n = (cos(step * pi / 180), sin(step * pi / 180), 0.0)
        assert 0.1 - 1e-12 <= farthest(body, upright, n) <= 0.1 * (1 + ROUND_EXCESS) + 1e-12


@pytest.mark.parametrize(
    ("body", "at", "expected"),
    [
        (Body("box", (0.2, 0.4, 0.6)), (0.4, 0.0, 0.0), 0.2),
        (Body("box", (0.2, 0.4, 0.6)), (0.4, 0.6, 0.0), 0.4),
        (Body("sphere", (0.1,)), (0.0, 0.0, 0.5), 0.3),
        (Body("capsule", (0.1, 0.4)), (0.0, 0.0, 0.5), 0.1),
        (Body("cylinder", (0.1 / (1.0 + ROUND_EXCESS), 0.4)), (0.5, 0.0, 0.6), 0.3 * sqrt(2) - 0.1 + 0.1 * sqrt(2)),
    ],
)  # fmt: skip
def test_distances_of_a_ball(body, at, expected):
    upright = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    assert ball_distance((*upright, *at), 0.1, body, (*upright, 0.0, 0.0, 0.0)) == pytest.approx(expected, abs=1e-9)
