"""What ends a program from outside, and what a robot shows for which that was done while its child is in a call.

A stop goes into the next tick that a child is sent, and nearly every tick ends within milliseconds. A call into
Python's own functions may last as long as it likes; then the child is ended for the stop.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from elitescript.language.options import SECONDARY
from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.messages.inputs import Compiled, Do, Input, Interpret, LoadTask, PlayTask, Query, Reboot, RunUnit
from elitescript.messages.machine import PowerDown, PowerOff, StopTask, WriteSignal
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.state import ZERO_SIX
from elitescript.records import replace

STOP_S: Final = 0.010
"""Wall time that a child has to answer a stop; with the cycle before and behind it makes less than 20 ms."""
REPLACE_S: Final = 0.03
"""The same if another program is to run: it may be that both begin at once."""
BEGIN_S: Final = 0.1
"""The same in the tick in which a program begins: its text is compiled, and its first calls load what they need."""
WORKED_SHARE: Final = 0.5
"""Share of that time that the child must have worked itself: on a busy computer it waits for a processor."""
COMPILES: Final = (RunUnit, Compiled, Interpret, Query, LoadTask, PlayTask)
"""Inputs of which a child may have something to compile: no call of a program keeps it then."""
_STOPPED_BY: Final = {
    "emergency_stop": SafetyMode.ROBOT_EMERGENCY_STOP,
    "system_emergency_stop": SafetyMode.SYSTEM_EMERGENCY_STOP,
}


def is_stop(item: Input) -> bool:
    """Return whether an input ends whatever program runs, and the motion of the arm."""
    if not isinstance(item, Do):
        return isinstance(item, Reboot)
    request = item.request
    if isinstance(request, WriteSignal):
        return request.name in _STOPPED_BY and bool(request.value)
    return isinstance(request, StopTask | PowerOff | PowerDown)


def is_program(item: Input) -> bool:
    """Return whether an input takes the place of the program that runs."""
    return isinstance(item, RunUnit) and item.kind != SECONDARY


def longest_s(inputs: Iterable[Input]) -> float | None:
    """Return how long the most urgent of some inputs may wait, s; None if none is urgent."""
    found = None
    for item in inputs:
        if is_stop(item):
            return STOP_S
        if is_program(item):
            found = REPLACE_S
    return found


def stopped(last: Snapshot, tick: int, inputs: Sequence[Input]) -> Snapshot:
    """Return what a robot shows at a tick at which its child was ended for these inputs.

    The arm stands where the child has last shown it: the arc of its braking goes with the child.
    """
    state = replace(last.robot, tick=tick, task_state=TaskState.STOPPED, line=0, qd_target=ZERO_SIX, qd_actual=ZERO_SIX)
    signals = dict(last.signals)
    for item in inputs:
        if is_stop(item) and isinstance(item, Do) and isinstance(item.request, WriteSignal):
            request = item.request
            levels = list(signals[request.name])
            levels[request.index] = request.value
            signals[request.name] = tuple(levels)
            state = replace(state, safety_mode=_STOPPED_BY[request.name])
    return replace(last, robot=state, signals=signals)
