"""Robot models: the numbers of one arm, loaded from a TOML file."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import pi
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.limits import JointVector
from elitescript.messages.plant import PlantConfig
from elitescript.models.datafile import OWN_SOURCE, DataFile, NumberSource, known_names, packaged, parsed, read_text
from elitescript.records import field, fields_of, record, replace

SUFFIX: Final = ".toml"
"""Of model files."""

MODELS_KEPT: Final = 16
"""Models that a process keeps: those of the package, and some of its own."""

JOINT_NAMES: Final = ("base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3")
LINK_NAMES: Final = ("shoulder", "upperarm", "forearm", "wrist_1", "wrist_2", "wrist_3")

OUTLINE: Final[dict[str, tuple[str, ...]]] = {
    "base": ("radius",),
    "shoulder": ("radius", "z_from", "z_to", "y_to"),
    "upperarm_housing": ("radius", "z_to"),
    "upperarm_tube": ("radius_first", "radius", "z"),
    "elbow_housing": ("radius", "z_to"),
    "forearm_housing": ("radius", "z_from", "z_to"),
    "forearm_tube": ("radius_first", "radius", "z"),
    "forearm_end": ("radius", "z_from", "z_to"),
    "wrist_1": ("radius", "y_from", "y_to"),
    "wrist_2": ("radius", "y_from", "y_to"),
    "wrist_3": ("radius", "y_from", "y_to"),
}
"""Rows of `[outline]` and what their numbers are, m, in link frames: the housings and tubes of the arm as bodies. Where
two links meet, one of them has the number, and the other's follows from it and the lengths; see `solids.arm`."""


@record
class JointLimit:
    """Limits of one joint."""

    name: str
    q_min: float
    """rad"""
    q_max: float
    """rad"""
    qd_max: float
    """rad/s"""
    qdd_max: float
    """Largest acceleration that a command may ask for, rad/s^2."""
    effort_max: float
    """N m"""
    torque_constant: float
    """Torque at the joint for a current of 1 A, N m/A."""


@record
class LinkMass:
    """Mass of the link that one joint moves; frame i of the modified Denavit-Hartenberg form."""

    name: str
    mass: float
    """kg"""
    com: tuple[float, float, float]
    """Centre of mass in the link frame, m."""
    inertia: tuple[float, float, float, float, float, float]
    """Elements Ixx, Iyy, Izz, Ixy, Ixz, Iyz of the tensor about the centre of mass, axes parallel
    to the link frame, kg m^2."""


@record
class SafetyLevel:
    """Limits in one safety mode."""

    tool_speed: float
    """m/s"""
    elbow_speed: float
    """m/s"""
    tool_force: float
    """N"""
    power: float
    """W"""
    momentum: float
    """kg m/s"""
    stop_time_s: float
    stop_distance: float
    """m"""


@record
class ModelSafetyLimits:
    """Safety limits; on a real robot they are set for each installation, here they are assumed."""

    normal: SafetyLevel
    reduced: SafetyLevel
    joint_speed_margin: float
    """Excess over its limit at which a joint speed is a violation, rad/s."""
    joint_position_margin: float
    """Distance outside its range at which a joint position is a violation, rad."""
    tracking_error_max: float
    """Distance of actual from target joint position that stops the arm, rad."""


@record
class Thermal:
    """Thermal model of joints and control box under load; all of it is assumed."""

    time_constant_s: float
    joint_rise_torque: float
    """Temperature rise of a joint that holds its rated torque permanently, K."""
    joint_rise_speed: float
    """The same for a joint that turns at its largest speed permanently, K."""
    controller_rise: float
    """Temperature rise of the control box when all joints have the mean of both, K."""


