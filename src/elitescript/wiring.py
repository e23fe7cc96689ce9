"""Controller and script host, wired: what `VirtualRobot` and `Kernel` both are made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from keyword import iskeyword
from math import isfinite
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.modes import AT_ONCE, PowerTimes
from elitescript.controller.safety.limits import SafetyLimits
from elitescript.errors import UsageError
from elitescript.messages.events import Event
from elitescript.messages.motion import Six
from elitescript.messages.plant import PlantConfig
from elitescript.messages.profile import Profile
from elitescript.messages.timing import RPC_TIMEOUT_S
from elitescript.models.model import RobotModel
from elitescript.runtime.environment import ProgramEnvironment
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.threads.scheduler import WORK_PER_TICK

EPOCH_S: Final = 1_704_067_200.0
"""2024-01-01T00:00:00Z: where the clock of a free run begins, so that every run is the same."""


@dataclass(frozen=True, slots=True)
class RobotOptions:
    """What a robot is made with, besides its model; see `VirtualRobot`."""

    epoch_s: float = EPOCH_S
    seed: int = 0
    joints: Six | None = None
    speed: float = 1.0
    work_per_tick: int = WORK_PER_TICK
    rpc_timeout_s: float = RPC_TIMEOUT_S
    contact: ContactConfig | None = None
    safety: SafetyLimits | None = None
    plant: PlantConfig | None = None
    is_powered: bool = True
    power_times: PowerTimes = AT_ONCE
    confirms_popups: bool = True


def assemble(
    model: RobotModel,
    profile: Profile,
    fittings: RobotOptions,
    *,
    on_event: Callable[[Event], None],
    on_end: Callable[[str], None] = lambda state: None,
    world: ProgramEnvironment | None = None,
) -> tuple[Controller, ScriptHost]:
    """Make a controller with a host for programs.

    Args:
        model: the arm.
        profile: the firmware.
        fittings: everything else.
        on_event: receives every event in order.
        on_end: called with `finished`, `alarm` or `stopped` when a program is over.
        world: everything outside programs; nothing by default.

    Raises:
        UsageError: an argument that makes no sense.
    """
    if not 0.0 <= fittings.speed <= 1.0:
        raise UsageError(f"speed must be in [0, 1], got {fittings.speed!r}")
    if not isfinite(fittings.rpc_timeout_s):
        raise UsageError(f"rpc_timeout_s must be finite, in s, got {fittings.rpc_timeout_s!r}; 0 waits for ever")
    host: ScriptHost | None = None

    def recorded(event: Event) -> None:
        if host is not None:
            host.spend_event()
        on_event(event)

    controller = Controller(
        model,
        epoch_s=fittings.epoch_s,
        on_event=recorded,
        home=None if fittings.joints is None else _checked_joints(model, fittings.joints),
        speed_scale=fittings.speed,
        contact=fittings.contact,
        safety=fittings.safety,
        plant=fittings.plant,
        is_powered=fittings.is_powered,
        power_times=fittings.power_times,
    )

    def ended(state: str) -> None:
        on_end(state)
        controller.task_ended(state)

    host = ScriptHost(
        controller,
        profile=profile,
        world=world,
        seed=fittings.seed,
        on_end=ended,
        confirms_popups=fittings.confirms_popups,
        work_per_tick=fittings.work_per_tick,
        rpc_timeout_s=fittings.rpc_timeout_s,
        is_rtsi_input=_is_rtsi_input,
    )
    controller.attach(host)
    return controller, host


def _is_rtsi_input(name: str) -> bool:
    # Few programs watch one; the others need not pay for the import.
    from elitescript.protocol.rtsi.inputs import INPUTS

    return name in INPUTS


def _checked_joints(model: RobotModel, joints: Six) -> Six:
    values = tuple(float(value) for value in joints)
    if len(values) != 6:
        raise UsageError(f"joints must be six numbers, got {len(values)}")
    for value, limit in zip(values, model.joints, strict=True):
        if not limit.q_min <= value <= limit.q_max:
            raise UsageError(f"joint {limit.name} must be in [{limit.q_min:.4f}, {limit.q_max:.4f}] rad, got {value:g}")
    return values


def checked_presets(presets: Mapping[str, object]) -> dict[str, object]:
    """Program globals that are given from outside.

    Raises:
        UsageError: a name that no program could give to a global.
    """
    for name in presets:
        if not name.isidentifier() or iskeyword(name) or name.startswith("__"):
            raise UsageError(f"{name!r} cannot be the name of a global")
    return dict(presets)
