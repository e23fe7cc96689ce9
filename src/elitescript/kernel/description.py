"""The arm of a robot, and what never changes about the robot."""

from __future__ import annotations

from pathlib import Path
from zlib import crc32

from elitescript.controller.safety.limits import OPERATIONAL_MODES, SafetyLimits
from elitescript.kernel.options import RobotOptions
from elitescript.messages.motion import Six
from elitescript.messages.profile import Profile
from elitescript.messages.snapshot import RobotDescription
from elitescript.models.datafile import read_text
from elitescript.models.model import RobotModel, is_model_file, load_model, parse_model


def named_model(name: str | Path) -> tuple[RobotModel, dict[str, str]]:
    """Return an arm by its name or by the path of its file, and the options of a robot that has it.

    Raises:
        UsageError: there is no such model, or its file is wrong.
    """
    if not is_model_file(name):
        model = load_model(name)
        return model, {"model": model.name}
    # A robot in another process cannot read files of this computer: it gets the text of the file.
    options = {"model": Path(name).name, "model_text": read_text(Path(name))}
    return parse_model(options["model"], options["model_text"]), options


def model_of(options: RobotOptions) -> RobotModel:
    """Return the arm that the options name.

    Raises:
        UsageError: there is no such model, or the file of an own arm is wrong.
    """
    return parse_model(options.model, options.model_text) if options.model_text else load_model(options.model)


def describe(options: RobotOptions, model: RobotModel, profile: Profile) -> RobotDescription:
    """Return what never changes about the robot.

    The safety checksum is ours (*assumed*: it changes with the limits).
    """
    a, d, alpha = model.arm.modified_dh
    ranges = model.joint_ranges
    return RobotDescription(
        model=model.name,
        type_id=model.type_id,
        serial_number=options.serial_number,
        robot_id=options.robot_id,
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
        safety_checksum=crc32(repr((model.name, options.safety)).encode()),
        operational_mode=OPERATIONAL_MODES[(options.safety or SafetyLimits()).operational_mode],
    )


def _six(values: list[float]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