@record
class RobotModel:
    """One robot model, SI units."""

    name: str
    type_id: int
    """Number of the model on the wire."""
    arm: Arm
    joints: tuple[JointLimit, ...]
    """Six joints, base to wrist 3."""
    payload_max_kg: float
    reach_m: float
    """Catalogue reach: upper arm, forearm and the wrist stretched."""
    links: tuple[LinkMass, ...]
    """The six links that move."""
    home: JointVector
    """Joint angles after power-on, rad."""
    default_joint_speed: float
    """rad/s"""
    default_joint_acceleration: float
    """rad/s^2"""
    default_tool_speed: float
    """m/s"""
    default_tool_acceleration: float
    """m/s^2"""
    max_joint_acceleration: float
    """Largest of the joints' `qdd_max`, rad/s^2."""
    planning_joint_acceleration: float
    """Acceleration with which a move is planned that only the arm limits, rad/s^2."""
    max_tool_speed: float
    """m/s"""
    max_tool_acceleration: float
    """Largest tool acceleration that a command may ask for, m/s^2."""
    stop_joint_deceleration: float
    """Along the path when a program stops, rad/s^2."""
    stop_tool_deceleration: float
    """m/s^2"""
    gravity: tuple[float, float, float]
    """Start value of `set_gravity`: the vector that points away from the earth, m/s^2."""
    equivalent_radius_m: float
    """Weight of a rotation against a translation, m/rad."""
    speed_ramp_s: float
    """Time in which a planned move adopts a new speed percentage (*assumed*)."""
    tracking_acceleration: float
    """Acceleration with which the tool catches up with a conveyor, m/s^2 (*assumed*)."""
    tracking_speed: float
    """Most speed above that of the conveyor while it does so, m/s (*assumed*)."""
    joint_temperatures: JointVector
    """Start temperatures of the joints, those without load, degC."""
    controller_temperature: float
    """Temperature of the control box while the arm stands without load, degC."""
    thermal: Thermal
    safety: ModelSafetyLimits
    plant: PlantConfig | None
    """How the joints follow their targets, if the file of an own arm has it."""
    sources: DataFile = field(repr=False, compare=False)
    """The file entries of the numbers; read them with `source`."""

    @property
    def joint_ranges(self) -> tuple[tuple[float, float], ...]:
        """(q_min, q_max) of each joint, rad."""
        return tuple([(joint.q_min, joint.q_max) for joint in self.joints])

    def source(self, path: str) -> NumberSource:
        """Return where a number comes from.

        Args:
            path: the number as it is reached from the model: `"joints.elbow.qd_max"`, `"arm.d1"`,
                `"links.forearm.mass"`, `"safety.normal.power"`, `"home"`.

        Raises:
            UsageError: the model has no such number.
        """
        first, _, rest = path.partition(".")
        if first == "joints":
            joint, _, quantity = rest.partition(".")
            if joint in JOINT_NAMES:
                path = f"joints.{quantity}"
        elif path == "max_joint_acceleration":
            path = "joints.qdd_max"
        return self.sources.source(path)

    @property
    def outline(self) -> dict[str, dict[str, float]] | None:
        """The numbers of `OUTLINE` by row and name, m; None if the model's file has none.

        Raises:
            UsageError: a row of another length, or something that is no number.
        """
        if not any(f"outline.{row}" in self.sources for row in OUTLINE):
            return None
        return {
            row: dict(zip(names, self.sources.row(f"outline.{row}", len(names)), strict=True))
            for row, names in OUTLINE.items()
        }

    def calibrated(
        self,
        a: Sequence[float] | None = None,
        d: Sequence[float] | None = None,
        alpha: Sequence[float] | None = None,
    ) -> RobotModel:
        """Return the model with the measured link parameters of one robot; see `Arm.calibrated`."""
        return replace(self, arm=self.arm.calibrated(a, d, alpha))


def model_names() -> tuple[str, ...]:
    """Return the names of the models that come with the package."""
    return known_names()


def load_model(name: str | Path) -> RobotModel:
    """Return the model of that name; a name that ends in `.toml` is the path of a model file.

    Capitals of a name do not matter.

    Raises:
        UsageError: there is no such model (the text names the nearest one), or its file is wrong.
    """
    return load_model_file(name) if is_model_file(name) else _packaged_model(str(name))


