"""The time of every line, and that nothing of it gets lost."""

from itertools import pairwise

import pytest

from elitescript.plotting.line_times import LineStretch, LineTime, ThreadLines, line_times, merged, stretches
from tests.plotting.recordings import recorded, restless, row


def test_stretches_follow_each_other():
    rows = [row(0.0, 3), row(0.004, 3), row(0.008, 5), row(0.012, 3), row(0.016, 0)]
    assert stretches(rows) == [LineStretch(0.0, 0.008, 3), LineStretch(0.008, 0.012, 5), LineStretch(0.012, 0.016, 3)]


def test_time_is_moving_when_a_joint_goes_on_and_standing_when_not():
    rows = [row(0.0, 3, 0.0), row(1.0, 3, 0.1), row(3.0, 3, 0.1), row(3.5, 4, 0.1), row(4.0, 4, 0.1)]
    assert line_times(rows) == [LineTime(3, 1.0, 2.5, 1), LineTime(4, 0.0, 0.5, 1)]


def test_rows_of_single_ticks_show_the_end_of_their_tick():
    rows = [row(0.0, 3, 0.1, 0.1), row(0.004, 3, 0.2, 0.1), row(0.008, 4, 0.2), row(0.012, 4, 0.2)]
    assert line_times(rows) == [LineTime(3, 0.008, 0.0, 1), LineTime(4, 0.0, 0.004, 1)]


@pytest.mark.parametrize("rows", [restless(1234), recorded().rows], ids=["restless", "program"])
def test_line_times_add_up_to_the_duration(rows):
    table = line_times(rows)
    assert sum(entry.moving_s + entry.standing_s for entry in table) == pytest.approx(rows[-1].t - rows[0].t, abs=1e-9)
    assert table == sorted(table, key=lambda entry: (-entry.moving_s - entry.standing_s, entry.line))


def test_the_lines_of_a_program_take_what_they_take():
    times = {entry.line: entry for entry in line_times(recorded().rows)}
    assert times[4].standing_s == pytest.approx(0.5)
    assert times[4].moving_s == 0.0
    assert times[3].moving_s > 0.5


def test_a_single_row_takes_no_time():
    assert stretches([row(0.0, 3)]) == []
    assert line_times([row(0.0, 3)]) == []


@pytest.mark.parametrize("limit", [10, 100, 1000])
def test_merged_stretches_are_few_and_leave_no_gap(limit):
    found = stretches(restless(5000))
    few = merged(found, limit)
    assert len(few) <= limit
    assert (few[0].start_s, few[-1].end_s) == (found[0].start_s, found[-1].end_s)
    assert all(a.end_s == b.start_s for a, b in pairwise(few))


def test_a_long_stretch_among_short_ones_keeps_its_line():
    rows = [row(0.004 * k, 1 + k % 2) for k in range(500)] + [row(2.0, 9), row(6.0, 9), row(6.004, 1)]
    assert any(s.line == 9 and s.end_s - s.start_s > 3.9 for s in merged(stretches(rows), 20))


def test_the_lines_of_a_thread_begin_and_end_with_it():
    lines = ThreadLines()
    lines.record(0.0, [])
    lines.record(1.0, [("camera", 4)])
    lines.record(1.5, [("camera", 4), ("plc", 9)])
    lines.record(2.0, [("camera", 5), ("plc", 9)])
    lines.record(3.0, [("plc", 9)])
    assert lines.stretches(4.0) == {
        "camera": [LineStretch(1.0, 2.0, 4), LineStretch(2.0, 3.0, 5), LineStretch(3.0, 4.0, 0)],
        "plc": [LineStretch(1.5, 4.0, 9)],
    }
