"""Data that ports publish: the state of a robot at one tick, and its constant description.

Primary port, RTSI, dashboard, Modbus server, pendant and `ctl` read a `Snapshot` and a `RobotDescription`, nothing
else, so that they agree about a tick.
"""

from __future__ import annotations

from collections.abc import Mapping

from elitescript.messages.enums import AnalogDomain
from elitescript.messages.motion import Six
from elitescript.messages.profile import BRACKETED
from elitescript.messages.signals import Value
from elitescript.messages.state import RobotState
from elitescript.records import record

Three = tuple[float, float, float]


@record
class TaskPicture:
    """The task as the dashboard shows it."""

    loaded: str
    """Path of the loaded task relative to the task folder; empty if none is."""
    running: str
    """Name of the program that runs, whether it came from the task or from a port; empty if none does."""
    configuration: str
    """Path of the loaded configuration relative to its folder."""
    is_saved: bool
    is_configuration_modified: bool


@record
class Snapshot:
    """State of the whole machine at one tick, as its ports show it."""

    robot: RobotState
    joint_torques: Six
    """N m."""
    joint_currents: Six
    """A."""
    joint_temperatures: Six
    """degC."""
    joint_voltages: Six
    """V."""
    tcp_force: Six
    """Wrench of the sensor without the payload, N and N m."""
    raw_wrench: Six
    """Wrench as the sensor measures it."""
    elbow_position: Three
    """m, base frame."""
    elbow_velocity: Three
    """m/s, base frame."""
    speed_scaling: float
    """Present rate of planned time, 0 to 1."""
    controller_temperature: float
    """degC."""
    robot_voltage: float
    """V."""
    robot_current: float
    """A."""
    io_current: float
    """A."""
    tool_current: float
    """A."""
    tool_temperature: float
    """degC."""
    signals: Mapping[str, tuple[Value, ...]]
    """Every family of `messages.signals` by name."""
    domains: Mapping[str, tuple[AnalogDomain, ...]]
    """Domain of every analog channel by family."""
    tool_analog_mode: int
    """See `SetToolAnalogMode`."""
    tool_pin_modes: tuple[int, int, int, int]
    """`ToolPinMode` of each pin."""
    is_remote: bool
    """Whether clients may change the robot."""
    is_freedrive: bool
    """Whether a person guides the arm."""
    popup: str
    """Text of the message window that is open; empty if none is."""
    task: TaskPicture
    overruns: int
    """Always 0: the robot server counts ticks that began late. The digests of journals cover the field."""
    is_guided_by_input: bool = False
    """Whether a person guides the arm because an input asks for it."""


@record
class RobotDescription:
    """Constant data of a robot."""

    model: str
    type_id: int
    """Number of the model on the wire."""
    serial_number: str
    robot_id: str
    firmware: tuple[int, int]
    """Release of the firmware whose ports the robot has."""
    version: tuple[int, int, int, int]
    """That clients are shown: major, minor, bug fix, build."""
    q_min: Six
    q_max: Six
    """rad"""
    qd_max: Six
    """rad/s"""
    qdd_max: Six
    """rad/s^2"""
    default_joint_speed: float
    default_joint_acceleration: float
    default_tool_speed: float
    default_tool_acceleration: float
    equivalent_radius_m: float
    dh_a: Six
    dh_d: Six
    dh_alpha: Six
    """Modified (Craig) parameters, m and rad: row i holds a(i-1), alpha(i-1), d(i)."""
    safety_checksum: int
    operational_mode: int = -1
    """0 manual, 1 automatic, -1 not reported."""
    query_form: str = BRACKETED
    """How the query port writes its replies, one of `QUERY_FORMS`."""
