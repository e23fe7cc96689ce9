"""Joint angles along a Cartesian path: checked when planned, exact when sampled.

The branch of the inverse kinematics is fixed at the start of a move; it could only change
through a singularity. The path is solved on a grid that is refined where the joints bend, so
that reach, joint ranges, singularities and the speeds of the joints are known before the arm
moves. The grid also holds the full turn of each joint; a sample in between is solved from its
pose alone and is exactly on the path.

With h the width of a grid interval and q' the derivative of a joint by the path position, the
difference of the step from the trapezoidal rule, e = |dq - h (q'_a + q'_b) / 2|, is h^3 q''' / 12:
the measure of how much the interval hides. A jump to another turn or branch shows in it too.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Hashable, Iterator, Sequence
from math import ceil
from typing import Final, TypeAlias

from elitescript.errors import InternalError, MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import joint_speeds, singularity
from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.motion.course import rounded
from elitescript.motion.limits import (
    RANGE_TOLERANCE_RAD,
    MotionLimits,
    joint_outside,
    joint_range_error,
    unwrapped,
)
from elitescript.motion.paths.cartesian import FlangePath
from elitescript.motion.refusals import JUMP_RAD, RANGE_HINT, jump, leaves_reach, out_of_range, out_of_reach, singular

INTERVAL_M: Final = 0.05
"""Widest interval of the first grid. Limits of reach and of joints with finer structure than this
bend the joints, which refines the grid."""

INTERVAL_RAD: Final = 0.4
"""The same for the rotation of the tool and for the angle of an arc."""

INTERVAL_MIN: Final = 1e-5
"""Narrowest interval of the grid (m or rad). The narrowest passage that is not refused, at the
give-up threshold of a singularity, is fifty times as wide."""

STEP_MAX_RAD: Final = 0.6
"""Largest joint step over an interval."""

ERROR_COARSE_RAD: Final = 0.01
"""Largest e of an interval in which no joint comes near its limits."""

BEND_MAX_RAD: Final = 0.1
"""Largest h |q'_b - q'_a| of an interval. An interval that hides a singular place between two
bent stretches may have a small e by chance, but not a small bend as well."""

ERROR_FINE_RAD: Final = 0.0005
"""Largest e where limits are near, so that speeds between the grid points are known to 1e-3."""

NEAR_LIMIT: Final = 0.8
"""Share of a speed or acceleration limit from which on the finer grid is used."""

RANGE_EXCURSION: Final = 4.0 / 27.0
"""A cubic leaves the range of its end points by at most this times h max|q'|."""

RANGE_RESOLUTION_RAD: Final = 1e-7
"""Excursions below this are not looked for."""


Ratios: TypeAlias = tuple[float, float, float]
"""Bounds, over the way between two neighbouring grid points and over the joints, of |q'| / qd_max, |q'| / qdd_max and
|q''| / qdd_max."""


