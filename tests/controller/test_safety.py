"""The safety state machine, generated from its table: every state with every action."""

import itertools

import pytest

from elitescript.controller.safety import states as safety
from elitescript.controller.safety.states import ACTIONS, EFFECTS, MODES, REFUSALS, TRANSITIONS, Safety, SafetyInputs
from elitescript.errors import CODES, ScriptStateError
from elitescript.messages.enums import SafetyMode

LATE = 10_000
EVERY = list(itertools.product(MODES, ACTIONS))


def machine(mode, inputs=None):
    seen = []
    state = Safety(lambda before, after: seen.append((before, after)))
    state.mode = mode
    state.inputs = inputs or SafetyInputs()
    return state, seen


def test_every_state_has_a_row_for_every_action():
    assert set(TRANSITIONS) | set(REFUSALS) == set(EVERY)
    assert not set(TRANSITIONS) & set(REFUSALS)


@pytest.mark.parametrize(("mode", "action"), EVERY)
def test_every_action_leads_where_the_table_says(mode, action):
    inputs = SafetyInputs(safeguard_stop=True)
    state, seen = machine(mode, inputs)
    if (mode, action) in REFUSALS:
        with pytest.raises(ScriptStateError) as caught:
            state.apply(action, LATE)
        assert REFUSALS[mode, action] in str(caught.value)
        assert (state.mode, seen, caught.value.code) == (mode, [], "R115")
        return
    wanted = TRANSITIONS[mode, action]
    wanted = SafetyMode.SAFEGUARD_STOP if wanted is None else wanted
    state.apply(action, LATE)
    assert state.mode is wanted
    assert seen == ([] if wanted is mode else [(mode, wanted)])


@pytest.mark.parametrize(("mode", "action"), EVERY)
def test_nothing_but_an_unlock_a_restart_or_the_end_of_its_cause_leads_out_of_a_stop(mode, action):
    """A stop is never left by accident: whatever else happens, the state is as strong as before, or stronger."""
    ends = {
        "unlock_protective_stop",
        "restart_safety",
        "release_emergency_stop",
        "release_system_stop",
        "close_safeguard",
    }
    if mode in safety.MOVING_MODES or (mode, action) in REFUSALS or action in ends:
        return
    after = TRANSITIONS[mode, action]
    assert after is not None
    assert MODES.index(after) >= MODES.index(mode)


@pytest.mark.parametrize(
    ("inputs", "wanted"),
    [
        (SafetyInputs(), SafetyMode.NORMAL),
        (SafetyInputs(reduced_mode=True), SafetyMode.REDUCED),
        (SafetyInputs(reduced_mode=True, is_outside=True), SafetyMode.RECOVERY),
        (SafetyInputs(safeguard_stop=True, is_outside=True), SafetyMode.SAFEGUARD_STOP),
        (SafetyInputs(system_emergency_stop=True, safeguard_stop=True), SafetyMode.SYSTEM_EMERGENCY_STOP),
        (SafetyInputs(emergency_stop=True, system_emergency_stop=True), SafetyMode.ROBOT_EMERGENCY_STOP),
    ],
)
def test_a_state_without_a_cause_of_its_own_gives_way_to_the_strongest_input(inputs, wanted):
    state, _ = machine(SafetyMode.FAULT, inputs)
    state.apply("restart_safety", 0)
    assert state.mode is wanted


def test_a_protective_stop_is_unlocked_only_after_five_seconds_and_at_standstill():
    state, _ = machine(SafetyMode.NORMAL)
    state.apply("stop_protectively", 100)
    with pytest.raises(ScriptStateError, match=r"5 s after the stop, in 0\.004 s") as caught:
        state.apply("unlock_protective_stop", 100 + 1249)
    assert (caught.value.limit, caught.value.unit) == (">= 5", "s")
    with pytest.raises(ScriptStateError, match="still brakes"):
        state.apply("unlock_protective_stop", 100 + 1250, is_standing=False)
    state.apply("unlock_protective_stop", 100 + 1250)
    assert state.mode is SafetyMode.NORMAL


def test_every_refusal_says_what_to_do():
    words = ("close it", "unlock it", "release it", "restart", "there is no protective stop to unlock")
    for text in REFUSALS.values():
        assert any(word in text for word in words), text


def test_every_state_has_an_effect_and_every_stop_that_ends_a_task_an_alarm():
    assert set(EFFECTS) == set(MODES)
    for mode, effect in EFFECTS.items():
        assert (effect.task == "is stopped") == (effect.code in CODES and effect.class_name != ""), mode
        assert (effect.task == "runs") == (mode in safety.MOVING_MODES)
