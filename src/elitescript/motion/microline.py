"""Plans the points of a file as a move: `moveml`.

The joints follow a cubic spline through every point (`spline`), at the interval of the file wherever they can
(`point_timing`). Poses are solved one by one on the present branch of the inverse kinematics; between two of them the
joints follow the same kind of spline. The manual says only that the file is run, so all of this is *assumed*, and also:

- The arm must be at the first point, up to `START_TOLERANCE_RAD` in each joint; the rest is made up for by a straight
  move in joint space at the machine's default speed. From further away the move is refused, because a free way is not
  known.
- Two neighbouring points further apart than a joint can go in ten intervals are an error in the file. What is too
  fast by less is played more slowly, with a note.
- Only joints limit the motion; the speed of the tool follows from the file.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from math import dist
from typing import Final

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import is_blocked, singularity, tcp_twist
from elitescript.kinematics.transforms import Transform, compose, inverse, position_of, transform_from_pose
from elitescript.messages.motion import MicroLine, MoveJ, MoveML, Six
from elitescript.messages.state import ZERO_SIX
from elitescript.motion.limits import JOINT_NAMES, RANGE_TOLERANCE_RAD, MotionLimits, joint_range_error, unwrapped
from elitescript.motion.paths.spline import JointSpline
from elitescript.motion.planner import SURELY_DEGREES, MoveNote, MoveNoteKind, Plan, plan_movej
from elitescript.motion.refusals import JUMP_RAD, SINGULAR_HINT, SURELY_MILLIMETRES
from elitescript.motion.segment import Segment
from elitescript.motion.timing.point_timing import CURVATURE_SHARE, TooFast, paced
from elitescript.said import said

START_TOLERANCE_RAD: Final = 0.01
"""Largest distance of each joint from the first point; on a stretched arm up to 9 mm at the tool."""

SAME_PLACE_RAD: Final = 1e-9
"""Distance at which the arm is at the first point."""

JUMP_INTERVALS: Final = 10.0
"""Intervals that a joint at its highest speed may need from one point to the next."""

NEAR_SINGULAR: Final = 0.1
"""Distance, as sine or in m, below which a singularity is the cause of a jump between solved poses."""


class PointPath:
    """The curve through the points, behind the way to the first of them; immutable.

    The path position is the angle, rad, of the leading joint on the way to the first point, and counts on from there
    with the time of the file, s.
    """

    __slots__ = ("_T_flange_tcp", "_arm", "_lead", "_spline", "length", "q_end", "q_start")

    kind = "points"
    unit = "s"

    def __init__(self, arm: Arm, T_flange_tcp: Transform, lead: Segment | None, spline: JointSpline) -> None:
        self._arm = arm
        self._T_flange_tcp = T_flange_tcp
        self._lead = lead
        self._spline = spline
        self.length = spline.duration_s + (lead.path.length if lead else 0.0)
        self.q_start: Six = lead.q_start if lead else spline.point(0)
        self.q_end: Six = spline.point(-1)

    @property
    def T_base_tcp_end(self) -> Transform:
        return self._arm.forward_tcp(self.q_end, self._T_flange_tcp)

    def q(self, s: float) -> Six:
        if s <= 0.0:
            return self.q_start
        if s >= self.length:
            return self.q_end
        return self.q_and_slope(s)[0]

    def q_and_slope(self, s: float) -> tuple[Six, Six]:
        lead = self._lead
        if lead is not None:
            if s < lead.path.length:
                return lead.path.q_and_slope(s)
            s -= lead.path.length
        return self._spline.q_and_speed(s)

    def turned(self, begin: float, end: float) -> Six | None:
        return None

    @property
    def course(self) -> None:
        """Not kept: a file has many points."""
        return

    def tool_rates(self, s: float) -> tuple[float, float]:
        vx, vy, vz, wx, wy, wz = tcp_twist(self._arm, *self.q_and_slope(s), self._T_flange_tcp)
        return dist((vx, vy, vz), (0.0, 0.0, 0.0)), dist((wx, wy, wz), (0.0, 0.0, 0.0))


def plan_moveml(arm: Arm, limits: MotionLimits, q_start: Six, T_flange_tcp: Transform, request: MoveML) -> Plan:
    """Plan the points of a file.

    Args:
        arm: the arm.
        limits: its limits; of those only the joints' count.
        q_start: joint angles at the start, rad.
        T_flange_tcp: TCP offset, for which poses hold.
        request: the move.

    Raises:
        MotionError: R110 a joint would leave its range, R111 a pose is out of reach, R112 the points pass a
            singularity, R116 the arm is not at the first point, R117 two points are too far apart; the text names
            file and line.
    """
    points = request.points
    if points.is_cartesian:
        columns = _solved(arm, limits, q_start, T_flange_tcp, request)
    else:
        numbers = array("d", points.numbers[48 * request.first - 48 : 48 * request.last])
        columns = [numbers[joint::6].tolist() for joint in range(6)]
    q1, q2, q3, q4, q5, q6 = [column[0] for column in columns]
    q_first = (q1, q2, q3, q4, q5, q6)
    _check_ranges(limits, columns, request)
    if not points.is_cartesian:
        _check_start(arm, q_start, q_first, T_flange_tcp, request)
    _check_steps(arm, limits, columns, request)
    is_aside = max(abs(there - here) for here, there in zip(q_start, q_first, strict=True)) > SAME_PLACE_RAD
    to_first = MoveJ(q_first if is_aside else q_start, request.a, request.v)
    way_there = plan_movej(arm, limits, q_start, to_first, T_flange_tcp)
    if request.first == request.last:
        return way_there
    lead = way_there.segment if is_aside else None
    if lead is None:
        for column, angle in zip(columns, q_start, strict=True):
            column[0] = angle
    spline = JointSpline(columns, points.interval_s)
    _check_excursions(limits, spline, request)
    profile, too_fast = paced(spline, limits)
    if lead is not None:
        profile = lead.profile.followed_by(profile)
    notes = (_slowed(limits, spline, request, too_fast, profile.duration_s),) if too_fast else ()
    return Plan(Segment(PointPath(arm, T_flange_tcp, lead, spline), profile), notes)


def _solved(
    arm: Arm, limits: MotionLimits, q_start: Six, T_flange_tcp: Transform, request: MoveML
) -> list[list[float]]:
    """Return the joint angles of the poses, joint by joint, each on the turn nearest to the one before."""
    points = request.points
    branch = branch_of(arm, q_start)
    T_tcp_flange = inverse(T_flange_tcp)
    T_base_part = transform_from_pose(points.frame)
    has_frame = points.frame != ZERO_SIX
    numbers = iter(array("d", points.numbers[48 * request.first - 48 : 48 * request.last]))
    rows = array("d")
    q = q_start
    for number, pose in enumerate(zip(*[numbers] * 6, strict=True), request.first):
        T_base_tcp = transform_from_pose(pose)
        # Without a frame only zeros change, by their sign.
        if has_frame or 0.0 in T_base_tcp:
            T_base_tcp = compose(T_base_part, T_base_tcp)
        T_base_flange = compose(T_base_tcp, T_tcp_flange)
        solution = solve_branch(arm, T_base_flange, branch, q[5])
        if solution is None:
            raise _out_of_reach(arm, T_base_flange, points, number)
        q = unwrapped(solution, q)
        if is_blocked(arm, q):
            raise MotionError(
                said(
                    "{place} meets the {blocked} singularity, where joints would turn without limit",
                    place=points.place(number),
                    blocked=singularity(arm, q).blocked,
                ),
                code="R112",
                value=number,
                hint=SINGULAR_HINT,
            )
        if number == request.first:
            # Before the others, which the arm may not reach from its present place.
            _check_start(arm, q_start, q, T_flange_tcp, request)
        rows.extend(q)
    return [rows[joint::6].tolist() for joint in range(6)]


def _out_of_reach(arm: Arm, T_base_flange: Transform, points: MicroLine, number: int) -> MotionError:
    reason = reason_unreachable(arm, T_base_flange)
    hint = "keep all points inside the workspace"
    if not reason:
        reason = "the arm would have to change between its configurations (shoulder, elbow or wrist turned over)"
        hint = "begin in the configuration in which the arm reaches all points"
    elif max(map(abs, points.point(number)[:3])) > SURELY_MILLIMETRES:
        hint = "unit_type 1 is for positions in mm"
    return MotionError(
        said("{place} is out of reach: {reason}", place=points.place(number), reason=reason),
        code="R111",
        value=list(points.point(number)),
        hint=hint,
    )


def _check_start(arm: Arm, q_start: Six, q_first: Six, T_flange_tcp: Transform, request: MoveML) -> None:
    differences = [there - here for here, there in zip(q_start, q_first, strict=True)]
    joint = max(range(6), key=lambda index: abs(differences[index]))
    if abs(differences[joint]) <= START_TOLERANCE_RAD:
        return
    here, there = (position_of(arm.forward_tcp(q, T_flange_tcp)) for q in (q_start, q_first))
    raise MotionError(
        said(
            "the arm is not where the points begin, {place}: joint {joint} is {differences:.4f} rad "
            "away from there, the TCP {dist:.1f} mm",
            place=request.points.place(request.first),
            joint=JOINT_NAMES[joint],
            differences=abs(differences[joint]),
            dist=1000.0 * dist(here, there),
        ),
        code="R116",
        value=differences[joint],
        limit=f"<= {START_TOLERANCE_RAD:g}",
        unit="rad",
        hint=said("go there first: movej(get_micro_line_values_by_index(index, 0, {first}))", first=request.first),
    )


def _check_ranges(limits: MotionLimits, columns: Sequence[Sequence[float]], request: MoveML) -> None:
    found: list[tuple[int, int]] = []
    for joint, column in enumerate(columns):
        low, high = limits.q_min[joint] - RANGE_TOLERANCE_RAD, limits.q_max[joint] + RANGE_TOLERANCE_RAD
        if min(column) < low or max(column) > high:
            found.append((next(index for index, angle in enumerate(column) if not low <= angle <= high), joint))
    if found:
        index, joint = min(found)
        raise _out_of_range(
            limits,
            request,
            joint,
            columns[joint][index],
            said("at {place}", place=request.points.place(request.first + index)),
        )


def _check_excursions(limits: MotionLimits, spline: JointSpline, request: MoveML) -> None:
    """Refuse a curve that leaves a joint's range between two points that lie inside."""
    for joint, column in enumerate(spline.columns):
        room = 0.125 * spline.interval_s * spline.interval_s * spline.largest_accelerations[joint]
        low, high = limits.q_min[joint] - RANGE_TOLERANCE_RAD, limits.q_max[joint] + RANGE_TOLERANCE_RAD
        if min(column) - room >= low and max(column) + room <= high:
            continue
        for interval in range(spline.intervals):
            for angle in spline.extremes(joint, interval):
                if not low <= angle <= high:
                    place = said("behind {place}", place=request.points.place(request.first + interval))
                    raise _out_of_range(limits, request, joint, angle, place)


