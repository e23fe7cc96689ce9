"""The limits of a model in the form that planning takes."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.messages.motion import Six
from elitescript.models.model import RobotModel
from elitescript.motion.limits import MotionLimits


def motion_limits(model: RobotModel) -> MotionLimits:
    """The limits of a model in the form that the planner takes."""
    joints = model.joints
    return MotionLimits(
        q_min=_six(joint.q_min for joint in joints),
        q_max=_six(joint.q_max for joint in joints),
        qd_max=_six(joint.qd_max for joint in joints),
        qdd_max=_six(joint.qdd_max for joint in joints),
        tool_speed_max=model.max_tool_speed,
        tool_acceleration_max=model.max_tool_acceleration,
        equivalent_radius_m=model.equivalent_radius_m,
    )


def _six(values: Iterable[float]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
