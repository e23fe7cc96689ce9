"""Defines the safety configuration: joint ranges and speeds, speed and force of the TCP, planes, the tool's direction.

No speed or place is watched in normal mode unless it is configured, because the limits of an installation are not
known. Reduced mode limits the TCP to `REDUCED_TCP_SPEED` (*assumed*: the usual value of collaborative arms of this
size). The force at the TCP is limited in every mode (*assumed* as well), where anything can touch the TCP.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf, isfinite, pi, radians
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import UsageError
from elitescript.kinematics.transforms import Transform
from elitescript.messages.enums import SafetyMode
from elitescript.messages.motion import Six
from elitescript.motion.limits import JOINT_NAMES
from elitescript.records import record, replace

if TYPE_CHECKING:
    from elitescript.controller.safety.config_table import ConfigTable

REDUCED_TCP_SPEED: Final = 0.75
"""m/s"""

NORMAL_TCP_FORCE: Final = 250.0
REDUCED_TCP_FORCE: Final = 150.0
"""N; the order of magnitude that collaborative arms are delivered with (*assumed*)."""

NOT_REPORTED: Final = "not reported"
CONFIGURABLE_MODES: Final = ("automatic", "manual")
OPERATIONAL_MODES: Final = {NOT_REPORTED: -1, "manual": 0, "automatic": 1}
"""Number of every operational mode on the wire. *Assumed*."""

PLANE_USES: Final = ("always", "normal", "reduced", "trigger_reduced")

PAIRS: Final = ((0, 1), (2, 3), (4, 5), (6, 7))
"""Configurable inputs that belong together (manual 2.14, `is_within_safety_limits`)."""

Vector3 = tuple[float, float, float]


def switched_pairs(read: Callable[[str, int], object]) -> tuple[bool, ...]:
    """Return for each pair of configurable inputs whether both are high; `read` gives the level of a signal."""
    name = "configurable_digital_in"
    return tuple([bool(read(name, first)) and bool(read(name, second)) for first, second in PAIRS])


def _check_positive(what: str, value: float, unit: str) -> None:
    if not (isfinite(value) and value > 0.0):
        raise UsageError(f"{what} must be a positive number in {unit}, got {value!r}")


@record
class SafetyBounds:
    """Limits of one mode; None where only the model limits.

    Args:
        q_min: lower ends of the joint ranges, rad.
        q_max: upper ends, rad.
        qd_max: joint speeds, rad/s.
        tcp_speed_max: speed of the TCP, m/s.
        tcp_force_max: force between the TCP and what it touches, N; None takes `NORMAL_TCP_FORCE` or
            `REDUCED_TCP_FORCE` (`SafetyLimits.tcp_force_max`).

    Raises:
        UsageError: an empty range, or a speed or force that is not a positive number.
    """

    q_min: Six | None = None
    q_max: Six | None = None
    qd_max: Six | None = None
    tcp_speed_max: float | None = None
    tcp_force_max: float | None = None

    def __post_init__(self) -> None:
        low, high = self.q_min or (-inf,) * 6, self.q_max or (inf,) * 6
        for name, a, b in zip(JOINT_NAMES, low, high, strict=True):
            if not a < b:
                raise UsageError(f"the safety range of joint {name} is empty: {a:g} to {b:g} rad")
        for name, speed in zip(JOINT_NAMES, self.qd_max or (1.0,) * 6, strict=True):
            _check_positive(f"the safety limit of the speed of joint {name}", speed, "rad/s")
        if self.tcp_speed_max is not None:
            _check_positive("the safety limit of the TCP speed", self.tcp_speed_max, "m/s")
        if self.tcp_force_max is not None:
            _check_positive("the safety limit of the TCP force", self.tcp_force_max, "N")

    @property
    def is_empty(self) -> bool:
        """Whether no range and no speed is limited."""
        return replace(self, tcp_force_max=None) == _NO_BOUNDS

    def within(self, other: SafetyBounds) -> SafetyBounds:
        """Return these ranges and speeds, completed with the ranges of `other`, and no speed above its speeds."""
        qd_max = self.qd_max or other.qd_max
        if self.qd_max is not None and other.qd_max is not None:
            a, b, c, d, e, f = map(min, self.qd_max, other.qd_max)
            qd_max = (a, b, c, d, e, f)
        speeds = [speed for speed in (self.tcp_speed_max, other.tcp_speed_max) if speed is not None]
        return SafetyBounds(
            self.q_min or other.q_min, self.q_max or other.q_max, qd_max, min(speeds) if speeds else None
        )


_NO_BOUNDS: Final = SafetyBounds()


@record
class SafetyPlane:
    """A plane in the base frame that the TCP may not pass.

    Args:
        name: for messages.
        point: a point of it, m.
        normal: direction to the allowed side; its length does not count.
        offset_m: moves the plane along the normal.
        use: in which mode it counts; `trigger_reduced` asks for reduced mode behind it instead of stopping the arm.
        pair: index of the pair of configurable inputs that switches it on while both are high (*assumed*); None
            for a plane that always counts.

    Raises:
        UsageError: a normal without direction, or an unknown use or pair.
    """

    name: str
    point: Vector3
    normal: Vector3
    offset_m: float = 0.0
    use: str = "always"
    pair: int | None = None

    def __post_init__(self) -> None:
        length = sum(part * part for part in self.normal) ** 0.5
        if not (isfinite(length) and length > 1e-9):
            raise UsageError(f"the normal of safety plane {self.name!r} has no direction: {self.normal}")
        if not all(map(isfinite, (*self.point, self.offset_m))):
            raise UsageError(f"point and offset of safety plane {self.name!r} must be finite numbers")
        if self.use not in PLANE_USES:
            raise UsageError(f"the use of safety plane {self.name!r} must be one of {', '.join(PLANE_USES)}")
        if self.pair is not None and self.pair not in range(len(PAIRS)):
            raise UsageError(f"the input pair of safety plane {self.name!r} must be 0 to 3, got {self.pair}")
        x, y, z = self.normal
        if abs(length - 1.0) > 1e-12:
            object.__setattr__(self, "normal", (x / length, y / length, z / length))

    def distance(self, T_base_tcp: Transform) -> float:
        """Return how far the TCP is on the allowed side, m; negative behind the plane."""
        x, y, z = T_base_tcp[9:]
        a, b, c = self.point
        u, v, w = self.normal
        return (x - a) * u + (y - b) * v + (z - c) * w - self.offset_m


@record
class ToolDirection:
    """A cone, fixed in the base frame, that the tool's z axis stays in.

    Args:
        axis: of the cone, of length 1.
        angle: from the axis to the surface, rad.
    """

    axis: Vector3
    angle: float

    def __post_init__(self) -> None:
        if not 0.0 < self.angle <= pi:
            raise UsageError(f"the angle of the tool direction must be in (0, pi] rad, got {self.angle:g}")


@record
class SafetyLimits:
    """The safety configuration of one installation.

    Args:
        normal: limits of normal mode.
        reduced: limits of reduced mode and of recovery; where it has none, or where speeds or the force of normal mode
            are lower, those of normal mode hold.
        planes: planes that the TCP may not pass.
        tool_direction: a cone that the tool stays in.
        operational_mode: one of `OPERATIONAL_MODES`; the primary port shows it, nothing else depends on it.

    Raises:
        UsageError: an unknown operational mode.
    """

    normal: SafetyBounds = _NO_BOUNDS
    reduced: SafetyBounds = SafetyBounds(tcp_speed_max=REDUCED_TCP_SPEED)
    planes: tuple[SafetyPlane, ...] = ()
    tool_direction: ToolDirection | None = None
    operational_mode: str = NOT_REPORTED

    def __post_init__(self) -> None:
        if self.operational_mode not in OPERATIONAL_MODES:
            modes = " or ".join(map(repr, CONFIGURABLE_MODES))
            raise UsageError(f"operational_mode must be {modes}, got {self.operational_mode!r}")

    @property
    def is_default(self) -> bool:
        """Whether normal mode is not watched at all."""
        return self.normal.is_empty and not self.planes and self.tool_direction is None

    def bounds(self, mode: SafetyMode) -> SafetyBounds:
        """Return limits of speed and range in a mode."""
        return self.normal if mode is SafetyMode.NORMAL else self.reduced.within(self.normal)

    def tcp_force_max(self, mode: SafetyMode) -> float:
        """Return the limit of the force at the TCP in a mode, N."""
        normal = self.normal.tcp_force_max or NORMAL_TCP_FORCE
        if mode is SafetyMode.NORMAL:
            return normal
        return min(normal, self.reduced.tcp_force_max or REDUCED_TCP_FORCE)

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> SafetyLimits:
        """Read the section `[safety]` of a world file.

        Keys: `joint_range` and `joint_speed` (rad, rad/s; with `_deg` in degrees), `tcp_speed` (m/s), `tcp_force` (N),
        the same in `[safety.reduced]`; `[[safety.planes]]` with `name`, `point`, `normal`, `offset` (m), `use` and
        `inputs`; `[safety.tool_direction]` with `axis` and `angle` or `angle_deg`; `operational_mode`, `automatic` or
        `manual`.

        Raises:
            UsageError: an unknown key, or an invalid value.
        """
        # Imported late: few robots have such a section.
        from elitescript.controller.safety.config_table import ConfigTable

        reader = ConfigTable("safety", table)
        normal = _bounds(reader)
        reduced = SafetyBounds(tcp_speed_max=REDUCED_TCP_SPEED)
        inner = reader.table("reduced")
        if inner is not None:
            given = _bounds(inner)
            reduced = given if given.tcp_speed_max is not None else replace(given, tcp_speed_max=REDUCED_TCP_SPEED)
            inner.finish()
        limits = cls(normal, reduced, _planes(reader), _tool_direction(reader), _operational_mode(reader))
        reader.finish()
        return limits


def _operational_mode(reader: ConfigTable) -> str:
    mode = reader.value("operational_mode")
    if mode is None:
        return NOT_REPORTED
    if mode not in CONFIGURABLE_MODES:
        raise reader.refused("operational_mode", 'must be "automatic" or "manual"', mode)
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
        raise reader.refused(key, f"must be six pairs [lowest, highest] in {unit}", rows)
    pairs = []
    for index, row in enumerate(rows):
        is_pair = isinstance(row, list) and len(row) == 2
        if not is_pair or any(isinstance(item, bool) or not isinstance(item, (int, float)) for item in row):
            raise reader.refused(f"{key}[{index}]", f"must be a pair [lowest, highest] in {unit}", row)
        if not row[0] < row[1]:
            raise reader.error(f"{key}[{index}]", f"is an empty range: {row[0]:g} to {row[1]:g} {unit}")
        pairs.append(row if in_degrees is None else [radians(row[0]), radians(row[1])])
    return _six(tuple(float(pair[0]) for pair in pairs)), _six(tuple(float(pair[1]) for pair in pairs))


def _planes(reader: ConfigTable) -> tuple[SafetyPlane, ...]:
    return tuple(_plane(row, number) for number, row in enumerate(reader.tables("planes"), 1))


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
        raise reader.refused("inputs", f"must be one of {known}", inputs)
    reader.finish()
    x, y, z = point
    return SafetyPlane(name, (x, y, z), normal, offset, use, None if inputs is None else PAIRS.index(tuple(inputs)))


def _tool_direction(reader: ConfigTable) -> ToolDirection | None:
    inner = reader.table("tool_direction")
    if inner is None:
        return None
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