def _out_of_range(limits: MotionLimits, request: MoveML, joint: int, angle: float, place: str) -> MotionError:
    hint = "keep the points inside the ranges of the joints"
    if request.points.is_cartesian:
        hint = "begin with that joint a full turn away"
    elif abs(angle) > SURELY_DEGREES:
        hint = "unit_type 1 is for joint positions in deg"
    return joint_range_error(limits, joint, angle, place, hint=hint)


def _check_steps(arm: Arm, limits: MotionLimits, columns: Sequence[Sequence[float]], request: MoveML) -> None:
    points = request.points
    found: list[tuple[int, int]] = []
    for joint, column in enumerate(columns):
        widest = JUMP_INTERVALS * limits.qd_max[joint] * points.interval_s
        if points.is_cartesian:
            widest = min(widest, JUMP_RAD)
        previous = column[0]
        for index, angle in enumerate(column):
            if not -widest <= angle - previous <= widest:
                found.append((index, joint))
                break
            previous = angle
    if not found:
        return
    index, joint = min(found)
    step = columns[joint][index] - columns[joint][index - 1]
    what = said(
        "from {place} to the next point joint {joint} would jump by {step:.4f} rad in {interval_s:g} s",
        place=points.place(request.first + index - 1),
        joint=JOINT_NAMES[joint],
        step=step,
        interval_s=points.interval_s,
    )
    if points.is_cartesian:
        q = [[column[k] for column in columns] for k in (index - 1, index)]
        if min(min(singularity(arm, row)) for row in q) < NEAR_SINGULAR:
            raise MotionError(
                said("the points pass through a singularity: {what}", what=what),
                code="R112",
                value=step,
                unit="rad",
                hint=SINGULAR_HINT,
            )
    raise MotionError(
        what,
        code="R117",
        value=step,
        limit=f"<= {min(JUMP_INTERVALS * limits.qd_max[joint] * points.interval_s, JUMP_RAD):.4g}",
        unit="rad",
        hint="is a line missing or wrong, or the interval too short?",
    )


