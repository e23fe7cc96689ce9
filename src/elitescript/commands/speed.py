"""Moving at a speed instead of to a target (manual 2.10 chapter 2.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import (
    JointDeceleration,
    JointSpeeds,
    Number,
    Optionally,
    TcpSpeed,
    ToolDeceleration,
)
from elitescript.commands.definition.registry import command
from elitescript.messages.motion import SpeedJ, SpeedL

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_TurnAcceleration = Annotated[
    float | None, Optionally(Number("rad/s^2", 0.0, is_low_open=True, meaning="joint acceleration"), "a")
]
_LeastTime = Annotated[float | None, Optionally(Number("s", 0.0, is_low_open=True), None)]


@command(family="motion", manual="2.1.25", waits=True, works_in_sec=False)
def speedj(
    robot: Robot,
    qd: JointSpeeds,
    a: JointDeceleration,
    t: _LeastTime = None,
) -> None:
    """Accelerate the joints to the speeds `qd` and go on moving after the call returned.

    It may begin while the arm moves or brakes; no speed jumps. All joints reach their speeds together. The next
    `speedj`, `speedl`, `servoj` or stop command takes over, and the end of the program brakes; a move to a target
    needs a stop first. The speed percentage lowers the speeds that are reached, which then counts as reaching `qd`
    (*assumed*). In front of the end of a joint's range the arm brakes, and the program ends with a protective stop
    (R140); a call that would go further is refused (*assumed*). While the arm has no power or its brakes are engaged,
    a call returns after `t` (without `t`, after a control period) with one warning and nothing moves (*assumed*).

    Args:
        qd: target speeds of the joints.
        a: acceleration of the leading joint.
        t: time after which the call returns, whether or not `qd` is reached; without it the call returns when `qd`
            is reached.

    Raises:
        MotionError: a joint stands at the end of its range and would go further.
        ScriptStateError: a stop of the safety system keeps the arm from moving.
    """
    robot.move(SpeedJ(qd, a, t))


@command(family="motion", manual="2.1.26", waits=True, works_in_sec=False)
def speedl(
    robot: Robot,
    xd: TcpSpeed,
    a: ToolDeceleration,
    t: _LeastTime = None,
    aRot: _TurnAcceleration = None,
) -> None:
    """Accelerate the TCP to the velocity `xd` and go on moving after the call returned.

    It may begin while the arm moves or brakes; no speed jumps. What ends it and what the speed percentage does is as
    in `speedj`. Where a joint would have to turn faster than it can, the TCP goes slower; in front of the
    end of a joint's range or a singularity the arm brakes, and the program ends with a protective stop (R140;
    *assumed*). Without power it returns as `speedj` does.

    Args:
        xd: linear velocity, then angular velocity vector, both in the base frame.
        a: tool acceleration.
        t: time after which the call returns, whether or not `xd` is reached; without it the call returns when `xd`
            is reached.
        aRot: angular acceleration; without it the number of `a` counts. A later firmware than 2.10 brought it.

    Raises:
        MotionError: a joint stands at the end of its range and would go further, or the arm is too near to a
            singularity.
        ScriptStateError: a stop of the safety system keeps the arm from moving.
    """
    robot.move(SpeedL(xd, a, a if aRot is None else aRot, t))
