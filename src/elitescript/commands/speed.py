"""Moving at a speed instead of to a target (manual 2.10 chapter 2.1)."""

from __future__ import annotations

from typing import Annotated, Final

from elitescript.commands.quantities import JointSpeeds, Number, Optionally, TcpSpeed
from elitescript.commands.registry import command
from elitescript.errors import NotSimulatedError

_NOT_YET: Final = "moving at a commanded speed is not simulated yet"

_LeastTime = Annotated[float | None, Optionally(Number("s", 0.0, is_low_open=True), None)]


@command(family="motion", manual="2.1.25", waits=True, works_in_sec=False, is_simulated=False)
def speedj(
    qd: JointSpeeds,
    a: Annotated[float, Number("rad/s^2", 0.0, is_low_open=True)],
    t: _LeastTime = None,
) -> None:
    """Accelerate the joints to the speeds `qd` and go on moving after the call returned.

    The next motion or stop command ends the movement, as does the end of the program. The speed percentage lowers
    the speeds that are reached.

    Args:
        qd: target speeds of the joints.
        a: acceleration of the leading joint.
        t: time after which the call returns, whether or not `qd` is reached; without it the call returns when `qd`
            is reached.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.26", waits=True, works_in_sec=False, is_simulated=False)
def speedl(
    xd: TcpSpeed,
    a: Annotated[float, Number("m/s^2", 0.0, is_low_open=True)],
    t: _LeastTime = None,
    aRot: Annotated[float | None, Optionally(Number("rad/s^2", 0.0, is_low_open=True), "a")] = None,
) -> None:
    """Accelerate the TCP to the velocity `xd` and go on moving after the call returned.

    The next motion or stop command ends the movement, as does the end of the program. The speed percentage lowers
    the speed that is reached.

    Args:
        xd: linear velocity, then angular velocity vector, both in the base frame.
        a: tool acceleration.
        t: time after which the call returns, whether or not `xd` is reached; without it the call returns when `xd`
            is reached.
        aRot: angular acceleration; without it the number of `a` counts. A later firmware than 2.10 brought it.
    """
    raise NotSimulatedError(_NOT_YET)
