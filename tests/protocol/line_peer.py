"""A client of a line protocol without a socket, and a robot that is whatever the test says."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output, Reply
from elitescript.messages.signals import SIGNALS
from elitescript.messages.snapshot import RobotDescription, Snapshot, TaskPicture
from elitescript.messages.state import ZERO_SIX, Payload, RobotState
from elitescript.protocol.connection import Connection

NO_VECTOR = (0.0, 0.0, 0.0)

DESCRIPTION = RobotDescription(
    model="cs66",
    type_id=62,
    serial_number="CS66-0001",
    robot_id="42",
    firmware=(2, 14, 1, 7),
    q_min=ZERO_SIX,
    q_max=ZERO_SIX,
    qd_max=ZERO_SIX,
    qdd_max=ZERO_SIX,
    default_joint_speed=1.0,
    default_joint_acceleration=1.4,
    default_tool_speed=0.25,
    default_tool_acceleration=1.2,
    equivalent_radius_m=0.3,
    dh_a=ZERO_SIX,
    dh_d=ZERO_SIX,
    dh_alpha=ZERO_SIX,
    safety_checksum=1,
)

ROBOT = RobotState(
    tick=0,
    time_s=0.0,
    robot_mode=RobotMode.RUNNING,
    safety_mode=SafetyMode.NORMAL,
    task_state=TaskState.STOPPED,
    q_target=ZERO_SIX,
    qd_target=ZERO_SIX,
    q_actual=ZERO_SIX,
    qd_actual=ZERO_SIX,
    tcp_offset=ZERO_SIX,
    tcp_pose_target=ZERO_SIX,
    tcp_pose_actual=ZERO_SIX,
    tcp_speed_target=ZERO_SIX,
    tcp_speed_actual=ZERO_SIX,
    flange_pose_actual=ZERO_SIX,
    payload=Payload(),
    gravity=(0.0, 0.0, 9.82),
    speed_scale=1.0,
    is_moving=False,
    line=0,
    node=(0, ""),
)

SNAPSHOT = Snapshot(
    robot=ROBOT,
    joint_torques=ZERO_SIX,
    joint_currents=ZERO_SIX,
    joint_temperatures=ZERO_SIX,
    joint_voltages=ZERO_SIX,
    tcp_force=ZERO_SIX,
    raw_wrench=ZERO_SIX,
    elbow_position=NO_VECTOR,
    elbow_velocity=NO_VECTOR,
    speed_scaling=1.0,
    controller_temperature=30.0,
    robot_voltage=48.0,
    robot_current=1.0,
    io_current=0.1,
    tool_current=0.0,
    tool_temperature=30.0,
    signals={signal.name: (signal.default,) * signal.size for signal in SIGNALS.values()},
    domains={},
    tool_analog_mode=0,
    tool_pin_modes=(0, 0, 0, 0),
    is_remote=True,
    is_freedrive=False,
    popup="",
    task=TaskPicture("test.task", "", "default.configuration", True, False),
    overruns=0,
)

_OF_ROBOT = ("robot_mode", "safety_mode", "task_state", "speed_scale")
_OF_TASK = ("loaded", "running", "configuration", "is_saved", "is_configuration_modified")


def picture(**changes: Any) -> Snapshot:
    """A snapshot with some fields of its own, of its robot state or of its task."""
    robot = replace(ROBOT, **{name: value for name, value in changes.items() if name in _OF_ROBOT})
    task = replace(SNAPSHOT.task, **{name: value for name, value in changes.items() if name in _OF_TASK})
    rest = {name: value for name, value in changes.items() if name not in _OF_ROBOT + _OF_TASK}
    return replace(SNAPSHOT, robot=robot, task=task, **rest)


class Peer:
    """One client, its connection, and the robot's last output."""

    def __init__(self, kind: type[Connection], origin: str = "peer#1", **changes: Any) -> None:
        self.connection = kind(origin, DESCRIPTION)
        self.output = Output(0, (), (), (), picture(**changes))
        self.greeting = self.connection.take()
        self.inputs: list[Input] = []

    def send(self, data: bytes) -> list[bytes]:
        """Send bytes; return the messages that come back at once."""
        self.inputs += self.connection.receive(data, self.output)
        return self.connection.take()

    def tick(self, *replies: Reply, ticks: int = 1, **changes: Any) -> list[bytes]:
        """Let the robot say something and change; return the messages that come then."""
        snapshot = picture(**changes) if changes else self.output.snapshot
        self.output = Output(self.output.tick + ticks, (), (), replies, snapshot)
        self.connection.publish(self.output)
        self.inputs += self.connection.take_inputs()
        return self.connection.take()
