"""Task, power and safety states against tables written by hand: every state with every action.

Names and order of the states, that a protective stop is unlocked and that the safety system is restarted are
documented; what a stop does to the task and to the power, what outranks what, and all times are assumed.
"""

from __future__ import annotations

import pytest

from elitescript.controller import modes, tasks
from elitescript.controller.safety import limits as safety_limits
from elitescript.controller.safety import states as safety
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits
from elitescript.controller.safety.states import Safety, SafetyInputs
from elitescript.errors import ScriptStateError
from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from tests.tables import rows

TASK = """
state     start     pause     resume    stop
STOPPED   PLAYING   -         -         -
PLAYING   -         PAUSED    -         STOPPED
PAUSED    -         -         PLAYING   STOPPED
"""

WHY_NOT_TASK = {
    "STOPPED pause": "cannot pause: no task is running",
    "STOPPED resume": "cannot resume: no task is paused",
    "STOPPED stop": "cannot stop: no task is running",
    "PLAYING start": "cannot start: a task is running; stop it first",
    "PLAYING resume": "cannot resume: the task is not paused",
    "PAUSED start": "cannot start: a task is paused; resume or stop it first",
    "PAUSED pause": "cannot pause: the task is paused already",
}

POWER = """
mode                  power_on   boot      initialise   release_brakes   engage_brakes   power_off
NO_CONTROLLER         -          -         -            -                -               -
DISCONNECTED          -          -         -            -                -               -
CONFIRM_SAFETY        -          -         -            -                -               -
BOOTING               -          -         IDLE         -                -               POWER_OFF
POWER_OFF             POWER_ON   -         -            -                -               -
POWER_ON              -          BOOTING   -            -                -               POWER_OFF
IDLE                  -          -         -            RUNNING          -               POWER_OFF
BACK_DRIVE            -          -         -            -                -               -
RUNNING               -          -         -            -                IDLE            POWER_OFF
UPDATING              -          -         -            -                -               -
WAITING_CALIBRATION   -          -         -            -                -               -
"""

WHY_NOT_READY = {
    "BOOTING": "the arm cannot move: the arm is being switched on",
    "POWER_OFF": "the arm cannot move: the arm is switched off",
    "POWER_ON": "the arm cannot move: the arm is being switched on",
    "IDLE": "the arm cannot move: the brakes are engaged",
    "RUNNING": "",
}

LETTERS = {
    "N": "NORMAL",
    "R": "REDUCED",
    "C": "RECOVERY",
    "G": "SAFEGUARD_STOP",
    "P": "PROTECTIVE_STOP",
    "S": "SYSTEM_EMERGENCY_STOP",
    "E": "ROBOT_EMERGENCY_STOP",
    "V": "VIOLATION",
    "F": "FAULT",
}
"""The weakest state first."""

# `*`: what the inputs ask for at that moment; `-`: refused.
SAFETY = """
press_emergency_stop      E E E E E E E V F
release_emergency_stop    N R C G P S * V F
press_system_stop         S S S S S S E V F
release_system_stop       N R C G P * E V F
open_safeguard            G G G G P S E V F
close_safeguard           N R C * P S E V F
ask_for_reduced           R R C G P S E V F
end_reduced               N * C G P S E V F
find_outside              C C C G P S E V F
come_inside               N R * G P S E V F
stop_protectively         P P P P P S E V F
violate                   V V V V V V V V F
fail                      F F F F F F F F F
restart_safety            * * * * * * * * *
unlock_protective_stop    - - - - * - - - -
power_on                  N R C G P - - - -
move                      N R C - - - - - -
start_task                N R C G - - - - -
resume_task               N R C - - - - - -
"""

WHAT_TO_DO = {
    "N": "the safety mode is NORMAL",
    "R": "the safety mode is REDUCED",
    "C": "the safety mode is RECOVERY",
    "G": "the safeguard is open; close it (signal safeguard_stop to False)",
    "P": "the arm is in protective stop; remove its cause, then unlock it (unlock_protective_stop), "
    "from 5 s after the stop on",
    "S": "the emergency stop of the cell is pressed; release it (signal system_emergency_stop to False), then "
    "power on and release the brakes",
    "E": "the emergency stop is pressed; release it (signal emergency_stop to False), then "
    "power on and release the brakes",
    "V": "a safety limit was violated; restart the safety system (restart_safety), then "
    "power on and release the brakes",
    "F": "the safety system has a fault; restart it (restart_safety), then power on and release the brakes",
}

