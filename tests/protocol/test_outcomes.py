"""Outcomes as texts of ports."""

from __future__ import annotations

import pytest

from elitescript.messages.outcomes import Done, Outcome, QueryFailed, Refused, RegistersRead, ShownValue
from elitescript.protocol.outcomes import refusal_of, value_text


@pytest.mark.parametrize(
    ("outcome", "refusal", "value"),
    [
        (Done(), None, ""),
        (ShownValue("[1, 2]"), None, "[1, 2]"),
        (RegistersRead((1,)), None, ""),
        (Refused("there is no such file: a: b"), "there is no such file: a: b", ""),
        (Refused(""), "", ""),
        (QueryFailed(is_compiled=True), "the robot answers with QueryFailed", ""),
    ],
)
def test_an_outcome_is_a_refusal_or_a_value(outcome: Outcome, refusal: str | None, value: str) -> None:
    assert (refusal_of(outcome), value_text(outcome)) == (refusal, value)