@lru_cache(MODELS_KEPT)
def _packaged_model(name: str) -> RobotModel:
    return _model(DataFile(*packaged(name), _KNOWN_KEYS))


def is_model_file(name: str | Path) -> bool:
    """Return whether a robot is named by the path of its file."""
    return str(name).endswith(SUFFIX)


def load_model_file(path: str | Path) -> RobotModel:
    """Return the model that a TOML file describes: one of the package, or an own arm; see `models.datafile`.

    Raises:
        UsageError: the file cannot be read, or an entry is missing, unknown or wrong; the text
            names file and key.
    """
    return parse_model(Path(path).name, read_text(Path(path)))


@lru_cache(MODELS_KEPT)
def parse_model(file: str, text: str) -> RobotModel:
    """Return the model that the text of a file describes; the same text is parsed once in a process.

    Args:
        file: its name, for error texts.
        text: its content.

    Raises:
        UsageError: an entry is missing, unknown or wrong; the text names file and key.
    """
    return _model(DataFile(file, parsed(file, text), _KNOWN_KEYS))


def _model(data: DataFile) -> RobotModel:
    data.refuse_other_keys()
    joints = _joints(data)
    return RobotModel(
        name=data.name,
        type_id=int(data.number("type_id", positive=True)),
        arm=_arm(data),
        joints=joints,
        reach_m=_reach_m(data),
        links=tuple([_link(data, name) for name in LINK_NAMES]),
        home=_home(data, joints),
        max_joint_acceleration=max([joint.qdd_max for joint in joints]),
        gravity=data.vector("gravity"),
        joint_temperatures=data.joint_row("joint_temperatures"),
        controller_temperature=data.number("controller_temperature"),
        thermal=Thermal(*[data.number(f"thermal.{name}", positive=True) for name in _THERMAL]),
        safety=ModelSafetyLimits(
            normal=_safety_level(data, "normal"),
            reduced=_safety_level(data, "reduced"),
            **{name: data.number(f"safety.{name}", positive=True) for name in _SAFETY},
        ),
        plant=_plant(data),
        sources=data,
        **{name: data.number(name, positive=True) for name in _POSITIVE},
    )


_LENGTHS: Final = ("d1", "a2", "a3", "d4", "d5", "d6")
_LENGTH_MAX_M: Final = 3.0
_ANGLE_MAX: Final = 4.0 * pi
_SPEED_MAX: Final = 20.0
"""Beyond these a number is in millimetres or degrees, whatever the arm, m, rad, rad/s."""

_POSITIVE: Final = (
    "payload_max_kg",
    "default_joint_speed",
    "default_joint_acceleration",
    "default_tool_speed",
    "default_tool_acceleration",
    "planning_joint_acceleration",
    "max_tool_speed",
    "max_tool_acceleration",
    "stop_joint_deceleration",
    "stop_tool_deceleration",
    "equivalent_radius_m",
    "speed_ramp_s",
    "tracking_acceleration",
    "tracking_speed",
)
"""Keys of positive numbers that the model has under the same name."""

_JOINT_ROWS: Final = ("q_min", "q_max", "qd_max", "qdd_max", "effort_max", "torque_constant")
_THERMAL: Final = tuple(fields_of(Thermal))
_SAFETY: Final = ("joint_speed_margin", "joint_position_margin", "tracking_error_max")
_SAFETY_LEVEL: Final = tuple(fields_of(SafetyLevel))
_KNOWN_KEYS: Final = frozenset(
    (
        *("type_id", "reach_m", "home", "gravity", "joint_temperatures", "controller_temperature"),
        *_POSITIVE,
        *(f"safety.{name}" for name in _SAFETY),
        *(f"thermal.{name}" for name in _THERMAL),
        *(f"arm.{name}" for name in _LENGTHS),
        *(f"calibration.{name}" for name in ("a", "d", "alpha")),
        *(f"joints.{name}" for name in _JOINT_ROWS),
        *(f"links.{link}.{name}" for link in LINK_NAMES for name in ("mass", "com", "inertia")),
        *(f"safety.{level}.{name}" for level in ("normal", "reduced") for name in _SAFETY_LEVEL),
        *(f"outline.{name}" for name in OUTLINE),
    )
)


