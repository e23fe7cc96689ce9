"""Facts of the arm for `check` and editors: its model, and the limits of its safety configuration."""

from __future__ import annotations

from elitescript.commands.definition.plausibility import ArmFacts
from elitescript.kernel.options import RobotOptions
from elitescript.kinematics.arm import Arm
from elitescript.models.model import load_model
from elitescript.records import NamedTuple


class _Limited(NamedTuple):
    """An arm with the limits of an installation."""

    name: str
    arm: Arm
    joint_ranges: tuple[tuple[float, float], ...]
    payload_max_kg: float


def arm_facts(robot: RobotOptions) -> ArmFacts:
    """Return the arm of a robot, with the joint ranges that its safety configuration allows.

    Raises:
        UsageError: no such arm.
    """
    model, safety = load_model(robot.model), robot.safety
    if safety is None or (safety.normal.q_min is None and safety.normal.q_max is None):
        return model
    low, high = zip(*model.joint_ranges, strict=True)
    lows = map(max, low, safety.normal.q_min or low)
    highs = map(min, high, safety.normal.q_max or high)
    return _Limited(model.name, model.arm, tuple(zip(lows, highs, strict=True)), model.payload_max_kg)
