"""Pages of single runs beside the page of a sweep."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.cli.main import main
from elitescript.outputs.writing import Output
from elitescript.sweep.chaos.properties import properties_of
from elitescript.sweep.failures.findings import Finding
from elitescript.sweep.plans.plan import Plan, Row
from elitescript.sweep.plans.variations import parse_variation
from elitescript.sweep.results.replays import REPLAYS_MAX, replay_of, write_pages
from elitescript.sweep.results.summary import summary_of
from elitescript.sweep.results.totals import Totals
from elitescript.sweep.single import Runner
from tests.plotting.front_end import pretend_built, pretend_not_built, recordings_of

PROGRAM = """def job():
  global x
  x = 0.5
  movej([x, -1.5, -1.5, -1.6, 1.5, 0])
  if x > 0.8:
    movej([9.9, 0, 0, 0, 0, 0])
  end
end
"""


def swept(runs: int) -> tuple[Runner, Totals]:
    """Run a program whose runs fail where x > 0.8."""
    plan = Plan(
        PROGRAM,
        "job.script",
        variations=(parse_variation("x=uniform(0,1)"),),
        ensure=("no_alarm", "always(q[0] < 0.79)"),
    )
    runner = Runner(plan)
    totals = Totals(plan.variations, properties_of(plan))
    for run in range(runs):
        totals.add(runner.run(runner.choices_of(run)))
    return runner, totals


@pytest.fixture
def built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stand a front end of one line in for the built one."""
    pretend_built(tmp_path, monkeypatch)


@pytest.mark.usefixtures("built")
def test_failing_runs_and_the_nearest_have_pages_that_show_their_run(tmp_path: Path) -> None:
    runner, totals = swept(30)
    group = next(iter(totals.groups.values()))
    first = group.rows[0]
    smallest = first.choices
    assert first.failure is not None
    finding = Finding(first, first.failure, smallest, 3, None, Path("CASE one.toml"))
    target = tmp_path / "out.html"
    said: list[str] = []
    write_pages(
        Output(target), runner, totals, summary_of(totals), [finding], "elitescript sweep job.script", said.append
    )
    pages = sorted(path.name for path in (tmp_path / "out.replays").iterdir())
    runs = [row.choices.run for group in totals.groups.values() for row in group.rows[:3]]
    nearest = [entry.run for entry in totals.nearest if entry is not None]
    assert nearest
    wanted = {f"run-{run}.html" for run in (*runs, *nearest)} | {f"run-{first.choices.run}-smallest.html"}
    assert set(pages) == wanted
    assert len(said) == len(pages) <= REPLAYS_MAX + 1
    for row in group.rows[:3]:
        (found,) = recordings_of(tmp_path / "out.replays" / f"run-{row.choices.run}.html")
        tick_s = found["columns"]["tick"][-1] * 0.004
        assert tick_s == pytest.approx(row.time_s, abs=0.005)
        # The arm stands where this run alone has sent it.
        assert any(abs(q[-1] - row.choices.values["x"]) < 1e-3 for q in found["columns"].values() if q)


@pytest.mark.usefixtures("built")
def test_a_replay_is_the_run_of_its_number() -> None:
    runner, totals = swept(12)
    row = next(iter(totals.groups.values())).rows[0]
    found = replay_of(runner, row.choices, "title of it")
    assert "<title>title of it</title>" in found


def test_without_the_front_end_it_is_refused_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pretend_not_built(tmp_path, monkeypatch)
    (tmp_path / "job.script").write_text(PROGRAM)
    assert main(["sweep", str(tmp_path / "job.script"), "--page", "x.html"]) == 2
    assert "make studio" in capsys.readouterr().err


def test_a_replay_that_cannot_be_written_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pretend_built(tmp_path, monkeypatch)
    runner, totals = swept(12)
    (tmp_path / "x.replays").mkdir()
    for number in range(12):
        (tmp_path / "x.replays" / f"run-{number}.html").mkdir()
    output = Output(tmp_path / "x.html", "--page x.html")
    with pytest.raises(OSError, match=r"--page x\.html: .*run-\d+\.html: it is a folder, not a file"):
        write_pages(output, runner, totals, summary_of(totals), [], "", lambda _: None)


@pytest.mark.parametrize("words", [["--only", "7", "--out", "x.csv"], ["--only", "100"], ["--only", "-1"]])
def test_only_takes_one_run_of_the_sweep(tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str]) -> None:
    (tmp_path / "job.script").write_text(PROGRAM)
    assert main(["sweep", str(tmp_path / "job.script"), "--runs", "100", *words]) == 2
    assert "--only" in capsys.readouterr().err


@pytest.mark.usefixtures("built")
def test_one_run_alone_is_that_of_the_sweep_and_has_its_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("job.script").write_text(PROGRAM)
    _, totals = swept(12)
    row: Row = next(iter(totals.groups.values())).rows[0]
    number = row.choices.run
    call = ["sweep", "job.script", "--vary", "x=uniform(0,1)", "--ensure", "no_alarm", "--jobs", "1", "--no-cases"]
    assert main([*call, "--only", str(number), "--page", "one.html", "--json"]) == 1
    out = capsys.readouterr().out.splitlines()
    assert f'"run":{number}' in out[0].replace(" ", "") and row.digest in out[0]
    assert len([line for line in out if '"row"' in line]) == 1
    assert (tmp_path / "one.replays" / f"run-{number}.html").is_file()
