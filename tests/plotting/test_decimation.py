"""Thinning keeps what the eye looks for: extremes, ends, and the course in between."""

import random

import pytest

from elitescript.plotting.decimation import decimated, extremes, within_tolerance


def interpolated(times, values, kept, index):
    after = next(k for k in kept if k >= index)
    if after == index:
        return values[index]
    before = max(k for k in kept if k < index)
    return values[before] + (values[after] - values[before]) * (times[index] - times[before]) / (
        times[after] - times[before]
    )


def walk(seed, count, step):
    generator = random.Random(seed)
    values = [0.0]
    for _ in range(count - 1):
        values.append(values[-1] + generator.gauss(0.0, step))
    return [0.004 * k for k in range(count)], values


@pytest.mark.parametrize("seed", range(20))
def test_dropped_samples_lie_within_the_tolerance(seed):
    times, values = walk(seed, 200, 0.1)
    kept = within_tolerance(times, values, 0.15)
    assert 2 < len(kept) < 200
    assert kept == sorted(set(kept))
    assert max(abs(values[k] - interpolated(times, values, kept, k)) for k in range(200)) <= 0.15 + 1e-9


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("tolerance", [1e-6, 1.0, 100.0])
def test_the_ends_and_the_extremes_of_the_whole_curve_survive(seed, tolerance):
    times, values = walk(seed, 3000, 1.0)
    kept = decimated(times, values, tolerance=tolerance, points_max=100)
    assert len(kept) <= 100
    assert (kept[0], kept[-1]) == (0, 2999)
    chosen = [values[k] for k in kept]
    assert (min(chosen), max(chosen)) == (min(values), max(values))


def test_every_stretch_keeps_its_spike():
    values = [0.0] * 1000
    spikes = range(50, 1000, 100)
    for k in spikes:
        values[k] = 1.0
    assert set(spikes) <= set(extremes(list(range(1000)), values, 60))


def test_a_straight_line_is_its_ends():
    assert within_tolerance(range(100), [2.0 * k for k in range(100)], 1e-9) == [0, 99]


def test_a_step_keeps_both_of_its_sides():
    assert within_tolerance(range(10), [0.0] * 5 + [1.0] * 5, 1e-3) == [0, 4, 5, 9]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_curve_of_nothing_stays_as_it_is(count):
    assert within_tolerance(range(count), [1.0] * count, 0.1) == list(range(count))


def test_a_tolerance_that_keeps_too_much_is_found_out_early():
    times, values = walk(1, 50_000, 1.0)
    kept = within_tolerance(times, values, 1e-6, 100)
    assert 100 < len(kept) <= 110
    assert within_tolerance(times[:50], values[:50], 1e-6, 100) == within_tolerance(times[:50], values[:50], 1e-6)
