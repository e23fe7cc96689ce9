"""The last minute as rows, in runs that begin anew."""

from __future__ import annotations

import struct

from elitescript.studio.connected.picture import Picture
from elitescript.studio.connected.trail import RUN_S, Trail


def pictures(times_s, **values):
    picture = Picture("here")
    for time_s in times_s:
        picture.take_package({"timestamp": time_s, "actual_joint_positions": (time_s,) * 6, **values})
        yield picture


def rows(frame):
    """Run, first tick, step and number of rows of a frame."""
    _, run, first, step, count = struct.unpack_from("<IIIII", frame)
    return run, first, step, count


def told(trail, times_s):
    return [message for picture in pictures(times_s) for message in trail.take(picture)]


def test_rows_go_together():
    trail = Trail()
    began, *frames = told(trail, [100 + 0.04 * index for index in range(12)])
    assert (began["type"], began["run"]) == ("run_began", 1)
    assert [rows(frame) for frame in frames] == [(1, 0, 10, 5), (1, 50, 10, 5)]
    assert rows(trail.all()[1]) == (1, 0, 10, 12)


def test_a_minute_is_kept():
    trail = Trail()
    told(trail, [0.04 * index for index in range(3000)])
    assert rows(trail.all()[1]) == (1, 15000, 10, 1500)


def test_the_same_moment_twice_is_one_row():
    trail = Trail()
    told(trail, [1.0, 1.0, 1.0, 1.04])
    assert rows(trail.all()[1])[3] == 2


def test_a_restart_and_a_long_gap_begin_anew():
    trail = Trail()
    messages = [
        message for message in told(trail, [50.0, 50.04, 0.0, 0.04, 100.0, 100.04]) if isinstance(message, dict)
    ]
    assert [message["run"] for message in messages] == [1, 2, 3]
    assert rows(trail.all()[1]) == (3, 0, 10, 2)


def test_a_long_day_is_cut_into_runs_with_the_last_minute():
    trail = Trail()
    messages = told(trail, [0.2 * index for index in range(int(RUN_S / 0.2) + 10)])
    (_, first), (at, second) = [(place, m) for place, m in enumerate(messages) if isinstance(m, dict)]
    assert (first["run"], second["run"]) == (1, 2)
    run, first_tick, step, count = rows(messages[at + 1])
    assert (run, step, count) == (2, 50, 1500)
    assert first_tick > 0
