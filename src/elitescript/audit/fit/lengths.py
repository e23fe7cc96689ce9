"""Lengths of an arm from points that are known as joints and as pose.

The position of the flange is linear in the six lengths for given joints, so each point gives three linear equations
(`kinematics.arm`). Both sides are rounded: the equations of a point are weighted with the covariance that follows.
No prior knowledge of the lengths enters; what the points do not determine is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, inf, sin, sqrt
from typing import Any, Final

from elitescript.audit.fit.least_squares import (
    NORMAL_95,
    Direction,
    Solution,
    chi_square_quantile,
    solve,
    student_quantile,
)
from elitescript.audit.fit.pairs import NO_TCP, Point, Points
from elitescript.audit.fit.parameters import DETERMINED, RELEVANT, Parameter, determined, not_determined
from elitescript.errors import UsageError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import jacobian
from elitescript.kinematics.rotations import multiply, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import rotation_of, transform_from_pose
from elitescript.messages.motion import Six
from elitescript.motion.limits import JOINT_NAMES
from elitescript.records import NamedTuple, record, replace

LENGTHS: Final = ("d1", "a2", "a3", "d4", "d5", "d6")
ZEROS: Final = tuple(f"zero.{name}" for name in JOINT_NAMES)

UNDETERMINED_SIGMA: Final = 1e-3
"""Standard deviation, m or rad, above which a direction counts as not determined."""

ORIENTATION_TOLERANCE_RAD: Final = 2e-3
"""Angle between the orientation of a pose and that of its joints above which they are not of one point. Orientation
does not depend on lengths, so this needs no fit; with `zeros` the tolerance is `ZERO_TOLERANCE_RAD`."""
ZERO_TOLERANCE_RAD: Final = 0.05
POSITION_TOLERANCE_M: Final = 0.05
"""Distance of a pose from that of the model above which joints and pose are not of one point."""

GAUSS_NEWTON_STEPS: Final = 8
NOTABLE_SHARE: Final = 0.05
"""Share of a parameter in a direction below which the words leave it out."""
FLOOR: Final = 1e-12
"""Half width, m or rad, below which no interval goes: rounding of the arithmetic."""
DISCORDANT: Final = 100.0
"""Factor by which the mean square of the residuals has to fall for a point to be left out."""


class Combination(NamedTuple):
    """A combination of parameters that is determined where each by itself is not."""

    text: str
    kind: str
    """`difference` or `sum`."""
    model: float
    found: float
    interval: tuple[float, float]


@record
class LengthFit:
    """Lengths of an arm, found from points.

    Attributes:
        parameters: the six lengths, with `zeros` the joint zeros as well.
        combinations: what is known of parameters that are not determined by themselves.
        words: what the table does not say, one sentence each.
        used: number of points that agree.
        left_out: points that are none, with the reason.
        rms_before: distance of the model's positions from the poses, m.
        rms_after: the same with the found lengths.
        differs: whether the points contradict the model, also where no parameter by itself is determined.
    """

    parameters: tuple[Parameter, ...]
    combinations: tuple[Combination, ...]
    words: tuple[str, ...]
    used: int
    left_out: tuple[str, ...]
    rms_before: float
    rms_after: float
    differs: bool

    def json(self) -> dict[str, Any]:
        """Return the fit as JSON has it."""
        return {
            "parameters": {parameter.name: parameter.json() for parameter in self.parameters},
            "combinations": [
                {"combination": row.text, "model": row.model, "found": row.found, "interval": list(row.interval)}
                for row in self.combinations
            ],
            "agrees": not self.differs,
            "points": self.used,
            "left_out": list(self.left_out),
            "rms_before_m": self.rms_before,
            "rms_after_m": self.rms_after,
            "words": list(self.words),
        }


def fit_lengths(points: Points, arm: Arm, *, zeros: bool = False, is_noise_known: bool = True) -> LengthFit:
    """Return the lengths that points with joints and pose determine.

    Args:
        points: at least one; how they are rounded is their noise.
        arm: the model that they are compared with.
        zeros: find an offset of each joint's zero as well, from the orientations too.
        is_noise_known: whether rounding is all the noise there is; if not it is estimated from the residuals.

    Raises:
        UsageError: no point is left, or the arm is a calibrated chain, which has no six lengths.
    """
    if arm.calibration is not None:
        raise UsageError("the arm has a measured chain ([calibration]), so it has no six lengths; fit from its base")
    agreeing, left_out = _agreeing(points, arm, ZERO_TOLERANCE_RAD if zeros else ORIENTATION_TOLERANCE_RAD)
    if not agreeing:
        reasons = f": {left_out[0]}" if left_out else ""
        raise UsageError(f"no point is known both as joints and as pose{reasons}")
    fitted = _Fit(points, arm, zeros)
    solution, kept = fitted.of(agreeing)
    while len(kept) > 3:
        bad = _discordant(fitted, kept, solution)
        if bad is None:
            break
        index, solution = bad
        left_out.append(f"{kept[index].name}: its pose is not that of its joints, while the other points agree")
        kept = [point for number, point in enumerate(kept) if number != index]
    return _statement(fitted, solution, kept, points, left_out, is_noise_known)


def _agreeing(points: Points, arm: Arm, tolerance: float) -> tuple[list[Point], list[str]]:
    """Return the points whose pose can be that of the joints, and why the others cannot."""
    best: dict[Six, tuple[float, Point]] = {}
    left_out = []
    for point in points.points:
        if point.tcp is None:
            left_out.append(f"{point.name}: the TCP offset of its pose is not known")
            continue
        T = arm.forward_tcp(point.q, transform_from_pose(point.tcp))
        angle = _norm(_turn(point, arm))
        distance = _norm([a - b for a, b in zip(point.pose, T[9:], strict=False)])
        if angle > tolerance:
            left_out.append(
                f"{point.name}: the pose is turned {angle:.3g} rad against the joints, so these are a hint (`qnear`) "
                f"or the TCP is another one"
            )
        elif distance > POSITION_TOLERANCE_M:
            left_out.append(
                f"{point.name}: the pose is {1e3 * distance:.0f} mm away from the joints, so these are a hint "
                f"(`qnear`) or the TCP is another one"
            )
        elif point.q in best and best[point.q][0] <= distance:
            left_out.append(_same_joints(point))
        else:
            if point.q in best:
                left_out.append(_same_joints(best[point.q][1]))
            best[point.q] = (distance, point)
    return [point for _, point in best.values()], left_out


def _same_joints(point: Point) -> str:
    return f"{point.name}: another pose with the same joints is nearer to them, so here they are a hint (`qnear`)"


def _turn(point: Point, arm: Arm) -> tuple[float, float, float]:
    """Return the rotation vector, base frame, from the orientation of the joints to that of the pose."""
    R_joints = rotation_of(arm.forward_tcp(point.q, transform_from_pose(point.tcp or NO_TCP)))
    return rotvec_from_rotation(multiply(rotation_of(transform_from_pose(point.pose)), transpose(R_joints)))


def _norm(values: Sequence[float]) -> float:
    return sqrt(sum(value * value for value in values))


class _Fit:
    """Makes and solves the equations.

    Args:
        points: for their rounding.
        arm: where the fit begins.
        zeros: with joint zeros.
    """

    __slots__ = ("arm", "names", "u_angle", "u_position", "u_q", "zeros")

    def __init__(self, points: Points, arm: Arm, zeros: bool) -> None:
        self.arm = arm
        self.zeros = zeros
        self.names = LENGTHS + ZEROS if zeros else LENGTHS
        self.u_q, self.u_position, self.u_angle = (
            step / sqrt(12.0) for step in (points.q_step, points.position_step, points.angle_step)
        )

    def of(self, points: Sequence[Point]) -> tuple[Solution, list[Point]]:
        """Return the solution, whose values are the differences to the model, and the points."""
        values = [0.0] * len(self.names)
        # Linear in the lengths; joint zeros need Gauss-Newton, which converges quadratically.
        steps = GAUSS_NEWTON_STEPS if self.zeros else 1
        while True:
            rows: list[list[float]] = []
            rest: list[float] = []
            arm, shift = self._shifted(values)
            for point in points:
                self.equations(point, arm, shift, rows, rest)
            solution = solve(rows, rest)
            values = [a + b for a, b in zip(values, solution.values, strict=True)]
            steps -= 1
            if steps == 0 or max(map(abs, solution.values)) < 1e-13:
                return replace(solution, values=tuple(values)), list(points)

    def _shifted(self, values: Sequence[float]) -> tuple[Arm, Sequence[float]]:
        lengths = {name: getattr(self.arm, name) + change for name, change in zip(LENGTHS, values, strict=False)}
        return replace(self.arm, **lengths), values[6:] or NO_TCP

    def distance(self, point: Point, values: Sequence[float]) -> float:
        """Return the distance of a point's pose from that of an arm with these differences, m."""
        arm, shift = self._shifted(values)
        q = [a + b for a, b in zip(point.q, shift, strict=True)]
        T = arm.forward_tcp(q, transform_from_pose(point.tcp or NO_TCP))
        return _norm([a - b for a, b in zip(point.pose, T[9:], strict=False)])

    def equations(
        self, point: Point, arm: Arm, shift: Sequence[float], rows: list[list[float]], rest: list[float]
    ) -> None:
        """Add the weighted equations of one point for an arm and offsets of its joints."""
        q = [a + b for a, b in zip(point.q, shift, strict=True)]
        T_flange_tcp = transform_from_pose(point.tcp or NO_TCP)
        T = arm.forward_tcp(q, T_flange_tcp)
        J = jacobian(arm, q, T_flange_tcp)
        coefficients = _length_rows(q)
        differences = [a - b for a, b in zip(point.pose, T[9:], strict=False)]
        u = [self.u_position] * 3
        if self.zeros:
            coefficients = [[*row, *J[i]] for i, row in enumerate(coefficients)]
            coefficients.extend([[0.0] * 6 + list(J[i]) for i in (3, 4, 5)])
            R = rotation_of(T)
            differences.extend(
                rotvec_from_rotation(multiply(rotation_of(transform_from_pose(point.pose)), transpose(R)))
            )
            u += [self.u_angle] * 3
        count = len(u)
        covariance = [
            [
                sum(J[i][k] * J[j][k] for k in range(6)) * self.u_q * self.u_q + (u[i] * u[i] if i == j else 0.0)
                for j in range(count)
            ]
            for i in range(count)
        ]
        _whiten(covariance, coefficients, differences)
        rows.extend(coefficients)
        rest.extend(differences)


