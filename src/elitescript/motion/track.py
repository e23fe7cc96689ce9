"""The joints along a Cartesian path: checked when planned, exact when sampled.

The branch of the inverse kinematics is fixed at the start of a move; it could only change
through a singularity. The path is solved on a grid that is refined where the joints bend, so
that reach, joint ranges, singularities and the speeds of the joints are known before the arm
moves. The grid also tells which full turn a joint is on; a sample in between is solved afresh
from its pose and lands exactly on the path, whatever was sampled before.

With h the width of a grid interval and q' the derivative of a joint by the path position, the
difference of the step from the trapezoidal rule, e = |dq - h (q'_a + q'_b) / 2|, is h^3 q''' / 12:
the measure of how much the interval hides. A jump to another turn or branch shows in it too.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from math import ceil, degrees, pi
from typing import Final

from elitescript.errors import InternalError, MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import (
    ELBOW_GIVE_UP_SINE,
    SHOULDER_GIVE_UP_M,
    WRIST_GIVE_UP_SINE,
    joint_speeds,
    singularity,
)
from elitescript.kinematics.limits import TURN
from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.motion.limits import JOINT_NAMES, MotionLimits, joint_outside, joint_range_error
from elitescript.motion.path import CartesianPath

INTERVAL_M: Final = 0.05
"""Widest interval of the first grid. Limits of reach and of joints have no finer structure than
this without bending the joints, which refines the grid."""

INTERVAL_RAD: Final = 0.4
"""The same for the rotation of the tool and for the angle of an arc."""

INTERVAL_MIN: Final = 1e-5
"""The grid is not refined below this (m or rad). The narrowest passage that is not refused, at
the give-up threshold of a singularity, is fifty times as wide."""

STEP_MAX_RAD: Final = 0.6
"""Largest joint step over an interval."""

JUMP_RAD: Final = 0.5 * pi
"""A joint step this large over the narrowest interval is a jump, not a motion."""

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
    """Joint angles over the path position of a Cartesian path; immutable. Made by `follow`."""

    __slots__ = (
        "_arm",
        "_branch",
        "grid_q",
        "grid_s",
        "grid_slope",
        "interval_ratios",
        "path",
    )

    def __init__(
        self,
        arm: Arm,
        branch: int,
        path: CartesianPath,
        grid_s: Sequence[float],
        grid_q: Sequence[Six],
        grid_slope: Sequence[Six],
        interval_ratios: Sequence[tuple[float, float, float]],
    ) -> None:
        """Take the solved grid.

        Args:
            arm: the arm.
            branch: its branch throughout.
            path: what the flange follows.
            grid_s: path positions of the grid, rising.
            grid_q: joint angles there, unwrapped, rad.
            grid_slope: their derivatives by the path position.
            interval_ratios: for each interval bounds, over its joints, of |q'| / qd_max, |q'| / qdd_max
                and |q''| / qdd_max.
        """
        self._arm = arm
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
        """Return the joint angles at a path position, rad."""
        if s <= 0.0:
            return self.grid_q[0]
        if s >= self.path.length:
            return self.grid_q[-1]
        return self._solved(s, self.path.flange(s))

    def q_and_slope(self, s: float) -> tuple[Six, Six]:
        """Return the joint angles, rad, and their derivatives by the path position."""
        if s <= 0.0:
            return self.grid_q[0], self.grid_slope[0]
        if s >= self.path.length:
            return self.grid_q[-1], self.grid_slope[-1]
        T_base_flange = self.path.flange(s)
        q = self._solved(s, T_base_flange)
        slope = joint_speeds(self._arm, q, self.path.flange_slope(s, T_base_flange))
        if slope is None:
            raise InternalError(f"singular {self.path.place(s)}, which the planner had checked")
        return q, slope

    def tool_rates(self, s: float) -> tuple[float, float]:
        """Return way (m) and rotation (rad) of the tool per unit of path position."""
        return self.path.tool_rates

    def _solved(self, s: float, T_base_flange: Transform) -> Six:
        near = self.grid_q[bisect_right(self.grid_s, s) - 1]
        q = solve_branch(self._arm, T_base_flange, self._branch, near[5])
        if q is None:
            raise InternalError(f"out of reach {self.path.place(s)}, which the planner had checked")
        return _unwrapped(q, near)


def follow(
    arm: Arm, limits: MotionLimits, path: CartesianPath, q_start: Six, speed: float, acceleration: float
) -> JointTrack:
    """Solve a path from joint angles q_start (rad) on, and check it.

    Args:
        arm: the arm.
        limits: its limits.
        path: starts at the flange pose of q_start.
        q_start: joint angles at the start.
        speed: path speed that is wanted; the grid is finer where joints are near their limits then.
        acceleration: path acceleration that is wanted.

    Raises:
        MotionError: R110 a joint would leave its range, R111 a point is out of reach, R112 the
            path meets a singularity; all say where.
    """
    branch = branch_of(arm, q_start)
    length = path.length
    if length == 0.0:
        return JointTrack(arm, branch, path, (0.0,), (q_start,), (_STANDSTILL,), ())
    if solve_branch(arm, path.flange(length), branch) is None:
        end_reason = reason_unreachable(arm, path.flange(length))
        if end_reason:
            raise _out_of_reach(path, length, end_reason)
    joint = joint_outside(limits, q_start)
    if joint is not None:
        raise joint_range_error(limits, joint, q_start[joint], path.place(0.0), hint=_RANGE_HINT)
    slope_start = _slope(arm, path, 0.0, path.flange(0.0), q_start)
    grid_s, grid_q, grid_slope = [0.0], [q_start], [slope_start]
    s_a, q_a, slope_a = 0.0, q_start, slope_start
    ratios: list[tuple[float, float, float]] = []
    intervals = max(2, ceil(length / INTERVAL_M if path.unit == "m" else 1), ceil(path.sweep / INTERVAL_RAD))
    # Path positions still ahead inside one interval of the first grid, the next one last; solved when needed.
    pending: list[tuple[float, Six | None, Six | None]] = []
    interval = 0
    joint_limits = tuple(zip(limits.qd_max, limits.qdd_max, limits.q_min, limits.q_max, strict=True))
    while pending or interval < intervals:
        if not pending:
            interval += 1
            pending.append((length * interval / intervals if interval < intervals else length, None, None))
        s_b, q_b, slope_b = pending[-1]
        if q_b is None or slope_b is None:
            T_base_flange = path.flange(s_b)
            q_b = solve_branch(arm, T_base_flange, branch, q_a[5])
            if q_b is None:
                raise _first_out_of_reach(arm, path, branch, s_a, s_b)
            slope_b = _slope(arm, path, s_b, T_base_flange, q_b)
            pending[-1] = s_b, q_b, slope_b
        q_b = _unwrapped(q_b, q_a)
        h = s_b - s_a
        is_coarse = False
        widest = 0.0
        interval_speed = interval_acceleration = interval_curvature = 0.0
        for qa, qb, da, db, (qd_max, qdd_max, q_min, q_max) in zip(
            q_a, q_b, slope_a, slope_b, joint_limits, strict=True
        ):
            step = qb - qa
            if step > widest:
                widest = step
            elif -step > widest:
                widest = -step
            error = abs(step - 0.5 * h * (da + db))
            steepest = max(da, -da, db, -db) + 1.5 * error / h
            bend = abs(db - da)
            curvature = (6.0 * error / h + bend) / h
            speed_share = steepest / qd_max
            if speed_share > interval_speed:
                interval_speed = speed_share
            if steepest > interval_acceleration * qdd_max:
                interval_acceleration = steepest / qdd_max
            if curvature > interval_curvature * qdd_max:
                interval_curvature = curvature / qdd_max
            is_near_limit = (
                speed_share * speed > NEAR_LIMIT
                or steepest * acceleration + curvature * speed * speed > NEAR_LIMIT * qdd_max
            )
            if bend * h > BEND_MAX_RAD or error > (ERROR_FINE_RAD if is_near_limit else ERROR_COARSE_RAD):
                is_coarse = True
            excursion = RANGE_EXCURSION * h * steepest
            if (
                da * db < 0.0
                and excursion > RANGE_RESOLUTION_RAD
                and (max(qa, qb) + excursion > q_max or min(qa, qb) - excursion < q_min)
            ):
                is_coarse = True
        if is_coarse or widest > STEP_MAX_RAD:
            if h > INTERVAL_MIN:
                pending.append((0.5 * (s_a + s_b), None, None))
                continue
            if widest > JUMP_RAD:
                raise _jump(path, s_b, q_a, q_b)
        joint = joint_outside(limits, q_b)
        if joint is not None:
            raise _out_of_range(arm, limits, path, branch, joint, s_a, q_a, s_b, q_b)
        ratios.append((interval_speed, interval_acceleration, interval_curvature))
        pending.pop()
        grid_s.append(s_b)
        grid_q.append(q_b)
        grid_slope.append(slope_b)
        s_a, q_a, slope_a = s_b, q_b, slope_b
    return JointTrack(arm, branch, path, grid_s, grid_q, grid_slope, ratios)


_STANDSTILL: Final[Six] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

BORDER_RESOLUTION: Final = 1e-4
"""How closely the first unreachable point of a path is looked for, m or rad."""


def _unwrapped(q: Six, near: Six) -> Six:
    """Return q with each joint on the full turn that is nearest to `near`."""
    q1, q2, q3, q4, q5, q6 = [
        angle + TURN * round((other - angle) / TURN) for angle, other in zip(q, near, strict=True)
    ]
    return q1, q2, q3, q4, q5, q6


def _slope(arm: Arm, path: CartesianPath, s: float, T_base_flange: Transform, q: Six) -> Six:
    """Return dq/ds, or refuse a point too near a singularity."""
    distance = singularity(arm, q)
    blocked = distance.blocked
    slope = None if blocked else joint_speeds(arm, q, path.flange_slope(s, T_base_flange))
    if slope is not None:
        return slope
    if blocked == "wrist":
        what = f"the sine of joint wrist2 is {distance.wrist:.6f}"
        value, limit, unit = distance.wrist, WRIST_GIVE_UP_SINE, ""
    elif blocked == "shoulder":
        what = f"the wrist centre is {distance.shoulder:.6f} m from passing beside the base axis"
        value, limit, unit = distance.shoulder, SHOULDER_GIVE_UP_M, "m"
    else:
        blocked = "elbow"
        what = f"the sine of joint elbow is {distance.elbow:.6f}"
        value, limit, unit = distance.elbow, ELBOW_GIVE_UP_SINE, ""
    raise MotionError(
        f"the move meets the {blocked} singularity {path.place(s)}: {what}, "
        f"at least {f'{limit:g} {unit}'.rstrip()} is needed to stay on the path",
        code="R112",
        value=value,
        limit=f">= {limit:g}",
        unit=unit or None,
        hint="use movej here, or lead the path past the singularity",
    )


def _jump(path: CartesianPath, s: float, q_a: Six, q_b: Six) -> MotionError:
    steps = [b - a for a, b in zip(q_a, q_b, strict=True)]
    joint = max(range(6), key=lambda index: abs(steps[index]))
    return MotionError(
        f"the move passes through a singularity {path.place(s)}: joint {JOINT_NAMES[joint]} would jump by "
        f"{steps[joint]:.4f} rad ({degrees(steps[joint]):.1f} deg)",
        code="R112",
        value=steps[joint],
        limit=f"< {JUMP_RAD:.4f}",
        unit="rad",
        hint="use movej here, or lead the path past the singularity",
    )


_RANGE_HINT: Final = "start the move with that joint a full turn away, or use movej"


def _out_of_range(
    arm: Arm,
    limits: MotionLimits,
    path: CartesianPath,
    branch: int,
    joint: int,
    s_a: float,
    q_a: Six,
    s_b: float,
    q_b: Six,
) -> MotionError:
    """Return the refusal for a joint that leaves its range between two grid points."""
    s_inside, s_outside = s_a, s_b
    while s_outside - s_inside > BORDER_RESOLUTION:
        middle = 0.5 * (s_inside + s_outside)
        q = solve_branch(arm, path.flange(middle), branch, q_a[5])
        if q is None or joint_outside(limits, _unwrapped(q, q_a)) is not None:
            s_outside = middle
        else:
            s_inside = middle
    return joint_range_error(
        limits,
        joint,
        q_b[joint],
        path.place(s_b),
        more=f", which it would leave {path.place(s_outside)}",
        hint=_RANGE_HINT,
    )


def _first_out_of_reach(arm: Arm, path: CartesianPath, branch: int, s_inside: float, s_outside: float) -> MotionError:
    """Return the refusal for a path that leaves the reach of the branch between two points."""
    s_deeper = s_outside
    while s_outside - s_inside > BORDER_RESOLUTION:
        middle = 0.5 * (s_inside + s_outside)
        if solve_branch(arm, path.flange(middle), branch) is None:
            s_outside = middle
        else:
            s_inside = middle
    reason = reason_unreachable(arm, path.flange(s_deeper))
    if reason:
        # At the border itself next to nothing is missing; a little further the numbers say more.
        return _out_of_reach(path, s_outside, f"at {s_deeper:.4f} {path.unit} it is {reason}")
    return _out_of_reach(
        path,
        s_outside,
        "the arm would have to change between its configurations (shoulder, elbow or wrist turned over)",
        "use movej to change the configuration first",
    )


def _out_of_reach(
    path: CartesianPath, s: float, reason: str, hint: str = "keep the whole path inside the workspace"
) -> MotionError:
    return MotionError(f"out of reach {path.place(s)}: {reason}", code="R111", value=s, unit=path.unit, hint=hint)
