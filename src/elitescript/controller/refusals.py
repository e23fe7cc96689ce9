"""Writes the message for a refused request: the action, the reason and a hint."""

from __future__ import annotations

from typing import Final

from elitescript.errors import text_of
from elitescript.messages import machine
from elitescript.said import Said, said

ACTIONS: Final[dict[type, str]] = {
    machine.WriteSignal: "set {0.name}[{0.index}] to {0.value}",
    machine.WritePortCoils: "set coils from {0.first} on",
    machine.WritePortRegisters: "set registers from {0.first} on",
    machine.SetAnalogDomain: "set the domain of {0.name}[{0.index}]",
    machine.SetAnalogFraction: "set {0.name}[{0.index}] to a fraction of {0.fraction:g}",
    machine.SetRunstateChoice: "tie {0.name}[{0.index}] to the program",
    machine.SetInputAction: "bind {0.name}[{0.index}]",
    machine.ResetInputActions: "unbind the inputs",
    machine.SetToolAnalogMode: "set the mode of the tool's analog pins to {0.mode}",
    machine.SetToolPin: "configure tool pin {0.index}",
    machine.SetTcp: "set the TCP",
    machine.SetPayload: "set the payload to {0.mass_kg:g} kg",
    machine.SetGravity: "set the direction of gravity",
    machine.SetSpeedScale: "set the speed to {0.fraction:g}",
    machine.SetOption: "set {0.name}",
    machine.SetLineMark: "mark line {0.number}",
    machine.PrepareEncoder: "prepare encoder {0.index}",
    machine.DecodePulses: "have encoder {0.index} count pulses",
    machine.SetEncoderCount: "set the count of encoder {0.index}",
    machine.PowerOn: "power on",
    machine.ReleaseBrakes: "release the brakes",
    machine.PowerOff: "power off",
    machine.PowerDown: "shut down",
    machine.PauseTask: "pause",
    machine.ResumeTask: "resume",
    machine.StopTask: "stop",
    machine.SetForceGain: "set the gain of force control to {0.scaling:g}",
    machine.SetForceDamping: "set the damping of force control to {0.damping:g}",
    machine.ZeroForceSensor: "zero the force sensor",
    machine.SetClientSensor: "change the force sensor",
    machine.DisturbInput: "disturb {0.name}[{0.index}]",
    machine.EndInputFaults: "end the faults of inputs",
    machine.AskSafety: "change the state of the safety system",
}
"""Action of each request, as it follows `cannot`; a format text with the request as its argument."""


def refusal_text(request: machine.MachineRequest, error: Exception) -> str:
    """Return one line about a request that was refused.

    Args:
        request: the request.
        error: the reason, perhaps with a `hint`.
    """
    why, hint = text_of(error), getattr(error, "hint", None)
    if not why.startswith("cannot "):
        action = ACTIONS[type(request)].format(request)
        why = said("cannot {action}: {why}", action=action if "[" in action else Said(action), why=why)
    return said("{why}; {hint}", why=why, hint=hint) if hint else why