def _length_rows(q: Sequence[float]) -> list[list[float]]:
    """Return the derivatives of the flange position, base frame, with respect to the lengths: three rows of six."""
    q1, q2, q3, q4, q5, _ = q
    q23 = q2 + q3
    q234 = q23 + q4
    s5 = sin(q5)
    # (r, z, n) components: d1, a2, a3, d4, d5, d6.
    r = (0.0, cos(q2), cos(q23), 0.0, sin(q234), -cos(q234) * s5)
    z = (1.0, sin(q2), sin(q23), 0.0, -cos(q234), -sin(q234) * s5)
    n = (0.0, 0.0, 0.0, 1.0, 0.0, cos(q5))
    c1, s1 = cos(q1), sin(q1)
    return [
        [c1 * u + s1 * w for u, w in zip(r, n, strict=True)],
        [s1 * u - c1 * w for u, w in zip(r, n, strict=True)],
        list(z),
    ]


def _whiten(covariance: list[list[float]], rows: list[list[float]], values: list[float]) -> None:
    """Divide equations by the Cholesky factor of the covariance of their values, in place."""
    count = len(values)
    L = [[0.0] * count for _ in range(count)]
    for i in range(count):
        for j in range(i + 1):
            rest = covariance[i][j] - sum(L[i][k] * L[j][k] for k in range(j))
            L[i][j] = sqrt(max(rest, 1e-34)) if i == j else rest / L[j][j]
    for i in range(count):
        for k in range(i):
            rows[i] = [a - L[i][k] * b for a, b in zip(rows[i], rows[k], strict=True)]
            values[i] -= L[i][k] * values[k]
        rows[i] = [a / L[i][i] for a in rows[i]]
        values[i] /= L[i][i]