class JointTrack:
    """Joint angles over the path position of a Cartesian path; immutable. A `JointPath`, made by `follow`."""

    __slots__ = ("_branch", "_turns", "arm", "grid_q", "grid_s", "grid_slope", "interval_ratios", "path")

    def __init__(
        self,
        arm: Arm,
        branch: int,
        path: FlangePath,
        grid_s: Sequence[float],
        grid_q: Sequence[Six],
        grid_slope: Sequence[Six],
        interval_ratios: Sequence[Ratios],
    ) -> None:
        """Take the solved grid.

        Args:
            arm: the arm.
            branch: its branch throughout.
            path: of the flange.
            grid_s: path positions of the grid, rising.
            grid_q: joint angles there, unwrapped, rad.
            grid_slope: their derivatives by the path position.
            interval_ratios: of each interval.
        """
        self.arm = arm
        self._branch = branch
        self.path = path
        self.grid_s = tuple(grid_s)
        self.grid_q = tuple(grid_q)
        self.grid_slope = tuple(grid_slope)
        self.interval_ratios = tuple(interval_ratios)
        self._turns: list[Six] | None = None
        """How far each joint has turned from the start to the places of the grid, at most; made when it is read."""

    @property
    def kind(self) -> str:
        return self.path.kind

    @property
    def unit(self) -> str:
        return self.path.unit

    @property
    def length(self) -> float:
        return self.path.length

    @property
    def q_start(self) -> Six:
        return self.grid_q[0]

    @property
    def q_end(self) -> Six:
        return self.grid_q[-1]

    @property
    def T_base_tcp_end(self) -> Transform:
        return self.path.T_base_tcp_end

    def q(self, s: float) -> Six:
        if s <= 0.0:
            return self.grid_q[0]
        if s >= self.path.length:
            return self.grid_q[-1]
        return self._solved(s, self.path.flange(s))

    def q_and_slope(self, s: float) -> tuple[Six, Six]:
        if s <= 0.0:
            return self.grid_q[0], self.grid_slope[0]
        if s >= self.path.length:
            return self.grid_q[-1], self.grid_slope[-1]
        T_base_flange, twist = self.path.flange_and_slope(s)
        q = self._solved(s, T_base_flange)
        slope = joint_speeds(self.arm, q, twist)
        if slope is None:
            raise InternalError(f"singular {self.path.place(s)}, which the planner had checked")
        return q, slope

    def turned(self, begin: float, end: float) -> Six:
        turns = self._turns
        if turns is None:
            turns = self._turns = list(_turns(self.grid_s, self.grid_q, self.grid_slope))
        a, b, c, d, e, f = self._turned_to(begin, turns)
        g, h, i, j, k, m = self._turned_to(end, turns)
        return g - a, h - b, i - c, j - d, k - e, m - f

    def _turned_to(self, s: float, turns: Sequence[Six]) -> Six:
        """Return how far each joint has turned up to a path position, at most."""
        index = min(max(bisect_right(self.grid_s, s) - 1, 0), len(turns) - 2)
        if index < 0:
            return turns[0]
        start, end = self.grid_s[index], self.grid_s[index + 1]
        share = min(max((s - start) / (end - start), 0.0), 1.0)
        q1, q2, q3, q4, q5, q6 = [a + share * (b - a) for a, b in zip(turns[index], turns[index + 1], strict=True)]
        return q1, q2, q3, q4, q5, q6

    @property
    def course(self) -> Hashable:
        # A line, an arc and a corner follow from both ends and the middle.
        q, slope = self.grid_q, self.grid_slope
        middle = len(q) // 2
        places = (*q[0], *q[middle], *q[-1], *slope[0], *slope[middle], *slope[-1])
        return self.kind, len(q), rounded((self.length, self.grid_s[middle], *places))

    def tool_rates(self, s: float) -> tuple[float, float]:
        return self.path.tool_rates

    def _solved(self, s: float, T_base_flange: Transform) -> Six:
        near = self.grid_q[bisect_right(self.grid_s, s) - 1]
        q = solve_branch(self.arm, T_base_flange, self._branch, near[5])
        if q is None:
            raise InternalError(f"out of reach {self.path.place(s)}, which the planner had checked")
        return unwrapped(q, near)


def _turns(grid_s: Sequence[float], grid_q: Sequence[Six], grid_slope: Sequence[Six]) -> Iterator[Six]:
    """Yield for each place of the grid how far each joint has turned from the start on, at most.

    Within an interval the joints turn as fast as the cubic through its ends at most, as in `_weighed`.
    """
    total = ZERO_SIX
    yield total
    for index in range(1, len(grid_s)):
        h = grid_s[index] - grid_s[index - 1]
        ends = zip(total, grid_q[index - 1], grid_q[index], grid_slope[index - 1], grid_slope[index], strict=True)
        q1, q2, q3, q4, q5, q6 = [
            sum_ + h * max(abs(da), abs(db)) + 1.5 * abs(qb - qa - 0.5 * h * (da + db)) for sum_, qa, qb, da, db in ends
        ]
        total = (q1, q2, q3, q4, q5, q6)
        yield total


