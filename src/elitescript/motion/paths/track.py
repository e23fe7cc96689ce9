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
from collections.abc import Sequence
from math import ceil
from typing import Final

from elitescript.errors import InternalError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import joint_speeds, singularity
from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.motion.limits import MotionLimits, joint_outside, joint_range_error, unwrapped
from elitescript.motion.paths.cartesian import FlangePath
from elitescript.motion.refusals import JUMP_RAD, RANGE_HINT, jump, leaves_reach, out_of_range, out_of_reach, singular
from elitescript.records import NamedTuple

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


class JointTrack:
    """Joint angles over the path position of a Cartesian path; immutable. A `JointPath`, made by `follow`."""

    __slots__ = ("_branch", "arm", "grid_q", "grid_s", "grid_slope", "interval_ratios", "path")

    def __init__(
        self,
        arm: Arm,
        branch: int,
        path: FlangePath,
        grid_s: Sequence[float],
        grid_q: Sequence[Six],
        grid_slope: Sequence[Six],
        interval_ratios: Sequence[tuple[float, float, float]],
    ) -> None:
        """Take the solved grid.

        Args:
            arm: the arm.
            branch: its branch throughout.
            path: of the flange.
            grid_s: path positions of the grid, rising.
            grid_q: joint angles there, unwrapped, rad.
            grid_slope: their derivatives by the path position.
            interval_ratios: for each interval bounds, over its joints, of |q'| / qd_max, |q'| / qdd_max
                and |q''| / qdd_max.
        """
        self.arm = arm
        self._branch = branch
        self.path = path
        self.grid_s = tuple(grid_s)
        self.grid_q = tuple(grid_q)
        self.grid_slope = tuple(grid_slope)
        self.interval_ratios = tuple(interval_ratios)

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
        T_base_flange = self.path.flange(s)
        q = self._solved(s, T_base_flange)
        slope = joint_speeds(self.arm, q, self.path.flange_slope(s, T_base_flange))
        if slope is None:
            raise InternalError(f"singular {self.path.place(s)}, which the planner had checked")
        return q, slope

    def tool_rates(self, s: float) -> tuple[float, float]:
        return self.path.tool_rates

    def _solved(self, s: float, T_base_flange: Transform) -> Six:
        near = self.grid_q[bisect_right(self.grid_s, s) - 1]
        q = solve_branch(self.arm, T_base_flange, self._branch, near[5])
        if q is None:
            raise InternalError(f"out of reach {self.path.place(s)}, which the planner had checked")
        return unwrapped(q, near)


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
    length = path.length
    if length == 0.0:
        return JointTrack(arm, branch, path, (0.0,), (q_start,), (ZERO_SIX,), ())
    if solve_branch(arm, path.flange(length), branch) is None:
        end_reason = reason_unreachable(arm, path.flange(length))
        if end_reason:
            raise out_of_reach(path, length, end_reason)
    joint = joint_outside(limits, q_start)
    if joint is not None:
        raise joint_range_error(limits, joint, q_start[joint], path.place(0.0), hint=RANGE_HINT)
    slope_start = _slope(arm, path, 0.0, path.flange(0.0), q_start)
    grid_s, grid_q, grid_slope = [0.0], [q_start], [slope_start]
    s_a, q_a, slope_a = 0.0, q_start, slope_start
    ratios: list[tuple[float, float, float]] = []
    intervals = max(2, ceil(path.way / INTERVAL_M), ceil(path.sweep / INTERVAL_RAD))
    # Path positions still ahead inside one interval of the first grid, the next one last; solved when needed.
    pending: list[tuple[float, Six | None, Six | None]] = []
    begun = 0
    joint_limits = tuple(zip(limits.qd_max, limits.qdd_max, limits.q_min, limits.q_max, strict=True))
    while pending or begun < intervals:
        if not pending:
            begun += 1
            pending.append((length * begun / intervals if begun < intervals else length, None, None))
        s_b, q_b, slope_b = pending[-1]
        if q_b is None or slope_b is None:
            T_base_flange = path.flange(s_b)
            q_b = solve_branch(arm, T_base_flange, branch, q_a[5])
            if q_b is None:
                raise leaves_reach(arm, path, branch, s_a, s_b)
            slope_b = _slope(arm, path, s_b, T_base_flange, q_b)
            pending[-1] = s_b, q_b, slope_b
        q_b = unwrapped(q_b, q_a)
        interval = _weighed(s_b - s_a, q_a, q_b, slope_a, slope_b, joint_limits, speed, acceleration)
        if interval.is_coarse:
            if s_b - s_a > INTERVAL_MIN:
                pending.append((0.5 * (s_a + s_b), None, None))
                continue
            if interval.widest > JUMP_RAD:
                raise jump(path, s_b, q_a, q_b)
        joint = joint_outside(limits, q_b)
        if joint is not None:
            raise out_of_range(arm, limits, path, branch, joint, s_a, q_a, s_b, q_b)
        ratios.append((interval.speed_ratio, interval.acceleration_ratio, interval.curvature_ratio))
        pending.pop()
        grid_s.append(s_b)
        grid_q.append(q_b)
        grid_slope.append(slope_b)
        s_a, q_a, slope_a = s_b, q_b, slope_b
    return JointTrack(arm, branch, path, grid_s, grid_q, grid_slope, ratios)


