"""How refused requests are told."""

from __future__ import annotations

from typing import get_args

import pytest

from elitescript.controller.refusals import ACTIONS, refusal_text
from elitescript.errors import ArgumentRangeError, ScriptStateError, UsageError
from elitescript.messages import machine
from elitescript.messages.machine import AskSafety, MachineRequest, SetSpeedScale, WriteSignal


def test_every_request_has_words():
    assert set(ACTIONS) == set(get_args(MachineRequest))


@pytest.mark.parametrize(
    ("request_made", "error", "text"),
    [
        (
            WriteSignal("standard_analog_in", 1, 11.0),
            ArgumentRangeError("standard_analog_in[1] must be in [0, 10] V, got 11"),
            "cannot set standard_analog_in[1] to 11.0: standard_analog_in[1] must be in [0, 10] V, got 11",
        ),
        (SetSpeedScale(2.0), UsageError("too fast"), "cannot set the speed to 2: too fast"),
        (
            AskSafety("unlock_protective_stop"),
            ScriptStateError("cannot unlock protective stop: too early", hint="look for its cause first"),
            "cannot unlock protective stop: too early; look for its cause first",
        ),
    ],
)
def test_a_refusal_names_action_reason_and_remedy(request_made: MachineRequest, error: Exception, text: str):
    assert refusal_text(request_made, error) == text


def test_no_class_name_is_among_the_words():
    names = [kind.__name__ for kind in get_args(MachineRequest)]
    assert not any(name in words for name in names for words in ACTIONS.values())
    assert all(hasattr(machine, name) for name in names)
