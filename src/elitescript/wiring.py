"""Controller and script host, wired: what `VirtualRobot` and `Kernel` both are made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from keyword import iskeyword
from typing import TYPE_CHECKING

from elitescript.controller.controller import Controller
from elitescript.errors import UsageError
from elitescript.messages.events import Event
from elitescript.messages.motion import Six
from elitescript.messages.profile import Profile
from elitescript.models.model import RobotModel
from elitescript.runtime.environment import ProgramEnvironment
from elitescript.runtime.host import ScriptHost

if TYPE_CHECKING:
    from elitescript.kernel.options import RobotOptions


def assemble(
    model: RobotModel,
    profile: Profile,
    options: RobotOptions,
    *,
    on_event: Callable[[Event], None],
    on_end: Callable[[str], None] = lambda state: None,
    world: ProgramEnvironment | None = None,
) -> tuple[Controller, ScriptHost]:
    """Make a controller with a host for programs.

    Args:
        model: the arm.
        profile: the firmware.
        options: everything else.
        on_event: receives every event in order.
        on_end: called with `finished`, `alarm` or `stopped` when a program is over.
        world: everything outside programs; nothing by default.

    Raises:
        UsageError: the arm cannot be at the joint positions of the options.
    """
    host: ScriptHost | None = None

    def recorded(event: Event) -> None:
        if host is not None:
            host.spend_event()
        on_event(event)

    controller = Controller(
        model,
        epoch_s=options.epoch_s,
        on_event=recorded,
        home=None if options.joints is None else _checked_joints(model, options.joints),
        speed_scale=options.speed,
        contact=options.contact,
        safety=options.safety,
        plant=options.plant or model.plant,
        is_powered=options.power_on,
        power_times=options.power_times,
    )

    def ended(state: str) -> None:
        on_end(state)
        controller.task_ended(state)

    host = ScriptHost(
        controller,
        profile=profile,
        world=world,
        seed=options.seed,
        on_end=ended,
        confirms_popups=options.confirms_popups,
        work_per_tick=options.work_per_tick,
        rpc_timeout_s=options.rpc_timeout_s,
        is_rtsi_input=_is_rtsi_input,
    )
    controller.attach(host)
    return controller, host


def _is_rtsi_input(name: str) -> bool:
    # Few programs watch one; the others need not pay for the import.
    from elitescript.protocol.rtsi.inputs import INPUTS

    return name in INPUTS


def _checked_joints(model: RobotModel, joints: Six) -> Six:
    for value, limit in zip(joints, model.joints, strict=True):
        if not limit.q_min <= value <= limit.q_max:
            raise UsageError(f"joint {limit.name} must be in [{limit.q_min:.4f}, {limit.q_max:.4f}] rad, got {value:g}")
    return joints


def checked_presets(presets: Mapping[str, object]) -> dict[str, object]:
    """Program globals that are given from outside.

    Raises:
        UsageError: a name that no program could give to a global.
    """
    for name in presets:
        if not name.isidentifier() or iskeyword(name) or name.startswith("__"):
            raise UsageError(f"{name!r} cannot be the name of a global")
    return dict(presets)
