"""Plans, choices and rows through JSON and back; what is none is refused with its place."""

from __future__ import annotations

import json
from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.sweep.plans.plan import Choices, Disturbance, Plan, Variation
from elitescript.sweep.plans.plan_json import choices_data, choices_of, plan_data, plan_digest, plan_of, row_of

PLAN = Plan(
    "def p():\nend\n",
    files={"a.txt": "YQ=="},
    world="[robot]\n",
    python={"cell.py": "x = 1"},
    options={"joints": [0.0, 1, 2, 3, 4, 5]},
    settings=("a=1",),
    variations=(Variation("m", "choice", (1, "a", True, [1, 2])),),
    ensure=("time_s < 1",),
    measures={"m2": "time_s"},
    until_s=5.0,
)


def test_a_plan_comes_back() -> None:
    assert plan_of(json.loads(json.dumps(plan_data(PLAN)))) == PLAN
    assert plan_digest(plan_of(plan_data(PLAN))) == plan_digest(PLAN)
    assert plan_digest(Plan("")) != plan_digest(Plan(" "))


def test_choices_come_back() -> None:
    choices = Choices(3, 2**53 - 1, {"x": 0.1, "y": "é"}, (Disturbance("drop", "tool", 0.5, 1.0, {"nth": 3}),))
    assert choices_of(json.loads(json.dumps(choices_data(choices)))) == choices


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"seed": "1"}, "plan.seed: a whole number is expected, not str '1'"),
        ({"seed": True}, "plan.seed: a whole number"),
        ({"ensure": "time_s"}, "plan.ensure: a list is expected"),
        ({"ensure": [1]}, r"plan.ensure\[0\]: a text is expected"),
        ({"variations": [["a", "uniform"]]}, r"plan.variations\[0\]: name, kind and arguments"),
        ({"sed": 1}, "plan: 'sed' is not known; did you mean 'seed'"),
    ],
)
def test_what_is_no_plan_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        plan_of({**plan_data(PLAN), **change})


def test_a_row_of_an_earlier_version_has_no_warnings() -> None:
    assert row_of([choices_data(Choices(0, 0)), "finished", 1.0, {}, "", None, []]).is_warned is False


def test_what_is_no_row_is_refused() -> None:
    with pytest.raises(UsageError, match="row: a list of 8"):
        row_of([1])
    with pytest.raises(UsageError, match=r"row\.state"):
        row_of([choices_data(Choices(0, 0)), 1, 0.0, {}, "", None, []])
    with pytest.raises(UsageError, match="plan: seed is missing"):
        plan_of({name: value for name, value in plan_data(PLAN).items() if name != "seed"})
