"""What a kernel is made with, and what it says about itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final
from zlib import crc32

from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.modes import REALISTIC, PowerTimes
from elitescript.controller.safety.limits import OPERATIONAL_MODES, SafetyLimits
from elitescript.messages.motion import Six
from elitescript.messages.plant import PlantConfig
from elitescript.messages.profile import DEFAULT_FIRMWARE, Profile
from elitescript.messages.signals import Value
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.timing import RPC_TIMEOUT_S
from elitescript.models.model import RobotModel, load_model, parse_model
from elitescript.runtime.threads.scheduler import WORK_PER_TICK

EPOCH_S: Final = 1_704_067_200.0
"""2024-01-01T00:00:00Z: where the clock of a free run begins, so that every run is the same."""

DEFAULT_CONFIGURATION: Final = "default.configuration"


@dataclass(frozen=True, slots=True)
class KernelConfig:
    """One robot. Together with the inputs of every tick it determines everything that the robot does."""

    model: str = "CS66"
    """Name of the model, or of the file that `model_text` was read from."""
    model_text: str = ""
    """The file of an own arm; empty for a model of the package."""
    firmware: str = DEFAULT_FIRMWARE
    seed: int = 0
    """Of the programs' random numbers."""
    first_tick: int = 0
    """Number of the first tick; a robot that goes on where another one ended goes on with its time."""
    epoch_s: float = EPOCH_S
    """The controller's clock at tick 0, seconds since 1970."""
    joints: Six | None = None
    """At the start, rad; the model's home if None."""
    speed: float = 1.0
    """Speed percentage at the start, as a fraction."""
    power_on: bool = False
    """Whether the arm has power at the start, its brakes open."""
    power_times: PowerTimes = REALISTIC
    remote: bool = True
    """Whether clients may change the robot at the start."""
    robot_id: str = "elitescript"
    serial_number: str = "ES0000000001"
    configuration: str = DEFAULT_CONFIGURATION
    """Path of the configuration that is loaded at the start."""
    contact: ContactConfig | None = None
    safety: SafetyLimits | None = None
    plant: PlantConfig | None = None
    signals: tuple[tuple[str, Value], ...] = ()
    """Levels at the start, by the names of `--set`."""
    faults: tuple[str, ...] = ()
    """What goes wrong on channels, as `devices.channels.faults.fault_text` writes it."""
    work_per_tick: int = WORK_PER_TICK
    rpc_timeout_s: float = RPC_TIMEOUT_S
    """How long a remote procedure call waits for its answer; 0 and less wait for ever."""
    strict: bool = False
    """Refuse what a Python 3 controller refuses, instead of warning."""
    confirms_popups: bool = False
    """Confirm popups that block at once, where there is nobody to do it."""


def configured_model(config: KernelConfig) -> RobotModel:
    """Return the arm of a configuration.

    Raises:
        UsageError: there is no such model, or the file of an own arm is wrong.
    """
    return parse_model(config.model, config.model_text) if config.model_text else load_model(config.model)


def describe(config: KernelConfig, model: RobotModel, profile: Profile) -> RobotDescription:
    """What never changes about the robot; the safety checksum is ours (*assumed*: it changes with the limits)."""
    a, d, alpha = model.arm.modified_dh
    ranges = model.joint_ranges
    return RobotDescription(
        model=model.name,
        type_id=model.type_id,
        serial_number=config.serial_number,
        robot_id=config.robot_id,
        firmware=profile.version,
        q_min=_six([low for low, _ in ranges]),
        q_max=_six([high for _, high in ranges]),
        qd_max=_six([joint.qd_max for joint in model.joints]),
        qdd_max=_six([joint.qdd_max for joint in model.joints]),
        default_joint_speed=model.default_joint_speed,
        default_joint_acceleration=model.default_joint_acceleration,
        default_tool_speed=model.default_tool_speed,
        default_tool_acceleration=model.default_tool_acceleration,
        equivalent_radius_m=model.equivalent_radius_m,
        dh_a=a,
        dh_d=d,
        dh_alpha=alpha,
        safety_checksum=crc32(repr((model.name, config.safety)).encode()),
        operational_mode=OPERATIONAL_MODES[(config.safety or SafetyLimits()).operational_mode],
    )


def _six(values: list[float]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
