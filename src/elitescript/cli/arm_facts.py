"""What `check` knows of the arm: its model, and what a world file limits."""

from __future__ import annotations

from typing import NamedTuple

from elitescript.commands.definition.plausibility import ArmFacts
from elitescript.devices.world_file import load_cell
from elitescript.kinematics.arm import Arm
from elitescript.models.model import load_model


class _Limited(NamedTuple):
    """An arm in an installation."""

    arm: Arm
    joint_ranges: tuple[tuple[float, float], ...]
    payload_max_kg: float


def arm_facts(robot: str | None, world: str | None) -> ArmFacts | None:
    """Return the arm of that name, with the joint ranges that the safety configuration of a world file leaves.

    Args:
        robot: name of the arm; None for any.
        world: path of a world file, which is read in any case, so that its mistakes are reported.

    Raises:
        UsageError: no such arm, or a world file that makes no sense.
    """
    cell = None if world is None else load_cell(world)
    if robot is None:
        return None
    model = load_model(robot)
    safety = None if cell is None else cell.configurations.get("safety")
    if safety is None or (safety.normal.q_min is None and safety.normal.q_max is None):
        return model
    low, high = zip(*model.joint_ranges, strict=True)
    lows = map(max, low, safety.normal.q_min or low)
    highs = map(min, high, safety.normal.q_max or high)
    return _Limited(model.arm, tuple(zip(lows, highs, strict=True)), model.payload_max_kg)
