"""Inverse kinematics: closed form, all branches, the nearest solution, and the reason if there is none.

The method is the usual one for arms with three parallel joints: the wrist centre gives q1, the
flange axes along n give q5 and q6, what remains is a triangle of upper arm and forearm. Symbols
are those of `arm`. A branch is `4 * shoulder + 2 * wrist + elbow` with

- shoulder 0: the wrist centre lies on the +r side (X > 0), 1: on the -r side;
- wrist 0: sin q5 >= 0, 1: sin q5 < 0;
- elbow 0: sin q3 >= 0, 1: sin q3 < 0.

Solutions are listed in rising branch number, which is the order in which the controller prints
them (script manual 2.14, example of `get_all_inverse_kin`).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, inf, isfinite, pi, sin, sqrt
from typing import Final

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.limits import (
    REACH_TOLERANCE_M,
    TURN,
    WRIST_SINGULAR_SINE,
    JointVector,
    nearest_turn,
    wrap_to_pi,
)
from elitescript.kinematics.transforms import Transform
from elitescript.records import NamedTuple, replace
from elitescript.said import said

BRANCHES: Final = 8


class Solution(NamedTuple):
    """One solution of the inverse kinematics."""

    branch: int
    """4 * shoulder + 2 * wrist + elbow."""
    q: JointVector
    """Joint angles, rad; in (-pi, pi] unless a full turn was added by `nearest`."""


def solutions(arm: Arm, T_base_flange: Transform, q6_near: float = 0.0) -> tuple[Solution, ...]:
    """Return all solutions in rising branch number, angles in (-pi, pi]; () when there is none.

    A pose outside the workspace by at most `REACH_TOLERANCE_M` is solved at the border. Where
    the wrist is singular, q6 is `q6_near` and the two wrist branches are listed once, as wrist
    0; where elbow or shoulder are singular the equal solutions of both branches are listed.
    A target with a component that is not a number has no solution.
    """
    if arm.calibration is None:
        found = _closed_form(arm, T_base_flange, q6_near, _BOTH, _BOTH, _BOTH, REACH_TOLERANCE_M, 0.0)
        return tuple([Solution(branch, q) for branch, q in found])
    from elitescript.kinematics.chain import refine

    refined: list[Solution] = []
    for branch, q_start in _closed_form(arm, T_base_flange, q6_near, _BOTH, _BOTH, _BOTH, START_SLACK_M, START_INSET):
        q = refine(arm.calibration, T_base_flange, q_start)
        if q is not None and not any(_same_joints(q, other.q) for other in refined):
            refined.append(Solution(branch, q))
    return tuple(refined)


def solve_branch(arm: Arm, T_base_flange: Transform, branch: int, q6_near: float = 0.0) -> JointVector | None:
    """Return the solution of one branch, angles in (-pi, pi], or None when the branch has none.

    For motions along a path, which keep the branch they start in. Where the wrist is singular
    both wrist branches give the same solution, with q6 = `q6_near`.
    """
    shoulder, wrist, elbow = _PICKS[branch]
    if arm.calibration is None:
        found = _closed_form(arm, T_base_flange, q6_near, shoulder, wrist, elbow, REACH_TOLERANCE_M, 0.0)
        return found[0][1] if found else None
    from elitescript.kinematics.chain import refine

    found = _closed_form(arm, T_base_flange, q6_near, shoulder, wrist, elbow, START_SLACK_M, START_INSET)
    return refine(arm.calibration, T_base_flange, found[0][1]) if found else None


def nearest(
    candidates: Sequence[Solution], q_near: Sequence[float], joint_ranges: Sequence[tuple[float, float]]
) -> Solution | None:
    """Return the solution nearest to `q_near`, each joint turned by full turns inside its range.

    The measure is the sum of the squared joint differences, on a tie the first candidate wins
    (assumed: the manual only says closest). A candidate with a joint that has no turn inside its
    range is dropped. The returned q carries the added turns. None when nothing is left.
    """
    best: Solution | None = None
    best_cost = inf
    for candidate in candidates:
        cost = 0.0
        q: list[float] = []
        for angle, near, (low, high) in zip(candidate.q, q_near, joint_ranges, strict=True):
            difference = angle - near
            if -pi < difference < pi and low <= angle <= high:
                q.append(angle)
            else:
                turned = nearest_turn(angle, near, low, high)
                if turned is None:
                    break
                difference = turned - near
                q.append(turned)
            cost += difference * difference
            if cost >= best_cost:
                break
        else:
            best_cost = cost
            q1, q2, q3, q4, q5, q6 = q
            best = Solution(candidate.branch, (q1, q2, q3, q4, q5, q6))
    return best


def branch_of(arm: Arm, q: Sequence[float]) -> int:
    """Return the branch that joint angles belong to, by the nominal lengths."""
    _, q2, q3, q4, q5, _ = q
    q23 = q2 + q3
    X = arm.a2 * cos(q2) + arm.a3 * cos(q23) + arm.d5 * sin(q23 + q4)
    return (4 if X < 0.0 else 0) + (2 if sin(q5) < 0.0 else 0) + (1 if sin(q3) < 0.0 else 0)


def reason_unreachable(arm: Arm, T_base_flange: Transform) -> str:
    """Return why the pose has no solution, with numbers and units; empty if it has one.

    The numbers are those of the nominal lengths and of the branch that comes nearest.
    """
    if not all(map(isfinite, T_base_flange)):
        return "the pose holds a number that is not finite"
    if solutions(arm, T_base_flange):
        return ""
    wx = T_base_flange[9] - arm.d6 * T_base_flange[2]
    wy = T_base_flange[10] - arm.d6 * T_base_flange[5]
    rho = sqrt(wx * wx + wy * wy)
    if rho < arm.d4 - REACH_TOLERANCE_M:
        return said(
            "too near the base axis by {miss} (the wrist centre would be {rho} from it; {least} is the least)",
            miss=_metres(arm.d4 - rho),
            rho=_metres(rho),
            least=_metres(arm.d4),
        )
    # Orientation and q1 are exact in these candidates, so what they miss is the length of the triangle.
    miss, q3 = inf, 0.0
    nominal = replace(arm, calibration=None)
    for _, q in _closed_form(arm, T_base_flange, 0.0, _BOTH, _BOTH, _BOTH, inf, 0.0):
        x, y, z = nominal.forward(q)[9:]
        dx, dy, dz = T_base_flange[9] - x, T_base_flange[10] - y, T_base_flange[11] - z
        distance = sqrt(dx * dx + dy * dy + dz * dz)
        if distance < miss:
            miss, q3 = distance, q[2]
    if miss <= REACH_TOLERANCE_M or miss == inf:
        return "at the border of the workspace, where the calibrated arm does not reach"
    if cos(q3) > 0.0:
        reach = -(arm.a2 + arm.a3)
        return said(
            "too far by {miss} (wrist joint 1 would be {reach} from the shoulder joint; the arm reaches {most})",
            miss=_metres(miss),
            reach=_metres(reach + miss),
            most=_metres(reach),
        )
    least = abs(arm.a2 - arm.a3)
    return said(
        "folded too far by {miss} (wrist joint 1 would be {reach} from the shoulder joint; {least} is the least)",
        miss=_metres(miss),
        reach=_metres(least - miss),
        least=_metres(least),
    )


START_SLACK_M: Final = 0.03
"""How far outside the nominal workspace a refinement may start, m. Calibration moves the border by
millimetres; the start value of q1, kept off the shoulder singularity, shifts joint 4 by centimetres."""

START_INSET: Final = 2e-3
"""Start values of a refinement keep this distance (m, rad) from the nominal singularities, where
the Jacobian gives no direction."""

_BOTH: Final = (1.0, -1.0)

_PICKS: Final = tuple(
    ((1.0 - 2.0 * shoulder,), (1.0 - 2.0 * wrist,), (1.0 - 2.0 * elbow,))
    for shoulder in (0, 1)
    for wrist in (0, 1)
    for elbow in (0, 1)
)

_SAME_SOLUTION_RAD: Final = 1e-7
"""Refined solutions this close are one solution reached from two starts."""


def _closed_form(
    arm: Arm,
    T_base_flange: Transform,
    q6_near: float,
    shoulders: tuple[float, ...],
    wrists: tuple[float, ...],
    elbows: tuple[float, ...],
    slack: float,
    inset: float,
) -> list[tuple[int, JointVector]]:
    """Return (branch, q) by the nominal closed form for the chosen signs.

    `slack` (m) is how far outside the workspace a target may lie to be solved at the border.
    `inset` (m, rad) moves the border inwards, for start values of a refinement; 0 is exact.
    """
    found: list[tuple[int, JointVector]] = []
    r11, r12, r13, r21, r22, r23, r31, r32, r33, px, py, pz = T_base_flange
    a2 = arm.a2
    a3 = arm.a3
    d4 = arm.d4
    d5 = arm.d5
    d6 = arm.d6
    longest = -a2 - a3
    shortest = abs(a2 - a3)
    wx = px - d6 * r13
    wy = py - d6 * r23
    wz = pz - d6 * r33 - arm.d1
    rho = sqrt(wx * wx + wy * wy)
    # Written so that a target that is not a number fails the test.
    if not rho >= d4 - slack or rho == 0.0:
        return found
    rho_inside = rho if rho >= d4 + inset else d4 + inset
    X = sqrt((rho_inside - d4) * (rho_inside + d4))
    scale = 1.0 / (rho * rho_inside)

    for shoulder in shoulders:
        c1 = (shoulder * wx * X - wy * d4) * scale
        s1 = (shoulder * wy * X + wx * d4) * scale
        q1 = atan2(s1, c1)
        if q1 <= -pi:
            q1 = pi

        # Components of the flange axes along n.
        xn = r11 * s1 - r21 * c1
        yn = r12 * s1 - r22 * c1
        zn = r13 * s1 - r23 * c1
        h = sqrt(xn * xn + yn * yn)
        wrists_here = wrists
        if h >= WRIST_SINGULAR_SINE:
            q5_plus = atan2(h, zn)
            q6_plus = atan2(-yn, xn)
            c6 = xn / h
            s6 = -yn / h
            c5 = zn
            s5 = h
        else:
            # The wrist - formulas below turn q6 by half a turn; anticipate it where they are used alone.
            q6_plus = wrap_to_pi(q6_near if wrists[0] > 0.0 else q6_near + pi)
            c6 = cos(q6_plus)
            s6 = sin(q6_plus)
            s5 = 0.0
            if zn > 0.0:
                q5_plus = 0.0
                c5 = 1.0
            else:
                q5_plus = pi
                c5 = -1.0
            if not inset:
                wrists_here = wrists[:1]
        if inset:
            q5_plus = min(max(q5_plus, inset), pi - inset)

        # Direction of frame 4 in the vertical plane of the arm.
        c5_c6 = c5 * c6
        c5_s6 = c5 * s6
        c234_plus = (r11 * c1 + r21 * s1) * c5_c6 - (r12 * c1 + r22 * s1) * c5_s6 - (r13 * c1 + r23 * s1) * s5
        s234_plus = r31 * c5_c6 - r32 * c5_s6 - r33 * s5
        length = sqrt(c234_plus * c234_plus + s234_plus * s234_plus)
        q234_plus = atan2(s234_plus, c234_plus)

        for wrist in wrists_here:
            # Joint 4 seen from the shoulder: (X4, Y4) along r and z.
            offset = wrist * d5 / length
            X4 = shoulder * X - offset * s234_plus
            Y4 = wz + offset * c234_plus
            r = sqrt(X4 * X4 + Y4 * Y4)
            if not shortest - slack <= r <= longest + slack:
                continue
            if r > longest - inset:
                r = longest - inset
            elif r < shortest + inset:
                r = shortest + inset
            # tan(q3 / 2) = far / near; exact also where acos would lose half the digits.
            far = sqrt((longest - r) * (longest + r))
            near = sqrt((r - shortest) * (r + shortest))
            q3_plus = 2.0 * atan2(far, near)
            # |a2 a3| sin q3 = far * near / 2 and 4 |a2 a3| cos q3 = near^2 - far^2.
            # Angle of joint 4 at the shoulder, seen from the upper arm.
            beta = atan2(0.5 * far * near / a2, a2 + 0.25 * (near * near - far * far) / a2)
            gamma = atan2(Y4, X4)
            if wrist > 0.0:
                q5 = q5_plus
                q6 = q6_plus
                q234 = q234_plus
            else:
                q5 = -q5_plus
                q6 = q6_plus + pi
                q234 = q234_plus + pi
                if q5 <= -pi:
                    q5 = pi
            while q6 > pi:
                q6 -= TURN
            while q6 <= -pi:
                q6 += TURN
            branch = (0 if shoulder > 0.0 else 4) + (0 if wrist > 0.0 else 2)
            for elbow in elbows:
                q3 = elbow * q3_plus
                if q3 <= -pi:
                    q3 = pi
                q2 = gamma - elbow * beta
                if q2 > pi:
                    q2 -= TURN
                elif q2 <= -pi:
                    q2 += TURN
                q4 = q234 - q2 - q3
                while q4 > pi:
                    q4 -= TURN
                while q4 <= -pi:
                    q4 += TURN
                found.append((branch if elbow > 0.0 else branch + 1, (q1, q2, q3, q4, q5, q6)))
    return found


def _same_joints(q: JointVector, q_other: JointVector) -> bool:
    return all(abs(wrap_to_pi(a - b)) < _SAME_SOLUTION_RAD for a, b in zip(q, q_other, strict=True))


def _metres(length: float) -> str:
    return f"{length:.4f} m"