class _Interval(NamedTuple):
    """Bounds on the way between two neighbouring grid points."""

    is_coarse: bool
    """Whether the bounds are too wide, so that a point in the middle is needed."""
    widest: float
    """Largest joint step, rad."""
    speed_ratio: float
    """Bound of |q'| / qd_max over way and joints."""
    acceleration_ratio: float
    """Bound of |q'| / qdd_max."""
    curvature_ratio: float
    """Bound of |q''| / qdd_max."""


def _weighed(
    h: float,
    q_a: Six,
    q_b: Six,
    slope_a: Six,
    slope_b: Six,
    joint_limits: tuple[tuple[float, float, float, float], ...],
    speed: float,
    acceleration: float,
) -> _Interval:
    """Return the bounds of an interval of width h, with the joints as cubics.

    The cubic through angles and slopes of both ends has |q'| <= max(|q'_a|, |q'_b|) + 1.5 e / h and
    |q''| <= (6 e / h + |q'_b - q'_a|) / h. `joint_limits` holds qd_max, qdd_max, q_min, q_max of each joint.
    """
    is_coarse = False
    widest = speed_ratio = acceleration_ratio = curvature_ratio = 0.0
    for qa, qb, da, db, (qd_max, qdd_max, q_min, q_max) in zip(q_a, q_b, slope_a, slope_b, joint_limits, strict=True):
        step = qb - qa
        if step > widest or -step > widest:
            widest = abs(step)
        error = abs(step - 0.5 * h * (da + db))
        bend = abs(db - da)
        steepest = max(da, -da, db, -db) + 1.5 * error / h
        curvature = (6.0 * error / h + bend) / h
        if steepest > speed_ratio * qd_max:
            speed_ratio = steepest / qd_max
        if steepest > acceleration_ratio * qdd_max:
            acceleration_ratio = steepest / qdd_max
        if curvature > curvature_ratio * qdd_max:
            curvature_ratio = curvature / qdd_max
        is_near_limit = (
            steepest * speed > NEAR_LIMIT * qd_max
            or steepest * acceleration + curvature * speed * speed > NEAR_LIMIT * qdd_max
        )
        excursion = RANGE_EXCURSION * h * steepest
        if (
            bend * h > BEND_MAX_RAD
            or error > (ERROR_FINE_RAD if is_near_limit else ERROR_COARSE_RAD)
            or (
                da * db < 0.0
                and excursion > RANGE_RESOLUTION_RAD
                and (max(qa, qb) + excursion > q_max or min(qa, qb) - excursion < q_min)
            )
        ):
            is_coarse = True
    return _Interval(is_coarse or widest > STEP_MAX_RAD, widest, speed_ratio, acceleration_ratio, curvature_ratio)


def _slope(arm: Arm, path: FlangePath, s: float, T_base_flange: Transform, q: Six) -> Six:
    """Return dq/ds, or refuse a point too near a singularity."""
    distance = singularity(arm, q)
    slope = None if distance.blocked else joint_speeds(arm, q, path.flange_slope(s, T_base_flange))
    if slope is None:
        raise singular(path, s, distance)
    return slope
