"""Conveyor encoders and tracking (manual 2.10 chapter 2.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import Bool, Choice, Integer, Number, Pose, Real, Vector, shown
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMPUTED, SIGNAL
from elitescript.errors import ArgumentRangeError
from elitescript.messages.enums import PulseDecoder
from elitescript.messages.machine import DecodePulses, PrepareEncoder, SetEncoderCount
from elitescript.messages.motion import Six, StopTracking, TrackCircular, TrackLinear
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_EncoderIndex = Annotated[int, Choice(0, 1)]
_Ticks = Annotated[float, Number("ticks")]

_FEWEST: Final = 1e-6
"""Smallest number of ticks that is not taken for 0."""
_ARGUMENTS: Final = {"encoder_index": "number of the conveyor encoder."}
"""Texts of arguments that several commands share."""


@command(family="motion", manual="2.1.20", arguments=_ARGUMENTS)
def encoder_enable_set_tick_count(
    robot: Robot, encoder_index: _EncoderIndex, range_id: Annotated[int, Integer(0, 4)]
) -> None:
    """Prepare an encoder whose count the program supplies itself with `encoder_set_tick_count`.

    The count is 0 until the first one comes (*assumed*).

    Args:
        range_id: range in which the real encoder counts: 0 signed 32 bits, 1 unsigned 8 bits, 2 unsigned 16 bits,
            3 unsigned 24 bits, 4 unsigned 32 bits.
    """
    robot.request(PrepareEncoder(encoder_index, range_id))


@command(family="motion", manual="2.1.21", arguments=_ARGUMENTS)
def encoder_get_tick_count(robot: Robot, encoder_index: _EncoderIndex) -> Annotated[Real, SIGNAL]:
    """Return the count of an encoder.

    An encoder that no program has prepared counts from 0 in the range of signed 32 bits (*assumed*: as the
    installation left it).

    Returns:
        The count.
    """
    return robot.machine.encoder_count(encoder_index)


@command(family="motion", manual="2.1.22", arguments=_ARGUMENTS)
def encoder_set_tick_count(robot: Robot, encoder_index: _EncoderIndex, count: _Ticks) -> None:
    """Set the count of an encoder that the controller does not read itself.

    `encoder_enable_set_tick_count` must have been called for the encoder. A conveyor that is tracked is taken to go on
    between two counts with the speed of the last 0.2 s; where no further count comes within twice the time between the
    last two, it is taken to stand where it was (*assumed*).

    Args:
        count: present count, inside the range that was chosen for the encoder.

    Raises:
        ScriptStateError: the encoder is not prepared for it.
        ArgumentRangeError: the count is outside the range of the encoder.
    """
    robot.request(SetEncoderCount(encoder_index, count))


@command(family="motion", manual="2.1.23", arguments=_ARGUMENTS)
def encoder_unwind_delta_tick_count(
    robot: Robot, encoder_index: _EncoderIndex, delta_tick_count: _Ticks
) -> Annotated[_Ticks, COMPUTED]:
    """Undo the overflow of a counter in the difference of two counts.

    Args:
        delta_tick_count: difference of two counts of that encoder.

    Returns:
        The difference, brought to within half a range of 0 by adding or subtracting the range (*assumed*).
    """
    return robot.machine.encoder_unwound(encoder_index, delta_tick_count)


@command(family="motion", since="2.12", manual="2.14: 3.1.25", arguments=_ARGUMENTS)
def encoder_enable_pulse_decode(
    robot: Robot,
    encoder_index: _EncoderIndex,
    decoder_type: Annotated[int, Integer(1, 4)],
    A: Annotated[int, Integer(16, 19)],
    B: Annotated[int, Choice(0, 16, 17, 18, 19)],
) -> None:
    """Read an incremental encoder at high-speed inputs.

    It counts from 0 in the range of signed 32 bits. The signal `encoder_speed` turns a simulated encoder: it is what
    quadrature counts; both edges of one channel count half as much, one edge a quarter, and both of them upwards
    whichever way the wheel turns (*assumed*).

    Args:
        decoder_type: 1 quadrature, 2 rising and falling edges, 3 rising edges, 4 falling edges.
        A: input of channel A. The manual names 16 and 17, the vendor's wiring page 16 to 19.
        B: input of channel B for quadrature; otherwise 0 will do.

    Raises:
        ArgumentRangeError: quadrature with one input for both channels, or without one for channel B.
    """
    decoder = PulseDecoder(decoder_type)
    if decoder is PulseDecoder.QUADRATURE and B in (A, 0):
        raise ArgumentRangeError(
            said("B must be another input than A ({a}) in quadrature mode, got {b}", a=A, b=B),
            argument="B",
            value=B,
            limit=f"16 to 19, not {A}",
        )
    robot.request(DecodePulses(encoder_index, decoder, A, B))


@command(family="motion", manual="2.1.30", works_in_sec=False, arguments=_ARGUMENTS)
def track_conveyor_linear(
    robot: Robot,
    direction: Annotated[Six, Vector(Number(), 6, names="[x, y, z, 0, 0, 0]")],
    ticks_per_meter: Annotated[float, Number("ticks/m")],
    encoder_index: _EncoderIndex = 0,
) -> None:
    """Track a straight conveyor with the moves that follow, until `stop_conveyor_tracking`.

    The call returns at once. Moves that follow are commanded as if the conveyor had stood still since then. The tool
    catches up what it loses while it gets up to the conveyor's speed (0.2 s for 0.25 m/s), and goes exactly with the
    part from then on; a move that ends sooner ends behind the part. The speed percentage has no part in that. A pause
    brings the arm to rest, after it the tool catches up again. Where the arm cannot follow any further it brakes
    and the program ends with a protective stop (R140). (All *assumed*.)

    Args:
        direction: direction of travel in the base frame: the first three numbers, whatever their length.
        ticks_per_meter: encoder ticks for one metre of travel; negative if the encoder counts backwards.

    Raises:
        ArgumentRangeError: no direction, or no ticks.
        MotionError: a conveyor is tracked already, or the arm stands in a singularity.
    """
    x, y, z = direction[:3]
    if x == y == z == 0.0:
        raise ArgumentRangeError(
            said(
                "direction must have a length: its first three numbers are zero, got {direction}",
                direction=shown(list(direction)),
            ),
            argument="direction",
            value=list(direction),
            limit="not zero",
        )
    _require_ticks("ticks_per_meter", ticks_per_meter, "ticks/m")
    robot.track(TrackLinear((x, y, z), ticks_per_meter, encoder_index))


@command(family="motion", manual="2.1.29", works_in_sec=False, arguments=_ARGUMENTS)
def track_conveyor_circular(
    robot: Robot,
    center: Pose,
    ticks_per_revolution: _Ticks,
    rotate_tool: Bool = False,
    encoder_index: _EncoderIndex = 0,
) -> None:
    """Track a turntable with the moves that follow, until `stop_conveyor_tracking`.

    The table turns about the z axis of `center`, by the right-hand rule when the encoder counts up (*assumed*). For
    the rest see `track_conveyor_linear`.

    Args:
        center: pose of the turntable's centre in the base frame.
        ticks_per_revolution: encoder ticks for one turn; negative if the encoder counts backwards.
        rotate_tool: True turns the tool with the table, False keeps the orientation that the moves command.

    Raises:
        ArgumentRangeError: no ticks.
        MotionError: a conveyor is tracked already, or the arm stands in a singularity.
    """
    _require_ticks("ticks_per_revolution", ticks_per_revolution, "ticks")
    robot.track(TrackCircular(center, ticks_per_revolution, rotate_tool, encoder_index))


@command(family="motion", manual="2.1.24", waits=True, works_in_sec=False)
def stop_conveyor_tracking(robot: Robot) -> None:
    """End conveyor tracking and bring the tool to standstill; return when the arm stands.

    All joints brake together as at the end of a program, whatever else moves the arm (*assumed*); it stays where it
    comes to rest. Does nothing when no conveyor is tracked.
    """
    robot.track(StopTracking())


def _require_ticks(argument: str, value: float, unit: str) -> None:
    if abs(value) < _FEWEST:
        raise ArgumentRangeError(
            said("{argument} must not be 0, got {value:g}", argument=argument, value=value),
            argument=argument,
            value=value,
            limit="not 0",
            unit=unit,
        )
