"""Plans blends: one move passes into the next without stopping.

A move with a radius is planned to stop at its waypoint, and leaves its path at a moment, inside the sphere of that
radius, at which it still has the way d1 to go and the speed v1. Braking evenly it would stop at the waypoint after
T = 2 d1 / v1. For that time the next move is superposed (`corner`): it starts from standstill at the waypoint and
has reached the speed v2 when the first stands still, at d2 = v2 T / 2 on its own path. When the next move is so short
that it would have to be slow for all of T, the first is followed a little further (*assumed*), but at most to the begin
of its own braking. A blend is then determined by v2, which is the largest that

- is no more than the next move's own speed, and allows that to stop at its end;
- leaves d2 inside the sphere, and before the next blend begins;
- keeps the tool within the greater acceleration of the two moves, where both guide the tool (*assumed*);
- keeps a blend of two joint moves within the greater acceleration of the two, for every joint (*assumed*);
- keeps the limits of every joint.

Along v2 = 0 the arm brakes on the first path, less hard than planned, which is nearly always allowed. Where it is
not, there is no blend.
"""

from __future__ import annotations

from itertools import pairwise
from math import dist, hypot, sqrt
from typing import Final

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.transforms import Transform, position_of
from elitescript.messages.motion import Six
from elitescript.motion.limits import MotionLimits, joint_outside
from elitescript.motion.paths.cartesian import CartesianPath
from elitescript.motion.paths.corner import Corner, JointCorner
from elitescript.motion.paths.joint_line import JointLine
from elitescript.motion.paths.track import JointTrack, follow
from elitescript.motion.paths.zones import way_within
from elitescript.motion.planner import Plan
from elitescript.motion.segment import BlendedSegment, JointPath, RunningSegment
from elitescript.motion.timing.profile import TimeLaw, trapezoid_of, trapezoid_of_duration
from elitescript.motion.timing.retiming import ACCELERATION_MARGIN, SPEED_MARGIN, entered

ATTEMPTS: Final = 9
"""Largest number of speeds v2 that are tried, by bisection."""

ENOUGH: Final = 0.03
"""Relative accuracy of v2."""

ARC_SAMPLES: Final = 8
"""Parts of a blend with an arc over which the acceleration of the tool is checked."""

JOINT_SAMPLES: Final = 8
"""Parts of a blend in joint space over which speeds and accelerations are checked."""

TIMED_SAMPLES: Final = 24
"""Places at which a move of a prescribed duration is checked."""

SAMPLE_S: Final = 1e-4
"""Time over which an acceleration is taken there."""

SAMPLE_MARGIN: Final = 0.97
"""Share of a limit that may be used where it is checked in places only."""


def blended(
    arm: Arm, limits: MotionLimits, first: Plan, t_s: float, second: Plan, T_flange_tcp: Transform
) -> BlendedSegment | None:
    """Return the second move with a blend at its begin, or None when the arm must stop in between.

    Args:
        arm: the arm.
        limits: its limits.
        first: the move under way, with a zone.
        t_s: time of its segment.
        second: the next move, planned from the end of the first.
        T_flange_tcp: TCP offset of both.
    """
    path = second.segment.path
    if path.length == 0.0 or not isinstance(path, JointTrack | JointLine):
        return None
    blend = _Blend(arm, limits, first, t_s, second, T_flange_tcp)
    if blend.d1 <= 0.0 or blend.speed <= 0.0:
        return None
    highest = candidate = high = blend.highest_speed()
    low, best = 0.0, None
    for _ in range(ATTEMPTS):
        segment = blend.at_speed(candidate) if candidate > 0.0 else None
        if segment is None:
            high = candidate
        else:
            best, low = segment, candidate
        if high - low <= ENOUGH * highest:
            break
        candidate = 0.5 * (low + high)
    return best


def entering_profile(limits: MotionLimits, plan: Plan, start: float, v_start: float, gone_s: float) -> TimeLaw | None:
    """Return the time law of a move from a position and a speed on; None when it is too fast there.

    Args:
        limits: limits of the arm.
        plan: of the move from standstill.
        start: path position.
        v_start: path speed.
        gone_s: time since its begin; a prescribed duration is counted from there.
    """
    path, law = plan.segment.path, plan.law
    way = path.length - start
    if way <= 0.0 or v_start * v_start > 2.0 * law.brake * way:
        return None
    if plan.t_s > gone_s:
        lasting = trapezoid_of_duration(path.length, law, plan.t_s - gone_s, start, v_start)
        if lasting is not None and _keeps_joints(path, limits, lasting):
            return lasting
        if lasting is None:
            quickest = trapezoid_of(path.length, law, start, v_start)
            if quickest.duration_s < plan.t_s - gone_s:
                # It would arrive too early even when braking all the way.
                return None
        else:
            law = law._replace(v=lasting.peak_speed)
    if isinstance(path, JointTrack):
        return entered(path, limits, law, start, v_start)
    return trapezoid_of(path.length, law, start, v_start)


