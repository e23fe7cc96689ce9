"""A robot that goes on where another one ended: from the last picture of that one.

What a picture does not show begins anew: the program, variables, tracking of conveyors, which inputs start hand guiding
and what outputs do while no program runs.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from elitescript.kernel.causes import RESTART
from elitescript.kernel.config import KernelConfig
from elitescript.messages.enums import RobotMode, SafetyMode
from elitescript.messages.inputs import Do, Input, LoadTask
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
from elitescript.messages.signals import SIGNALS, signal_name
from elitescript.messages.snapshot import RobotDescription, Snapshot

_POWERED: Final = frozenset({RobotMode.POWER_ON, RobotMode.BOOTING, RobotMode.IDLE})
_SAFETY_ACTIONS: Final = {
    SafetyMode.PROTECTIVE_STOP: "stop_protectively",
    SafetyMode.VIOLATION: "violate",
    SafetyMode.FAULT: "fail",
}


def restored_config(
    config: KernelConfig, description: RobotDescription, last: Snapshot, first_tick: int
) -> KernelConfig:
    """The configuration with which a robot goes on.

    Args:
        config: of the robot that ended.
        description: of the robot that ended.
        last: its last picture.
        first_tick: number of the next tick.
    """
    state = last.robot
    levels = [
        (signal_name(row, index), value)
        for name, row in SIGNALS.items()
        for index, value in enumerate(last.signals[name])
        if value != row.default
    ]
    ranges = zip(description.q_min, description.q_max, strict=True)
    a, b, c, d, e, f = (min(max(q, low), high) for q, (low, high) in zip(state.q_actual, ranges, strict=True))
    return replace(
        config,
        first_tick=first_tick,
        joints=(a, b, c, d, e, f),
        speed=min(max(state.speed_scale, 0.0), 1.0),
        power_on=state.robot_mode in (RobotMode.RUNNING, RobotMode.BACK_DRIVE),
        remote=last.is_remote,
        configuration=last.task.configuration or config.configuration,
        signals=tuple(levels),
    )


def restored_inputs(last: Snapshot) -> tuple[Input, ...]:
    """What the robot is told in its first tick, because a configuration does not have it."""
    state = last.robot
    requests: list[MachineRequest] = [
        SetTcp(state.tcp_offset),
        SetPayload(state.payload.mass_kg, state.payload.cog, state.payload.inertia),
        SetGravity(state.gravity),
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
    ]
    if state.robot_mode in _POWERED:
        requests.append(PowerOn())
    if state.safety_mode in _SAFETY_ACTIONS:
        requests.append(AskSafety(_SAFETY_ACTIONS[state.safety_mode], "it was so before the restart"))
    task = (LoadTask(RESTART, last.task.loaded),) if last.task.loaded else ()
    return (*(Do(RESTART, request) for request in requests), *task)
