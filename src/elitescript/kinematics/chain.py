"""Measured chain of a calibrated arm: forward kinematics, joint axes, Newton steps.

A real arm reports link parameters that differ a little from the nominal ones. Its joint axes
are then no longer exactly parallel and the closed-form inverse does not hold; here the chain
is evaluated link by link, and a nominal solution is refined until it meets the target.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, isfinite, sin, sqrt
from typing import Final

from elitescript.errors import UsageError
from elitescript.kinematics.limits import REACH_TOLERANCE_M, JointVector, SixFloats, wrap_to_pi
from elitescript.kinematics.rotations import Vector3, multiply, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import IDENTITY, Transform, rotation_of
from elitescript.records import field, record

MAX_ITERATIONS: Final = 40
"""Offsets of real arms need four steps; the rest is for poses close to a singularity."""

CONVERGED: Final = 1e-13
"""Residual (m and rad together) at which a refinement ends: what rounding leaves of a forward
kinematics of two metres, with a margin of a hundred."""


@record
class CalibratedChain:
    """Modified Denavit-Hartenberg parameters of six joints, as the controller reports them.

    Link i is `T_i = Rx(alpha_i) Tx(a_i) Rz(q_i) Tz(d_i)` (Craig's form).

    Args:
        a: six lengths, m.
        d: six offsets along the joint, m.
        alpha: six twists, rad.

    Raises:
        UsageError: an array that does not hold six finite numbers.
    """

    a: SixFloats
    d: SixFloats
    alpha: SixFloats
    links: tuple[tuple[float, float, float, float], ...] = field(init=False, repr=False, compare=False)
    """(a, d, cos alpha, sin alpha) of each link."""

    def __post_init__(self) -> None:
        for name, values in (("a", self.a), ("d", self.d), ("alpha", self.alpha)):
            object.__setattr__(self, name, six_floats(name, values))
        links = tuple((a, d, cos(alpha), sin(alpha)) for a, d, alpha in zip(self.a, self.d, self.alpha, strict=True))
        object.__setattr__(self, "links", links)

    def forward(self, q: Sequence[float]) -> Transform:
        """Return `T_base_flange` for joint angles in rad."""
        return self.axes(q)[1]

    def elbow(self, q: Sequence[float]) -> Vector3:
        """Return the position of the elbow joint (joint 3) in the base frame, m."""
        return self.axes(q)[0][2][0]

    def axes(self, q: Sequence[float]) -> tuple[tuple[tuple[Vector3, Vector3], ...], Transform]:
        """Return (a point on the joint, its direction) for each joint in the base frame, and `T_base_flange`."""
        axes = []
        r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z = IDENTITY
        for angle, (a, d, ca, sa) in zip(q, self.links, strict=True):
            c = cos(angle)
            s = sin(angle)
            ty = -sa * d
            tz = ca * d
            x += r11 * a + r12 * ty + r13 * tz
            y += r21 * a + r22 * ty + r23 * tz
            z += r31 * a + r32 * ty + r33 * tz
            # The twist mixes the second and third columns; the joint then turns about the new third.
            y1 = r12 * ca + r13 * sa
            y2 = r22 * ca + r23 * sa
            y3 = r32 * ca + r33 * sa
            r13 = r13 * ca - r12 * sa
            r23 = r23 * ca - r22 * sa
            r33 = r33 * ca - r32 * sa
            r11, r12 = r11 * c + y1 * s, y1 * c - r11 * s
            r21, r22 = r21 * c + y2 * s, y2 * c - r21 * s
            r31, r32 = r31 * c + y3 * s, y3 * c - r31 * s
            axes.append(((x, y, z), (r13, r23, r33)))
        return tuple(axes), (r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z)


def refine(chain: CalibratedChain, T_base_flange: Transform, q_start: Sequence[float]) -> JointVector | None:
    """Return the joint angles near `q_start` that reach the target, in (-pi, pi], or None.

    Newton's method with the exact Jacobian, damped by the square of the residual (Yamashita and
    Fukushima, 2001): far from singularities it converges quadratically, four steps for the
    offsets of real arms; close to one a step stays below half a radian.
    """
    q = list(q_start)
    for _ in range(MAX_ITERATIONS):
        axes, T = chain.axes(q)
        error = _pose_error(T, T_base_flange)
        residual_square = sum(e * e for e in error)
        if residual_square <= CONVERGED * CONVERGED:
            break
        step = _damped_step(jacobian_columns(axes, (T[9], T[10], T[11])), error, residual_square)
        q = [angle + change for angle, change in zip(q, step, strict=True)]
    else:
        error = _pose_error(chain.forward(q), T_base_flange)
        if not sum(e * e for e in error) <= REACH_TOLERANCE_M * REACH_TOLERANCE_M:
            return None
    q1, q2, q3, q4, q5, q6 = q
    return wrap_to_pi(q1), wrap_to_pi(q2), wrap_to_pi(q3), wrap_to_pi(q4), wrap_to_pi(q5), wrap_to_pi(q6)


def jacobian_columns(axes: Sequence[tuple[Vector3, Vector3]], p: Vector3) -> list[SixFloats]:
    """Return the columns of the Jacobian of point p, from a point on each joint and the joint's direction."""
    px, py, pz = p
    columns = []
    for (ox, oy, oz), (zx, zy, zz) in axes:
        dx, dy, dz = px - ox, py - oy, pz - oz
        columns.append((zy * dz - zz * dy, zz * dx - zx * dz, zx * dy - zy * dx, zx, zy, zz))
    return columns


