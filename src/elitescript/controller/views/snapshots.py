"""Builds the snapshot of the machine that ports publish; unchanged parts are not computed again.

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
from elitescript.messages.state import ZERO_SIX, JointState, Payload
from elitescript.records import NamedTuple

BUS_V: Final = 48.0
"""Voltage of joints and robot with power (*assumed*: nominal)."""
IDLE_CURRENT_A: Final = 0.5
"""Current of the electronics of the arm (*assumed*)."""
IO_CURRENT_A: Final = 0.05
"""Current of inputs and outputs of the cabinet (*assumed*)."""
TOOL_CURRENT_A: Final = 0.05
"""Current of a tool with supply (*assumed*)."""

_INSTANT_S: Final = 1e-4
_NO_VOLTAGES: Final[Six] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_BUS_VOLTAGES: Final[Six] = (BUS_V, BUS_V, BUS_V, BUS_V, BUS_V, BUS_V)


class LoadState(NamedTuple):
    """Loads of the joints, wrenches, and motion of the elbow."""

    torques: Six
    currents: Six
    joint_current: float
    """Sum of their magnitudes."""
    tcp_force: Six
    raw_wrench: Six
    elbow_position: Three
    elbow_velocity: Three


class _Key(NamedTuple):
    """Everything that the load of a resting arm depends on."""

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

    __slots__ = ("_controller", "_key", "_load")

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._key: _Key | None = None
        self._load = LoadState(ZERO_SIX, ZERO_SIX, 0.0, ZERO_SIX, ZERO_SIX, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def picture(self, task: TaskPicture, popup: str, *, is_remote: bool, overruns: int) -> Snapshot:
        """Return the snapshot of the present tick.

        Args:
            task: state of the task for the dashboard.
            popup: text of the open message window.
            is_remote: whether clients may change the robot.
            overruns: ticks that began late.
        """
        controller = self._controller
        robot = controller.state()
        signals = controller.signals
        temperatures, controller_temperature = controller.loads.temperatures(robot.tick)
        load = self._load_of_now(robot.robot_mode)
        is_powered = robot.robot_mode in POWERED
        voltage = BUS_V if is_powered else 0.0
        image = signals.image
        pins = signals.tool_pins
        is_paused = robot.task_state is TaskState.PAUSED
        return Snapshot(
            robot=robot,
            joint_torques=load.torques,
            joint_currents=load.currents,
            joint_temperatures=temperatures,
            joint_voltages=_BUS_VOLTAGES if is_powered else _NO_VOLTAGES,
            tcp_force=load.tcp_force,
            raw_wrench=load.raw_wrench,
            elbow_position=load.elbow_position,
            elbow_velocity=load.elbow_velocity,
            speed_scaling=0.0 if is_paused and not robot.is_moving else controller.motion.rate(robot.tick),
            controller_temperature=controller_temperature,
            robot_voltage=voltage,
            robot_current=IDLE_CURRENT_A + load.joint_current if is_powered else 0.0,
            io_current=IO_CURRENT_A,
            tool_current=TOOL_CURRENT_A if is_powered and image["tool_voltage"][0] else 0.0,
            tool_temperature=temperatures[5],
            signals=image,
            domains=signals.domain_image,
            tool_analog_mode=signals.tool_analog_mode,
            tool_pin_modes=(int(pins[0].mode), int(pins[1].mode), int(pins[2].mode), int(pins[3].mode)),
            is_remote=is_remote,
            is_freedrive=controller.yielding.is_guiding,
            popup=popup,
            task=task,
            overruns=overruns,
            is_guided_by_input=controller.yielding.is_guided_by_input,
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

    def _load_of_now(self, mode: RobotMode) -> LoadState:
        controller = self._controller
        arm_state, setup, tick = controller.arm_state, controller.setup, controller.tick
        if not arm_state.is_resting:
            self._key = None
            self._load = self._worked_out(mode, controller.joints())
            return self._load
        joints = controller.joints()
        sensor = controller.yielding.sensor
        key = _Key(
            mode,
            arm_state.joints(tick),
            setup.tcp_offset,
            setup.payload,
            setup.gravity,
            sensor.zero,
            sensor.client_offset,
            controller.signals.image,
        )
        if key != self._key:
            self._key = key
            self._load = self._worked_out(mode, joints)
        return self._load

    def _worked_out(self, mode: RobotMode, joints: JointState) -> LoadState:
        controller = self._controller
        torques = currents = ZERO_SIX
        if mode is RobotMode.RUNNING:
            torques, currents = controller.loads.measured(controller.tick)
        arm = controller.arm
        return LoadState(
            torques,
            currents,
            sum(map(abs, currents)),
            controller.tcp_wrench(True),
            controller.tcp_wrench(False),
            arm.elbow(joints.q_actual),
            elbow_velocity(arm, joints.q_actual, joints.qd_actual),
        )


def elbow_velocity(arm: Arm, q: Six, qd: Six) -> Three:
    """Return the velocity of the elbow (m/s, base frame) for joints in rad and rad/s, as a central difference."""
    if qd == ZERO_SIX:
        return (0.0, 0.0, 0.0)
    before, after = [arm.elbow([a + h * w for a, w in zip(q, qd, strict=True)]) for h in (-_INSTANT_S, _INSTANT_S)]
    x, y, z = [(later - now) / (2.0 * _INSTANT_S) for now, later in zip(before, after, strict=True)]
    return (x, y, z)
