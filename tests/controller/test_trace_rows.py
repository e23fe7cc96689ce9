"""Rows of a trace that are kept as numbers: they read as a list of rows does."""

import pickle
from random import Random

import pytest

from elitescript import PlantConfig, VirtualRobot
from elitescript.controller.views.trace import TRACE_COLUMNS, Trace, TraceRow
from elitescript.controller.views.trace_rows import TraceRows
from elitescript.controller.views.trace_signals import SignalLevels
from elitescript.errors import UsageError
from elitescript.kinematics import tcp
from elitescript.robot import TRACE_TICKS_MAX

PROGRAM = """def main():
  set_standard_digital_out(1, True)
  movej([0.2, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  sleep(0.5)
  set_standard_digital_out(1, False)
  movel([0.4, -0.2, 0.4, 3.14, 0, 0], a=1.2, v=0.25)
end
"""


def traced(plant=None):
    """The rows of a program, and the same as a list of rows made one by one."""
    rows = []
    robot = VirtualRobot("CS66", plant=plant)
    kept = robot.run(PROGRAM, trace=True).trace
    VirtualRobot("CS66", plant=plant).run(PROGRAM, trace=Trace(rows.append))
    without = [row._replace(signals=its.signals) for row, its in zip(rows, kept, strict=True)]
    return kept, without


def made(count, **columns):
    chance = Random(3)

    def six():
        return tuple(chance.uniform(-3.0, 3.0) for _ in range(6))

    return [TraceRow(0.004 * k, 1, six(), six(), six(), "playing", **columns) for k in range(count)]


@pytest.mark.parametrize("plant", [None, PlantConfig(lag_s=0.02, noise_rad=1e-5), PlantConfig(noise_rad=1e-5)])
def test_rows_read_as_a_list_of_them_does(plant):
    kept, rows = traced(plant)
    assert len(kept) == len(rows) > 500
    assert kept == rows
    assert rows == kept
    assert list(kept) == rows
    assert [kept[k] for k in range(len(rows))] == rows
    assert [kept[-1 - k] for k in range(len(rows))] == rows[::-1]
    assert kept[3:40:7] == rows[3:40:7]
    assert kept[::-50] == rows[::-50]
    assert list(reversed(kept)) == rows[::-1]
    assert rows[100] in kept
    assert kept.index(rows[100]) == 100
    with pytest.raises(IndexError):
        kept[len(rows)]
    with pytest.raises(IndexError):
        kept[-1 - len(rows)]


def test_rows_that_differ_in_anything_are_not_equal():
    rows = made(3)
    kept = TraceRows(rows)
    for change in ({"t": 9.0}, {"line": 2}, {"q": (0.0,) * 6}, {"state": "paused"}, {"q_actual": (0.0,) * 6}):
        assert kept != TraceRows([*rows[:2], rows[2]._replace(**change)])
    assert kept != rows[:2]
    assert kept != [*rows, rows[0]]
    assert kept == tuple(rows)
    assert kept != "rows"
    assert TraceRows() == []
    assert not TraceRows()


def test_rows_are_joined_with_others_to_a_list():
    rows, others = made(3), made(2)
    kept = TraceRows(rows)
    assert kept + TraceRows(others) == kept + others == rows + others
    assert others + kept == others + rows
    for wrong in (others[0], 3, "text"):
        with pytest.raises(TypeError):
            kept + wrong
        with pytest.raises(TypeError):
            wrong + kept


@pytest.mark.parametrize(
    ("index", "error", "text"),
    [
        (3, IndexError, "there is no row 3 of a trace of 3"),
        (-4, IndexError, "there is no row -4 of a trace of 3"),
        (1.0, TypeError, "'float'"),
        ("q", TypeError, "'str'"),
    ],
)
def test_a_wrong_index_is_an_error_of_the_trace(index, error, text):
    with pytest.raises(error, match=text):
        TraceRows(made(3))[index]


