"""What matters is found, and what is chance is not."""

from __future__ import annotations

from elitescript.sweep.plans.plan import Disturbance
from elitescript.sweep.results.effects import effects_of, regions_of
from tests.sweep.made import row, swept


def test_a_corner_of_the_box_is_found_with_honest_counts():
    totals = swept(1000, lambda run, v, _: row(run, v, "ok" if v["part_x"] > 0.41 and v["part_y"] < -0.2 else ""))
    (region,) = regions_of(totals)
    found = {condition.of: condition for condition in region.conditions}
    assert set(found) == {"part_x", "part_y"}
    assert found["part_x"].relation == ">" and abs(found["part_x"].value - 0.41) < 0.03
    assert found["part_y"].relation == "<=" and abs(found["part_y"].value + 0.2) < 0.03
    values = [kept.values for kept in [*totals.holding_sample, *totals.failing_sample]]
    inside = [v for v in values if v[0] > found["part_x"].value and v[1] <= found["part_y"].value]
    assert region.inside == len(inside)
    assert region.failing == sum(v[0] > 0.41 and v[1] < -0.2 for v in inside)
    assert (region.failing_in_all, region.in_all) == (totals.failed, 1000)
    assert region.p < 1e-6


def test_a_choice_and_a_disturbance_make_a_region():
    def made(run, v, chance):
        drop = (Disturbance("drop", "gripper", 1.0),) if chance.random() < 0.3 else ()
        other = (Disturbance("delay", "gripper", 2.0),) if chance.random() < 0.3 else ()
        bad = bool(drop) and v["speed"] == "fast"
        return row(run, v, "ok" if bad else "", disturbances=(*other, *drop))

    totals = swept(800, made)
    (region,) = regions_of(totals)
    assert {str(condition) for condition in region.conditions} <= {
        "drop on gripper",
        "speed == fast",
        "speed != slow",
    }
    assert len(region.conditions) == 2
    assert region.failing == region.inside == totals.failed


def test_two_kinds_of_failures_have_a_region_each():
    def made(run, v, _):
        if v["part_x"] > 0.8:
            return row(run, v, "ok", line=4)
        return row(run, v, "ok", line=9) if v["idle"] < 0.15 else row(run, v)

    regions = regions_of(swept(1200, made))
    assert [{condition.of for condition in region.conditions} for region in regions] == [{"idle"}, {"part_x"}]


def test_chance_has_no_region_and_no_effect():
    for seed in range(20):
        totals = swept(
            400,
            lambda run, v, chance: row(run, v, "ok" if chance.random() < 0.1 else "", time_s=chance.gauss(10, 1)),
            seed,
        )
        assert regions_of(totals) == ()
        assert effects_of(totals) == ()


def test_effects_name_what_moves_an_outcome_and_which_way():
    def made(run, v, chance):
        time_s = 10 - 2 * v["part_x"] + (1 if v["speed"] == "slow" else 0) + 0.1 * chance.random()
        return row(run, v, "ok" if v["part_y"] > 0.5 else "", time_s=time_s, measures={"peak": v["idle"] ** 2})

    effects = effects_of(swept(600, made, measures=("peak",)))
    assert [(effect.outcome, effect.of) for effect in effects] == [
        ("failing", "part_y"),
        ("time_s", "part_x"),
        ("time_s", "speed"),
        ("peak", "idle"),
    ]
    failing, time, speed, peak = effects
    assert (failing.low, failing.high) == (0.0, 1.0)
    assert time.correlation < -0.8 and time.low > time.high
    assert (speed.lowest, speed.highest) == ("speed == fast", "speed == slow")
    assert 0.9 < speed.high - speed.low < 1.2
    assert peak.correlation > 0.99 and peak.share > 0.95


def test_an_effect_that_neither_rises_nor_falls_is_found():
    totals = swept(600, lambda run, v, _: row(run, v, "ok" if abs(v["part_x"]) < 0.2 else ""))
    (effect,) = effects_of(totals)
    assert effect.of == "part_x" and abs(effect.correlation) < 0.2
    (region,) = regions_of(totals)
    assert {condition.relation for condition in region.conditions} == {"<=", ">"}


def test_times_of_runs_that_were_cut_off_are_no_cycle_times():
    def made(run, v, chance):
        cut = v["part_x"] > 0.5
        return row(
            run,
            v,
            "ok" if cut else "",
            300.0 if cut else chance.gauss(10, 1),
            state="time_limit" if cut else "finished",
        )

    assert {effect.outcome for effect in effects_of(swept(600, made))} == {"failing"}


def test_a_sample_of_many_rows_gives_the_true_shares():
    totals = swept(6000, lambda run, v, _: row(run, v, "ok" if v["part_x"] > 0.98 else ""), sample=1000)
    assert totals.holding_sample.one_in == 8 and totals.failing_sample.one_in == 1
    (effect,) = effects_of(totals)
    edge = float(effect.highest.removeprefix("part_x >= "))
    true = 0.02 / (1.0 - edge)
    assert 0.7 * true < effect.high < 1.4 * true and effect.low == 0.0


def test_the_same_rows_give_the_same_findings_in_any_order():
    rows = []
    swept(500, lambda run, v, _: rows.append(row(run, v, "ok" if v["part_x"] > 0.5 else "")) or rows[-1])
    from elitescript.sweep.results.totals import Totals
    from tests.sweep.made import BOX

    found = []
    for order in (rows, rows[::-1]):
        totals = Totals(BOX, ("always(ok)",))
        for made in order:
            totals.add(made)
        found.append((effects_of(totals), regions_of(totals)))
    assert found[0] == found[1]
