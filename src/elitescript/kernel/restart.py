"""Restart: a robot goes on where another one ended, from the last snapshot of that one.

What a snapshot does not show begins anew: the program, variables, tracking of conveyors, which inputs start hand
guiding and what outputs do while no program runs.

The snapshot comes from a process that has failed: what no robot can go on from, such as a joint position that is not a
number, begins anew too.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from typing import Final

from elitescript.kernel.options import RobotOptions
from elitescript.messages.enums import RobotMode, SafetyMode
from elitescript.messages.inputs import RESTART, Do, Input, LoadTask
from elitescript.messages.machine import (
    AskSafety,
    MachineRequest,
    PowerOn,
    SetAnalogDomain,
    SetGravity,
    SetPayload,
    SetTcp,
    SetToolAnalogMode,
    WriteSignal,
)
from elitescript.messages.signals import SIGNALS, Signal, Value, signal_name
from elitescript.messages.snapshot import RobotDescription, Snapshot
from elitescript.records import replace

_POWERED: Final = frozenset({RobotMode.POWER_ON, RobotMode.BOOTING, RobotMode.IDLE})
_SAFETY_ACTIONS: Final = {
    SafetyMode.PROTECTIVE_STOP: "stop_protectively",
    SafetyMode.VIOLATION: "violate",
    SafetyMode.FAULT: "fail",
}


def restored_options(
    options: RobotOptions, description: RobotDescription, last: Snapshot, first_tick: int
) -> RobotOptions:
    """Return the options with which a robot goes on.

    Args:
        options: of the robot that ended.
        description: of the robot that ended.
        last: its last snapshot.
        first_tick: number of the next tick.
    """
    state = last.robot
    levels = [
        (signal_name(row, index), value)
        for name, row in SIGNALS.items()
        for index, value in enumerate(last.signals[name])
        if value != row.default and _is_level(row, value)
    ]
    joints = options.joints
    if _are_finite(state.q_actual):
        ranges = zip(description.q_min, description.q_max, strict=True)
        a, b, c, d, e, f = (min(max(q, low), high) for q, (low, high) in zip(state.q_actual, ranges, strict=True))
        joints = (a, b, c, d, e, f)
    return replace(
        options,
        first_tick=first_tick,
        joints=joints,
        speed=min(max(state.speed_scale, 0.0), 1.0) if isfinite(state.speed_scale) else options.speed,
        power_on=state.robot_mode in (RobotMode.RUNNING, RobotMode.BACK_DRIVE),
        remote=last.is_remote,
        configuration=last.task.configuration or options.configuration,
        signals=tuple(levels),
    )


def restored_inputs(last: Snapshot) -> tuple[Input, ...]:
    """Return inputs of its first tick: what a configuration does not have."""
    state = last.robot
    payload = state.payload
    requests: list[MachineRequest] = []
    if _are_finite(state.tcp_offset):
        requests.append(SetTcp(state.tcp_offset))
    if _are_finite((payload.mass_kg, *payload.cog, *payload.inertia)):
        requests.append(SetPayload(payload.mass_kg, payload.cog, payload.inertia))
    if _are_finite(state.gravity):
        requests.append(SetGravity(state.gravity))
    requests += [
        SetToolAnalogMode(last.tool_analog_mode),
        *(
            SetAnalogDomain(name, index, domain)
            for name, domains in last.domains.items()
            if name in SIGNALS
            for index, domain in enumerate(domains)
        ),
    ]
    # Changing a domain changes the level.
    requests += [
        WriteSignal(name, index, value)
        for name in last.domains
        if name in SIGNALS
        for index, value in enumerate(last.signals[name])
        if isfinite(value)
    ]
    if state.robot_mode in _POWERED:
        requests.append(PowerOn())
    if state.safety_mode in _SAFETY_ACTIONS:
        requests.append(AskSafety(_SAFETY_ACTIONS[state.safety_mode], "it was so before the restart"))
    task = (LoadTask(RESTART, last.task.loaded),) if last.task.loaded else ()
    return (*(Do(RESTART, request) for request in requests), *task)


def _are_finite(values: Sequence[float]) -> bool:
    return all(map(isfinite, values))


def _is_level(row: Signal, value: Value) -> bool:
    low = -inf if row.low is None else row.low
    high = inf if row.high is None else row.high
    return isfinite(value) and low <= value <= high