# What a state does to the task and to the power; alarm of the task.
EFFECTS = """
NORMAL                  runs         power stays   .      .
REDUCED                 runs         power stays   .      .
RECOVERY                runs         power stays   .      .
SAFEGUARD_STOP          is paused    power stays   .      .
PROTECTIVE_STOP         is stopped   power stays   R140   ProtectiveStop
SYSTEM_EMERGENCY_STOP   is stopped   power goes    R141   EmergencyStop
ROBOT_EMERGENCY_STOP    is stopped   power goes    R141   EmergencyStop
VIOLATION               is stopped   power goes    R142   SafetyViolation
FAULT                   is stopped   power goes    R142   SafetyFault
"""

LATE = 10_000


def matrix(text: str) -> dict[tuple[str, str], str]:
    """A table whose first row names the actions."""
    (_, *actions), *lines = rows(text)
    return {(state, action): after for state, *row in lines for action, after in zip(actions, row, strict=True)}


def safety_cells() -> list[tuple[str, str, str]]:
    return [
        (letter, action, after)
        for action, line in rows(SAFETY)
        for letter, after in zip(LETTERS, line.split(" "), strict=True)
    ]


@pytest.mark.parametrize(("cell", "after"), matrix(TASK).items())
def test_task(cell: tuple[str, str], after: str) -> None:
    state, action = cell
    seen: list[tuple[str, str]] = []
    task = tasks.Task(lambda old, new: seen.append((old.name, new.name)))
    task.state = TaskState[state]
    if after == "-":
        with pytest.raises(ScriptStateError) as caught:
            task.apply(action)
        assert str(caught.value) == WHY_NOT_TASK[f"{state} {action}"]
        assert (task.state.name, seen) == (state, [])
    else:
        task.apply(action)
        assert (task.state.name, seen) == (after, [(state, after)])


@pytest.mark.parametrize(("cell", "after"), matrix(POWER).items())
def test_power(cell: tuple[str, str], after: str) -> None:
    mode, action = cell
    seen: list[str] = []
    power = modes.Power(lambda new: seen.append(new.name), RobotMode[mode])
    if after == "-":
        with pytest.raises(ScriptStateError) as caught:
            power.apply(action)
        assert str(caught.value) == f"cannot {action.replace('_', ' ')} while the robot is {mode}"
        assert (power.mode.name, seen) == (mode, [])
    else:
        power.apply(action)
        assert (power.mode.name, seen) == (after, [after])


def test_the_tables_have_every_state_and_no_other_action() -> None:
    assert {state for state, _ in matrix(POWER)} == set(RobotMode.__members__)
    assert {state for state, _ in matrix(TASK)} == set(TaskState.__members__) - {"UNKNOWN"}
    assert len(tasks.TRANSITIONS) == sum(after != "-" for after in matrix(TASK).values())
    assert len(modes.TRANSITIONS) == sum(after != "-" for after in matrix(POWER).values())
    assert [mode.name for mode in safety.MODES] == list(LETTERS.values())
    assert list(safety.ACTIONS) == [action for action, _ in rows(SAFETY)]


@pytest.mark.parametrize(("mode", "why"), WHY_NOT_READY.items())
def test_what_keeps_the_arm_from_moving(mode: str, why: str) -> None:
    power = modes.Power(lambda _: None, RobotMode[mode])
    if not why:
        power.require_ready()
        return
    with pytest.raises(ScriptStateError) as caught:
        power.require_ready()
    assert (str(caught.value), caught.value.code) == (why, "R115")
    assert caught.value.hint == "power on and release the brakes"


# At 250 ticks a second: 0.4 s until the joints boot, 0.8 s until they are idle, 1 s for the brakes.
WAY_UP = """
1.0   POWER_ON 0   BOOTING 100   IDLE 300   RUNNING 550
0.5   POWER_ON 0   BOOTING 50    IDLE 150   RUNNING 275
0.0   POWER_ON 0   BOOTING 0     IDLE 0     RUNNING 0
"""


