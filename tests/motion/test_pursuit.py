"""Catching up ends with no lag at all, within its bounds, in the least time."""

from itertools import pairwise
from math import inf, sqrt
from random import Random

import pytest

from elitescript.motion.timing.pursuit import CatchUp, Coast, caught_up

A, V = 1.2, 0.25


def random_starts(count=300):
    generator = Random(5)
    for _ in range(count):
        yield generator.uniform(-0.4, 0.4), generator.uniform(-1.0, 1.0), generator.uniform(0.2, 5.0)


def test_from_standstill_behind_a_belt_takes_one_plus_root_two_ramps():
    law = CatchUp(0.0, 0.1, 1.0, inf)
    assert law.duration_s == pytest.approx(0.1 * (1.0 + sqrt(2.0)), rel=1e-12)


def test_nothing_to_catch_up_is_over_at_once():
    law = CatchUp(0.0, 0.0, A, V)
    assert law.duration_s == 0.0
    assert law.at(0.0) == (0.0, 0.0)


def test_begins_where_it_is_told_to_and_ends_at_exactly_nothing():
    for lag, rate, a in random_starts():
        law = CatchUp(lag, rate, a, V)
        assert law.at(0.0) == (lag, rate)
        assert law.at(law.duration_s) == (0.0, 0.0)
        assert law.at(law.duration_s + 100.0) == (0.0, 0.0)


def test_lag_and_rate_are_continuous_and_the_rate_changes_no_faster_than_allowed():
    for lag, rate, a in random_starts():
        law = CatchUp(lag, rate, a, V)
        step_s = law.duration_s / 400
        rows = [law.at(step_s * k) for k in range(402)]
        for (x, w), (x_next, w_next) in pairwise(rows):
            assert abs(w_next - w) <= a * step_s * (1 + 1e-9) + 1e-12
            assert x_next - x == pytest.approx(0.5 * (w + w_next) * step_s, abs=1.01 * a * step_s * step_s)
        assert max(abs(w) for _, w in rows) <= max(V, abs(rate)) + 1e-12


def test_no_bounded_way_is_quicker():
    """The rate has to be swept twice through zero: a quicker law would break the bound."""
    for lag, rate, a in random_starts(100):
        law = CatchUp(lag, rate, a, inf)
        # Reach in the time T from (lag, rate): lag at most moved by the bang-bang of the same two switches.
        T = law.duration_s
        shorter = 0.999 * T

        def end_of(first, switch_s, lag=lag, rate=rate, a=a, T=shorter):
            x = lag + rate * switch_s + 0.5 * first * a * switch_s**2
            w = rate + first * a * switch_s
            left = T - switch_s
            return x + w * left - 0.5 * first * a * left**2, w - first * a * left

        for first in (1.0, -1.0):
            # The switch that brings the rate to zero at the end; the lag is then not zero.
            switch_s = 0.5 * (shorter - first * rate / a)
            if 0.0 <= switch_s <= shorter:
                x, w = end_of(first, switch_s)
                assert abs(w) < 1e-9
                assert abs(x) > 1e-9


def test_a_rate_above_the_bound_is_brought_below_it_first():
    law = CatchUp(0.5, -0.8, 1.0, 0.2)
    assert law.at(0.6)[1] == pytest.approx(-0.2, abs=1e-12)
    assert law.at(law.duration_s) == (0.0, 0.0)


def test_small_lags_are_caught_up_gently_but_in_time():
    generator = Random(8)
    for _ in range(300):
        size = 10.0 ** generator.uniform(-8.0, 0.0)
        lag, rate = generator.uniform(-1.0, 1.0) * size, generator.uniform(-1.0, 1.0) * size
        quickest, law = CatchUp(lag, rate, 3.0, 0.5), caught_up(lag, rate, 3.0, 0.5, 0.2)
        assert law.at(0.0) == (lag, rate)
        if quickest.duration_s >= 0.2:
            assert law.duration_s == quickest.duration_s
        else:
            assert quickest.duration_s <= law.duration_s <= 0.2 + 1e-12


@pytest.mark.parametrize("lag", [1e-300, 1e-30, -5e-324])
@pytest.mark.parametrize("acceleration", [3.0, 1e-300])
def test_next_to_nothing_is_caught_up_too(lag, acceleration):
    law = caught_up(lag, 0.0, acceleration, 0.5, 0.2)
    assert abs(law.at(0.0)[0]) <= abs(lag) * (1.0 + 1e-6)
    assert law.at(law.duration_s) == (0.0, 0.0)


def test_coasting_stands_after_its_ramp_at_half_of_the_way():
    coast = Coast(1.0, 0.4, 0.5)
    assert coast.at(0.0) == (1.0, 0.4)
    assert coast.at(0.25)[1] == pytest.approx(0.2)
    assert coast.at(0.5) == coast.at(9.0) == (1.1, 0.0)
