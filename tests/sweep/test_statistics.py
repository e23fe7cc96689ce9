"""Statistics against numbers from tables and from counting."""

from __future__ import annotations

import itertools
import math
import random

import pytest

from elitescript.sweep.results.statistics import (
    at_least_so_many,
    chi_squared_tail,
    groups_differ,
    rank_correlation,
    ranks,
    share_interval,
)


# NIST/SEMATECH e-Handbook 1.3.6.7.4: critical values of chi squared.
@pytest.mark.parametrize(
    ("degrees", "critical", "tail"),
    [(1, 3.841, 0.05), (1, 10.828, 0.001), (2, 5.991, 0.05), (7, 18.475, 0.01), (7, 2.167, 0.95), (30, 59.703, 0.001)],
)
def test_tails_of_chi_squared(degrees, critical, tail):
    assert chi_squared_tail(critical, degrees) == pytest.approx(tail, rel=2e-3)


def test_the_far_tail_of_chi_squared_with_one_degree_is_that_of_the_normal_distribution():
    for z in (0.1, 1.0, 3.0, 8.0):
        assert chi_squared_tail(z * z, 1) == pytest.approx(math.erfc(z / math.sqrt(2)), rel=1e-9)
    assert chi_squared_tail(0.0, 3) == 1.0
    assert chi_squared_tail(5000.0, 3) < 1e-300 or chi_squared_tail(5000.0, 3) == 0.0


def test_intervals_of_shares():
    # Newcombe, Statistics in Medicine 17 (1998), table I: 81/263, 15/148 and 1/29 by Wilson's method.
    assert share_interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert share_interval(15, 148) == pytest.approx((0.0624, 0.1605), abs=5e-5)
    assert share_interval(1, 29) == pytest.approx((0.0061, 0.1718), abs=5e-5)
    assert share_interval(0, 1000) == (0.0, 0.003)
    assert share_interval(1000, 1000) == (0.997, 1.0)
    assert share_interval(0, 2) == (0.0, 1.0)
    assert share_interval(0, 0) == (0.0, 1.0)


def test_equal_values_share_their_ranks():
    assert ranks([3.0, 1.0, 3.0, 2.0]) == [3.5, 1.0, 3.5, 2.0]
    assert rank_correlation(ranks([1, 2, 3]), ranks([10, 100, 1000])) == pytest.approx(1.0)
    assert rank_correlation(ranks([1, 2, 3]), ranks([3, 2, 1])) == pytest.approx(-1.0)
    assert rank_correlation(ranks([1, 1, 1]), ranks([3, 2, 1])) == 0.0


def test_groups_by_kruskal_and_wallis():
    # By hand: ranks 1 to 9 in three groups, sums 6, 15, 24: H = 12 / 90 * (36 + 225 + 576) / 3 - 30 = 7.2.
    found = groups_differ([0, 0, 0, 1, 1, 1, 2, 2, 2], ranks([float(n) for n in range(9)]))
    assert found.p == pytest.approx(math.exp(-3.6), rel=1e-9)
    assert found.share == pytest.approx(7.2 / 8)
    assert groups_differ([0, 0, 1, 1], ranks([1.0, 1.0, 1.0, 1.0])).p == 1.0
    assert groups_differ([0, 0, 0], ranks([1.0, 2.0, 3.0])).p == 1.0


def test_chance_is_called_one_as_often_as_it_says():
    chance = random.Random(7)
    found = [
        groups_differ([n % 4 for n in range(60)], ranks([float(chance.random() < 0.3) for _ in range(60)])).p
        for _ in range(600)
    ]
    assert 0.02 < sum(p < 0.05 for p in found) / len(found) < 0.085


def test_the_exact_test_counts_draws():
    urn = [1, 1, 1, 0, 0, 0, 0]
    for hits, drawn in itertools.product(range(5), range(1, 7)):
        draws = list(itertools.combinations(urn, drawn))
        wanted = sum(sum(draw) >= hits for draw in draws) / len(draws)
        assert at_least_so_many(hits, drawn, 3, 7) == pytest.approx(wanted, abs=1e-12)
