"""State of the arm and the controller at one tick."""

from __future__ import annotations

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.motion import Six
from elitescript.records import NamedTuple, record

ZERO_SIX: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@record
class JointState:
    """Joints as commanded and as measured: rad, rad/s."""

    q_target: Six
    qd_target: Six
    q_actual: Six
    qd_actual: Six


class Poses(NamedTuple):
    """Poses of TCP and flange, base frame: m, rad."""

    target: Six
    actual: Six
    flange: Six


class TcpSpeeds(NamedTuple):
    """Velocities of the TCP, base frame: m/s, rad/s."""

    target: Six
    actual: Six


@record
class Payload:
    """Load at the flange; see `messages.machine.SetPayload`."""

    mass_kg: float = 0.0
    cog: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: Six = ZERO_SIX


@record
class RobotState:
    """Consistent state of the machine at one tick; poses in the base frame, m and rad (roll-pitch-yaw)."""

    tick: int
    time_s: float
    robot_mode: RobotMode
    safety_mode: SafetyMode
    task_state: TaskState
    q_target: Six
    qd_target: Six
    q_actual: Six
    qd_actual: Six
    tcp_offset: Six
    """From flange to TCP."""
    tcp_pose_target: Six
    tcp_pose_actual: Six
    tcp_speed_target: Six
    """Linear (m/s) and angular (rad/s) velocity of the TCP in the base frame."""
    tcp_speed_actual: Six
    flange_pose_actual: Six
    payload: Payload
    gravity: tuple[float, float, float]
    speed_scale: float
    """Speed percentage as a fraction, 0 to 1."""
    is_moving: bool
    line: int
    """Script line of the main thread; 0 when no program runs."""
    node: tuple[int, str]
    """Last `$ LINE` mark: number and label."""