def solve_linear(rows: Sequence[Sequence[float]], right: Sequence[float]) -> tuple[float, ...] | None:
    """Solve six equations by elimination with row exchange; None when the matrix is singular."""
    size = len(right)
    work = [[*row, value] for row, value in zip(rows, right, strict=True)]
    for column in range(size):
        pivot = max(range(column, size), key=lambda row: abs(work[row][column]))
        if not abs(work[pivot][column]) > _SINGULAR_PIVOT:
            return None
        work[column], work[pivot] = work[pivot], work[column]
        top = work[column]
        for lower in work[column + 1 :]:
            factor = lower[column] / top[column]
            for k in range(column, size + 1):
                lower[k] -= factor * top[k]
    solution = [0.0] * size
    for row in range(size - 1, -1, -1):
        known = sum(work[row][k] * solution[k] for k in range(row + 1, size))
        solution[row] = (work[row][size] - known) / work[row][row]
    return tuple(solution)


def six_floats(name: str, values: Sequence[float]) -> SixFloats:
    """Return the values as a tuple of six floats.

    Raises:
        UsageError: not six of them, or one that is not finite.
    """
    if len(values) != 6:
        raise UsageError(f"{name} needs six numbers, one for each joint; it has {len(values)}")
    a, b, c, d, e, f = (float(value) for value in values)
    for index, value in enumerate((a, b, c, d, e, f)):
        if not isfinite(value):
            raise UsageError(f"{name}[{index}] is {value}; it has to be a finite number")
    return a, b, c, d, e, f


def _pose_error(T: Transform, T_target: Transform) -> SixFloats:
    """Return the position and the rotation vector from T to the target, in the base frame."""
    rotation = rotvec_from_rotation(multiply(rotation_of(T_target), transpose(rotation_of(T))))
    return (T_target[9] - T[9], T_target[10] - T[10], T_target[11] - T[11], *rotation)


def _damped_step(columns: Sequence[Sequence[float]], error: Sequence[float], damping: float) -> list[float]:
    """Solve (J^T J + damping E) step = J^T error by Cholesky's method; `columns` are those of J."""
    size = len(columns)
    lower = [[0.0] * size for _ in range(size)]
    forward = [0.0] * size
    for i in range(size):
        ci = columns[i]
        row = lower[i]
        for j in range(i):
            known = sum(row[k] * lower[j][k] for k in range(j))
            row[j] = (sum(x * y for x, y in zip(ci, columns[j], strict=True)) - known) / lower[j][j]
        square = sum(x * x for x in ci) + damping - sum(x * x for x in row[:i])
        row[i] = sqrt(max(square, _SMALLEST_SQUARE))
        known = sum(row[k] * forward[k] for k in range(i))
        forward[i] = (sum(x * y for x, y in zip(ci, error, strict=True)) - known) / row[i]
    step = [0.0] * size
    for i in range(size - 1, -1, -1):
        known = sum(lower[k][i] * step[k] for k in range(i + 1, size))
        step[i] = (forward[i] - known) / lower[i][i]
    return step


_SINGULAR_PIVOT: Final = 1e-12
"""A pivot this small (m or rad per rad) is rounding: the joints cannot produce the motion."""

_SMALLEST_SQUARE: Final = 1e-18
"""Keeps the Cholesky pivot positive where rounding would make it zero or negative."""
