"""Names that real programs call and no manual describes, with the least surprising behaviour.

Sources: programs that the pendant generated, the vendor's SDK and support pages, public programs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import (
    Any_,
    Anything,
    BlendRadius,
    Bool,
    Number,
    Pose,
    ToolAcceleration,
    ToolSpeed,
    Vector,
    Whole,
)
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMMANDED_IN_BASE, COMPUTED_IN_BASE, STATE
from elitescript.commands.motion import blend_radius
from elitescript.errors import InvalidValueError
from elitescript.kinematics.pose import frame_from_points
from elitescript.messages.machine import SetClientSensor, SetOption
from elitescript.messages.motion import MoveP
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_Vector3 = Annotated[tuple[float, float, float], Vector(Number(), 3, "m")]
_PointOrPose = Annotated[tuple[float, ...], Vector(Number(), None, "m")]


@command(family="observed", evidence="observed")
def labelmsg(robot: Robot, n: Whole, name: Any_) -> None:
    """Record the node of the program tree that was reached; generated programs of software 2.1 call it.

    Args:
        n: number of the node.
        name: name of the node.
    """
    robot.mark(n, str(name))


@command(family="observed", evidence="observed")
def set_safety_mode_transition_hardness(robot: Robot, type: Whole) -> None:
    """Store a value without effect; first line of generated programs, with 1.

    Args:
        type: what to store.
    """
    robot.request(SetOption("safety_mode_transition_hardness", type))


@command(family="observed", evidence="observed")
def set_tool_digital_io_work_mode(robot: Robot, mode: Whole) -> None:
    """Store a value without effect; in the preamble of generated programs, with 0.

    Args:
        mode: what to store.
    """
    robot.request(SetOption("tool_digital_io_work_mode", mode))


@command(family="observed", evidence="observed", since="2.16")
def set_tool_second_power_on(robot: Robot, b: Bool) -> None:
    """Store a value without effect; the vendor's support pages name it for software 2.16.

    Args:
        b: True for on.
    """
    robot.request(SetOption("tool_second_power_on", b))


@command(family="observed", evidence="observed", waits=True, works_in_sec=False)
def movep(robot: Robot, pose: Pose, a: ToolAcceleration = 1.2, v: ToolSpeed = 0.25, r: BlendRadius = 0) -> None:
    """Move the TCP on a straight line, at constant tool speed; seen in generated welding programs.

    One `movep` after another is a chain (*assumed*): the arm looks ahead and keeps its speed at the corners, as far as
    the acceleration allows, and stops at the end of the last. The call returns when the next one should be known, and
    at once while the arm has not enough path ahead.

    Args:
        pose: target pose of the TCP in the base frame.
        a: tool acceleration; 0 takes the machine's default.
        v: tool speed; 0 takes the machine's default.
        r: blend radius; 0 rounds the corner by at most 0.1 mm (*assumed*).

    Raises:
        MotionError: a point of the line is out of reach, outside the joint limits or too near a singularity.
        ScriptStateError: the arm is not ready, or another thread moves it.
    """
    _, _, default_a, default_v = robot.machine.default_motion
    robot.move(MoveP(pose, a or default_a, v or default_v, blend_radius(robot, r)))


@command(family="observed", evidence="observed", spellings={"x_vec": "x_axis", "y_vec": "y_axis"})
def cal_rpy_frame(
    origin: _PointOrPose, x_axis: _PointOrPose, y_axis: _PointOrPose
) -> Annotated[Pose, COMPUTED_IN_BASE]:
    """Return the frame through three points, as generated welding programs call it.

    Args:
        origin: position or pose of the origin in the base frame; of a pose only the position counts, here and below.
        x_axis: a point on the x axis (*assumed*: a point, not a direction).
        y_axis: a point in the xy plane, on the side of positive y.

    Returns:
        Pose of the frame in the base frame, roll-pitch-yaw.

    Raises:
        InvalidValueError: fewer than three numbers, points that coincide, or three points on one line.
    """
    for name, point in (("origin", origin), ("x_axis", x_axis), ("y_axis", y_axis)):
        if len(point) not in (3, 6):
            raise InvalidValueError(
                said("{name} must have 3 or 6 elements, got {count}", name=name, count=len(point)),
                argument=name,
                value=list(point),
            )
    try:
        return frame_from_points(origin, x_axis, y_axis)
    except InvalidValueError as error:
        error.argument = "x_axis" if error.argument == "x_point" else "y_axis"
        raise


@command(family="observed", evidence="observed")
def pin_thread(robot: Robot, cpu: Whole = 0, prio: Whole = 0, lockmem: Whole = 0) -> None:
    """Store a value without effect: threads of a program take turns here, whatever core of a real controller runs them.

    The names of the arguments are those of a control program of the vendor's SDK, `pin_thread(cpu=1, prio=80,
    lockmem=1)`. Their order, defaults and ranges are *assumed*.

    Args:
        cpu: core on which a real controller runs the calling thread.
        prio: priority of the thread there.
        lockmem: 1 keeps the memory of the controller's process from being swapped out.
    """
    robot.request(SetOption("pin_thread", cpu))


@command(family="observed", evidence="observed")
def serial_open_list(robot: Robot) -> Annotated[list[str], Anything("list[str]"), STATE]:
    """Return the devices of the serial ports that are enabled.

    A post-processor knows the name; what it returns is *assumed*.

    Returns:
        `tool` and the devices of the control box, in the order of their names; empty if none is enabled.
    """
    return robot.lines.open_devices()


@command(family="observed", evidence="observed")
def get_target_tcp_pose_along_path(robot: Robot) -> Annotated[Pose, COMMANDED_IN_BASE]:
    """Return the commanded pose of the TCP without the path offset; `get_target_tcp_pose` is the one with it.

    Returns:
        [x, y, z, Rx, Ry, Rz] in the base frame.
    """
    return robot.machine.tcp_pose_along_path()


@command(family="observed", evidence="observed")
def ft_rtsi_input_enable(
    robot: Robot,
    enable: Bool,
    sensor_mass: Annotated[float, Number("kg", 0.0)] = 0,
    sensor_measuring_offset: _Vector3 = (0, 0, 0),
    sensor_cog: _Vector3 = (0, 0, 0),
) -> None:
    """Take force readings from RTSI inputs instead of the arm's sensor; the vendor's SDK calls it.

    Readings are taken along the axes of the flange and as free of the weight of sensor and tool; so mass and centre of
    gravity have no effect (*assumed*).

    Args:
        enable: True for readings from RTSI.
        sensor_mass: mass of the sensor.
        sensor_measuring_offset: where the sensor measures, in the flange frame.
        sensor_cog: centre of gravity of the sensor, in the flange frame.
    """
    robot.request(SetClientSensor(enable, sensor_mass, sensor_measuring_offset, sensor_cog))


@command(family="observed", evidence="observed", since="2.14")
def set_collision_detect_enabled(robot: Robot, enable: Bool) -> None:
    """Store a value without effect: collisions are not detected from the joints; the vendor's SDK 1.4 calls it.

    What limits contact here is the greatest force of the safety configuration. That firmware 2.14 has the command is
    *assumed*.

    Args:
        enable: True for on.
    """
    robot.request(SetOption("collision_detect_enabled", enable))


@command(family="observed", evidence="observed", since="2.14")
def set_dyn_collision_force_min_ratio(robot: Robot, ratio: Annotated[float, Number("", 0.0, 100.0)]) -> None:
    """Store a value without effect, see `set_collision_detect_enabled`; the vendor's SDK 1.4 calls it.

    Args:
        ratio: sensitivity; clients of that SDK give 10 to 100 percent. Whether the script passes percent or a fraction
            is not known, and both are taken (*assumed*).
    """
    robot.request(SetOption("dyn_collision_force_min_ratio", ratio))