def _discordant(fitted: _Fit, points: list[Point], solution: Solution) -> tuple[int, Solution] | None:
    """Return the point without which the others agree far better, and the solution without it."""
    if solution.freedom == 0 or solution.chi_square <= DISCORDANT * solution.freedom:
        return None
    if max(fitted.distance(point, solution.values) for point in points) <= RELEVANT:
        return None
    best: tuple[float, int, Solution] | None = None
    for index in range(len(points)):
        without, _ = fitted.of([point for number, point in enumerate(points) if number != index])
        mean = without.chi_square / max(without.freedom, 1)
        if without.freedom > 0 and (best is None or mean < best[0]):
            best = (mean, index, without)
    if best is None or best[0] * DISCORDANT > solution.chi_square / solution.freedom:
        return None
    return best[1], best[2]


# ---------------------------------------------------------------- the statement


def _statement(
    fitted: _Fit, solution: Solution, kept: list[Point], points: Points, left_out: list[str], is_noise_known: bool
) -> LengthFit:
    names = fitted.names
    factor, noise_words = _noise(solution, is_noise_known)
    model = [getattr(fitted.arm, name) for name in LENGTHS] + [0.0] * (len(names) - 6)
    vague = [row for row in solution.directions if row.sigma * factor / NORMAL_95 > UNDETERMINED_SIGMA]
    parameters = []
    for index, name in enumerate(names):
        unit = "m" if index < 6 else "rad"
        sigma = solution.sigma_of(index)
        if sigma * factor / NORMAL_95 > UNDETERMINED_SIGMA:
            parameters.append(not_determined(name, unit, model[index], _why(index, names, vague)))
        else:
            half = max(sigma * factor, FLOOR)
            parameters.append(
                determined(name, unit, model[index], model[index] + solution.values[index], half, f"{len(kept)} points")
            )
    combinations = _combinations(fitted, solution, parameters, model, factor)
    words = [points.tcp_words, noise_words, *_vague_words(vague, names, combinations)]
    d6 = next(parameter for parameter in parameters if parameter.name == "d6")
    if d6.state == DETERMINED and d6.differs:
        words.append(
            "in poses, d6 and a TCP offset along the z axis of the flange are the same: the difference is in either"
        )
    if fitted.zeros:
        words.append(
            "the zero of joint 1 and a turn of the base are the same in poses, so are the zero of joint 6 and a turn "
            "of the tool"
        )
    else:
        words.append("joint zeros are taken as exact (--zeros finds them too)")
    zeros = [0.0] * len(names)
    return LengthFit(
        parameters=tuple(parameters),
        combinations=combinations,
        words=tuple(words),
        used=len(kept),
        left_out=tuple(left_out),
        rms_before=_rms([fitted.distance(point, zeros) for point in kept]),
        rms_after=_rms([fitted.distance(point, solution.values) for point in kept]),
        differs=_contradicts(fitted, kept, factor),
    )