def test_rows_can_be_copied_between_processes():
    kept, rows = traced()
    copy = pickle.loads(pickle.dumps(kept))
    assert copy == rows
    assert repr(copy) == f"<{len(rows)} trace rows from 0 to {rows[-1].t:g} s>"


def test_rows_may_be_read_while_they_grow():
    rows = made(2500)
    kept = TraceRows(rows[:10])
    found = []
    for row in kept:
        found.append(row)
        if len(kept) < len(rows):
            kept.append(rows[len(kept)])
    assert found == rows


def test_a_row_takes_104_bytes_48_more_when_its_pose_is_read_and_one_at_rest_8():
    moving = TraceRows(made(1000))
    poses = sum(len(stretch.poses.tobytes()) for stretch in moving._stretches)
    assert sum(len(part.tobytes()) for part in (moving._times, moving._numbers)) == 104 * 1000
    assert poses == 48 * 1000
    run = VirtualRobot("CS66").run("sleep(40)\n", trace=True)
    assert len(run.trace) > 10_000
    assert len(run.trace._numbers) <= 4 * 18
    assert len({row.q for row in run.trace}) == 1


def test_a_polling_loop_at_rest_keeps_its_numbers_once():
    run = VirtualRobot("CS66").run("for k in range(500):\n  sync()\nend\n", trace=True)
    assert len(run.trace) > 500
    assert len(run.trace._numbers) < 40 * 18


def test_rows_between_two_times_or_every_third_of_them():
    kept, rows = traced()
    assert kept.between(0.1, 0.2) == [row for row in rows if 0.1 <= row.t <= 0.2]
    assert kept.between(0.1, 0.2, 3) == [row for row in rows if 0.1 <= row.t <= 0.2][::3]
    assert kept.between(0.1001, 0.1002) == []
    assert kept.between(-1.0, 99.0) == rows
    with pytest.raises(UsageError, match="every must be at least 1 row, got 0"):
        kept.between(0.0, 1.0, 0)


def test_only_the_rows_that_are_asked_for_are_made(monkeypatch):
    kept, _ = traced()
    made = []
    row_at = TraceRows._row
    monkeypatch.setattr(TraceRows, "_row", lambda self, index: made.append(index) or row_at(self, index))
    assert len(kept.between(0.0, 0.4, 10)) == 11
    assert made == list(range(0, 101, 10))


def test_columns_have_the_numbers_of_the_rows():
    kept, rows = traced()
    assert list(kept.times) == [row.t for row in rows]
    for joint in range(6):
        assert list(kept.column(f"q{joint + 1}")) == [row.q[joint] for row in rows]
        assert list(kept.column(f"qd{joint + 1}")) == [row.qd[joint] for row in rows]
        assert list(kept.column(f"qa{joint + 1}")) == [row.q[joint] for row in rows]
    for place, name in enumerate(("x", "y", "z", "rx", "ry", "rz")):
        assert list(kept.column(name)) == [row.tcp_pose[place] for row in rows]
    assert not kept.has_actual
    with pytest.raises(UsageError, match="no column of numbers 'line'"):
        kept.column("line")


def test_measured_joints_have_columns_too():
    kept, rows = traced(PlantConfig(lag_s=0.02))
    assert kept.has_actual
    assert list(kept.column("qa2")) == [row.q_actual[1] for row in rows]
    mixed = TraceRows([*made(2), *[row._replace(t=1.0 + row.t) for row in made(2, q_actual=(0.5,) * 6)]])
    assert not mixed.has_actual
    assert list(mixed.column("qa1")) == [mixed[0].q[0], mixed[1].q[0], 0.5, 0.5]


def test_stretches_share_line_state_and_signals():
    kept, rows = traced()
    begin = 0
    for part in kept.stretches():
        assert part.begin == begin < part.end
        begin = part.end
        for row in rows[part.begin : part.end]:
            assert (row.line, row.state) == (part.line, part.state)
            assert row.signals is part.signals
    assert begin == len(rows)
    assert len(kept.stretches()) < 20