def follow(
    arm: Arm, limits: MotionLimits, path: FlangePath, q_start: Six, speed: float, acceleration: float
) -> JointTrack:
    """Solve a path from joint angles q_start (rad) on, and check it.

    Args:
        arm: the arm.
        limits: its limits.
        path: starts at the flange pose of q_start.
        q_start: joint angles at the start.
        speed: wanted path speed; the grid is finer where joints are near their limits then.
        acceleration: wanted path acceleration.

    Raises:
        MotionError: R110 a joint would leave its range, R111 a point is out of reach, R112 the
            path meets a singularity; all say where.
    """
    branch = branch_of(arm, q_start)
    if path.length == 0.0:
        return JointTrack(arm, branch, path, (0.0,), (q_start,), (ZERO_SIX,), ())
    try:
        return _followed(arm, limits, path, q_start, branch, speed, acceleration)
    except MotionError:
        # An end out of reach is named first, wherever the path fails.
        T_end = path.flange(path.length)
        reason = reason_unreachable(arm, T_end) if solve_branch(arm, T_end, branch) is None else ""
        if reason:
            raise out_of_reach(path, path.length, reason) from None
        raise


def reach_along(
    arm: Arm, limits: MotionLimits, path: FlangePath, q_start: Six, speed: float, acceleration: float
) -> tuple[float, MotionError]:
    """Return how far the arm can follow a path that leads out of its workspace, and why not farther.

    Args:
        arm, limits, path, q_start, speed, acceleration: as of `follow`; the path is longer than the arm reaches.

    Returns:
        A path position that is reached, at most `REACH_RESOLUTION` before the last one, and the refusal of the rest.

    Raises:
        MotionError: the start is outside the joint ranges already.
    """
    branch = branch_of(arm, q_start)
    solved: list[float] = [0.0]
    try:
        _followed(arm, limits, path, q_start, branch, speed, acceleration, solved)
    except MotionError as error:
        refusal = error
    else:
        raise InternalError(f"a path of {path.length} {path.unit} inside the workspace")
    if len(solved) < 2 and joint_outside(limits, q_start) is not None:
        raise refusal
    inside, outside = solved[-1], solved[-1] + max(INTERVAL_MIN, INTERVAL_M)
    while outside - inside > REACH_RESOLUTION:
        middle = 0.5 * (inside + outside)
        T_base_flange, twist = path.flange_and_slope(middle)
        q = solve_branch(arm, T_base_flange, branch)
        try:
            is_inside = q is not None and joint_outside(limits, unwrapped(q, q_start)) is None
            if is_inside and q is not None:
                _slope(arm, path, middle, twist, q)
        except MotionError:
            is_inside = False
        inside, outside = (middle, outside) if is_inside else (inside, middle)
    return max(solved[-1], inside - REACH_RESOLUTION), refusal


REACH_RESOLUTION: Final = 1e-4
"""How exactly the end of the reach along a line is found, m."""


def _followed(
    arm: Arm,
    limits: MotionLimits,
    path: FlangePath,
    q_start: Six,
    branch: int,
    speed: float,
    acceleration: float,
    solved: list[float] | None = None,
) -> JointTrack:
    """Solve a path; see `follow`. `solved` gets the positions of its grid one after the other, up to a refusal."""
    joint = joint_outside(limits, q_start)
    if joint is not None:
        raise joint_range_error(limits, joint, q_start[joint], path.place(0.0), hint=RANGE_HINT)
    length = path.length
    slope_start = _slope(arm, path, 0.0, path.flange_and_slope(0.0)[1], q_start)
    grid_s, grid_q, grid_slope = [0.0] if solved is None else solved, [q_start], [slope_start]
    s_a, q_a, slope_a = 0.0, q_start, slope_start
    grid_ratios: list[Ratios] = []
    intervals = max(2, ceil(path.way / INTERVAL_M), ceil(path.sweep / INTERVAL_RAD))
    # Path positions still ahead inside one interval of the first grid, the next one last; solved when needed.
    pending: list[tuple[float, Six | None, Six | None]] = []
    begun = 0
    joint_limits = [
        (qd_max, qdd_max, q_min, q_max, q_min - RANGE_TOLERANCE_RAD, q_max + RANGE_TOLERANCE_RAD)
        for qd_max, qdd_max, q_min, q_max in zip(limits.qd_max, limits.qdd_max, limits.q_min, limits.q_max, strict=True)
    ]
    while pending or begun < intervals:
        if not pending:
            begun += 1
            pending.append((length * begun / intervals if begun < intervals else length, None, None))
        s_b, q_b, slope_b = pending[-1]
        if q_b is None or slope_b is None:
            T_base_flange, twist = path.flange_and_slope(s_b)
            q_b = solve_branch(arm, T_base_flange, branch, q_a[5])
            if q_b is None:
                raise leaves_reach(arm, path, branch, s_a, s_b)
            slope_b = _slope(arm, path, s_b, twist, q_b)
            pending[-1] = s_b, q_b, slope_b
        q_b = unwrapped(q_b, q_a)
        h = s_b - s_a
        weighed = _weighed(h, q_a, q_b, slope_a, slope_b, joint_limits, speed, acceleration)
        if weighed is None:
            pending.append((0.5 * (s_a + s_b), None, None))
            continue
        if h <= INTERVAL_MIN and any(abs(b - a) > JUMP_RAD for a, b in zip(q_a, q_b, strict=True)):
            raise jump(path, s_b, q_a, q_b)
        ratios, is_inside = weighed
        if not is_inside:
            joint = joint_outside(limits, q_b)
            assert joint is not None
            raise out_of_range(arm, limits, path, branch, joint, s_a, q_a, s_b, q_b)
        grid_ratios.append(ratios)
        pending.pop()
        grid_s.append(s_b)
        grid_q.append(q_b)
        grid_slope.append(slope_b)
        s_a, q_a, slope_a = s_b, q_b, slope_b
    return JointTrack(arm, branch, path, grid_s, grid_q, grid_slope, grid_ratios)


