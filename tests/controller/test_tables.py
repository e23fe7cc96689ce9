"""Both state machines, generated from their tables: every transition, and every one that is not there."""

import itertools

import pytest

from elitescript.controller import modes, tasks
from elitescript.errors import ScriptStateError
from elitescript.messages.enums import RobotMode, TaskState

TASK_ACTIONS = ("start", "pause", "resume", "stop")
TASK_STATES = (TaskState.STOPPED, TaskState.PLAYING, TaskState.PAUSED)
POWER_ACTIONS = ("power_on", "release_brakes", "engage_brakes", "power_off")


@pytest.mark.parametrize(("state", "action"), list(itertools.product(TASK_STATES, TASK_ACTIONS)))
def test_task(state, action):
    seen = []
    task = tasks.Task(lambda before, after: seen.append((before, after)))
    task.state = state
    wanted = tasks.TRANSITIONS.get((state, action))
    if wanted is None:
        with pytest.raises(ScriptStateError, match=tasks.REFUSALS[state, action]):
            task.apply(action)
        assert (task.state, seen) == (state, [])
    else:
        task.apply(action)
        assert (task.state, seen) == (wanted, [(state, wanted)])


@pytest.mark.parametrize(("mode", "action"), list(itertools.product(RobotMode, POWER_ACTIONS)))
def test_power(mode, action):
    seen = []
    power = modes.Power(seen.append, mode)
    wanted = modes.TRANSITIONS.get((mode, action))
    if wanted is None:
        with pytest.raises(ScriptStateError, match=mode.name):
            power.apply(action)
        assert (power.mode, seen) == (mode, [])
    else:
        power.apply(action)
        assert (power.mode, seen) == (wanted, [wanted])


def test_an_arm_that_cannot_move_says_why():
    for mode in {mode for pair in modes.TRANSITIONS.items() for mode in (pair[0][0], pair[1])} - {RobotMode.RUNNING}:
        assert modes.WHY_NOT_READY[mode]
