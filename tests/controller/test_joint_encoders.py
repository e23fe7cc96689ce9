"""Noise of encoders: what it is, and that looking does not change it."""

from __future__ import annotations

from itertools import combinations, pairwise
from statistics import fmean, pstdev

import pytest

from elitescript.controller.arm.joint_encoders import JointEncoders
from elitescript.messages.motion import Six
from elitescript.messages.state import JointState
from elitescript.messages.timing import PERIOD_S

TICKS = 4000
Q: Six = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
QD: Six = (0.0, 0.1, 0.0, -0.1, 0.0, 0.0)
JOINTS = JointState((1.0,) * 6, (2.0,) * 6, Q, QD)


def test_exact_encoders_pass_on_what_they_see() -> None:
    assert JointEncoders().read(5, JOINTS) is JOINTS


def test_noise_is_normal_and_of_the_asked_size() -> None:
    encoders = JointEncoders(1e-5, seed=3)
    columns = list(zip(*(encoders.noise(tick) for tick in range(TICKS)), strict=True))
    for column in columns:
        assert abs(fmean(column)) < 4e-5 / TICKS**0.5
        assert pstdev(column) == pytest.approx(1e-5, rel=0.05)
        assert sum(abs(value) < 1e-5 for value in column) / TICKS == pytest.approx(0.6827, abs=0.03)
        assert abs(fmean(a * b for a, b in pairwise(column))) < 0.07e-10
    for one, other in combinations(columns, 2):
        assert abs(fmean(a * b for a, b in zip(one, other, strict=True))) < 0.07e-10


def test_speeds_are_differences_of_positions() -> None:
    encoders = JointEncoders(1e-5, seed=3)
    before, here = encoders.read(99, JOINTS), encoders.read(100, JOINTS)
    for q0, q1, qd, qd_true in zip(before.q_actual, here.q_actual, here.qd_actual, QD, strict=True):
        assert qd - qd_true == pytest.approx((q1 - q0) / PERIOD_S, abs=1e-9)
    assert here.q_target == JOINTS.q_target
    assert here.qd_target == JOINTS.qd_target


def test_the_order_of_looking_does_not_matter() -> None:
    forward, backward = JointEncoders(1e-5, seed=3), JointEncoders(1e-5, seed=3)
    ticks = range(50)
    one = [forward.read(tick, JOINTS) for tick in ticks]
    other = [backward.read(tick, JOINTS) for tick in reversed(ticks) for _ in range(2)]
    assert one == other[::-2]


def test_another_seed_is_another_noise() -> None:
    assert len({JointEncoders(1e-5, seed).noise(7) for seed in (0, 1, -1, 2**60)}) == 4
