"""Conveyor encoders and tracking (manual 2.10 chapter 2.1)."""

from __future__ import annotations

from typing import Annotated, Final

from elitescript.commands.quantities import Bool, Choice, Integer, Number, Pose, Real, Vector
from elitescript.commands.registry import command
from elitescript.errors import ArgumentRangeError, NotSimulatedError
from elitescript.messages.motion import Six

_NOT_YET: Final = "conveyor tracking is not simulated yet"
_QUADRATURE: Final = 1

_EncoderIndex = Annotated[int, Choice(0, 1)]
_Ticks = Annotated[float, Number("ticks")]


@command(family="motion", manual="2.1.20", is_simulated=False)
def encoder_enable_set_tick_count(encoder_index: _EncoderIndex, range_id: Annotated[int, Integer(0, 4)]) -> None:
    """Prepare an encoder whose count the program supplies itself with `encoder_set_tick_count`.

    Args:
        encoder_index: number of the conveyor encoder.
        range_id: range in which the real encoder counts: 0 signed 32 bits, 1 unsigned 8 bits, 2 unsigned 16 bits,
            3 unsigned 24 bits, 4 unsigned 32 bits.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.21", is_simulated=False)
def encoder_get_tick_count(encoder_index: _EncoderIndex) -> Real:
    """Count of an encoder.

    Args:
        encoder_index: number of the conveyor encoder.

    Returns:
        The count.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.22", is_simulated=False)
def encoder_set_tick_count(encoder_index: _EncoderIndex, count: _Ticks) -> None:
    """Tell the controller the count of an encoder that it does not read itself.

    `encoder_enable_set_tick_count` must have been called for the encoder.

    Args:
        encoder_index: number of the conveyor encoder.
        count: present count, inside the range that was chosen for the encoder.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.23", is_simulated=False)
def encoder_unwind_delta_tick_count(encoder_index: _EncoderIndex, delta_tick_count: _Ticks) -> _Ticks:
    """Undo the overflow of a counter in the difference of two counts.

    Args:
        encoder_index: number of the conveyor encoder.
        delta_tick_count: difference of two counts of that encoder.

    Returns:
        The difference, brought to within half a range of 0 by adding or subtracting the range (*assumed*).
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", since="2.12", manual="2.14: 3.1.25", is_simulated=False)
def encoder_enable_pulse_decode(
    encoder_index: _EncoderIndex,
    decoder_type: Annotated[int, Integer(1, 4)],
    A: Annotated[int, Integer(16, 19)],
    B: Annotated[int, Choice(0, 16, 17, 18, 19)],
) -> None:
    """Read an incremental encoder at high-speed inputs.

    Args:
        encoder_index: number of the conveyor encoder.
        decoder_type: 1 quadrature, 2 rising and falling edges, 3 rising edges, 4 falling edges.
        A: input of channel A. The manual names 16 and 17, the vendor's wiring page 16 to 19.
        B: input of channel B for quadrature; otherwise 0 will do.

    Raises:
        ArgumentRangeError: quadrature with one input for both channels.
    """
    if decoder_type == _QUADRATURE and A == B:
        raise ArgumentRangeError(
            f"B must be another input than A ({A}) in quadrature mode, got {B}",
            argument="B",
            value=B,
            limit=f"not {A}",
        )
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.30", works_in_sec=False, is_simulated=False)
def track_conveyor_linear(
    direction: Annotated[Six, Vector(Number(), 6, names="[x, y, z, 0, 0, 0]")],
    ticks_per_meter: Annotated[float, Number("ticks/m")],
    encoder_index: _EncoderIndex = 0,
) -> None:
    """Let the moves that follow go along with a straight conveyor, until `stop_conveyor_tracking`.

    Args:
        direction: direction of travel in the base frame: the first three numbers, whatever their length.
        ticks_per_meter: encoder ticks for one metre of travel.
        encoder_index: number of the conveyor encoder.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.29", works_in_sec=False, is_simulated=False)
def track_conveyor_circular(
    center: Pose,
    ticks_per_revolution: _Ticks,
    rotate_tool: Bool = False,
    encoder_index: _EncoderIndex = 0,
) -> None:
    """Let the moves that follow go along with a turntable, until `stop_conveyor_tracking`.

    Args:
        center: pose of the turntable's centre in the base frame.
        ticks_per_revolution: encoder ticks for one turn.
        rotate_tool: True turns the tool with the table, False keeps the orientation that the moves command.
        encoder_index: number of the conveyor encoder.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.24", waits=True, works_in_sec=False, is_simulated=False)
def stop_conveyor_tracking() -> None:
    """End conveyor tracking and bring the tool to standstill."""
    raise NotSimulatedError(_NOT_YET)