def _contradicts(fitted: _Fit, points: Sequence[Point], factor: float) -> bool:
    """Return whether the residuals of the model are more than the noise."""
    rows: list[list[float]] = []
    rest: list[float] = []
    for point in points:
        fitted.equations(point, fitted.arm, NO_TCP, rows, rest)
    square = sum(value * value for value in rest) * (NORMAL_95 / factor) ** 2
    zeros = [0.0] * len(fitted.names)
    far = max(fitted.distance(point, zeros) for point in points)
    return far > RELEVANT and square > chi_square_quantile(len(rest), 0.999)


def _noise(solution: Solution, is_known: bool) -> tuple[float, str]:
    """Return the half width of an interval in standard deviations of the weights, and the words for it."""
    if solution.freedom == 0:
        return (
            NORMAL_95,
            "there are no more equations than unknowns: the noise is taken to be the rounding of the digits",
        )
    mean = solution.chi_square / solution.freedom
    if is_known and solution.chi_square <= chi_square_quantile(solution.freedom, 0.99):
        return NORMAL_95, "the residuals are those of rounded digits"
    spread = sqrt(mean)
    half = spread * student_quantile(solution.freedom)
    if not is_known:
        return half, f"the noise is estimated from {solution.freedom} residuals"
    return half, f"the residuals are {spread:.3g} times what rounded digits leave, so the intervals are widened by that"


