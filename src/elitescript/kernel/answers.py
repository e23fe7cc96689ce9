"""The outcome of a request to the machine."""

from __future__ import annotations

from elitescript.controller.controller import Controller
from elitescript.messages.machine import MachineRequest, WritePortRegisters
from elitescript.messages.outcomes import Done, Outcome, Refused, RegistersRead


def outcome_of(
    controller: Controller, firmware: tuple[int, int, int, int], request: MachineRequest, why_not: str
) -> Outcome:
    """Return what is answered to a request.

    Args:
        controller: the machine, after the request.
        firmware: version of the controller, for registers that show it.
        request: what was asked for.
        why_not: why it was refused; empty if it was not.
    """
    if why_not:
        return Refused(why_not)
    if isinstance(request, WritePortRegisters) and request.read_count:
        return RegistersRead(tuple(controller.port_image(firmware).registers(request.read_first, request.read_count)))
    return Done()