def thinned(rows):
    """Every second row but the first of those in one line; and the last row."""
    found = []
    line, is_even = -1, True
    for row in rows:
        is_even = row.line != line or not is_even
        line = row.line
        if is_even:
            found.append(row)
    return found if found[-1] is rows[-1] else [*found, rows[-1]]


@pytest.mark.parametrize("seed", range(20))
def test_thin_drops_every_second_row_of_a_line(seed):
    chance = Random(seed)
    low, high = SignalLevels({"flag[0]": False}), SignalLevels({"flag[0]": True})
    rows = [
        row._replace(line=line, signals=signals, q_actual=row.q if chance.random() < 0.1 else None)
        for row, line, signals in zip(
            made(200),
            [line for _ in range(200) for line in [chance.randrange(3)] * chance.randrange(1, 6)],
            [level for _ in range(200) for level in [chance.choice((low, high))] * chance.randrange(1, 4)],
            strict=False,
        )
    ]
    kept = TraceRows(rows)
    for _ in range(4):
        kept.thin()
        rows = thinned(rows)
        assert kept == rows


def test_rows_at_rest_are_thinned_too():
    kept, rows = traced()
    kept.thin()
    assert kept == thinned(rows)


def test_a_long_wait_is_recorded_in_whole():
    run = VirtualRobot("CS66").run(f"sleep({TRACE_TICKS_MAX * 0.004 * 2.5})\n", trace=True)
    assert list(run.trace.times) == [k / 250 for k in range(len(run.trace))]
    assert len(run.trace) > 2 * TRACE_TICKS_MAX


class TestColumns:
    def test_they_are_those_of_the_rows(self):
        rows = VirtualRobot().run(PROGRAM, trace=True).trace
        columns = rows.columns()
        assert list(columns)[:21] == list(TRACE_COLUMNS)
        assert list(columns)[21:] == ["standard_digital_out[1]"]
        assert {len(column) for column in columns.values()} == {len(rows)}
        for number in (0, 17, len(rows) - 1):
            row = rows[number]
            got = [columns[name][number] for name in columns]
            flat = [row.t, row.line, *row.q, *row.qd, *row.tcp_pose, row.state, row.signals["standard_digital_out[1]"]]
            assert got == flat

    def test_measured_joints_where_there_is_a_plant(self):
        rows = VirtualRobot(plant=PlantConfig(lag_s=0.02)).run(PROGRAM, trace=True).trace
        columns = rows.columns()
        assert [columns[f"qa{joint}"][20] for joint in range(1, 7)] == list(rows[20].q_actual)

    def test_none_without_rows(self):
        assert set(map(len, TraceRows().columns().values())) == {0}


def test_poses_are_computed_when_they_are_read(monkeypatch):
    asked = []
    poses_of = tcp.tcp_poses
    monkeypatch.setattr(
        tcp, "tcp_poses", lambda arm, joints, at: asked.append(len(joints)) or poses_of(arm, joints, at)
    )
    kept = VirtualRobot("CS66").run(PROGRAM, trace=True).trace
    assert kept.column("q1")
    assert sum(asked) < 5
    asked.clear()
    assert list(kept.column("z")) == [row.tcp_pose[2] for row in kept]
    moving = sum(asked)
    assert 300 < moving <= len(kept)
    # They are kept then.
    assert kept.column("rx")
    assert sum(asked) == moving


@pytest.mark.parametrize("read", ["x", None])
def test_poses_that_are_read_while_rows_come_are_those_of_the_rows(read):
    rows, growing = traced()[1], TraceRows()

    class Growing(Trace):
        def _take(self, span):
            if read is None and len(growing) % 3:
                assert span.tcp_poses
            growing.add(span)
            if read is not None:
                assert len(growing.column(read)) == len(growing)

    VirtualRobot("CS66").run(PROGRAM, trace=Growing(lambda row: None))
    assert [row.tcp_pose for row in growing] == [row.tcp_pose for row in rows]
    growing.thin()
    assert [row.tcp_pose for row in growing] == [row.tcp_pose for row in rows if row.t in set(growing.times)]
