"""The tables of `python -m benchmarks`: what a row shows, and what the comparison of two packages makes of rows."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from benchmarks.__main__ import main
from benchmarks.against import comparison
from benchmarks.measure import ROOT, best_in_turn, environment, least, middle, process_times
from benchmarks.table import Row, Time, as_data, not_installed, timed_row, words


def test_a_row_shows_cpu_beside_wall_in_its_unit_and_the_ratio_of_cpu_times() -> None:
    row = timed_row("a move", Time(wall_s=0.000_3, cpu_s=0.000_15), "us", other=0.000_1, beside="ruckig")
    assert row.cells == ("a move", "150 us", "300 us", "", "100 us (ruckig)", "1.5")


def test_a_simulation_stands_beside_the_robot_with_wall_time() -> None:
    row = timed_row("a program", Time(wall_s=0.5, cpu_s=0.25), "ms", simulated_s=119.0)
    assert row.cells == ("a program", "250 ms", "500 ms", "", "119 s (the robot)", "238 x real time")


def test_a_figure_that_is_no_time_keeps_its_unit() -> None:
    row = Row("memory", "MB", value=37.04, words="at the end", other=18.52, beside="half of it")
    assert row.cells == ("memory", "", "", "37.0 MB, at the end", "18.5 MB (half of it)", "2")


@pytest.mark.parametrize(
    ("value", "shown"), [(1234.5, "1234 MB"), (12.34, "12.3 MB"), (1.234, "1.23 MB"), (0.0123, "0.012 MB")]
)
def test_a_figure_has_three_digits_that_count(value: float, shown: str) -> None:
    assert Row("memory", "MB", value=value).cells[3] == shown


def test_rows_of_words_and_rows_of_what_is_missing() -> None:
    assert words("late", "p50 0.1 ms", "aim: 0.2", "-").cells == ("late", "", "", "p50 0.1 ms", "aim: 0.2", "")
    assert not_installed("eaik").cells == ("compared with eaik", "", "", "", "eaik is not installed", "")


def test_rows_come_back_from_json() -> None:
    row = timed_row("a move", Time(0.3, 0.1), "us", other=0.2, beside="ruckig")
    assert Row(**json.loads(json.dumps(as_data(row)))) == row


def test_a_comparison_has_a_line_for_each_figure_with_least_median_and_both_ratios() -> None:
    old = [[timed_row("a move", Time(wall, cpu), "s")] for wall, cpu in ((9.0, 4.0), (8.0, 6.0), (12.0, 8.0))]
    new = [[timed_row("a move", Time(wall, cpu), "s")] for wall, cpu in ((6.0, 1.0), (3.0, 3.0), (4.0, 5.0))]
    assert comparison(old, new) == [
        ("a move", "CPU", "4.00 s", "6.00 s", "1.00 s", "3.00 s", "0.25", "0.50"),
        ("a move", "wall", "8.00 s", "9.00 s", "3.00 s", "4.00 s", "0.38", "0.44"),
    ]


def test_a_row_that_the_old_package_does_not_have_has_no_ratio() -> None:
    assert comparison([], [[Row("memory", "MB", value=3.0)]]) == [
        ("memory", "", "-", "-", "3.00 MB", "3.00 MB", "-", "-")
    ]


def test_least_and_middle_take_wall_and_cpu_apart() -> None:
    times = [Time(1.0, 30.0), Time(2.0, 10.0), Time(4.0, 20.0)]
    assert least(times) == Time(1.0, 10.0)
    assert middle(times) == Time(2.0, 20.0)


def test_measured_runs_take_turns() -> None:
    ran: list[str] = []
    assert len(best_in_turn([lambda: ran.append("old"), lambda: ran.append("new")], rounds=3)) == 2
    assert ran == ["old", "new"] * 3


def test_measured_processes_have_the_package_of_the_checkout_and_keep_bytecode(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    kept = environment(Path("/other/src"))
    assert kept["PYTHONPATH"].split(os.pathsep)[0] == str(Path("/other/src"))
    assert "PYTHONDONTWRITEBYTECODE" not in kept


@pytest.mark.skipif(sys.platform == "win32", reason="children are measured with resource")
def test_processes_are_measured_with_their_cpu_time() -> None:
    busy = [sys.executable, "-S", "-c", "import time\nwhile time.process_time() < 0.03: pass"]
    (time,) = process_times([busy], rounds=1)
    assert time.cpu_s >= 0.03
    assert time.wall_s >= 0.03


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["nothing"], "no benchmark is called 'nothing'"),
        (["--against", "/nowhere"], "/nowhere has no src/elitescript"),
        (["--rounds", "0"], "--rounds is 0"),
        (["--against", str(ROOT), "--quoted"], "--against prints its own table"),
        (["--against", str(ROOT), "--json"], "--against prints its own table"),
    ],
)
def test_wrong_arguments_are_refused(arguments: list[str], reason: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as refused:
        main(arguments)
    assert refused.value.code == 2
    assert reason in capsys.readouterr().err
