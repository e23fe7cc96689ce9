"""Disturbances are drawn from what there is, the same for the number of a run, with whole kinds on or off."""

from __future__ import annotations

from collections import Counter
from functools import partial
from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.records import replace
from elitescript.sweep.chaos.applying import apply
from elitescript.sweep.chaos.drawing import draw, is_over, time_limit_s
from elitescript.sweep.chaos.ground import Ground
from elitescript.sweep.chaos.profile import profile_named
from elitescript.sweep.plans.plan import Disturbance
from tests.sweep.chaos.cells import source, surveyed, world

RUNS = 150


@pytest.fixture(scope="module")
def ground() -> Ground:
    return surveyed()[0]


def drawn(ground: Ground, name: str, runs: int = RUNS) -> list[tuple[Disturbance, ...]]:
    profile = profile_named(name)
    return [draw(profile, ground, partial(source, 7, run)) for run in range(runs)]


def test_the_world_takes_everything_that_is_drawn(ground: Ground) -> None:
    for disturbances in drawn(ground, "all"):
        apply(VirtualRobot("CS66", world=world()), disturbances)


def test_the_same_run_has_the_same_disturbances(ground: Ground) -> None:
    assert drawn(ground, "all", 20) == drawn(ground, "all", 40)[:20]


def test_every_kind_that_makes_sense_is_drawn(ground: Ground) -> None:
    kinds = {item.kind for disturbances in drawn(ground, "all", 400) for item in disturbances}
    assert kinds == {one.kind for one in ground.chances}


def test_a_run_has_between_none_and_the_most(ground: Ground) -> None:
    counts = Counter(map(len, drawn(ground, "all")))
    assert set(counts) == {0, 1, 2, 3}
    assert min(counts.values()) > RUNS / 8


def test_half_of_the_kinds_are_off_in_a_run(ground: Ground) -> None:
    profile = replace(profile_named("channels"), most=20)
    kinds = [len({item.kind for item in draw(profile, ground, partial(source, 7, run))}) for run in range(100)]
    # All nine would be there in most runs with many disturbances, were none switched off.
    assert max(kinds) < 9
    assert sum(kinds) / len(kinds) < 5


def test_a_further_disturbance_changes_no_other(ground: Ground) -> None:
    class Fixed(Random):
        def __init__(self, count: int) -> None:
            super().__init__(5)
            self.count: float | None = (count + 0.5) / 4

        def random(self) -> float:
            drawn, self.count = self.count, None
            return super().random() if drawn is None else drawn

    def of(count: int) -> set[str]:
        found = draw(
            profile_named("all"),
            ground,
            lambda name: Fixed(count) if name == "chaos" else source(1, 1, name),
        )
        assert len(found) == count
        return {repr(item) for item in found}

    assert of(1) < of(2) < of(3)


def test_people_and_stops_end_and_faults_do_in_some_runs(ground: Ground) -> None:
    items = [item for disturbances in drawn(ground, "all", 300) for item in disturbances]
    people = [item for item in items if item.kind in ("pause", "safeguard_stop", "no_part", "early_press", "slider")]
    assert people
    assert all(item.for_s is not None for item in people)
    stuck = [item for item in items if item.kind in ("stuck", "inverted", "silence", "refuse")]
    assert 0.5 < sum(item.for_s is not None for item in stuck) / len(stuck) < 0.9


def test_most_faults_begin_shortly_before_something_happens(ground: Ground) -> None:
    items = [item for disturbances in drawn(ground, "channels", 300) for item in disturbances]
    moments = next(one.place.moments for one in ground.chances if one.kind == "drop" and one.place)
    near = [item for item in items if any(0.0 <= moment - item.at_s <= 0.06 for moment in moments)]
    assert len(near) / len(items) > 0.6


def test_times_are_whole_control_periods(ground: Ground) -> None:
    for disturbances in drawn(ground, "all"):
        for item in disturbances:
            for time_s in (item.at_s, item.for_s or 0.0):
                assert abs(time_s / 0.004 - round(time_s / 0.004)) < 1e-6


@pytest.mark.parametrize(
    ("disturbance", "expected"),
    [
        (Disturbance("pause", at_s=1.0, for_s=2.0), True),
        (Disturbance("pause", at_s=1.0, for_s=3.5), False),
        (Disturbance("stuck", "standard_digital_in[1]", 1.0), False),
        (Disturbance("drop", 5000, 1.0, None, {"count": 1}), True),
        (Disturbance("drop", 5000, 1.0), False),
        (Disturbance("delay", 5000, 1.0, None, {"count": 2, "delay_s": 1.5}), True),
        (Disturbance("delay", 5000, 1.0, None, {"count": 2, "delay_s": 1.6}), False),
        (Disturbance("late", "standard_digital_in[1]", 1.0, 2.0, {"delay_s": 1.1}), False),
        (Disturbance("protective_stop", at_s=1.0), False),
    ],
)
def test_a_disturbance_is_over_before_a_time(disturbance: Disturbance, expected: bool) -> None:
    assert is_over(disturbance, 4.0) is expected


def test_the_limit_of_time_leaves_room_for_pauses(ground: Ground) -> None:
    plain_s = ground.plain.time_s
    assert time_limit_s(ground, (), None) == pytest.approx(2 * plain_s + 30)
    assert time_limit_s(ground, (Disturbance("pause", at_s=1.0, for_s=7.0),), None) == pytest.approx(2 * plain_s + 37)
    late = Disturbance("delay", 5000, 1.0, None, {"delay_s": 4.0})
    assert time_limit_s(ground, (late,), None) == pytest.approx(2 * plain_s + 30 + 6 * 4.0)  # six messages
    twice = Disturbance("delay", 5000, 1.0, None, {"delay_s": 4.0, "count": 2})
    assert time_limit_s(ground, (twice,), None) == pytest.approx(2 * plain_s + 38)
    assert time_limit_s(ground, (), 5.0) == 5.0
    endless = replace(ground, plain=replace(ground.plain, state="time_limit"))
    assert time_limit_s(endless, (), 20.0) == 20.0
    assert time_limit_s(endless, (), None) == 600.0
