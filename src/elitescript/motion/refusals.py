"""Refusals of Cartesian paths, with place, number, limit and unit."""

from __future__ import annotations

from math import degrees, pi
from typing import Final

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import ELBOW_GIVE_UP_SINE, SHOULDER_GIVE_UP_M, WRIST_GIVE_UP_SINE, Singularity
from elitescript.messages.motion import Six
from elitescript.motion.limits import JOINT_NAMES, MotionLimits, joint_outside, joint_range_error, unwrapped
from elitescript.motion.paths.cartesian import FlangePath
from elitescript.said import said

JUMP_RAD: Final = 0.5 * pi
"""A joint step this large over the narrowest interval of a grid is a jump, not a motion."""

RANGE_HINT: Final = "start the move with that joint a full turn away, or use movej"

SINGULAR_HINT: Final = "use movej here, or lead the path past the singularity"

SURELY_MILLIMETRES: Final = 20.0
"""A path of this length, in m, is probably meant in millimetres."""

BORDER_RESOLUTION: Final = 1e-4
"""Accuracy of the first unreachable point of a path, m or rad."""


def singular(path: FlangePath, s: float, distance: Singularity) -> MotionError:
    """Return the refusal (R112) of a point too near a singularity."""
    blocked = distance.blocked
    if blocked == "wrist":
        what = said("the sine of joint wrist2 is {wrist:.6f}", wrist=distance.wrist)
        value, limit, unit = distance.wrist, WRIST_GIVE_UP_SINE, ""
    elif blocked == "shoulder":
        what = said(
            "the wrist centre is {shoulder:.6f} m from passing beside the base axis", shoulder=distance.shoulder
        )
        value, limit, unit = distance.shoulder, SHOULDER_GIVE_UP_M, "m"
    elif blocked == "elbow":
        what = said("the sine of joint elbow is {elbow:.6f}", elbow=distance.elbow)
        value, limit, unit = distance.elbow, ELBOW_GIVE_UP_SINE, ""
    else:
        # A calibrated arm is singular a little beside the place of nominal lengths.
        return MotionError(
            said("the move meets a singularity {place}", place=path.place(s)),
            code="R112",
            value=s,
            unit=path.unit,
            hint=SINGULAR_HINT,
        )
    return MotionError(
        said(
            "the move meets the {blocked} singularity {place}: {what}, at least {least} is needed to stay on the path",
            blocked=blocked,
            place=path.place(s),
            what=what,
            least=f"{limit:g} {unit}".rstrip(),
        ),
        code="R112",
        value=value,
        limit=f">= {limit:g}",
        unit=unit or None,
        hint=SINGULAR_HINT,
    )


def jump(path: FlangePath, s: float, q_a: Six, q_b: Six) -> MotionError:
    """Return the refusal (R112) of a joint that turns over between two neighbouring points."""
    steps = [b - a for a, b in zip(q_a, q_b, strict=True)]
    joint = max(range(6), key=lambda index: abs(steps[index]))
    return MotionError(
        said(
            "the move passes through a singularity {place}: joint {joint} would jump by {steps:.4f} "
            "rad ({steps_deg:.1f} deg)",
            place=path.place(s),
            joint=JOINT_NAMES[joint],
            steps=steps[joint],
            steps_deg=degrees(steps[joint]),
        ),
        code="R112",
        value=steps[joint],
        limit=f"< {JUMP_RAD:.4f}",
        unit="rad",
        hint=SINGULAR_HINT,
    )


def out_of_range(
    arm: Arm,
    limits: MotionLimits,
    path: FlangePath,
    branch: int,
    joint: int,
    s_a: float,
    q_a: Six,
    s_b: float,
    q_b: Six,
) -> MotionError:
    """Return the refusal (R110) of a joint that leaves its range between two grid points."""
    s_inside, s_outside = s_a, s_b
    while s_outside - s_inside > BORDER_RESOLUTION:
        middle = 0.5 * (s_inside + s_outside)
        q = solve_branch(arm, path.flange(middle), branch, q_a[5])
        if q is None or joint_outside(limits, unwrapped(q, q_a)) is not None:
            s_outside = middle
        else:
            s_inside = middle
    return joint_range_error(
        limits,
        joint,
        q_b[joint],
        path.place(s_b),
        more=said(", which it would leave {place}", place=path.place(s_outside)),
        hint=RANGE_HINT,
    )


def leaves_reach(arm: Arm, path: FlangePath, branch: int, s_inside: float, s_outside: float) -> MotionError:
    """Return the refusal (R111) of a path that leaves the reach of the branch between two points."""
    s_deeper = s_outside
    while s_outside - s_inside > BORDER_RESOLUTION:
        middle = 0.5 * (s_inside + s_outside)
        if solve_branch(arm, path.flange(middle), branch) is None:
            s_outside = middle
        else:
            s_inside = middle
    reason = reason_unreachable(arm, path.flange(s_deeper))
    if reason:
        # At the border itself the excess is almost zero; a little further the numbers are meaningful.
        return out_of_reach(
            path,
            s_outside,
            said("at {s_deeper:.4f} {unit} it is {reason}", s_deeper=s_deeper, unit=path.unit, reason=reason),
        )
    return out_of_reach(
        path,
        s_outside,
        "the arm would have to change between its configurations (shoulder, elbow or wrist turned over)",
        "use movej to change the configuration first",
    )


def out_of_reach(
    path: FlangePath, s: float, reason: str, hint: str = "keep the whole path inside the workspace"
) -> MotionError:
    """Return the refusal (R111) of one point."""
    if path.unit == "m" and path.length > SURELY_MILLIMETRES:
        hint = "positions are in m, not in mm"
    return MotionError(
        said("out of reach {place}: {reason}", place=path.place(s), reason=reason),
        code="R111",
        value=s,
        unit=path.unit,
        hint=hint,
    )
