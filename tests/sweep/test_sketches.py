"""Sketches know a distribution within their error, and depend on what was added, not on its order."""

from __future__ import annotations

import math
import random

from elitescript.sweep.results.sketches import BINS, Sample, Sketch


def sketch(values):
    found = Sketch()
    for value in values:
        found.add(value)
    return found


def test_few_values_are_known_to_a_picometre():
    found = sketch([31.2, 30.8, -1.5, 31.2, 0.0]).distribution()
    assert (found.least, found.most, found.count) == (-1.5, 31.2, 5)
    assert found.error < 1e-12
    assert abs(found.median - 30.8) <= found.error


def test_quantiles_of_many_values_are_within_the_error_that_is_said():
    chance = random.Random(3)
    for values in (
        [chance.gauss(30.0, 0.4) for _ in range(20_000)],
        [chance.expovariate(1.0) for _ in range(20_000)] + [1e9],
        [chance.uniform(-1e-3, 1e-3) for _ in range(20_000)],
    ):
        found = sketch(values).distribution()
        ordered = sorted(values)
        for share, name in ((0.05, "p05"), (0.25, "p25"), (0.5, "median"), (0.75, "p75"), (0.95, "p95")):
            true = ordered[math.ceil(share * len(values)) - 1]
            assert abs(getattr(found, name) - true) <= found.error * (1 + 1e-12)
        # One value far away costs the others little.
        assert found.error < (ordered[int(0.99 * len(ordered))] - ordered[0]) / 100
        assert abs(found.mean - math.fsum(values) / len(values)) <= 1e-12 * max(map(abs, values))


def test_the_order_does_not_matter():
    chance = random.Random(4)
    values = [chance.lognormvariate(0, 3) for _ in range(8_000)]
    first = sketch(values).distribution()
    chance.shuffle(values)
    assert sketch(values).distribution() == first


def test_it_stays_small_and_takes_every_number():
    chance = random.Random(5)
    found = sketch([chance.uniform(-1, 1) * 10.0 ** chance.randint(-300, 308) for _ in range(6_000)])
    assert len(found._bins) <= BINS
    for value in (math.inf, -math.inf, math.nan, 1.7e308, 1.7e308, 1.7e308, 5e-324):
        found.add(value)
    assert found.distribution().others == 3
    assert found.distribution().most == 1.7e308
    assert 1e304 < found.distribution().mean < 1e306
    assert Sketch().distribution() is None


def test_a_sample_is_chosen_by_numbers_alone():
    numbers = list(range(50_000))
    first = Sample(1000)
    for number in numbers:
        first.add(number, lambda number=number: number)
    random.Random(6).shuffle(numbers)
    second = Sample(1000)
    for number in numbers:
        second.add(number, lambda number=number: number)
    assert list(first) == list(second) == sorted(first)
    assert 500 <= len(first) <= 1000
    assert first.seen == 50_000
    assert len(first) * first.one_in / 50_000 == round(len(first) * first.one_in / 50_000, 9)
    assert abs(len(first) * first.one_in / 50_000 - 1) < 0.1


def test_a_sample_of_few_is_all_of_them_and_a_smaller_one_is_part_of_it():
    large, small = Sample(1000), Sample(100)
    for number in range(800):
        large.add(number, lambda number=number: number)
        small.add(number, lambda number=number: number)
    assert list(large) == list(range(800))
    assert large.one_in == 1
    assert large.at_most(100) == (list(small), small.one_in)
    assert len(small) > 50