def _weighed(
    h: float,
    q_a: Six,
    q_b: Six,
    slope_a: Six,
    slope_b: Six,
    joint_limits: Sequence[tuple[float, float, float, float, float, float]],
    speed: float,
    acceleration: float,
) -> tuple[Ratios, bool] | None:
    """Return the ratios of an interval of width h, with the joints as cubics, and whether q_b lies inside the ranges.

    The cubic through angles and slopes of both ends has |q'| <= max(|q'_a|, |q'_b|) + 1.5 e / h and
    |q''| <= (6 e / h + |q'_b - q'_a|) / h. `joint_limits` holds qd_max, qdd_max, q_min, q_max of each joint, and the
    ends of its range with the tolerance.
    None when the bounds are too wide, so that a point in the middle is needed; an interval as narrow as
    `INTERVAL_MIN` has none.
    """
    is_inside = True
    may_split = h > INTERVAL_MIN
    speed_ratio = acceleration_ratio = curvature_ratio = 0.0
    for qa, qb, da, db, (qd_max, qdd_max, q_min, q_max, low, high) in zip(
        q_a, q_b, slope_a, slope_b, joint_limits, strict=True
    ):
        step = qb - qa
        error = abs(step - 0.5 * h * (da + db))
        bend = abs(db - da)
        size_a, size_b = abs(da), abs(db)
        steepest = (size_a if size_a > size_b else size_b) + 1.5 * error / h
        curvature = (6.0 * error / h + bend) / h
        if may_split:
            if bend * h > BEND_MAX_RAD or error > ERROR_COARSE_RAD or not -STEP_MAX_RAD <= step <= STEP_MAX_RAD:
                return None
            if error > ERROR_FINE_RAD and (
                steepest * speed > NEAR_LIMIT * qd_max
                or steepest * acceleration + curvature * speed * speed > NEAR_LIMIT * qdd_max
            ):
                return None
            if da * db < 0.0:
                excursion = RANGE_EXCURSION * h * steepest
                if excursion > RANGE_RESOLUTION_RAD and (
                    max(qa, qb) + excursion > q_max or min(qa, qb) - excursion < q_min
                ):
                    return None
        if steepest > speed_ratio * qd_max:
            speed_ratio = steepest / qd_max
        if steepest > acceleration_ratio * qdd_max:
            acceleration_ratio = steepest / qdd_max
        if curvature > curvature_ratio * qdd_max:
            curvature_ratio = curvature / qdd_max
        if not low <= qb <= high:
            is_inside = False
    return (speed_ratio, acceleration_ratio, curvature_ratio), is_inside


def _slope(arm: Arm, path: FlangePath, s: float, twist: Six, q: Six) -> Six:
    """Return dq/ds for a twist of the flange, or refuse a point too near a singularity."""
    slope = joint_speeds(arm, q, twist, keeps_clear=True)
    if slope is None:
        raise singular(path, s, singularity(arm, q))
    return slope
