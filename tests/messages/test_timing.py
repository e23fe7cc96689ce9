import random

import pytest

from elitescript.messages.timing import PERIOD_S, TICKS_PER_S, seconds, ticks_for


def test_period_and_rate_are_one_fact():
    assert PERIOD_S * TICKS_PER_S == 1.0


@pytest.mark.parametrize(
    ("duration_s", "ticks"), [(0.0, 0), (-1.0, 0), (0.004, 1), (0.0040001, 2), (0.1, 25), (1.0, 250), (0.3, 75)]
)
def test_a_wait_is_rounded_up_to_ticks(duration_s, ticks):
    assert ticks_for(duration_s) == ticks


def test_a_wait_never_ends_early_and_whole_ticks_are_kept():
    generator = random.Random(1)
    for _ in range(1000):
        ticks = generator.randrange(0, 10_000_000)
        assert ticks_for(seconds(ticks)) == ticks
        duration_s = generator.uniform(0.0, 1e4)
        assert seconds(ticks_for(duration_s)) >= duration_s - 1e-9
