"""Paths of many short segments from a file (manual 2.10 sections 2.1.34 to 2.1.37)."""

from __future__ import annotations

from typing import Annotated, Final

from elitescript.commands.quantities import Choice, Integer, Number, Pose, Str, Vector, Whole
from elitescript.commands.registry import command
from elitescript.errors import ArgumentRangeError, NotSimulatedError
from elitescript.messages.motion import Six

_NOT_YET: Final = "micro-segment files are not simulated yet"

_LineNumber = Annotated[int, Integer(0)]


@command(family="motion", manual="2.1.34", is_simulated=False)
def load_micro_line_file(
    file_name: Str,
    interval_time: Annotated[int, Integer(1, unit="ms")],
    pos_type: Annotated[int, Choice(0, 1)] = 0,
    unit_type: Annotated[int, Choice(0, 1)] = 0,
) -> Whole:
    """Load a file of densely sampled points.

    Args:
        file_name: name of the file.
        interval_time: time from one point to the next.
        pos_type: 0 the file holds joint positions, 1 poses.
        unit_type: 0 rad, or m and rad; 1 deg, or mm and rad (orientations stay in rad).

    Returns:
        Index for the other commands of this family; every call gives another one.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.35", is_simulated=False)
def micro_line_set_pcs(micro_line_index: Whole, part_coordinate_system: Pose) -> None:
    """Set the part frame in which the points of a loaded file are given.

    Args:
        micro_line_index: what `load_micro_line_file` returned.
        part_coordinate_system: the frame, in the base frame.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.36", is_simulated=False)
def get_micro_line_values_by_index(
    micro_line_index: Whole, pos_type: Annotated[int, Choice(0, 1)], line_index: Whole
) -> Annotated[Six, Vector(Number(), 6)]:
    """One point of a loaded file.

    Args:
        micro_line_index: what `load_micro_line_file` returned.
        pos_type: 0 gives joint positions, 1 a pose, whatever the file holds.
        line_index: line of the file, counted from 1.

    Returns:
        Joint positions or pose of the point.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="motion", manual="2.1.37", waits=True, works_in_sec=False, is_simulated=False)
def moveml(micro_line_index: Whole, start_line: _LineNumber = 0, end_line: _LineNumber = 0) -> None:
    """Run the points of a loaded file, at the interval of the file.

    Args:
        micro_line_index: what `load_micro_line_file` returned.
        start_line: first line to run; 0 is the first line of the file.
        end_line: last line to run; 0 is the last line of the file.

    Raises:
        ArgumentRangeError: `start_line` comes after `end_line`.
    """
    if end_line and start_line > end_line:
        raise ArgumentRangeError(
            f"start_line must be at most end_line ({end_line}), got {start_line}",
            argument="start_line",
            value=start_line,
            limit=f"<= {end_line}",
        )
    raise NotSimulatedError(_NOT_YET)
