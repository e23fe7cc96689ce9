"""Compares the arm with its safety limits and describes breaches, with numbers and hints."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, degrees, sqrt
from typing import Any, Final

from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import Transform
from elitescript.messages.enums import SafetyMode
from elitescript.messages.motion import Six
from elitescript.motion.limits import JOINT_NAMES
from elitescript.motion.streaming.speed import Obstacle
from elitescript.records import record
from elitescript.said import said

SPEED_TOLERANCE: Final = 0.02
"""A speed this much above its limit, as a share of it, is not a breach (*assumed*): a motion at the limit may go on."""

POSITION_TOLERANCE: Final = 1e-6
"""m or rad; a place on the border is inside."""

NO_PAIRS: Final = (False, False, False, False)


@record
class Breach:
    """A safety limit that the arm exceeds.

    Attributes:
        kind: `joint_range`, `joint_speed`, `tcp_speed`, `tcp_force`, `plane`, `tool_direction`, `obstacle`,
            `request` or `emergency_stop`.
        text: what, where, value, limit and unit in one sentence.
        subject: name of the joint or plane; empty where there is only one.
        value: measured value.
        limit: allowed range, as text.
        unit: of both.
        hints: remedies.
    """

    kind: str
    text: str
    subject: str = ""
    value: float | None = None
    limit: str = ""
    unit: str = ""
    hints: tuple[str, ...] = ()

    def details(self, mode: SafetyMode) -> dict[str, Any]:
        """Return the details of its alarm, in the safety mode that it leads to."""
        details: dict[str, Any] = {
            "safety_mode": mode.name,
            "reason": self.kind,
            "value": self.value,
            "limit": self.limit,
            "unit": self.unit,
        }
        if self.subject:
            details["plane" if self.kind == "plane" else "joint"] = self.subject
        details["hints"] = list(self.hints)
        return {name: value for name, value in details.items() if value not in (None, "", [])}


class SafetyMonitor:
    """Compares joints with the limits; it keeps no state.

    Args:
        arm: geometry.
        limits: the configuration.
    """

    __slots__ = ("_arm", "limits")

    def __init__(self, arm: Arm, limits: SafetyLimits) -> None:
        self._arm = arm
        self.limits = limits

    def is_watching(self, mode: SafetyMode) -> bool:
        """Return whether anything can be exceeded in a mode, so that every tick of a motion is checked."""
        limits = self.limits
        return not limits.is_default or (mode is not SafetyMode.NORMAL and not limits.bounds(mode).is_empty)

    def position_breach(
        self, q: Six, T_flange_tcp: Transform, mode: SafetyMode, pairs: Sequence[bool] = NO_PAIRS
    ) -> Breach | None:
        """Return the first limit of position that joints (rad) exceed.

        Args:
            q: the joints.
            T_flange_tcp: active TCP.
            mode: its limits hold.
            pairs: for each pair of configurable inputs, whether its planes count.
        """
        limits, bounds = self.limits, self.limits.bounds(mode)
        if bounds.q_min is not None and bounds.q_max is not None:
            for joint, (angle, low, high) in enumerate(zip(q, bounds.q_min, bounds.q_max, strict=True)):
                if not low - POSITION_TOLERANCE <= angle <= high + POSITION_TOLERANCE:
                    return _range_breach(joint, angle, low, high)
        if not limits.planes and limits.tool_direction is None:
            return None
        T_base_tcp = self._arm.forward_tcp(q, T_flange_tcp)
        for plane in limits.planes:
            if _counts(plane, mode) and (plane.pair is None or pairs[plane.pair]):
                distance = plane.distance(T_base_tcp)
                if not distance >= -POSITION_TOLERANCE:
                    return _plane_breach(plane, distance)
        cone = limits.tool_direction
        if cone is not None:
            x, y, z = cone.axis
            cosine = x * T_base_tcp[2] + y * T_base_tcp[5] + z * T_base_tcp[8]
            angle = acos(max(-1.0, min(1.0, cosine)))
            if not angle <= cone.angle + POSITION_TOLERANCE:
                return _direction_breach(angle, cone.angle)
        return None

    def speed_breach(self, q: Six, qd: Six, T_flange_tcp: Transform, mode: SafetyMode) -> Breach | None:
        """Return the first limit of speed that joints at q (rad) with speeds qd (rad/s) exceed."""
        bounds = self.limits.bounds(mode)
        if bounds.qd_max is not None:
            for joint, (speed, limit) in enumerate(zip(qd, bounds.qd_max, strict=True)):
                if not abs(speed) <= limit * (1.0 + SPEED_TOLERANCE):
                    return _joint_speed_breach(joint, speed, limit, mode)
        if bounds.tcp_speed_max is not None:
            speed = self.tcp_speed(q, qd, T_flange_tcp)
            if not speed <= bounds.tcp_speed_max * (1.0 + SPEED_TOLERANCE):
                return _tcp_speed_breach(speed, bounds.tcp_speed_max, mode)
        return None

    def speed_share(self, q: Six, qd: Six, T_flange_tcp: Transform, mode: SafetyMode) -> float:
        """Return the largest speed as a share of its limit; more than 1 above it."""
        bounds: SafetyBounds = self.limits.bounds(mode)
        shares = [0.0]
        if bounds.qd_max is not None:
            shares += [abs(speed) / limit for speed, limit in zip(qd, bounds.qd_max, strict=True)]
        if bounds.tcp_speed_max is not None:
            shares.append(self.tcp_speed(q, qd, T_flange_tcp) / bounds.tcp_speed_max)
        return max(shares)

    def tcp_speed(self, q: Six, qd: Six, T_flange_tcp: Transform) -> float:
        """Return the speed of the TCP, m/s."""
        x, y, z, *_ = tcp_twist(self._arm, q, qd, T_flange_tcp)
        return sqrt(x * x + y * y + z * z)

    def force_breach(self, force: float, mode: SafetyMode) -> Breach | None:
        """Return the breach, if a force (N) exceeds the limit at the TCP."""
        limit = self.limits.tcp_force_max(mode)
        return None if force <= limit else _tcp_force_breach(force, limit, mode)

    def asks_for_reduced(self, q: Six, T_flange_tcp: Transform, pairs: Sequence[bool]) -> bool:
        """Return whether the TCP is behind a plane that triggers reduced mode."""
        triggers = [plane for plane in self.limits.planes if plane.use == "trigger_reduced"]
        if not triggers:
            return False
        T_base_tcp = self._arm.forward_tcp(q, T_flange_tcp)
        return any(plane.distance(T_base_tcp) < 0.0 for plane in triggers if plane.pair is None or pairs[plane.pair])


def obstacle_breach(obstacle: Obstacle) -> Breach:
    """Return the breach for the joint range or singularity that a motion at a speed has reached."""
    joint = JOINT_NAMES[obstacle.joint] if obstacle.joint >= 0 else ""
    if obstacle.code == "R111" or not (joint or obstacle.limit):
        first = "positions are in m: a target more than 100 m away is a direction; are millimetres meant?"
        second = "end a motion in a direction before: call stopl in another thread, after an input, a way or a force"
    elif joint:
        first = said(
            "end the motion before joint {joint} comes to the end of its range: give a time t and call stopj",
            joint=joint,
        )
        second = "begin with that joint a full turn away, by a movej before"
    else:
        first = "lead the motion past the singularity, by another direction or another start"
        second = "use speedj or movej here: joint motions know no singularities"
    return Breach(
        "obstacle",
        obstacle.text,
        joint,
        obstacle.value,
        obstacle.limit,
        obstacle.unit,
        (first, second, "drive away from there with movej after unlocking the stop"),
    )


def requested_breach(reason: str) -> Breach:
    """Return the breach for a stop that was requested from outside."""
    return Breach(
        "request",
        reason or "asked for from outside",
        hints=(
            "look for the cause where the stop was asked for",
            "unlock the stop when the cause is gone",
            "start the program again: it does not go on where it was",
        ),
    )


def _counts(plane: SafetyPlane, mode: SafetyMode) -> bool:
    if plane.use == "always":
        return True
    return plane.use == ("normal" if mode is SafetyMode.NORMAL else "reduced")


def _range_breach(joint: int, angle: float, low: float, high: float) -> Breach:
    name = JOINT_NAMES[joint]
    return Breach(
        "joint_range",
        said(
            "joint {name} is at {angle:.4f} rad ({angle_deg:.1f} deg); its safety range is {low:.4f} "
            "to {high:.4f} rad ({low_deg:.1f} to {high_deg:.1f} deg)",
            name=name,
            angle=angle,
            angle_deg=degrees(angle),
            low=low,
            high=high,
            low_deg=degrees(low),
            high_deg=degrees(high),
        ),
        name,
        angle,
        f"[{low:.6g}, {high:.6g}]",
        "rad",
        (
            said("choose a target that keeps joint {name} inside its safety range", name=name),
            "for a pose, ask get_inverse_kin with a qnear on the other side, or go there by movej first",
            "ask is_within_safety_limits before the move, or widen joint_range of the safety limits",
        ),
    )


def _excess(
    kind: str, text: str, value: float, limit: float, unit: str, hints: tuple[str, str, str], name: str = ""
) -> Breach:
    """Return the breach for a value above its upper limit."""
    return Breach(kind, text, name, value, f"<= {limit:.6g}", unit, hints)


def _joint_speed_breach(joint: int, speed: float, limit: float, mode: SafetyMode) -> Breach:
    name = JOINT_NAMES[joint]
    return _excess(
        "joint_speed",
        said(
            "joint {name} turns at {speed:.4f} rad/s ({speed_deg:.1f} deg/s); {limit:.4f} rad/s "
            "({limit_deg:.1f} deg/s) are allowed in {words}",
            name=name,
            speed=abs(speed),
            speed_deg=degrees(abs(speed)),
            limit=limit,
            limit_deg=degrees(limit),
            words=_words(mode),
        ),
        abs(speed),
        limit,
        "rad/s",
        (
            "give the motion a lower v, or a longer t",
            "keep a Cartesian motion away from singularities, where joints turn fast: use movej there",
            "lower the speed percentage, or raise joint_speed of the safety limits",
        ),
        name,
    )


def _tcp_speed_breach(speed: float, limit: float, mode: SafetyMode) -> Breach:
    return _excess(
        "tcp_speed",
        said(
            "the TCP moves at {speed:.4f} m/s; {limit:.4f} m/s are allowed in {words}",
            speed=speed,
            limit=limit,
            words=_words(mode),
        ),
        speed,
        limit,
        "m/s",
        (
            "give the motion a lower v, or a longer t",
            "use movel where the speed of the TCP counts: v of movej is that of a joint",
            "lower the speed percentage, or raise tcp_speed of the safety limits",
        ),
    )


def _tcp_force_breach(force: float, limit: float, mode: SafetyMode) -> Breach:
    return _excess(
        "tcp_force",
        said(
            "what the TCP touches pushes it with {force:.1f} N; {limit:.6g} N are allowed in {words}",
            force=force,
            limit=limit,
            words=_words(mode),
        ),
        force,
        limit,
        "N",
        (
            "end the move above what it touches and press with force_mode, or search with a slow speedl until force() "
            "rises",
            "check target and TCP offset (set_tcp): a longer tool touches sooner; after unlocking, move back out",
            "raise tcp_force of the safety limits if the process needs more",
        ),
    )


def _plane_breach(plane: SafetyPlane, distance: float) -> Breach:
    return Breach(
        "plane",
        said(
            "the TCP is {distance:.2f} mm behind safety plane {plane!r}", distance=-distance * 1000.0, plane=plane.name
        ),
        plane.name,
        distance,
        ">= 0",
        "m",
        (
            said("lead the path on the allowed side of {plane!r}, by a waypoint between", plane=plane.name),
            "check the TCP offset (set_tcp): the plane holds for the TCP, and a longer tool is behind it sooner",
            "ask is_within_safety_limits before the move, or move the plane in the safety limits",
        ),
    )


def _direction_breach(angle: float, limit: float) -> Breach:
    return _excess(
        "tool_direction",
        said(
            "the tool is {angle:.4f} rad ({angle_deg:.1f} deg) away from its safety direction; "
            "{limit:.4f} rad ({limit_deg:.1f} deg) are allowed",
            angle=angle,
            angle_deg=degrees(angle),
            limit=limit,
            limit_deg=degrees(limit),
        ),
        angle,
        limit,
        "rad",
        (
            "keep the orientation along the path: the target's rx, ry, rz may be wrong",
            "check the TCP offset (set_tcp): its rotation turns the tool's z axis",
            "ask is_within_safety_limits before the move, or widen tool_direction of the safety limits",
        ),
    )


def _words(mode: SafetyMode) -> str:
    return "normal mode" if mode is SafetyMode.NORMAL else "recovery" if mode is SafetyMode.RECOVERY else "reduced mode"
