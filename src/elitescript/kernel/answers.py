"""What the robot's answer to a request of a port shows."""

from __future__ import annotations

from elitescript.controller.controller import Controller
from elitescript.messages.machine import MachineRequest, WritePortRegisters


def shown_after(controller: Controller, firmware: tuple[int, int, int, int], request: MachineRequest) -> str:
    """Registers that a request asks to be read right after it, as hexadecimal digits, four each; else nothing."""
    if not isinstance(request, WritePortRegisters) or not request.read_count:
        return ""
    words = controller.port_image(firmware).registers(request.read_first, request.read_count)
    return "".join(f"{word:04x}" for word in words)
