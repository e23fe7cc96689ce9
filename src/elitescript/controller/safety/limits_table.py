"""Reads the safety configuration from the section `[safety]` of a cell file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi, radians
from typing import Any

from elitescript.controller.config_table import ConfigTable, shown
from elitescript.controller.safety.limits import (
    CONFIGURABLE_MODES,
    NOT_REPORTED,
    PAIRS,
    PLANE_USES,
    REDUCED_TCP_SPEED,
    SafetyBounds,
    SafetyLimits,
    SafetyPlane,
    ToolDirection,
)
from elitescript.messages.motion import Six


def read_safety_limits(table: Mapping[str, Any]) -> SafetyLimits:
    """See `SafetyLimits.from_table`."""
    reader = ConfigTable("[safety]", table)
    normal = _bounds(reader)
    reduced = SafetyBounds(tcp_speed_max=REDUCED_TCP_SPEED)
    if reader.has("reduced"):
        inner = ConfigTable("[safety.reduced]", reader.value("reduced"))
        given = _bounds(inner)
        reduced = given if given.tcp_speed_max is not None else replace(given, tcp_speed_max=REDUCED_TCP_SPEED)
        inner.finish()
    reader.value("reduced")
    limits = SafetyLimits(normal, reduced, _planes(reader), _tool_direction(reader), _operational_mode(reader))
    reader.finish()
    return limits


def _operational_mode(reader: ConfigTable) -> str:
    mode = reader.value("operational_mode")
    if mode is None:
        return NOT_REPORTED
    if mode not in CONFIGURABLE_MODES:
        raise reader.error("operational_mode", f'must be "automatic" or "manual", got {shown(mode)}')
    return str(mode)


def _bounds(reader: ConfigTable) -> SafetyBounds:
    q_min, q_max = _joint_range(reader)
    speeds = _in_degrees_or_not(reader, "joint_speed", "/s")
    return SafetyBounds(
        q_min,
        q_max,
        None if speeds is None else _six(speeds),
        reader.number("tcp_speed", "m/s", is_positive=True),
        reader.number("tcp_force", "N", is_positive=True),
    )


def _in_degrees_or_not(reader: ConfigTable, key: str, per: str) -> tuple[float, ...] | None:
    plain = reader.numbers(key, 6, f"rad{per}", is_positive=True)
    in_degrees = reader.numbers(f"{key}_deg", 6, f"deg{per}", is_positive=True)
    if plain is not None and in_degrees is not None:
        raise reader.error(f"{key}_deg", f"is given besides {key}; give one of them")
    return plain if in_degrees is None else tuple(map(radians, in_degrees))


def _joint_range(reader: ConfigTable) -> tuple[Six | None, Six | None]:
    plain, in_degrees = reader.value("joint_range"), reader.value("joint_range_deg")
    if plain is None and in_degrees is None:
        return None, None
    if plain is not None and in_degrees is not None:
        raise reader.error("joint_range_deg", "is given besides joint_range; give one of them")
    key, rows, unit = ("joint_range", plain, "rad") if in_degrees is None else ("joint_range_deg", in_degrees, "deg")
    if not isinstance(rows, list) or len(rows) != 6:
        raise reader.error(key, f"must be six pairs [lowest, highest] in {unit}, got {shown(rows)}")
    pairs = []
    for index, row in enumerate(rows):
        is_pair = isinstance(row, list) and len(row) == 2
        if not is_pair or any(isinstance(item, bool) or not isinstance(item, (int, float)) for item in row):
            raise reader.error(f"{key}[{index}]", f"must be a pair [lowest, highest] in {unit}, got {shown(row)}")
        if not row[0] < row[1]:
            raise reader.error(f"{key}[{index}]", f"is an empty range: {row[0]:g} to {row[1]:g} {unit}")
        pairs.append(row if in_degrees is None else [radians(row[0]), radians(row[1])])
    return _six(tuple(float(pair[0]) for pair in pairs)), _six(tuple(float(pair[1]) for pair in pairs))


def _planes(reader: ConfigTable) -> tuple[SafetyPlane, ...]:
    rows = reader.value("planes")
    if rows is None:
        return ()
    if not isinstance(rows, list):
        raise reader.error("planes", "must be a list of tables: write each under [[safety.planes]]")
    return tuple(_plane(ConfigTable(f"[[safety.planes]] {number}:", row), number) for number, row in enumerate(rows, 1))


def _plane(reader: ConfigTable, number: int) -> SafetyPlane:
    name = reader.text("name", f"plane {number}")
    point = reader.numbers("point", 3, "m")
    normal = reader.direction("normal")
    if point is None or normal is None:
        missing = "point" if point is None else "normal"
        raise reader.error(missing, "is missing: a plane has a point and a normal to the allowed side")
    offset = reader.number("offset", "m") or 0.0
    use = reader.text("use", "always", PLANE_USES)
    inputs = reader.value("inputs")
    if inputs is not None and (not isinstance(inputs, list) or tuple(inputs) not in PAIRS):
        known = ", ".join(str(list(pair)) for pair in PAIRS)
        raise reader.error("inputs", f"must be one of {known}, got {shown(inputs)}")
    reader.finish()
    x, y, z = point
    return SafetyPlane(name, (x, y, z), normal, offset, use, None if inputs is None else PAIRS.index(tuple(inputs)))


def _tool_direction(reader: ConfigTable) -> ToolDirection | None:
    table = reader.value("tool_direction")
    if table is None:
        return None
    inner = ConfigTable("[safety.tool_direction]", table)
    axis = inner.direction("axis")
    angle = inner.number("angle", "rad", is_positive=True)
    angle_deg = inner.number("angle_deg", "deg", is_positive=True)
    inner.finish()
    if axis is None:
        raise inner.error("axis", "is missing")
    if (angle is None) == (angle_deg is None):
        raise inner.error("angle_deg", "or angle must be given, one of them")
    value = radians(angle_deg) if angle is None and angle_deg is not None else angle
    assert value is not None
    if not value <= pi:
        raise inner.error("angle", "must not be more than pi rad (180 deg)")
    return ToolDirection(axis, value)


def _six(values: tuple[float, ...]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