def _keeps_joints(path: JointPath, limits: MotionLimits, profile: TimeLaw) -> bool:
    """Return whether the joints keep their limits, checked in places."""
    if isinstance(path, JointLine):
        # Its law holds for every joint.
        return True
    segment = RunningSegment(path, profile)
    for sample in range(TIMED_SAMPLES):
        t_s = (profile.duration_s - SAMPLE_S) * sample / TIMED_SAMPLES
        qd, qd_later = segment.sample_speed(t_s), segment.sample_speed(t_s + SAMPLE_S)
        for w, w_later, top, a_top in zip(qd, qd_later, limits.qd_max, limits.qdd_max, strict=True):
            if abs(w) > top * SAMPLE_MARGIN or abs(w_later - w) > a_top * SAMPLE_MARGIN * SAMPLE_S:
                return False
    return True


_ALL: Final = 1.0 + 1e-9


class _Blend:
    """One blend, for trials of v2."""

    __slots__ = (
        "T_flange_tcp",
        "approach_s",
        "arm",
        "before_s",
        "d1",
        "duration_s",
        "first",
        "guides_tool",
        "limits",
        "q_start",
        "room",
        "second",
        "speed",
    )

    def __init__(
        self, arm: Arm, limits: MotionLimits, first: Plan, t_s: float, second: Plan, T_flange_tcp: Transform
    ) -> None:
        self.arm = arm
        self.limits = limits
        self.first = first
        self.second = second
        self.T_flange_tcp = T_flange_tcp
        path, zone = second.segment.path, first.zone
        self.guides_tool = isinstance(first.segment.path, JointTrack) and isinstance(path, JointTrack)
        self.room = path.length if second.zone is None else second.zone.begin
        if zone is not None:
            self.room = min(self.room, way_within(path, zone.radius, arm, T_flange_tcp))
        length, profile = first.segment.path.length, first.segment.profile
        self.before_s = first.segment.profile_time(t_s)
        position, speed = profile.at(self.before_s)
        self.approach_s = 0.0
        braking = 0.5 * speed * speed / first.law.brake
        wanted = max(self.room / second.law.v * speed, braking)
        if wanted < length - position:
            self.approach_s = max(0.0, profile.time_at(length - wanted) - self.before_s)
            position, speed = profile.at(self.before_s + self.approach_s)
        self.speed = speed
        self.d1 = length - position
        self.duration_s = 2.0 * self.d1 / speed if speed > 0.0 else 0.0
        self.q_start: Six = first.segment.path.q(position)

    def highest_speed(self) -> float:
        """Return an upper bound of v2 from simple limits."""
        T, path, law = self.duration_s, self.second.segment.path, self.second.law
        # (v2 T / 2) + v2^2 / (2 brake) is all of its path at most.
        half_gain = 0.5 * law.brake * T
        stoppable = sqrt(half_gain * half_gain + 2.0 * law.brake * path.length) - half_gain
        far = 2.0 * self.room / T
        speed = min(law.v, far, stoppable)
        if self.guides_tool:
            return min(speed, self._turning_speed(far))
        if isinstance(path, JointLine) and isinstance(self.first.segment.path, JointLine):
            return min(speed, self._joint_turning_speed(self.first.segment.path, path))
        return speed

    def at_speed(self, v2: float) -> BlendedSegment | None:
        """Return the second move entered at v2, or None when that exceeds a limit."""
        T = self.duration_s
        d2 = 0.5 * v2 * T
        profile = entering_profile(self.limits, self.second, d2, v2, self.approach_s + T)
        if profile is None:
            return None
        corner = self._tool_corner(d2) if self.guides_tool else self._joint_corner(d2)
        if corner is None:
            return None
        before = self.first.segment
        return BlendedSegment(
            before.path, before.profile, self.before_s, self.approach_s, corner, self.second.segment.path, profile
        )

    def _turning_speed(self, v_far: float) -> float:
        """Return the v2 at which an even change of the tool's velocity takes all of the acceleration."""
        corner = self._corner(0.5 * v_far * self.duration_s)
        before, after = corner.velocity(0.0), corner.velocity(corner.length)
        change = self._tool_acceleration * self.duration_s
        size = hypot(*after)
        if self.second.segment.path.unit == "rad" or size == 0.0:
            return self.second.law.a * self.duration_s
        if change == 0.0:
            return v_far
        along = sum(a * b for a, b in zip(before, after, strict=True)) / size
        beside = max(0.0, sum(a * a for a in before) - along * along)
        return max(0.0, along + sqrt(max(0.0, change * change - beside)))

    @property
    def _tool_acceleration(self) -> float:
        return max(self.first.tool_acceleration, self.second.tool_acceleration)

    def _joint_turning_speed(self, first: JointLine, second: JointLine) -> float:
        """Return the largest v2 that keeps the acceleration of every joint."""
        T, highest = self.duration_s, self.second.law.v
        most = max(self.first.law.a, self.second.law.a)
        for before, after, top in zip(first.slope, second.slope, self.limits.qdd_max, strict=True):
            if after:
                along = before * self.speed if after > 0.0 else -before * self.speed
                highest = min(highest, max(0.0, T * min(top, most) + along) / abs(after))
        return highest

    def _corner(self, d2: float) -> Corner:
        tracks = self.first.segment.path, self.second.segment.path
        first, second = [track.path for track in tracks if isinstance(track, JointTrack)]
        assert isinstance(first, CartesianPath) and isinstance(second, CartesianPath)
        return Corner(first, second, self.d1, d2, self.duration_s, "s", self.T_flange_tcp)

    def _tool_corner(self, d2: float) -> JointPath | None:
        corner = self._corner(d2)
        if "arc" in (self.first.segment.kind, self.second.segment.kind) and not self._keeps_tool(corner):
            return None
        try:
            track = follow(self.arm, self.limits, corner, self.q_start, 1.0, 0.0)
        except MotionError:
            return None
        for speed_ratio, _, curvature_ratio in track.interval_ratios:
            if speed_ratio > 1.0 or curvature_ratio > 1.0:
                return None
        return track

    def _keeps_tool(self, corner: Corner) -> bool:
        """Return whether the tool keeps the sphere and its acceleration at a corner with an arc."""
        step_s = corner.length / ARC_SAMPLES
        waypoint = position_of(self.first.segment.path.T_base_tcp_end)
        most = self._tool_acceleration * step_s
        zone = self.first.zone
        before = corner.velocity(0.0)
        for sample in range(1, ARC_SAMPLES + 1):
            after = corner.velocity(sample * step_s)
            if most and dist(before, after) > most * SAMPLE_MARGIN:
                return False
            if zone is not None and dist(corner.point(sample * step_s), waypoint) > zone.radius:
                return False
            before = after
        return True

    def _joint_corner(self, d2: float) -> JointPath | None:
        path = self.second.segment.path
        corner = JointCorner(self.arm, self.T_flange_tcp, self.first.segment.path, path, self.d1, d2, self.duration_s)
        waypoint = position_of(self.arm.forward_tcp(path.q_start, self.T_flange_tcp))
        zone = self.first.zone
        step_s = corner.length / JOINT_SAMPLES
        # Two joint moves change their speeds evenly; any other path bends between the samples.
        is_even = isinstance(path, JointLine) and isinstance(self.first.segment.path, JointLine)
        speed_share, share = (_ALL, _ALL) if is_even else (SPEED_MARGIN, ACCELERATION_MARGIN)
        speeds: list[Six] = []
        for sample in range(JOINT_SAMPLES + 1):
            q, qd = corner.q_and_slope(sample * step_s)
            if joint_outside(self.limits, q) is not None:
                return None
            if any(abs(w) > top * speed_share for w, top in zip(qd, self.limits.qd_max, strict=True)):
                return None
            if zone is not None and sample:
                place = position_of(self.arm.forward_tcp(q, self.T_flange_tcp))
                if dist(place, waypoint) > zone.radius * _ALL:
                    return None
            speeds.append(qd)
        for joint, top in enumerate(self.limits.qdd_max):
            changes = [b[joint] - a[joint] for a, b in pairwise(speeds)]
            # At the ends the acceleration is extrapolated by half a sample from the outermost mean.
            changes += [1.5 * changes[0] - 0.5 * changes[1], 1.5 * changes[-1] - 0.5 * changes[-2]]
            if any(abs(change) > top * share * step_s for change in changes):
                return None
        return corner
