"""Inputs that switch hand guiding (manual 2.10 sections 3.24 to 3.28)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import Choice, signal_index
from elitescript.commands.definition.registry import command
from elitescript.messages.machine import ResetInputActions, SetInputAction

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_FREEDRIVE: Final = "freedrive"

_Action = Annotated[str, Choice("default", _FREEDRIVE)]
_ARGUMENTS: Final = {
    "port": "index of the input.",
    "action": '`"freedrive"`: hand guiding while the input is high; `"default"`: nothing.',
}
"""Texts of arguments that several commands share."""


@command(family="io", manual="3.24")
def set_input_actions_to_default(robot: Robot) -> None:
    """Unbind all standard, configurable and tool inputs and all boolean input registers."""
    robot.request(ResetInputActions())


@command(family="io", manual="3.25", arguments=_ARGUMENTS)
def set_configurable_digital_input_action(
    robot: Robot, port: Annotated[int, signal_index("configurable_digital_in")], action: _Action
) -> None:
    """Bind a configurable input."""
    robot.request(SetInputAction("configurable_digital_in", port, action == _FREEDRIVE))


@command(family="io", manual="3.26", arguments=_ARGUMENTS)
def set_standard_digital_input_action(
    robot: Robot, port: Annotated[int, signal_index("standard_digital_in")], action: _Action
) -> None:
    """Bind a standard input."""
    robot.request(SetInputAction("standard_digital_in", port, action == _FREEDRIVE))


@command(family="io", manual="3.27", arguments=_ARGUMENTS)
def set_tool_digital_input_action(
    robot: Robot, port: Annotated[int, signal_index("tool_digital_in")], action: _Action
) -> None:
    """Bind a tool input.

    Args:
        port: index of the pin.
    """
    robot.request(SetInputAction("tool_digital_in", port, action == _FREEDRIVE))


@command(family="io", manual="3.28")
def set_gp_boolean_input_action(
    robot: Robot, port: Annotated[int, signal_index("input_bool_register")], action: _Action
) -> None:
    """Bind a boolean input register.

    Args:
        port: number of the register.
        action: `"freedrive"`: hand guiding while the register is True; `"default"`: nothing.
    """
    robot.request(SetInputAction("input_bool_register", port, action == _FREEDRIVE))
