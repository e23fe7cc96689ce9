"""Compares the arm of a recording with a model, by what the controller's primary port says of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Any, Final

from elitescript.models.model import RobotModel
from elitescript.records import NamedTuple

LENGTH_M: Final = 1e-5
ANGLE_RAD: Final = 1e-5
"""Differences of lengths and angles of an arm that do not count."""
_SHARE: Final = 1e-3
"""The same of limits and defaults, as a share."""

_DEFAULTS: Final = {
    "joint_speed": "default_joint_speed",
    "joint_acceleration": "default_joint_acceleration",
    "tool_speed": "default_tool_speed",
    "tool_acceleration": "default_tool_acceleration",
}
_LIMITS: Final = ("q_min", "q_max", "qd_max", "qdd_max")


class ArmDifference(NamedTuple):
    """A number of the arm that differs from the model's, in its SI unit."""

    name: str
    unit: str
    recorded: float
    model: float
    is_geometry: bool
    """Whether it moves the TCP elsewhere for the same joints."""


def shows_lengths(facts: Mapping[str, Any]) -> bool:
    """Return whether a recording shows lengths by which its arm can be compared."""
    lengths = facts.get("lengths", {})
    return all(any(map(isfinite, known)) and any(known) for known in (lengths.get("a", ()), lengths.get("d", ())))


def arm_differences(facts: Mapping[str, Any], model: RobotModel) -> Iterator[ArmDifference]:
    """Yield what the recorded configuration has that the model has not: lengths first, then limits, then defaults."""
    lengths = facts.get("lengths", {})
    for key, values, first in zip(("a", "d", "alpha"), model.arm.modified_dh, (0, 1, 0), strict=True):
        known = lengths.get(key)
        if known is None or not any(known):
            continue
        unit, least = ("rad", ANGLE_RAD) if key == "alpha" else ("m", LENGTH_M)
        for index, (found, value) in enumerate(zip(known, values, strict=True)):
            if isfinite(found) and abs(found - value) > least:
                yield ArmDifference(f"{key}{index + first}", unit, found, value, True)
    limits = facts.get("limits", {})
    own: Mapping[str, Sequence[float]] = {
        "q_min": [low for low, _ in model.joint_ranges],
        "q_max": [high for _, high in model.joint_ranges],
        "qd_max": [joint.qd_max for joint in model.joints],
        "qdd_max": [joint.qdd_max for joint in model.joints],
    }
    for name, unit in zip(_LIMITS, ("rad", "rad", "rad/s", "rad/s^2"), strict=True):
        for joint, (found, value) in enumerate(zip(limits.get(name, ()), own[name], strict=False), 1):
            if isfinite(found) and found and abs(found - value) > _SHARE * abs(value):
                yield ArmDifference(f"{name} of joint {joint}", unit, found, value, False)
    defaults = facts.get("defaults", {})
    for name, attribute in _DEFAULTS.items():
        found, value = defaults.get(name), getattr(model, attribute)
        if found and isfinite(found) and abs(found - value) > _SHARE * value:
            unit = ("rad" if name.startswith("joint") else "m") + ("/s" if name.endswith("speed") else "/s^2")
            yield ArmDifference(attribute, unit, found, value, False)