def _slowed(
    limits: MotionLimits, spline: JointSpline, request: MoveML, too_fast: TooFast, duration_s: float
) -> MoveNote:
    """Return the note for points that come faster than the arm can move; names file, line, joint and numbers."""
    speed, acceleration = spline.largest(too_fast.joint, too_fast.interval)
    name = JOINT_NAMES[too_fast.joint]
    if too_fast.is_speed:
        asked = said(
            "joint {name} would turn at {speed:.3f} rad/s; it can {qd_max:.4g} rad/s",
            name=name,
            speed=speed,
            qd_max=limits.qd_max[too_fast.joint],
        )
    else:
        limit = CURVATURE_SHARE * limits.qdd_max[too_fast.joint]
        asked = said(
            "joint {name} would be accelerated with {acceleration:.1f} rad/s^2, of which {limit:.4g} are possible",
            name=name,
            acceleration=acceleration,
            limit=limit,
        )
    return MoveNote(
        MoveNoteKind.SPEED_LOWERED_FOR_JOINT_LIMITS,
        said(
            "the points of {points} come faster than the arm can move: behind {place} {asked}; they "
            "are played at {rate:.0f} % of their speed there, and take {duration_s:.3f} s instead of "
            "{spline_duration_s:.3f} s",
            points=request.points.name,
            place=request.points.place(request.first + too_fast.interval),
            asked=asked,
            rate=100.0 * too_fast.rate,
            duration_s=duration_s,
            spline_duration_s=spline.duration_s,
        ),
    )
