"""The line of progress: a bar, the rate, failures, time left; four times a second."""

from __future__ import annotations

import pytest

from elitescript.sweep.results.progress import Meter, duration


def test_the_line_has_share_rate_failures_and_time_left():
    meter = Meter(1000, 10.0)
    assert meter.text(250, 3, 12.0) == (
        "[#####---------------]  25 %  250 of 1,000 runs, 3 fail, 125 runs/s, 6 s left  (Ctrl-C keeps what is there)"
    )
    assert meter.text(300, 3, 12.2) is None
    assert "of 1,000 runs, 125 runs/s" in (meter.text(281, 0, 12.25) or "")


def test_the_rate_is_the_recent_one():
    meter = Meter(100_000, 0.0)
    for second in range(1, 61):
        text = meter.text(second * 1000 if second <= 30 else 30_000 + (second - 30) * 100, 0, float(second))
        if second == 30:
            assert ", 1,000 runs/s" in (text or "")
    assert ", 100 runs/s" in (text or "")


def test_rows_from_an_earlier_sweep_are_no_rate():
    meter = Meter(1000, 0.0, 900)
    assert "90 %  900 of 1,000 runs, 0 runs/s  (" in (meter.text(900, 0, 1.0) or "")
    assert "10 runs/s" in (meter.text(920, 0, 2.0) or "")
    assert "left" not in (meter.text(1000, 0, 3.0) or "")


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.2, "0 s"), (59.4, "59 s"), (61, "1 min 01 s"), (3725, "1 h 02 min"), (90000, "1 d 1 h")],
)
def test_durations_have_two_units(seconds, words):
    assert duration(seconds) == words
