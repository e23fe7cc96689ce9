"""`elitescript.sweep.sweep`: many runs from Python."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript import Run
from elitescript.errors import ProgramError, UsageError
from elitescript.sweep import choice, grid, sweep, uniform
from elitescript.sweep.engines.local import LocalEngine

PROGRAM = """\
def cell():
  pause_s = 0.5
  sleep(pause_s)
  textmsg("paused ", get_standard_digital_in(1))
end
"""


def short(run: Run) -> bool:
    return run.time_s < 0.5


def test_functions_are_called_in_this_process(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    result = sweep(
        PROGRAM,
        vary={"pause_s": grid(0.25, 0.75, 3), "standard_digital_in[1]": [True]},
        ensure=[short, lambda run: run.log == ["paused True"]],
        measure={"texts": lambda run: len(run.log), "twice": "2 * time_s"},
        out=out,
    )
    assert not result.holds
    assert len(result) == 3
    assert [row.failed for row in result] == ["", "short", "short"]
    assert [row.choices.run for row in result.failures] == [1, 2]
    assert [record["twice"] for record in result.records()] == [0.504, 1.0, 1.504]
    assert out.read_text().splitlines()[0] == ",".join(result.columns)
    assert "1 of 3 runs hold, 2 fail" in repr(result)
    assert result.play(result.failures[0]).log == ["paused True"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.csv", "out.csv.sweep"]
    with pytest.raises(UsageError, match="what functions compute cannot be compared with what is there"):
        sweep(PROGRAM, ensure=short, out=out, resume=True)


def test_a_finished_table_belongs_to_its_settings(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    arguments = {"vary": {"pause_s": uniform(0, 1)}, "ensure": "time_s < 2", "jobs": 1, "out": out}
    first = sweep(PROGRAM, **arguments, runs=4)
    seen: list[tuple[int, int]] = []
    again = sweep(PROGRAM, **arguments, runs=2, resume=True, on_progress=lambda *counts: seen.append(counts))
    assert [row.digest for row in again] == [row.digest for row in first]
    assert seen == []
    more = sweep(PROGRAM, **arguments, runs=6, resume=True, on_progress=lambda *counts: seen.append(counts))
    assert seen[0][0] > 4
    assert (len(more), len(out.read_text().splitlines())) == (6, 7)
    with pytest.raises(UsageError, match="was made with other settings: --seed 1 now, --seed 0 then"):
        sweep(PROGRAM, **arguments, runs=6, seed=1, resume=True)


def test_rows_are_those_of_processes() -> None:
    arguments = {"vary": {"pause_s": uniform(0, 1)}, "runs": 12, "ensure": "time_s < 2", "seed": 3}
    here = sweep(PROGRAM, **{**arguments, "ensure": ["time_s < 2", lambda run: True]})
    seen: list[tuple[int, int]] = []
    there = sweep(PROGRAM, **arguments, jobs=1, on_progress=lambda *counts: seen.append(counts))
    assert there.holds
    assert [row.digest for row in there] == [row.digest for row in here]
    assert seen[-1] == (12, 0)
    with LocalEngine(1) as engine:
        assert [row.digest for row in sweep(PROGRAM, **arguments, engine=engine)] == [row.digest for row in here]


def test_arguments_that_make_no_sense() -> None:
    with pytest.raises(UsageError, match="functions are called in this process"):
        sweep(PROGRAM, ensure=short, jobs=2)
    with pytest.raises(UsageError, match="neither an expression nor a function"):
        sweep(PROGRAM, ensure=[3])  # type: ignore[list-item]
    with pytest.raises(UsageError, match=r"vary pause_s=uniform\(1\): 1 value given"):
        sweep(PROGRAM, vary={"pause_s": "uniform(1)"})
    with pytest.raises(UsageError, match="max_wall_s must be > 0 s, got 0"):
        sweep(PROGRAM, max_wall_s=0)
    with pytest.raises(UsageError, match="there is no folder nowhere"):
        sweep(PROGRAM, out="nowhere/out.csv")
    with pytest.raises(UsageError, match=r"vary pause_s: .* or a list to choose from, not 3"):
        sweep(PROGRAM, vary={"pause_s": 3})  # type: ignore[dict-item]
    for value in (None, {1: 2}, [object()]):
        with pytest.raises(UsageError, match="is neither a number, a text, true or false, nor a list of them"):
            sweep(PROGRAM, vary={"pause_s": [1, value]})
    with pytest.raises(UsageError, match="resume goes with out"):
        sweep(PROGRAM, resume=True)
    with pytest.raises(TypeError, match="did you mean 'speed'"):
        sweep(PROGRAM, sped=1)
    with pytest.raises(UsageError, match="write it into the world file"):
        sweep(PROGRAM, safety=object())
    with pytest.raises(ProgramError):
        sweep("def p():\n  sleep(\nend\n", vary={"x": choice(1)})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"until_s": "5"}, "until_s must be a number in s, got '5'"),
        ({"until_s": True}, "until_s must be a number in s, got True"),
        ({"step_s": "x"}, "step_s must be a number"),
        ({"max_wall_s": float("nan")}, "max_wall_s must be >= 0 s, got nan"),
        ({"jobs": True}, "jobs must be a whole number >= 1, got True"),
        ({"jobs": 0}, "jobs must be a whole number >= 1, got 0"),
        ({"runs": "2"}, "runs must be a whole number >= 1, got '2'"),
    ],
)
def test_numbers_that_are_none_are_refused_by_their_names(given, words):
    with pytest.raises(UsageError, match=words):
        sweep(PROGRAM, **{"runs": 1, "jobs": 1, **given})
