"""Builds the snapshot of the machine that ports publish: the parts that are read, once for an arm at rest.

Supply voltages and currents are *assumed*: a 48 V bus, idle currents of cabinet and tool, and the currents of the
motors. A joint without power, or with its brakes closed, has no torque.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.kinematics.arm import Arm
from elitescript.messages.enums import POWERED, RobotMode, TaskState
from elitescript.messages.motion import Six
from elitescript.messages.snapshot import Snapshot, TaskPicture, Three
from elitescript.messages.snapshot_parts import (
    ALL_PARTS,
    ELBOW,
    JOINTS,
    LOADS,
    POSES,
    TCP_SPEEDS,
    TEMPERATURES,
    WRENCHES,
)
from elitescript.messages.state import ZERO_SIX, JointState, Payload, Poses, TcpSpeeds
from elitescript.records import NamedTuple

BUS_V: Final = 48.0
"""Voltage of joints and robot with power (*assumed*: nominal)."""
IDLE_CURRENT_A: Final = 0.5
"""Current of the electronics of the arm (*assumed*)."""
IO_CURRENT_A: Final = 0.05
"""Current of inputs and outputs of the cabinet (*assumed*)."""
TOOL_CURRENT_A: Final = 0.05
"""Current of a tool with supply (*assumed*)."""

_OF_LOADS: Final = LOADS | WRENCHES | ELBOW
_OF_JOINTS: Final = JOINTS | POSES | TCP_SPEEDS | _OF_LOADS
"""Parts that follow from the joints."""
_INSTANT_S: Final = 1e-4
_NO_VOLTAGES: Final[Six] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_BUS_VOLTAGES: Final[Six] = (BUS_V, BUS_V, BUS_V, BUS_V, BUS_V, BUS_V)


class _Key(NamedTuple):
    """Everything that loads, wrenches and elbow of a resting arm depend on."""

    mode: RobotMode
    joints: JointState
    tcp_offset: Six
    payload: Payload
    gravity: Three
    zero: Six
    client_sensor: tuple[float, float, float] | None
    image: Mapping[str, object]


class SnapshotBuilder:
    """Makes the snapshots of one controller.

    Args:
        controller: the machine.
    """

    __slots__ = (
        "_controller",
        "_currents",
        "_elbow_position",
        "_elbow_velocity",
        "_joint_current",
        "_joints",
        "_key",
        "_made",
        "_poses",
        "_raw_wrench",
        "_tcp_force",
        "_tcp_speeds",
        "_temperatures",
        "_torques",
    )

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._key: _Key | None = None
        """Of an arm at rest; None while it moves."""
        self._made = 0
        """Parts that hold for `_key`."""
        self._joints: JointState | None = None
        """Of the last snapshot that has them; None before the first one, which is whole."""
        self._poses: Poses
        self._tcp_speeds: TcpSpeeds
        self._torques = self._currents = self._tcp_force = self._raw_wrench = ZERO_SIX
        self._joint_current = 0.0
        """Sum of the magnitudes of the currents."""
        self._elbow_position: Three = (0.0, 0.0, 0.0)
        self._elbow_velocity: Three = (0.0, 0.0, 0.0)
        self._temperatures: tuple[Six, float]

    def copy(self) -> SnapshotBuilder:
        """Return another one that goes on from what this one has computed."""
        other = SnapshotBuilder(self._controller)
        for name in _KEPT:
            if hasattr(self, name):
                setattr(other, name, getattr(self, name))
        return other

    def picture(self, task: TaskPicture, popup: str, *, is_remote: bool, parts: int = ALL_PARTS) -> Snapshot:
        """Return the snapshot of the present tick.

        Args:
            task: state of the task for the dashboard.
            popup: text of the open message window.
            is_remote: whether clients may change the robot.
            parts: that are computed; the others stay as in the last snapshot that had them. The first one has all.
        """
        controller = self._controller
        signals, mode, tick = controller.signals, controller.robot_mode, controller.tick
        joints = self._joints
        if joints is None:
            parts = ALL_PARTS
        if parts & _OF_JOINTS or joints is None:
            joints = self._joints = controller.joints()
            if parts & POSES:
                self._poses = controller.poses_of(joints)
            if parts & TCP_SPEEDS:
                self._tcp_speeds = controller.tcp_speeds_of(joints)
            self._make_loads(parts & _OF_LOADS, mode, joints)
        if parts & TEMPERATURES:
            self._temperatures = controller.loads.temperatures(tick)
        temperatures, controller_temperature = self._temperatures
        robot = controller.state_of(tick, joints, self._poses, self._tcp_speeds)
        is_powered = mode in POWERED
        image = signals.image
        pins = signals.tool_pins
        is_paused = robot.task_state is TaskState.PAUSED
        # By position, in the order of the fields: so many keywords take a microsecond.
        return Snapshot(
            robot,
            self._torques,  # joint_torques
            self._currents,  # joint_currents
            temperatures,  # joint_temperatures
            _BUS_VOLTAGES if is_powered else _NO_VOLTAGES,  # joint_voltages
            self._tcp_force,
            self._raw_wrench,
            self._elbow_position,
            self._elbow_velocity,
            0.0 if is_paused and not robot.is_moving else controller.motion.rate(tick),  # speed_scaling
            controller_temperature,
            BUS_V if is_powered else 0.0,  # robot_voltage
            IDLE_CURRENT_A + self._joint_current if is_powered else 0.0,  # robot_current
            IO_CURRENT_A,  # io_current
            TOOL_CURRENT_A if is_powered and image["tool_voltage"][0] else 0.0,  # tool_current
            temperatures[5],  # tool_temperature
            image,  # signals
            signals.domain_image,  # domains
            signals.tool_analog_mode,
            (int(pins[0].mode), int(pins[1].mode), int(pins[2].mode), int(pins[3].mode)),  # tool_pin_modes
            is_remote,
            controller.yielding.is_guiding,  # is_freedrive
            popup,
            task,
            0,  # overruns
            controller.yielding.is_guided_by_input,
        )

    def discrete_state(self) -> tuple[object, ...]:
        """Return levels, modes, tool and payload: the part of a snapshot that does not change with time alone.

        While it stays equal, an older snapshot is valid for these; joints, poses, forces, temperatures and the program
        line are of its own tick.
        """
        controller = self._controller
        signals, setup, yielding = controller.signals, controller.setup, controller.yielding
        return (
            signals.image,
            signals.domain_image,
            signals.tool_analog_mode,
            tuple(signals.tool_pins),
            setup.tcp_offset,
            setup.payload,
            setup.gravity,
            controller.power.mode,
            controller.safety.mode,
            controller.safety.speed_scale,
            controller.task.state,
            yielding.is_guiding,
            yielding.is_guided_by_input,
        )

    def _make_loads(self, parts: int, mode: RobotMode, joints: JointState) -> None:
        """Compute loads, wrenches and elbow, unless the arm rests and they are there already."""
        if not parts:
            return
        controller = self._controller
        key = self._key_of_rest(mode)
        if key is None or key != self._key:
            self._key, self._made = key, 0
        parts &= ~self._made
        self._made |= parts
        if parts & LOADS:
            self._torques = self._currents = ZERO_SIX
            if mode is RobotMode.RUNNING:
                self._torques, self._currents = controller.loads.measured(controller.tick)
            self._joint_current = sum(map(abs, self._currents))
        if parts & WRENCHES:
            self._tcp_force, self._raw_wrench = controller.tcp_wrenches()
        if parts & ELBOW:
            self._elbow_position = controller.arm.elbow(joints.q_actual)
            self._elbow_velocity = elbow_velocity(controller.arm, joints.q_actual, joints.qd_actual)

    def _key_of_rest(self, mode: RobotMode) -> _Key | None:
        controller = self._controller
        arm_state, setup, sensor = controller.arm_state, controller.setup, controller.yielding.sensor
        if not arm_state.is_resting:
            return None
        return _Key(
            mode,
            arm_state.joints(controller.tick),
            setup.tcp_offset,
            setup.payload,
            setup.gravity,
            sensor.zero,
            sensor.client_offset,
            controller.signals.image,
        )


_KEPT: Final = tuple(name for name in SnapshotBuilder.__slots__ if name != "_controller")


def elbow_velocity(arm: Arm, q: Six, qd: Six) -> Three:
    """Return the velocity of the elbow (m/s, base frame) for joints in rad and rad/s, as a central difference."""
    if qd == ZERO_SIX:
        return (0.0, 0.0, 0.0)
    x0, y0, z0 = arm.elbow(_moved(q, qd, -_INSTANT_S))
    x1, y1, z1 = arm.elbow(_moved(q, qd, _INSTANT_S))
    span_s = 2.0 * _INSTANT_S
    return (x1 - x0) / span_s, (y1 - y0) / span_s, (z1 - z0) / span_s


def _moved(q: Six, qd: Six, time_s: float) -> Six:
    q1, q2, q3, q4, q5, q6 = q
    w1, w2, w3, w4, w5, w6 = qd
    return (
        q1 + time_s * w1,
        q2 + time_s * w2,
        q3 + time_s * w3,
        q4 + time_s * w4,
        q5 + time_s * w5,
        q6 + time_s * w6,
    )
