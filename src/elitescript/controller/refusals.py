"""How a refused request is told to people: the action in their words, what is in the way, and what to do about it."""

from __future__ import annotations

from typing import Final

from elitescript.messages.machine import (
    AskSafety,
    DecodePulses,
    DisturbInput,
    EndInputFaults,
    MachineRequest,
    PauseTask,
    PowerDown,
    PowerOff,
    PowerOn,
    PrepareEncoder,
    ReleaseBrakes,
    ResetInputActions,
    ResumeTask,
    SetAnalogDomain,
    SetAnalogFraction,
    SetClientSensor,
    SetEncoderCount,
    SetForceDamping,
    SetForceGain,
    SetGravity,
    SetInputAction,
    SetLineMark,
    SetOption,
    SetPayload,
    SetRunstateChoice,
    SetSpeedScale,
    SetTcp,
    SetToolAnalogMode,
    SetToolPin,
    StopTask,
    WritePortCoils,
    WritePortRegisters,
    WriteSignal,
    ZeroForceSensor,
)

ACTIONS: Final[dict[type, str]] = {
    WriteSignal: "set {0.name}[{0.index}] to {0.value}",
    WritePortCoils: "set coils from {0.first} on",
    WritePortRegisters: "set registers from {0.first} on",
    SetAnalogDomain: "set the domain of {0.name}[{0.index}]",
    SetAnalogFraction: "set {0.name}[{0.index}] to a fraction of {0.fraction:g}",
    SetRunstateChoice: "tie {0.name}[{0.index}] to the program",
    SetInputAction: "bind {0.name}[{0.index}]",
    ResetInputActions: "unbind the inputs",
    SetToolAnalogMode: "set the mode of the tool's analog pins to {0.mode}",
    SetToolPin: "configure tool pin {0.index}",
    SetTcp: "set the TCP",
    SetPayload: "set the payload to {0.mass_kg:g} kg",
    SetGravity: "set the direction of gravity",
    SetSpeedScale: "set the speed to {0.fraction:g}",
    SetOption: "set {0.name}",
    SetLineMark: "mark line {0.number}",
    PrepareEncoder: "prepare encoder {0.index}",
    DecodePulses: "have encoder {0.index} count pulses",
    SetEncoderCount: "set the count of encoder {0.index}",
    PowerOn: "power on",
    ReleaseBrakes: "release the brakes",
    PowerOff: "power off",
    PowerDown: "shut down",
    PauseTask: "pause",
    ResumeTask: "resume",
    StopTask: "stop",
    SetForceGain: "set the gain of force control to {0.scaling:g}",
    SetForceDamping: "set the damping of force control to {0.damping:g}",
    ZeroForceSensor: "zero the force sensor",
    SetClientSensor: "change the force sensor",
    DisturbInput: "disturb {0.name}[{0.index}]",
    EndInputFaults: "end the faults of inputs",
    AskSafety: "change the state of the safety system",
}
"""What each request asks for, as it follows `cannot`; a format text that is given the request."""


def refusal_text(request: MachineRequest, error: Exception) -> str:
    """Return one line about a request that was refused.

    Args:
        request: what was asked for.
        error: why it was refused; its `hint`, if it has one, says what to do.
    """
    why, hint = str(error), getattr(error, "hint", None)
    if not why.startswith("cannot "):
        why = f"cannot {ACTIONS[type(request)].format(request)}: {why}"
    return f"{why}; {hint}" if hint else why