@pytest.mark.parametrize(("factor", "steps"), [(float(factor), steps) for factor, *steps in rows(WAY_UP)])
def test_the_steps_up_take_the_assumed_times(factor: float, steps: list[str]) -> None:
    seen: list[str] = []
    now = 0
    usual = modes.PowerTimes()
    times = modes.PowerTimes(usual.power_on_s * factor, usual.boot_s * factor, usual.release_s * factor)
    power = modes.Power(lambda mode: seen.append(f"{mode.name} {now}"), RobotMode.POWER_OFF, times)
    power.go_up(RobotMode.RUNNING, now)
    while (due := power.next_tick) is not None:
        now = due
        power.go_on(now)
    assert seen == steps


def test_the_assumed_times() -> None:
    assert modes.PowerTimes(0.4, 0.8, 1.0) == modes.REALISTIC
    assert modes.PowerTimes(0.0, 0.0, 0.0) == modes.AT_ONCE


@pytest.mark.parametrize(("letter", "action", "after"), safety_cells())
def test_safety(letter: str, action: str, after: str) -> None:
    before = LETTERS[letter]
    seen: list[tuple[str, str]] = []
    state = Safety(lambda old, new: seen.append((old.name, new.name)))
    state.mode = SafetyMode[before]
    # No stop leads into recovery by itself, so an arm that is outside shows that the inputs were asked.
    state.inputs = SafetyInputs(is_outside=True, reduced_mode=True)
    if after == "-":
        with pytest.raises(ScriptStateError) as caught:
            state.apply(action, LATE)
        lock = "there is no protective stop to unlock; " if action == "unlock_protective_stop" else ""
        assert str(caught.value) == f"cannot {action.replace('_', ' ')}: {lock}{WHAT_TO_DO[letter]}"
        assert (state.mode.name, seen, caught.value.code) == (before, [], "R115")
        return
    state.apply(action, LATE)
    wanted = "RECOVERY" if after == "*" else LETTERS[after]
    assert (state.mode.name, seen) == (wanted, [] if wanted == before else [(before, wanted)])
    assert state.may_move == (wanted in ("NORMAL", "REDUCED", "RECOVERY"))


@pytest.mark.parametrize("letter", LETTERS)
def test_a_restart_without_inputs_ends_every_state(letter: str) -> None:
    state = Safety(lambda _old, _new: None)
    state.mode = SafetyMode[LETTERS[letter]]
    state.apply("restart_safety", LATE)
    assert state.mode is SafetyMode.NORMAL


def test_effects_on_task_and_power() -> None:
    shown = {
        mode.name: (
            effect.task,
            "power stays" if effect.is_power_kept else "power goes",
            effect.code,
            effect.class_name,
        )
        for mode, effect in safety.EFFECTS.items()
    }
    assert shown == {name: tuple(rest) for name, *rest in rows(EFFECTS)}


def test_what_signals_and_requests_may_do() -> None:
    assert safety.INPUT_ACTIONS == {
        "emergency_stop": ("press_emergency_stop", "release_emergency_stop"),
        "system_emergency_stop": ("press_system_stop", "release_system_stop"),
        "safeguard_stop": ("open_safeguard", "close_safeguard"),
    }
    assert set(safety.ASKED_FROM_OUTSIDE) == {
        "stop_protectively",
        "unlock_protective_stop",
        "violate",
        "fail",
        "restart_safety",
    }
    assert safety.UNLOCK_AFTER_S == 5.0


@pytest.mark.parametrize(
    ("mode", "speed", "force"),
    [("NORMAL", None, 250.0), ("REDUCED", 0.75, 150.0), ("RECOVERY", 0.75, 150.0)],
)
def test_limits_of_an_installation_that_configures_none(mode: str, speed: float | None, force: float) -> None:
    limits = SafetyLimits()
    assert limits.bounds(SafetyMode[mode]) == SafetyBounds(tcp_speed_max=speed)
    assert limits.tcp_force_max(SafetyMode[mode]) == force


def test_planes_count_where_their_use_says_and_switch_with_a_pair_of_inputs() -> None:
    assert safety_limits.PLANE_USES == ("always", "normal", "reduced", "trigger_reduced")
    for pair, inputs in enumerate([(0, 1), (2, 3), (4, 5), (6, 7)]):
        for high in range(256):
            switched = safety_limits.switched_pairs(lambda _, index, high=high: high >> index & 1)
            assert switched[pair] == all(high >> index & 1 for index in inputs)
