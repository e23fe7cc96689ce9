"""Path offsets, as generated welding programs use them; no manual describes them.

Known are their names and arguments there. The rest is *assumed*, after the commands of the same names in URScript.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import Integer, Number, Pose
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMMANDED
from elitescript.messages.path_offset import (
    EnablePathOffset,
    FilterPathOffset,
    LimitPathOffset,
    OffsetFrame,
    SetPathOffset,
)

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_Frame = Annotated[int, Integer(1, 3)]


@command(family="observed", evidence="observed", works_in_sec=False)
def path_offset_enable(robot: Robot) -> None:
    """Let path offsets count until the program ends; generated welding programs call it in a thread.

    There is no offset until `path_offset_set` is called. Settings of `path_offset_set_max_offset` and
    `path_offset_set_alpha_filter` hold already (*assumed*). Has no effect when offsets count already.

    Raises:
        ScriptStateError: the arm is not ready.
        MotionError: the arm is guided by hand.
    """
    robot.shift(EnablePathOffset())


@command(family="observed", evidence="observed")
def path_offset_set(robot: Robot, offset: Pose, type: _Frame) -> None:
    """Shift the motion of the arm: moves, chains, streams, and an arm that stands.

    Moves keep their own path and end; the arm is beside them by the offset, and a move ends at its target plus the
    offset. The offset passes the filter and is reached as fast as the joints can; a warning says where they fall
    behind by more than 0.5 mm. It holds until the next call, and ends with the program: the arm stays where it comes
    to rest. Without `path_offset_enable` it has no effect, with a warning. Where the arm cannot follow any further it
    brakes and the program ends with a protective stop (R140). (All *assumed*.)

    Args:
        offset: translation along the axes of the frame, and roll-pitch-yaw rotation of the tool about the TCP.
        type: axes: 1 base; 2 TCP, as the move has it without offset; 3 motion: x along the path, y across it and the
            tool's z axis (y = x cross z_tool), z = x cross y, which is against z_tool where that is upright. While
            the arm stands the axes stay as they were, at first with x along the tool's x axis (*assumed*).

    Raises:
        ScriptStateError: the arm is not ready.
        MotionError: the arm is guided by hand.
    """
    robot.shift(SetPathOffset(offset, OffsetFrame(type)))


@command(family="observed", evidence="observed")
def path_offset_get(robot: Robot, type: _Frame) -> Annotated[Pose, COMMANDED]:
    """Return the offset that the arm has at present, whatever it is on its way to.

    Args:
        type: axes along which it is given: 1 base, 2 TCP, 3 motion, see `path_offset_set`.

    Returns:
        [x, y, z, Rx, Ry, Rz], exactly zero where the arm is on its path.
    """
    return robot.machine.path_offset_along(OffsetFrame(type))


@command(family="observed", evidence="observed", spellings={"a": "trans", "b": "rot"})
def path_offset_set_max_offset(
    robot: Robot, trans: Annotated[float, Number("m", 0.0)], rot: Annotated[float, Number("rad", 0.0)]
) -> None:
    """Limit path offsets; at the begin of a program 0.1 m and 0.52 rad (*assumed*).

    Each element of an offset that is above its limit counts as the limit, with one warning for each line (*assumed*).

    Args:
        trans: greatest translation along each axis.
        rot: greatest angle of each rotation.
    """
    robot.shift(LimitPathOffset(trans, rot))


@command(family="observed", evidence="observed", spellings={"a": "alpha"})
def path_offset_set_alpha_filter(robot: Robot, alpha: Annotated[float, Number("", 0.0, 1.0, is_low_open=True)]) -> None:
    """Smooth path offsets: in each control period of 4 ms, a share of the way to the offset that was set.

    At the begin of a program offsets are not smoothed, as with 1 (*assumed*). Generated programs set 0.1, which makes
    63 % of a step in 40 ms.

    Args:
        alpha: the share.
    """
    robot.shift(FilterPathOffset(alpha))
