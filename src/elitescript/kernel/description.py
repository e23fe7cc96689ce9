"""What never changes about a robot."""

from __future__ import annotations

from zlib import crc32

from elitescript.controller.safety.limits import OPERATIONAL_MODES, SafetyLimits
from elitescript.kernel.options import RobotOptions
from elitescript.messages.motion import Six
from elitescript.messages.profile import Profile
from elitescript.messages.snapshot import RobotDescription
from elitescript.models.model import RobotModel


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
        firmware=profile.release,
        version=profile.version,
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
        query_form=options.query_form,
        operational_mode=OPERATIONAL_MODES[(options.safety or SafetyLimits()).operational_mode],
    )


def _six(values: list[float]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
