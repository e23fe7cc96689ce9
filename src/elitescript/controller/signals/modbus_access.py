"""The controller's own Modbus server as the machine sees it: what its registers and coils show, and writes to them.

A write is all or nothing: every part is checked before the first one is carried out. A domain that is written together
with a level counts before it. A register of outputs sets all of them; a tool pin that is no output is left out as long
as its bit is what the register shows (*assumed*), so that a client can write back what it has read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from elitescript.controller.signals.image import TOOL_PIN_OUT
from elitescript.messages.enums import AnalogDomain, RobotMode
from elitescript.messages.machine import (
    MachineRequest,
    SetAnalogDomain,
    WritePortCoils,
    WritePortRegisters,
    WriteSignal,
)
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.state import ZERO_SIX, RobotState
from elitescript.modbus.port_image import PortImage, check_registers, coil_writes, register_writes
from elitescript.modbus.port_map import View

if TYPE_CHECKING:
    from collections.abc import Mapping

    from elitescript.controller.controller import Controller


class LivePortSource:
    """What the port map reads of a controller in the middle of a tick; see `port_map.Picture`.

    Args:
        controller: the machine.
    """

    __slots__ = ("_controller",)

    def __init__(self, controller: Controller) -> None:
        self._controller = controller

    @property
    def robot(self) -> RobotState:
        """The machine at this tick."""
        return self._controller.state()

    @property
    def joint_currents(self) -> Six:
        """A."""
        controller = self._controller
        if controller.robot_mode is not RobotMode.RUNNING:
            return ZERO_SIX
        return controller.loads.measured(controller.tick)[1]

    @property
    def joint_temperatures(self) -> Six:
        """degC."""
        return self._controller.joint_temperatures

    @property
    def signals(self) -> Mapping[str, tuple[Value, ...]]:
        """The signal image."""
        return self._controller.signals.image

    @property
    def domains(self) -> Mapping[str, tuple[AnalogDomain, ...]]:
        """Of every analog channel."""
        return self._controller.signals.domain_image


def port_image(controller: Controller, version: tuple[int, ...]) -> PortImage:
    """Registers and coils as they are now.

    Args:
        controller: the machine.
        version: of the controller: major, minor, bug fix.
    """
    return PortImage(View(LivePortSource(controller), version))


def write_coils(controller: Controller, request: WritePortCoils) -> None:
    """Set coils.

    Raises:
        ScriptError: one of them cannot be set; nothing has changed.
    """
    _carry_out(controller, coil_writes(request.first, request.values))


def write_registers(controller: Controller, request: WritePortRegisters) -> None:
    """Set registers.

    Raises:
        ScriptError: one of them cannot be set; nothing has changed.
    """
    if request.read_count:
        check_registers(request.read_first, request.read_count)
    parts = register_writes(request.first, request.values)
    _carry_out(controller, [part for part in parts if not _is_idle_pin(controller, part)])


def _is_idle_pin(controller: Controller, part: MachineRequest) -> bool:
    if not isinstance(part, WriteSignal) or part.name != TOOL_PIN_OUT:
        return False
    signals = controller.signals
    return not signals.is_tool_output(part.index) and signals.read(TOOL_PIN_OUT, part.index) == part.value


def _carry_out(controller: Controller, parts: list[MachineRequest]) -> None:
    signals = controller.signals
    domains = {(part.name, part.index): part.domain for part in parts if isinstance(part, SetAnalogDomain)}
    for part in parts:
        if isinstance(part, WriteSignal):
            key = (part.name, part.index)
            signals.check(part, domains.get(key, signals.domain(*key)))
    # Domains come first: a level belongs to the new one.
    for part in sorted(parts, key=lambda part: not isinstance(part, SetAnalogDomain)):
        controller.request(part)
