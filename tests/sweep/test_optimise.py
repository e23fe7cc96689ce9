"""A search for values: the same for any engine, better than chance, and honest about what holds."""

from __future__ import annotations

import json
import random
import shlex
from collections.abc import Sequence
from pathlib import Path
from statistics import mean

import pytest

from elitescript.cli.main import main
from elitescript.errors import UsageError
from elitescript.sweep.engines.local import LocalEngine
from elitescript.sweep.optimise import BATCH, Candidate, Outcome, Search, check_search, optimise, rounded
from elitescript.sweep.plans.plan import Choices, Failure, Plan, Row, Variation
from elitescript.sweep.plans.variations import parse_variation

pytest.importorskip("optuna", reason="extra `optimise`")

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = """\
def cell():
  global cost
  A = 1.0
  B = 0.0
  MODE = "slow"
  if MODE == "slow":
    cost = 5
  else:
    cost = 0
  end
  cost = cost + (A - 2.2) * (A - 2.2) + B * B
end
"""
OVER = tuple(
    parse_variation(text, "--over")
    for text in ("A=uniform(0.5, 3)", "B=grid(-2, 2, 9)", "MODE=choice('slow', 'fast', 'slow')")
)
PLAN = Plan(PROGRAM, seed=1)


class Formula:
    """An engine whose runs are a formula: 5 for the wrong mode, and squares; A above `limit` fails by so much."""

    def __init__(self, limit: float = 9.0, has_margin: bool = True) -> None:
        self.limit = limit
        self.has_margin = has_margin
        self.asked: list[int] = []

    def rows_of(self, plan: Plan, choices: Sequence[Choices]) -> list[Row]:
        self.asked.append(len(choices))
        return [self._row(one) for one in choices]

    def _row(self, choices: Choices) -> Row:
        a, b, mode = (choices.values.get(name, plain) for name, plain in (("A", 1.0), ("B", 0.0), ("MODE", "slow")))
        assert isinstance(a, float)
        assert isinstance(b, int | float)
        cost = (a - 2.2) ** 2 + b * b + (0 if mode == "fast" else 5)
        margin = self.limit - a
        failure = Failure("a < limit", "finished") if margin < 0 else None
        return Row(
            choices, "finished", 1.0, {"objective": cost}, f"{a} {b} {mode}", failure,
            (margin if self.has_margin else None,),
        )  # fmt: skip


def found(engine: object, runs: int = 80, seed: int = 1, **settings: object) -> Outcome:
    plan = Plan(PROGRAM, seed=seed)
    return optimise(Search(plan, OVER, "globals['cost']", runs=runs, **settings), engine)  # type: ignore[arg-type]


def best(outcome: Outcome) -> Candidate:
    assert outcome.best is not None
    return outcome.best


def test_the_best_values_are_found():
    outcome = found(Formula())
    assert len(outcome.candidates) == 80
    assert [candidate.number for candidate in outcome.candidates] == list(range(80))
    assert outcome.plain.objective == pytest.approx(1.44 + 5)
    values = best(outcome).values
    assert values["A"] == pytest.approx(2.2, abs=0.02)
    assert (values["B"], values["MODE"]) == (0, "fast")


def test_the_same_seed_asks_the_same_and_another_one_something_else():
    first = [candidate.values for candidate in found(Formula(), 20).candidates]
    assert [candidate.values for candidate in found(Formula(), 20).candidates] == first
    assert [candidate.values for candidate in found(Formula(), 20, seed=2).candidates] != first


def test_candidates_are_asked_for_in_batches_of_one_size():
    engine = Formula()
    found(engine, 40)
    # The plain program, the batches, and what comes of steps from the best one.
    assert engine.asked[:4] == [1, BATCH, BATCH, BATCH]


@pytest.mark.parametrize("has_margin", [True, False])
def test_what_does_not_hold_is_never_the_best(has_margin: bool):
    outcome = found(Formula(limit=1.5, has_margin=has_margin))
    assert best(outcome).values["A"] == pytest.approx(1.5, abs=0.03)
    assert best(outcome).values["A"] <= 1.5
    assert any(candidate.failed == "a < limit" for candidate in outcome.candidates)
    (change,) = [change for change in outcome.changes if change.name == "A"]
    assert change.high is not None
    assert change.high.failed == "a < limit"
    assert change.low is not None
    assert change.low.holds


def test_if_nothing_holds_there_is_no_best():
    outcome = found(Formula(limit=0.0), 20)
    assert outcome.best is None
    assert outcome.changes == ()
    assert len(outcome.candidates) == 20


def test_a_search_is_better_than_as_many_runs_at_random():
    engine = Formula()

    def chance(seed: int) -> float:
        draw = random.Random(seed)
        choices = []
        for run in range(60):
            values = {"A": draw.uniform(0.5, 3), "B": draw.randint(-4, 4) / 2, "MODE": draw.choice(OVER[2].arguments)}
            choices.append(Choices(run, 0, values))
        return min(float(row.measures["objective"]) for row in engine.rows_of(PLAN, choices))  # type: ignore[arg-type]

    at_random = mean(chance(seed) for seed in range(20))
    searched = [best(found(engine, 60, seed)).objective for seed in range(3)]
    assert all(cost is not None and cost < at_random / 2 for cost in searched)


