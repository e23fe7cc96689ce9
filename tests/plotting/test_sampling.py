"""Rows of long runs: fewer, but every stretch of a line from its first period on."""

import pytest

from elitescript.plotting.line_times import line_times
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot

PROGRAM = """def job():
  for i in range(20):
    movej([0.1, -1.5, -1.5, -1.6, 1.5, 0], a=3, v=2)
    sleep(0.5)
    movej([0.0, -1.5, -1.5, -1.6, 1.5, 0], a=3, v=2)
  end
end
"""


def sampled(rows_max):
    sampling = Sampling(rows_max)
    VirtualRobot("CS66").run(PROGRAM, trace=sampling)
    return sampling


def test_a_short_run_has_the_rows_of_its_trace():
    sampling = sampled(1_000_000)
    assert sampling.step_s == 0.004
    assert sampling.rows == VirtualRobot("CS66").run(PROGRAM, trace=True).trace


@pytest.mark.parametrize("rows_max", [300, 500, 1500])
def test_a_long_run_is_thinned_and_its_line_times_stay_exact(rows_max):
    whole, thin = sampled(1_000_000), sampled(rows_max)
    assert len(thin.rows) <= rows_max
    assert thin.step_s > 0.004
    assert set(thin.rows) <= set(whole.rows)
    assert (thin.rows[0], thin.rows[-1]) == (whole.rows[0], whole.rows[-1])
    times = [row.t for row in thin.rows]
    assert times == sorted(set(times))
    for a, b in zip(line_times(thin.rows), line_times(whole.rows), strict=True):
        assert (a.line, a.visits) == (b.line, b.visits)
        assert a.moving_s + a.standing_s == pytest.approx(b.moving_s + b.standing_s, abs=0.009)