def _reach_m(data: DataFile) -> float:
    """Return the catalogue reach; that of an own arm follows its lengths, unless its file gives one."""
    lengths = ("arm.a2", "arm.a3", "arm.d5")
    is_own = [data.source(name).source == OWN_SOURCE for name in (*lengths, "reach_m")]
    if any(is_own[:3]) and not is_own[3]:
        a2, a3, d5 = (data.number(name) for name in lengths)
        return d5 - a2 - a3
    return data.number("reach_m", positive=True)


def _plant(data: DataFile) -> PlantConfig | None:
    if "plant" not in data.tables:
        return None
    try:
        return PlantConfig.from_table(data.tables["plant"])
    except UsageError as error:
        raise UsageError(f"{data.file}: {error}") from None


def _arm(data: DataFile) -> Arm:
    d1, a2, a3, d4, d5, d6 = (_length(data, f"arm.{name}") for name in _LENGTHS)
    a, d, alpha = (
        data.joint_row(f"calibration.{name}") if f"calibration.{name}" in data else None for name in ("a", "d", "alpha")
    )
    try:
        arm = Arm(d1, a2, a3, d4, d5, d6)
        return arm if a is d is alpha is None else arm.calibrated(a, d, alpha)
    except UsageError as error:
        raise UsageError(f"{data.file}: arm: {error}") from None


def _length(data: DataFile, key: str) -> float:
    length = data.number(key)
    if abs(length) > _LENGTH_MAX_M:
        raise UsageError(
            f"{data.file}: {key}: {length:g} m is longer than any arm (at most {_LENGTH_MAX_M:g} m); "
            f"{length:g} mm are {length / 1000.0:g} m"
        )
    return length


def _joint_angles(data: DataFile, key: str, largest: float, unit: str) -> JointVector:
    row = data.joint_row(key)
    for name, value in zip(JOINT_NAMES, row, strict=True):
        if abs(value) > largest:
            raise UsageError(
                f"{data.file}: {key}: {value:g} {unit} of {name} is more than any joint does (at most {largest:.4g} "
                f"{unit}); {key}_deg takes degrees"
            )
    return row


def _joints(data: DataFile) -> tuple[JointLimit, ...]:
    q_min, q_max = (_joint_angles(data, f"joints.{name}", _ANGLE_MAX, "rad") for name in ("q_min", "q_max"))
    _joint_angles(data, "joints.qd_max", _SPEED_MAX, "rad/s")
    for name, low, high in zip(JOINT_NAMES, q_min, q_max, strict=True):
        if not low < high:
            raise UsageError(
                f"{data.file}: joints.q_min: {low} rad of {name} is not below its joints.q_max, {high} rad"
            )
    rows = [data.joint_row(f"joints.{name}", positive=True) for name in _JOINT_ROWS[2:]]
    return tuple([JointLimit(*row) for row in zip(JOINT_NAMES, q_min, q_max, *rows, strict=True)])


def _home(data: DataFile, joints: tuple[JointLimit, ...]) -> JointVector:
    home = data.joint_row("home")
    for angle, joint in zip(home, joints, strict=True):
        if not joint.q_min <= angle <= joint.q_max:
            raise UsageError(
                f"{data.file}: home: {angle} rad of {joint.name} is outside its range "
                f"[{joint.q_min}, {joint.q_max}] rad"
            )
    return home


def _link(data: DataFile, name: str) -> LinkMass:
    return LinkMass(
        name,
        data.number(f"links.{name}.mass", positive=True),
        data.vector(f"links.{name}.com"),
        data.joint_row(f"links.{name}.inertia"),
    )


def _safety_level(data: DataFile, level: str) -> SafetyLevel:
    return SafetyLevel(*[data.number(f"safety.{level}.{name}", positive=True) for name in _SAFETY_LEVEL])