def test_either_number_of_processes_finds_the_same():
    def values(jobs: int) -> list[object]:
        with LocalEngine(jobs) as engine:
            outcome = found(engine, 12)
        return [outcome.plain, outcome.best, outcome.candidates, outcome.changes]

    assert values(1) == values(2)


def test_candidates_are_run_with_the_same_variations():
    plan = Plan(PROGRAM, seed=1, variations=(Variation("C", "uniform", (0.0, 1.0)),))

    class Noting(Formula):
        def rows_of(self, plan: Plan, choices: Sequence[Choices]) -> list[Row]:
            seen.extend((one.seed, one.values["C"]) for one in choices)
            return super().rows_of(plan, choices)

    seen: list[tuple[int, object]] = []
    plan = Plan(PROGRAM.replace("B * B", "B * B * C"), seed=1, variations=plan.variations, settings=("C=0",))
    search = Search(plan, OVER, "globals['cost']", runs=12, repeats=3)
    outcome = optimise(search, Noting())  # type: ignore[arg-type]
    assert len(outcome.candidates) == 4
    assert len(set(seen[:3])) == 3
    assert all(seen[at] == seen[at % 3] for at in range(len(seen)))
    numbers = [row.choices.run for candidate in outcome.candidates for row in candidate.rows]
    assert numbers == list(range(12))


@pytest.mark.parametrize(
    ("over", "settings", "text"),
    [
        ((), {}, "--over"),
        ((Variation("A", "normal", (0, 1)),), {}, "normal has no ends"),
        (OVER, {"repeats": 0}, "--repeat 0"),
        (OVER, {"repeats": 101}, "from 1 to --runs, 100"),
        ((Variation("AA", "uniform", (0, 1)),), {}, "the program has no such name"),
        ((OVER[0], OVER[0]), {}, f"--over {OVER[0].name}: it is chosen twice"),
        ((Variation("A", "grid", (0, 1, 10**9)),), {}, "1000000000 points"),
    ],
)
def test_what_cannot_be_searched_is_refused(over: tuple[Variation, ...], settings: dict[str, int], text: str):
    with pytest.raises(UsageError, match=text):
        check_search(Search(PLAN, over, "time_s", **settings))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("low", "high", "value", "near"),
    [(0, 1, 0.123456, 0.123), (0.5, 3, 1.23456, 1.235), (0, 250, 123.456, 123.5), (0, 0.01, 0.00123456, 0.00123)],
)
def test_values_have_few_digits(low: float, high: float, value: float, near: float):
    assert rounded(Variation("a", "uniform", (low, high)), value) == near


def test_rounded_values_stay_in_their_range():
    assert rounded(Variation("a", "uniform", (0.12344, 1.0)), 0.12344) == 0.12344
    assert rounded(Variation("a", "uniform", (2.0, 2.0)), 2.0) == 2.0


@pytest.mark.slow
def test_the_page_shows_what_is_found(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    page = (ROOT / "docs/how-to/optimise.md").read_text(encoding="utf-8")
    command, _, shown = page.partition("```console\n$ ")[2].partition("```")[0].partition("\n")
    monkeypatch.chdir(ROOT)
    assert main(shlex.split(command)[1:]) == 0
    assert capsys.readouterr().out == shown


def test_a_search_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    Path("cell.script").write_text(PROGRAM)
    call = ["sweep", "cell.script", "--minimise", "globals['cost']", "--runs", "9", "--jobs", "1"]
    over = ["--over", "A=uniform(0.5, 3)", "MODE=choice('slow', 'fast')"]
    assert main([*call, *over, "--json", "--out", "rows.csv"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["type"] for line in lines] == ["candidate"] * 9 + ["summary"]
    assert lines[-1]["baseline"]["objective"] == pytest.approx(6.44)
    assert lines[-1]["best"]["objective"] == min(line["objective"] for line in lines[:-1])
    rows = Path("rows.csv").read_text().splitlines()
    assert rows[0].startswith("run,seed,A,MODE,state,time_s,objective,")
    assert len(rows) == 10
    # Nothing holds.
    assert main([*call, *over, "--ensure", "globals['cost'] < -1"]) == 1
    assert "no candidate holds" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--minimise", "time_s", "--maximise", "time_s", "--over", "A=uniform(0, 1)"], "name one measure only"),
        (["--minimise", "time_s"], "--over"),
        (["--over", "A=uniform(0, 1)"], "--over goes with --minimise"),
        (["--repeat", "3"], "--repeat goes with --minimise"),
        (["--minimise", "time", "--over", "A=uniform(0, 1)"], "time_s"),
        (["--minimise", "time_s", "--page", "x.html"], "--page is of a sweep"),
        (["--minimise", "time_s", "--only", "0"], "--only is of a sweep"),
        (["--mixed"], "--mixed goes with --dask"),
        (["--dask", "tcp://h:1", "--jobs", "2"], "--jobs is for this computer"),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], text: str
):
    program = tmp_path / "cell.script"
    program.write_text(PROGRAM)
    assert main(["sweep", str(program), *words]) == 2
    assert text in capsys.readouterr().err