def _rms(values: Sequence[float]) -> float:
    return sqrt(sum(value * value for value in values) / len(values))


def _members(direction: Direction, names: Sequence[str]) -> list[str]:
    return [name for name, share in zip(names, direction.vector, strict=True) if abs(share) > NOTABLE_SHARE]


def _why(index: int, names: Sequence[str], vague: Sequence[Direction]) -> str:
    if len(vague) == 1:
        others = [name for name in _members(vague[0], names) if name != names[index]]
        return f"known only together with {' and '.join(others)}" if others else "the points say nothing of it"
    return "known only together with others"


def _vague_words(vague: Sequence[Direction], names: Sequence[str], combinations: Sequence[Combination]) -> list[str]:
    if not vague:
        return []
    together = " and ".join(name for name in names if any(name in _members(row, names) for row in vague))
    reach = "any amount" if any(row.sigma == inf for row in vague) else "more than 1 mm (standard deviation)"
    if len(vague) > 1:
        words = (
            f"{together}: {len(vague)} combinations of them are not determined; points in other attitudes would do it"
        )
    elif " and " in together:
        words = f"{together} together: one change of all of them, by {reach}, leaves the poses as they are"
    else:
        words = f"{together} is not determined: it may change by {reach}"
    known = [
        f"only their {row.kind} is determined: {row.text} = {row.found:.9g} m, 95 % in [{row.interval[0]:.9g}, "
        f"{row.interval[1]:.9g}], model {row.model:.9g}"
        for row in combinations
    ]
    return [words, *known]


def _combinations(
    fitted: _Fit, solution: Solution, parameters: Sequence[Parameter], model: Sequence[float], factor: float
) -> tuple[Combination, ...]:
    """Return sums and differences of two lengths that are determined although neither of the two is."""
    unknown = [index for index, row in enumerate(parameters[:6]) if row.found is None]
    found = []
    for position, i in enumerate(unknown):
        for j in unknown[position + 1 :]:
            for sign in (-1.0, 1.0):
                weights = [0.0] * len(fitted.names)
                weights[i], weights[j] = 1.0, sign
                half = solution.sigma(weights) * factor
                if half / NORMAL_95 > UNDETERMINED_SIGMA:
                    continue
                before = model[i] + sign * model[j]
                value = before + solution.values[i] + sign * solution.values[j]
                half = max(half, FLOOR)
                kind = "difference" if sign < 0.0 else "sum"
                text = f"{fitted.names[i]} {'-' if sign < 0.0 else '+'} {fitted.names[j]}"
                found.append(Combination(text, kind, before, value, (value - half, value + half)))
    return tuple(found)
