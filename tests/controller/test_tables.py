"""Both state machines, generated from their tables: every transition, and every one that is not there."""

import itertools

import pytest

from elitescript.controller import modes, tasks
from elitescript.errors import ScriptStateError
from elitescript.messages.enums import RobotMode, TaskState

TASK_ACTIONS = ("start", "pause", "resume", "stop")
TASK_STATES = (TaskState.STOPPED, TaskState.PLAYING, TaskState.PAUSED)
POWER_ACTIONS = ("power_on", "boot", "initialise", "release_brakes", "engage_brakes", "power_off")


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


class TestGoingUp:
    @staticmethod
    def steps(power, seen):
        while (due := power.next_tick) is not None:
            power.go_on(due)
            yield due, seen[-1].name

    def test_every_step_takes_its_time(self):
        seen = []
        power = modes.Power(seen.append, RobotMode.POWER_OFF, modes.PowerTimes(0.4, 0.8, 1.0))
        power.go_up(RobotMode.RUNNING, 10)
        assert list(self.steps(power, seen)) == [(110, "BOOTING"), (310, "IDLE"), (560, "RUNNING")]

    def test_a_goal_can_be_raised_on_the_way_but_not_lowered(self):
        seen = []
        power = modes.Power(seen.append, RobotMode.POWER_OFF, modes.PowerTimes(0.4, 0.8, 1.0))
        power.go_up(RobotMode.IDLE, 0)
        power.go_up(RobotMode.RUNNING, 50)
        power.go_up(RobotMode.IDLE, 60)
        assert list(self.steps(power, seen))[-1] == (550, "RUNNING")

    def test_without_times_it_is_done_at_once(self):
        seen = []
        power = modes.Power(seen.append, RobotMode.POWER_OFF)
        power.go_up(RobotMode.RUNNING, 7)
        assert [mode.name for mode in seen] == ["POWER_ON", "BOOTING", "IDLE", "RUNNING"]

    def test_going_off_ends_it(self):
        power = modes.Power(lambda mode: None, RobotMode.POWER_OFF, modes.PowerTimes())
        power.go_up(RobotMode.RUNNING, 0)
        power.go_off()
        power.settle(False)
        assert (power.mode, power.next_tick) == (RobotMode.POWER_OFF, None)
