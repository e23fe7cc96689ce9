"""Plays paths of densely sampled points from a file (manual 2.10 sections 2.1.34 to 2.1.37).

What follows is *assumed*: a file is a text file in the task folder (`commands.micro_file`);
every load gives the next index, from 0, and it holds until the program ends; lines without a point do not count.
How the points are played is part of the motion package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import Choice, Integer, Number, Pose, Str, Vector, Whole
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import STATE
from elitescript.commands.kinematics import nearest_solution
from elitescript.errors import ArgumentRangeError, InvalidValueError, MotionError
from elitescript.kinematics.inverse import reason_unreachable
from elitescript.kinematics.transforms import compose, inverse, pose_from_transform, transform_from_pose
from elitescript.messages.motion import MicroLine, MoveML, Six
from elitescript.records import replace
from elitescript.said import Said, said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

INDICES_MAX: Final = 10_000
"""Loads of one program (*assumed*)."""

POINTS_IN_ALL_MAX: Final = 2_000_000
"""Points that one program may hold, equal files counted once (*assumed*)."""

INTERVAL_MAX_MS: Final = 3_600_000
"""An hour (*assumed*)."""

_LineNumber = Annotated[int, Integer(0)]


@command(family="motion", manual="2.1.34")
def load_micro_line_file(
    robot: Robot,
    file_name: Str,
    interval_time: Annotated[int, Integer(1, INTERVAL_MAX_MS, unit="ms")],
    pos_type: Annotated[int, Choice(0, 1)] = 0,
    unit_type: Annotated[int, Choice(0, 1)] = 0,
) -> Annotated[Whole, STATE]:
    """Load a file of densely sampled points: one point a line, six numbers separated by blanks or commas.

    Blank lines and what follows a `#` are skipped. Nothing moves, and nothing is checked against the arm yet.

    Args:
        file_name: name of the file in the task folder.
        interval_time: time from one point to the next.
        pos_type: 0 the file holds joint positions, 1 poses.
        unit_type: 0 rad, or m and rad; 1 deg, or mm and rad (orientations stay in rad).

    Returns:
        Index for the other commands of this family; every call gives another one.

    Raises:
        InvalidValueError: there is no such file, or it holds something else; says line and column.
    """
    from elitescript.commands.micro_file import BYTES_MAX, read_points

    loaded = robot.micro_lines
    if len(loaded) >= INDICES_MAX:
        raise InvalidValueError(
            said("the program has loaded {indices_max} files already", indices_max=INDICES_MAX),
            value=INDICES_MAX + 1,
            limit=f"<= {INDICES_MAX}",
            hint="load a file once, before the loop that plays it",
        )
    data = robot.read_task_file(file_name, BYTES_MAX)
    is_cartesian = pos_type == 1
    numbers, file_lines = read_points(data, file_name, is_cartesian=is_cartesian, is_degrees=unit_type == 1)
    held = 0
    seen: set[int] = set()
    for other in loaded:
        if other.numbers == numbers and other.file_lines == file_lines:
            numbers, file_lines = other.numbers, other.file_lines
        if id(other.numbers) not in seen:
            seen.add(id(other.numbers))
            held += len(other)
    line = MicroLine(file_name, interval_time / 1000, is_cartesian, numbers, file_lines)
    if id(numbers) not in seen and held + len(line) > POINTS_IN_ALL_MAX:
        raise InvalidValueError(
            said(
                "with the {count} points of {file_name} the program would hold more than {limit} points",
                count=len(line),
                file_name=file_name,
                limit=POINTS_IN_ALL_MAX,
            ),
            value=held + len(line),
            limit=f"<= {POINTS_IN_ALL_MAX}",
        )
    loaded.append(line)
    return len(loaded) - 1


@command(family="motion", manual="2.1.35")
def micro_line_set_pcs(robot: Robot, micro_line_index: Whole, part_coordinate_system: Pose) -> None:
    """Set the part frame in which the poses of a loaded file are given.

    Before the first call it is the base frame. A later call replaces the frame, for moves that begin after it. Joint
    positions have no frame: for a file of them the call changes nothing but gives a warning (*assumed*).

    Args:
        micro_line_index: what `load_micro_line_file` returned.
        part_coordinate_system: the frame, in the base frame.
    """
    line = _loaded(robot, micro_line_index)
    if not line.is_cartesian:
        robot.warn_once(
            f"micro_line_set_pcs {line.name}",
            said(
                "micro_line_set_pcs: {line} holds joint positions, to which a part frame does not apply", line=line.name
            ),
        )
    robot.micro_lines[micro_line_index] = replace(line, frame=part_coordinate_system)


@command(family="motion", manual="2.1.36")
def get_micro_line_values_by_index(
    robot: Robot, micro_line_index: Whole, pos_type: Annotated[int, Choice(0, 1)], line_index: Whole
) -> Annotated[Six, Vector(Number(), 6), STATE]:
    """Return one point of a loaded file, as `moveml` would reach it.

    Poses are those of the active TCP in the base frame, with the part frame worked in (*assumed*). Joint positions of
    a pose are the nearest to where the arm is (*assumed*).

    Args:
        micro_line_index: what `load_micro_line_file` returned.
        pos_type: 0 returns joint positions, 1 a pose.
        line_index: number of the point, from 1; lines without a point do not count (*assumed*).

    Returns:
        Joint positions or pose of the point.

    Raises:
        MotionError: the arm cannot reach the pose.
    """
    line = _loaded(robot, micro_line_index)
    _check_number(line, "line_index", line_index, 1)
    point = line.point(line_index)
    machine = robot.machine
    if not line.is_cartesian:
        if pos_type == 0:
            return point
        return pose_from_transform(machine.arm.forward_tcp(point, transform_from_pose(machine.tcp_offset)))
    T_base_tcp = compose(transform_from_pose(line.frame), transform_from_pose(point))
    if pos_type == 1:
        return pose_from_transform(T_base_tcp)
    T_base_flange = compose(T_base_tcp, inverse(transform_from_pose(machine.tcp_offset)))
    solution, candidates = nearest_solution(machine, T_base_flange)
    if solution is None:
        reason = reason_unreachable(machine.arm, T_base_flange)
        raise MotionError(
            said(
                "no joint position reaches {place}: {reason}",
                place=line.place(line_index),
                reason=reason or Said("a joint would be outside its limits"),
            ),
            code="R110" if candidates else "R111",
            argument="line_index",
            value=line_index,
        )
    return solution.q


@command(family="motion", manual="2.1.37", waits=True, works_in_sec=False)
def moveml(robot: Robot, micro_line_index: Whole, start_line: _LineNumber = 0, end_line: _LineNumber = 0) -> None:
    """Play the points of a loaded file at its interval; return at standstill.

    The joints follow a smooth curve through every point. The arm has to be at the first point already, up to 0.01 rad
    in each joint, which it makes up for. A path that does not begin and end at rest is sped up and slowed down within
    the limits of the joints, and where points come faster than the joints can turn it goes slower; both take more
    time than the file says. All of this is *assumed*; the manual says only that the file is run.

    Args:
        micro_line_index: what `load_micro_line_file` returned.
        start_line: number of the first point; 0 is the first of the file.
        end_line: number of the last point; 0 is the last of the file.

    Raises:
        MotionError: the arm is not at the first point, or it cannot reach or pass one; says which.
        ScriptStateError: the arm is not ready, or another thread moves it.
    """
    line = _loaded(robot, micro_line_index)
    first, last = start_line or 1, end_line or len(line)
    _check_number(line, "start_line", start_line, 0)
    _check_number(line, "end_line", end_line, 0)
    if first > last:
        raise ArgumentRangeError(
            said("start_line must be at most end_line ({last}), got {first}", last=last, first=first),
            argument="start_line",
            value=first,
            limit=f"<= {last}",
        )
    a, v, _, _ = robot.machine.default_motion
    robot.move(MoveML(line, first, last, a, v))


def _loaded(robot: Robot, index: int) -> MicroLine:
    loaded = robot.micro_lines
    if 0 <= index < len(loaded):
        return loaded[index]
    limit = f"in [0, {len(loaded) - 1}]" if loaded else "what load_micro_line_file returned"
    raise ArgumentRangeError(
        said("no file is loaded as {index}", index=index),
        argument="micro_line_index",
        value=index,
        limit=limit,
        hint="load_micro_line_file returns the index, which holds until the program ends",
    )


def _check_number(line: MicroLine, argument: str, number: int, low: int) -> None:
    if not low <= number <= len(line):
        raise ArgumentRangeError(
            said(
                "{argument} must be in [{low}, {count}], the points of {line}; got {number}",
                argument=argument,
                low=low,
                count=len(line),
                line=line.name,
                number=number,
            ),
            argument=argument,
            value=number,
            limit=f"[{low}, {len(line)}]",
        )
