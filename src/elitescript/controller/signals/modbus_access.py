"""Gives the Modbus server of the controller its registers, and checks writes to registers and coils.

A write is all or nothing: every part is checked before the first one is carried out. A domain that is written together
with a level counts before it. A register of outputs sets all of them; a tool pin that is no output is left out if its
bit is unchanged (*assumed*), so that a client can write back a register that it has read.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from elitescript.controller.arm.joint_loads import JointLoads
from elitescript.controller.modes import Power
from elitescript.controller.signals.image import TOOL_PIN_OUT, SignalImage
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
from elitescript.modbus.port_image import check_registers, coil_writes, register_writes


class LivePortSource:
    """Gives the port map the machine in the middle of a tick; see `port_map.PortSource`.

    Args:
        tick: the present one.
        state: makes the state of this tick.
        power: of the arm.
        loads: of the joints.
        signals: the signal image.
    """

    __slots__ = ("_loads", "_power", "_signals", "_state", "_tick")

    def __init__(
        self, tick: int, state: Callable[[], RobotState], power: Power, loads: JointLoads, signals: SignalImage
    ) -> None:
        self._tick = tick
        self._state = state
        self._power = power
        self._loads = loads
        self._signals = signals

    @property
    def robot(self) -> RobotState:
        """The machine at this tick."""
        return self._state()

    @property
    def joint_currents(self) -> Six:
        """Motor currents, A."""
        if self._power.mode is not RobotMode.RUNNING:
            return ZERO_SIX
        return self._loads.measured(self._tick)[1]

    @property
    def joint_temperatures(self) -> Six:
        """Joint temperatures, degC."""
        return self._loads.temperatures(self._tick)[0]

    @property
    def signals(self) -> Mapping[str, tuple[Value, ...]]:
        """The signal image."""
        return self._signals.image

    @property
    def domains(self) -> Mapping[str, tuple[AnalogDomain, ...]]:
        """Domain of every analog channel."""
        return self._signals.domain_image


def port_writes(signals: SignalImage, request: WritePortCoils | WritePortRegisters) -> list[MachineRequest]:
    """Return the requests of a write to the server, in the order in which they have to be carried out.

    Raises:
        ScriptError: one of them cannot be carried out.
    """
    parts: list[MachineRequest]
    if isinstance(request, WritePortCoils):
        parts = coil_writes(request.first, request.values)
    else:
        if request.read_count:
            check_registers(request.read_first, request.read_count)
        written = register_writes(request.first, request.values)
        parts = [part for part in written if not _is_idle_pin(signals, part)]
    domains = {(part.name, part.index): part.domain for part in parts if isinstance(part, SetAnalogDomain)}
    for part in parts:
        if isinstance(part, WriteSignal):
            key = (part.name, part.index)
            signals.check(*key, part.value, domains.get(key))
    # Domains come first: a level belongs to the new one.
    return sorted(parts, key=lambda part: not isinstance(part, SetAnalogDomain))


def _is_idle_pin(signals: SignalImage, part: MachineRequest) -> bool:
    if not isinstance(part, WriteSignal) or part.name != TOOL_PIN_OUT:
        return False
    return not signals.is_tool_output(part.index) and signals.read(TOOL_PIN_OUT, part.index) == part.value
