"""Shrinking finds the culprit among disturbances, and the simplest numbers that still fail, with few runs."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from elitescript.errors import UsageError
from elitescript.records import replace
from elitescript.sweep.failures.shrinking import Shrinking, Shrunk, is_same, shrink
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure

NOISE = tuple(Disturbance("pause", at_s=0.5 * at, for_s=1.0) for at in range(12))


def shrunk(still_fails: Callable[[Choices], bool], *disturbances: Disturbance, **more: object) -> Shrunk:
    choices = Choices(17, 5, more.pop("values", {}), disturbances)  # type: ignore[arg-type]
    return shrink(choices, still_fails, **more)  # type: ignore[arg-type]


def test_a_run_that_fails_by_itself_keeps_nothing() -> None:
    assert shrunk(lambda choices: True, *NOISE) == (Choices(17, 5), 1, True)


def test_one_culprit_among_many_takes_few_runs() -> None:
    culprit = Disturbance("protective_stop", at_s=0.0)
    found = shrunk(lambda choices: culprit in choices.disturbances, *NOISE[:6], culprit, *NOISE[6:])
    assert found.choices.disturbances == (culprit,)
    assert found.runs <= 12


def test_two_that_fail_together_are_both_kept() -> None:
    first, last = Disturbance("protective_stop", at_s=0.0), Disturbance("pause", at_s=0.0, for_s=0.1)

    def fails(choices: Choices) -> bool:
        return first in choices.disturbances and last in choices.disturbances

    found = shrunk(fails, first, *NOISE[1:], last)
    assert found.choices.disturbances == (first, last)
    assert found.is_complete


def test_numbers_go_to_the_least_that_fails_in_few_digits() -> None:
    def still_fails(choices: Choices) -> bool:
        item = choices.disturbances[0] if choices.disturbances else None
        return item is not None and item.at_s >= 3.2 and (item.for_s or 99.0) >= 2.313

    found = shrunk(still_fails, Disturbance("pause", at_s=41.416, for_s=7.772))
    assert found.choices.disturbances == (Disturbance("pause", at_s=4.0, for_s=3.0),)


def test_a_time_that_must_be_exact_snaps_to_tenths_or_stays() -> None:
    def still_fails(choices: Choices) -> bool:
        return bool(choices.disturbances) and 3.18 <= choices.disturbances[0].at_s <= 3.22

    assert shrunk(still_fails, Disturbance("protective_stop", at_s=3.204)).choices.disturbances[0].at_s == 3.2


def test_kinds_become_simpler() -> None:
    def still_fails(choices: Choices) -> bool:
        return any(
            item.kind in ("drop", "disconnect", "corrupt") and item.settings.get("direction") != "to_device"
            for item in choices.disturbances
        )

    for kind, for_s, settings in (
        ("disconnect", 2.0, {}),
        ("corrupt", None, {"count": 3, "direction": "both"}),
        ("drop", None, {"share": 0.5}),
    ):
        found = shrunk(still_fails, Disturbance(kind, 5000, 2.0, for_s, settings))
        assert found.choices.disturbances == (
            Disturbance("drop", 5000, 0.0, None, {"count": 1, "direction": "to_robot"}),
        )


@pytest.mark.parametrize("kind", ["silence", "drop"])
def test_one_message_of_several_that_are_lost_is_found(kind: str) -> None:
    def still_fails(choices: Choices) -> bool:
        # The first message from 0 s on does not matter, the second does.
        item = choices.disturbances[0] if choices.disturbances else None
        return item is not None and (
            item.for_s is not None or {"nth": 2}.items() <= item.settings.items() or (item.settings["count"] > 1)
        )

    settings = {"count": 3} if kind == "drop" else {}
    found = shrunk(still_fails, Disturbance(kind, 5000, 2.0, 1.0 if kind == "silence" else None, settings))
    ((kind, settings),) = [(item.kind, dict(item.settings)) for item in found.choices.disturbances]
    assert (kind, settings.pop("direction"), settings) == ("drop", "to_robot", {"count": 1, "nth": 2})


def test_a_fault_of_an_input_becomes_a_level() -> None:
    def still_fails(choices: Choices) -> bool:
        return any(
            item.kind == "noisy" or (item.kind == "stuck" and item.settings.get("value") is True)
            for item in choices.disturbances
        )

    noisy = Disturbance("noisy", "standard_digital_in[3]", 2.0, None, {"rate_hz": 12.3})
    expected = Disturbance("stuck", "standard_digital_in[3]", 0.0, 0.1, {"value": True})
    assert shrunk(still_fails, noisy).choices.disturbances == (expected,)


def test_varied_values_go_towards_the_plain_ones() -> None:
    def still_fails(choices: Choices) -> bool:
        return float(choices.values["x"]) > 0.437 and choices.values["mode"] in ("a", "b")

    found = shrunk(
        still_fails,
        values={"x": 0.4813924, "y": 3.7, "mode": "b"},
        plain={"x": 0.4, "y": 1.0, "mode": "a"},
    )
    assert found.choices.values == {"x": 0.44, "y": 1.0, "mode": "a"}


def test_what_is_refused_does_not_fail() -> None:
    def still_fails(choices: Choices) -> bool:
        if any(item.kind == "drop" for item in choices.disturbances):
            raise UsageError("on: nothing is there")
        return bool(choices.disturbances)

    found = shrunk(still_fails, Disturbance("disconnect", 5000, 0.0, 0.1))
    assert [item.kind for item in found.choices.disturbances] == ["disconnect"]


def test_candidates_that_make_no_sense_are_never_run() -> None:
    seen: list[Disturbance] = []

    def still_fails(choices: Choices) -> bool:
        seen.extend(choices.disturbances)
        return bool(choices.disturbances)

    bouncing = Disturbance("bouncing", "standard_digital_in[3]", 1.0, 2.0, {"settle_s": 0.1, "bounces": 4})
    shrunk(still_fails, bouncing)
    for item in seen:
        if item.kind == "bouncing":
            assert item.settings["settle_s"] >= 0.008 * item.settings["bounces"]


def test_the_budget_is_kept_and_the_best_so_far_returned() -> None:
    calls: list[Choices] = []

    def still_fails(choices: Choices) -> bool:
        calls.append(choices)
        return NOISE[3] in choices.disturbances and NOISE[9] in choices.disturbances

    found = shrunk(still_fails, *NOISE, budget=10)
    assert (len(calls), found.runs, found.is_complete) == (10, 10, False)
    assert still_fails(found.choices)


def test_no_choices_are_run_twice() -> None:
    calls: list[str] = []

    def still_fails(choices: Choices) -> bool:
        calls.append(repr(choices))
        return sum(item.for_s or 0.0 for item in choices.disturbances) > 3.3

    shrunk(still_fails, *NOISE)
    assert len(calls) == len(set(calls))


def test_the_seed_stays() -> None:
    found = shrunk(lambda choices: bool(choices.disturbances), *NOISE).choices
    assert (found.run, found.seed) == (17, 5)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [({}, True), ({"disturbance": "pause", "text": "x", "t": 3.0}, True), ({"line": 9}, False), ({"code": ""}, False)],
)
def test_the_same_failure_has_property_alarm_and_line(changes: dict[str, object], expected: bool) -> None:
    failure = Failure("no_alarm", "alarm", "R101", 12, "drop", "text", 1.0)
    assert is_same(replace(failure, **changes), failure) is expected
    assert not is_same(None, failure)


def fails_late(choices: Choices) -> bool:
    """A pause of 2 s or more that begins after 3 s, with a stop before it and a value above 0.3."""
    kinds = [item.kind for item in choices.disturbances]
    late = [item for item in choices.disturbances if item.kind == "pause" and item.at_s >= 3.2 and item.for_s >= 2.0]
    return bool(late) and "protective_stop" in kinds and choices.values["x"] > 0.3


@pytest.mark.parametrize("width", [1, 2, 3, 7, 100])
@pytest.mark.parametrize("budget", [3, 20, 200])
def test_candidates_that_are_run_beside_each_other_change_nothing(width: int, budget: int) -> None:
    pauses = tuple(Disturbance("pause", at_s=0.7 * at, for_s=1.0 + 0.3 * at) for at in range(9))
    choices = Choices(3, 1, {"x": 0.873}, (*pauses, Disturbance("protective_stop", at_s=1.0)))
    plain = {"x": 0.0}
    one = shrink(choices, fails_late, plain=plain, budget=budget)
    search = Shrinking(choices, plain=plain, budget=budget)
    rounds = 0
    while search.asked:
        rounds += 1
        search.answer({at: fails_late(candidate) for at, candidate in enumerate(search.asked[:width])})
    assert search.result == one
    assert one.runs <= budget
    assert rounds <= one.runs
    if width > 1 and budget == 200:
        assert rounds < 0.8 * one.runs
