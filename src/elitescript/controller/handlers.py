"""Who handles which kind of request: one handler for each."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from elitescript.controller.force.compliance_control import YIELD_SETTINGS
from elitescript.controller.modes import WHY_NOT_READY
from elitescript.controller.motion.conveyor_encoders import ENCODER_HANDLERS
from elitescript.controller.signals.image import SIGNAL_SETTINGS
from elitescript.controller.task_requests import TASK_HANDLERS
from elitescript.controller.tool_setup import SETUP_HANDLERS
from elitescript.messages.machine import (
    AskSafety,
    DisturbInput,
    EndInputFaults,
    SetLineMark,
    SetSpeedScale,
    WritePortCoils,
    WritePortRegisters,
)

if TYPE_CHECKING:
    from elitescript.controller.controller import Controller


def _set_speed(controller: Controller, request: SetSpeedScale) -> None:
    controller.safety.set_speed_scale(request.fraction)


def _ask_safety(controller: Controller, request: AskSafety) -> None:
    controller.safety.ask(request)


def _declare(controller: Controller, request: Any) -> None:
    SETUP_HANDLERS[type(request)](controller.setup, request)
    controller.safety.disturb()


def _set_signal(controller: Controller, request: Any) -> None:
    SIGNAL_SETTINGS[type(request)](controller.signals, request)
    guide_by_input(controller)


def guide_by_input(controller: Controller) -> None:
    """Begin or end hand guiding as the inputs ask for it, when one may have changed."""
    why_not = WHY_NOT_READY.get(controller.power.mode) or controller.safety.refusal("move")
    controller.yielding.guide_by_input(why_not, controller.arm_state, controller.tick)


def _disturb_input(controller: Controller, request: DisturbInput) -> None:
    controller.disturb_input(request)
    guide_by_input(controller)


def _end_input_faults(controller: Controller, _request: EndInputFaults) -> None:
    if controller.signals.faults is not None:
        controller.signals.faults.end()
        guide_by_input(controller)


def _set_encoder(controller: Controller, request: Any) -> None:
    ENCODER_HANDLERS[type(request)](controller.tracking.encoders, request, controller.tick)


def _set_force(controller: Controller, request: Any) -> None:
    YIELD_SETTINGS[type(request)](controller.yielding, request, controller.arm_state.joints(controller.tick))


def _write_port(controller: Controller, request: WritePortCoils | WritePortRegisters) -> None:
    # Few programs do; the others need not pay for the import.
    from elitescript.controller.signals.modbus_access import write_coils, write_registers

    if isinstance(request, WritePortCoils):
        write_coils(controller, request)
    else:
        write_registers(controller, request)


HANDLERS: Final[dict[type, Callable[[Controller, Any], None]]] = {
    SetSpeedScale: _set_speed,
    SetLineMark: lambda controller, request: controller.mark(request.number, request.label),
    AskSafety: _ask_safety,
    **dict.fromkeys((WritePortCoils, WritePortRegisters), _write_port),
    DisturbInput: _disturb_input,
    EndInputFaults: _end_input_faults,
    **TASK_HANDLERS,
    **dict.fromkeys(SIGNAL_SETTINGS, _set_signal),
    **dict.fromkeys(SETUP_HANDLERS, _declare),
    **dict.fromkeys(ENCODER_HANDLERS, _set_encoder),
    **dict.fromkeys(YIELD_SETTINGS, _set_force),
}
"""Every kind of machine request and who handles it."""
