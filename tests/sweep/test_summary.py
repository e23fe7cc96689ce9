"""The summary says what rows have: as words on one screen, and as JSON."""

from __future__ import annotations

import json

from elitescript.records import replace
from elitescript.sweep.plans.plan import Disturbance
from elitescript.sweep.results.summary import summary_of
from elitescript.sweep.results.totals import KINDS_MAX, Totals
from tests.sweep.made import row, swept

TIMES = "\N{MULTIPLICATION SIGN}"


def test_all_hold():
    totals = swept(200, lambda run, v, chance: row(run, v, time_s=chance.gauss(10, 1), margins=(0.1 + run / 1000,)))
    lines = summary_of(totals).lines()
    assert lines[0] == "all 200 runs hold; the probability to fail is below 1.5 % (95 %)"
    assert lines[1].startswith("cycle time: ")
    assert lines[2:] == ["nearest to failing: run 0, 0.1 left of always(ok)"]


def test_runs_with_warnings_are_counted():
    totals = swept(20, lambda run, v, _: replace(row(run, v), is_warned=run < 3))
    summary = summary_of(totals, is_random=False)
    assert summary.lines()[0] == "all 20 runs hold; 3 runs found warnings"
    assert summary.as_json()["warned"] == 3
    one = summary_of(swept(1, lambda run, v, _: replace(row(run, v), is_warned=True)), is_random=False)
    assert one.lines()[0] == "the run holds, but has warnings"


def test_one_run_is_told_as_one():
    assert summary_of(swept(1, lambda run, v, _: row(run, v))).lines()[0].startswith("the run holds")


def test_an_equality_that_holds_is_never_near_to_failing():
    lines = summary_of(swept(20, lambda run, v, _: row(run, v, margins=(0.0,)))).lines()
    assert not any(line.startswith("nearest") for line in lines)


def test_a_grid_is_no_estimate():
    summary = summary_of(swept(100, lambda run, v, _: row(run, v)), is_random=False)
    assert summary.interval is None
    assert summary.lines() == ["all 100 runs hold", "cycle time: 10 s in each run"]


def test_failures_are_told_by_kind_with_region_and_first_runs():
    def made(run, v, _):
        bad = v["part_x"] > 0.6
        drop = (Disturbance("drop", "gripper", 3.2),) if bad else ()
        return row(run, v, "always(ok)" if bad else "", disturbances=drop, line=40 if bad else 0, text="it\nwaits")

    totals = swept(300, made)
    lines = summary_of(totals).lines()
    assert lines[0].startswith(f"{300 - totals.failed} of 300 runs hold, {totals.failed} fail (")
    start = lines.index(f"{totals.failed} failures of 1 kind:")
    first = ", ".join(str(kept.choices.run) for kept in next(iter(totals.groups.values())).rows[:5])
    assert lines[start + 1] == f"  {totals.failed}{TIMES} always(ok) in line 40, after drop (runs {first}, ...)"
    assert lines[start + 2] == "     it waits"
    assert lines[start + 3].startswith("     with ")
    assert f"{totals.failed} of {totals.failed} runs fail so, 0 of {300 - totals.failed} elsewhere" in lines[start + 3]
    assert any(line.startswith("  failing: 100 % of runs where part_x >= ") for line in lines)


def test_states_and_measures_that_are_no_numbers_are_counted():
    def made(run, v, _):
        state = "time_limit" if run % 10 == 0 else "finished"
        measures = {"peak": float(run), "kind": "round" if run % 4 else None, "held": run % 2 == 0}
        return row(run, v, state=state, measures=measures)

    lines = summary_of(swept(100, made, measures=("peak", "kind", "held"))).lines()
    assert lines[1] == "ended: 90 finished, 10 time_limit"
    assert lines[3:6] == [
        "peak: 0 to 99, median 49, 95 % at most 94",
        f"kind: round 75{TIMES}",
        f"held: false 50{TIMES}, true 50{TIMES}",
    ]


def test_many_kinds_stay_on_one_screen_and_are_all_counted():
    totals = swept(2000, lambda run, v, _: row(run, v, "always(ok)", line=run + 1))
    summary = summary_of(totals)
    assert len(summary.kinds) == KINDS_MAX and summary.other_kinds == 2000 - KINDS_MAX
    assert len(summary.lines()) < 40
    assert f"  1,995{TIMES} of other kinds" in summary.lines()


def test_json_is_json_and_has_everything():
    def made(run, v, chance):
        return row(
            run, v, "always(ok)" if v["part_x"] > 0.6 else "", chance.gauss(9, 1), margins=(0.6 - v["part_x"],),
            measures={"peak": float("inf") if run == 3 else 1.0},
        )  # fmt: skip

    found = json.loads(json.dumps(summary_of(swept(300, made, measures=("peak",))).as_json(), allow_nan=False))
    assert found["runs"] == 300 and found["hold"] + found["failed"] == 300
    assert found["measures"]["peak"] == {
        **dict.fromkeys(("least", "p05", "p25", "median", "p75", "p95", "most", "mean"), 1.0),
        "count": 299,
        "error": 2.0**-41,
        "others": 1,
    }
    assert found["properties"][0]["failed"] == found["failed"]
    assert found["properties"][0]["worst"]["margin"] < 0 < found["properties"][0]["nearest"]["margin"]
    assert found["failures"][0]["region"]["conditions"][0]["of"] == "part_x"
    assert found["effects"][0]["outcome"] == "failing"
    assert set(found["time_s"]) == {"finished"}


def test_no_run_is_no_summary_but_a_line():
    assert summary_of(Totals((), ())).lines() == ["no run"]


def test_one_mistake_that_many_disturbances_show_is_one_kind():
    def made(run, v, _):
        kind = ("drop", "silence", "drop", "")[run % 4]
        other = (Disturbance(kind, 5020, 1.0),) if kind else ()
        return row(
            run,
            v,
            "never_stuck" if kind else "",
            disturbances=other,
            state="time_limit" if kind else "finished",
            line=36,
        )

    (kind,) = summary_of(swept(400, made)).kinds
    assert kind.title() == f"never_stuck: time_limit in line 36, after drop 200{TIMES}, silence 100{TIMES}"
    assert (kind.count, kind.after) == (300, {"drop": 200, "silence": 100})
    assert [entry.choices.run for entry in kind.rows] == [0, 1, 2, 4, 5, 6, 8, 9, 10, 12]


def test_the_rows_that_a_page_keeps_change_nothing(monkeypatch):
    for module in ("effects", "summary"):
        monkeypatch.setattr(f"elitescript.sweep.results.{module}.SAMPLE", 512)

    def made(run, v, chance):
        return row(run, v, "always(ok)" if v["part_x"] > 0.6 else "", chance.gauss(9, 1))

    few = summary_of(swept(900, made, sample=512))
    many = summary_of(swept(900, made, sample=5_000))
    assert few.sampled < 900
    assert few.lines() == many.lines()
    assert few.sampled == many.sampled
