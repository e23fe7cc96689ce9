"""Plans moves: turns a request into a segment, or refuses it.

A move is checked whole when it is accepted: numbers, joint ranges, reach, singularities. A
refusal raises `MotionError` and changes nothing. Values beyond the limits of the arm are
lowered to them (documented), with a note where that makes a difference.

Laws, with v, a the wanted speed and acceleration and d the length of the path:

- one trapezoid on the path; it lasts `d / v + v / a`, or `2 sqrt(d / a)` when the path is too
  short to reach v (*assumed*: the manual describes the phases, not the law);
- `movej`: straight in joint space, all joints start and end together (documented); v and a hold
  for the joint with the largest displacement (*assumed*) and are lowered so that no joint passes
  its own limits (documented);
- `movel`, `movec`: v and a hold for the TCP on its line or circle (documented); the orientation
  takes the shortest rotation in step with the path (*assumed*); a pure rotation uses v and a as
  rad/s and rad/s^2 (*assumed*); where a joint would pass its limits, as near singularities, the
  tool is slowed down for as long as needed and stays on its path (*assumed*);
- with a blend radius r > 0 the last braking uses `APPROACH_SHARE` of a, and a move is still planned to stop at its
  target, so that the arm can stop there from its speed in the sphere (*assumed*);
- a duration t > 0 replaces v and a (documented) and is kept exactly; when the limits of the arm
  do not allow it the move takes the shortest possible time (*assumed*);
- a move whose target is where the arm stands takes no time, or t if that is given (*assumed*).
"""

from __future__ import annotations

from enum import StrEnum
from math import degrees, hypot, inf, isfinite, pi, sqrt
from typing import Final

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import singularity
from elitescript.kinematics.rotations import multiply, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import IDENTITY, Transform, compose, rotation_of, transform_from_pose
from elitescript.messages.motion import DIRECTION_M, RADIUS_HINT, RADIUS_SHORTENED, MoveC, MoveJ, MoveL, Six
from elitescript.motion.limits import JOINT_NAMES, MotionLimits, joint_outside, joint_range_error
from elitescript.motion.paths.cartesian import CartesianPath, arc, line
from elitescript.motion.paths.joint_line import JointLine
from elitescript.motion.paths.track import JointTrack, follow, reach_along
from elitescript.motion.paths.zones import Zone, zone_before
from elitescript.motion.segment import Segment
from elitescript.motion.streaming.speed import Obstacle
from elitescript.motion.timing.profile import Law, TimeLaw, resting, trapezoid, trapezoid_lasting, trapezoid_of
from elitescript.motion.timing.retiming import SlowPlace, keeps_limits, retimed
from elitescript.records import record, replace
from elitescript.said import said

NEAR_WRIST_SINE: Final = 0.2
"""|sin q5| below which the wrist singularity is the cause of a slow place: at ordinary tool speeds
the joints reach their limits there."""

NEAR_ELBOW_SINE: Final = 0.4
"""The same for |sin q3|."""

NEAR_SHOULDER_M: Final = 0.12
"""The same for the distance of the wrist centre from passing beside the base axis."""

NOTEWORTHY: Final = 1e-3
"""Share of the wanted duration up to which a longer one needs no note."""

NOTEWORTHY_TURN: Final = pi / 180.0
"""Difference of the end orientation from the given one, rad, up to which it needs no note."""

APPROACH_SHARE: Final = 0.8
"""Share of the acceleration with which a move with a blend radius brakes. The rest turns the arm: an arm that brakes
with all of its acceleration could not change its direction, and would have to stop at a sharp corner. With a fifth left
a corner of any angle can be passed (back along its own path at a quarter of the speed, at a right angle at three
quarters of it)."""

SURELY_DEGREES: Final = 10.0
"""A joint angle of this size, in rad, is probably meant in degrees."""

DEGREES_HINT: Final = "joint angles are in rad; d2r(90) turns degrees into rad"


class MoveNoteKind(StrEnum):
    """Difference of a move from its request."""

    T_TOO_SHORT = "t_too_short"
    LOWERED_TO_LIMITS = "lowered_to_limits"
    SPEED_LOWERED_NEAR_SINGULARITY = "speed_lowered_near_singularity"
    SPEED_LOWERED_FOR_JOINT_LIMITS = "speed_lowered_for_joint_limits"
    RADIUS_SHORTENED = "radius_shortened"
    ORIENTATION_NOT_USED = "orientation_not_used"


@record
class MoveNote:
    """Note for the author of a program about an accepted move."""

    kind: MoveNoteKind
    text: str
    code: str = ""
    """Row of `errors.CODES`, where the checker has the same finding."""
    hint: str = ""


_NO_LAW: Final = Law(0.0, 0.0, 0.0)


@record
class Plan:
    """An accepted move, from standstill to standstill, and the data for its blends."""

    segment: Segment
    notes: tuple[MoveNote, ...] = ()
    law: Law = _NO_LAW
    """Limits of its time law."""
    tool_acceleration: float = 0.0
    """Greatest acceleration of the TCP that the move may use, m/s^2; 0 for moves that do not guide the TCP."""
    t_s: float = 0.0
    """Requested duration; 0 without one."""
    zone: Zone | None = None
    """Where a blend begins."""
    obstacle: Obstacle | None = None
    """Why a move in a direction cannot go on at its end; None for moves that arrive at their targets."""


_BEYOND_REACH_M: Final = 10.0
"""Farther than any arm reaches."""


def plan_movej(
    arm: Arm, limits: MotionLimits, q_start: Six, request: MoveJ, T_flange_tcp: Transform = IDENTITY
) -> Plan:
    """Plan a straight line in joint space.

    Args:
        arm: the arm.
        limits: its limits.
        q_start: joint angles at the start, rad.
        request: the move.
        T_flange_tcp: TCP offset; only for the poses that the segment reports.

    Raises:
        MotionError: R102 an invalid number, R110 the target is outside the joint ranges.
    """
    _check_numbers("q", request.q_target, request.a, request.v, request.t_s, request.r)
    joint = joint_outside(limits, request.q_target)
    if joint is not None:
        angle = request.q_target[joint]
        hint = DEGREES_HINT if abs(angle) > SURELY_DEGREES else "choose a target inside the range"
        raise joint_range_error(limits, joint, angle, "at the target", hint=hint)
    path = JointLine(arm, T_flange_tcp, q_start, request.q_target)
    if path.length == 0.0:
        return Plan(Segment(path, resting(request.t_s)))
    # The limits of every joint, as limits of the leading one.
    v_max = min(limit / abs(share) for limit, share in zip(limits.qd_max, path.slope, strict=True) if share)
    a_max = min(limit / abs(share) for limit, share in zip(limits.qdd_max, path.slope, strict=True) if share)
    notes: tuple[MoveNote, ...] = ()
    if request.t_s == 0.0:
        law = _law(min(request.v, v_max), min(request.a, a_max), request.r)
        profile = trapezoid_of(path.length, law)
        _check_end(profile, request.a, request.v)
        notes = _lowered(path.length, request.v, v_max, request.a, a_max, "rad")
    else:
        lasting = trapezoid_lasting(path.length, request.t_s, v_max, a_max)
        if lasting is not None:
            profile, law = lasting, _law_of(lasting, a_max)
        else:
            law = _law(v_max, a_max, request.r)
            profile = trapezoid_of(path.length, law)
            notes = (_t_too_short(request.t_s, profile),)
    plan = Plan(Segment(path, profile), notes, law, 0.0, request.t_s)
    return _with_zone(plan, arm, T_flange_tcp, request.r)


def plan_movel(
    arm: Arm, limits: MotionLimits, q_start: Six, T_flange_tcp: Transform, request: MoveL, *, is_entered: bool = False
) -> Plan:
    """Plan a straight line of the TCP.

    A target more than `DIRECTION_M` away is a direction: the line ends where the arm cannot go on, and the plan says
    why. The time `t` of such a line gives its speed.

    Args:
        arm: the arm.
        limits: its limits.
        q_start: joint angles at the start, rad.
        T_flange_tcp: TCP offset.
        request: the move.
        is_entered: whether a blend may enter it at speed, so that even a short path may reach v.

    Raises:
        MotionError: R102 an invalid number, R110 a joint would leave its range, R111 a point
            is out of reach, R112 the line meets a singularity; the text says where on the line.
    """
    _check_numbers("p", request.p_target, request.a, request.v, request.t_s, request.r)
    T_base_flange = arm.forward(q_start)
    T_base_tcp = compose(T_base_flange, T_flange_tcp)
    path = line(T_base_flange, T_base_tcp, transform_from_pose(request.p_target), limits.equivalent_radius_m)
    if path.unit == "rad":
        v_max, a_max = limits.tool_turn_speed_max, limits.tool_turn_acceleration_max
    else:
        v_max, a_max = limits.tool_speed_max, limits.tool_acceleration_max
    if path.unit == "m" and path.length > DIRECTION_M:
        v = path.length / request.t_s if request.t_s > 0.0 else request.v
        slower = min(v, v_max), min(request.a, a_max)

        def up_to(s: float) -> CartesianPath:
            T_base_tcp_end = compose(path.flange(s), T_flange_tcp)
            return line(T_base_flange, T_base_tcp, T_base_tcp_end, limits.equivalent_radius_m)

        end, refusal = reach_along(arm, limits, up_to(_BEYOND_REACH_M), q_start, *slower)
        plan = _plan_cartesian(arm, limits, q_start, up_to(end), *slower, 0.0, v_max, a_max, 0.0, is_entered)
        notes = _lowered(path.length, v, v_max, request.a, a_max, "m")
        # Places are counted on the line that was tried, whose end means nothing.
        why = str(refusal).replace(f" of the line of {_BEYOND_REACH_M:.4f} m", "")
        text = said("the line of movel cannot go on after {way:.4f} m: {why}", way=end, why=why)
        return replace(plan, notes=notes, obstacle=Obstacle(refusal.code, text, end, "", "m"))
    plan = _plan_cartesian(
        arm, limits, q_start, path, request.v, request.a, request.t_s, v_max, a_max, request.r, is_entered
    )
    return _with_zone(plan, arm, T_flange_tcp, request.r)


def plan_movec(
    arm: Arm, limits: MotionLimits, q_start: Six, T_flange_tcp: Transform, request: MoveC, *, is_entered: bool = False
) -> Plan:
    """Plan an arc of the TCP through `p_via` to `p_target`; arguments and errors as `plan_movel`.

    The speed is also held so low that the acceleration towards the centre of the circle, v^2 / R,
    stays within the highest tool acceleration (*assumed*).

    Raises:
        MotionError: besides those of `plan_movel` R113, the three points have no circle.
    """
    _check_numbers("p_via", request.p_via, request.a, request.v, 0.0, request.r)
    _check_numbers("p_target", request.p_target, request.a, request.v, 0.0, request.r)
    T_base_flange = arm.forward(q_start)
    path = arc(
        T_base_flange,
        compose(T_base_flange, T_flange_tcp),
        transform_from_pose(request.p_via),
        transform_from_pose(request.p_target),
        request.is_orientation_fixed,
    )
    v_max = min(limits.tool_speed_max, sqrt(limits.tool_acceleration_max * path.radius))
    plan = _plan_cartesian(
        arm,
        limits,
        q_start,
        path,
        request.v,
        request.a,
        0.0,
        v_max,
        limits.tool_acceleration_max,
        request.r,
        is_entered,
    )
    centripetal = plan.law.v * plan.law.v / path.radius
    notes = plan.notes
    if request.is_orientation_fixed:
        notes += _orientation_not_used(path.T_base_tcp_end, transform_from_pose(request.p_target))
    plan = replace(plan, tool_acceleration=hypot(plan.law.a, centripetal), notes=notes)
    return _with_zone(plan, arm, T_flange_tcp, request.r)


def _plan_cartesian(
    arm: Arm,
    limits: MotionLimits,
    q_start: Six,
    path: CartesianPath,
    v: float,
    a: float,
    t_s: float,
    v_max: float,
    a_max: float,
    r: float,
    is_entered: bool,
) -> Plan:
    """Plan a Cartesian path; v_max and a_max are the limits of the tool on it."""
    if path.length == 0.0:
        return Plan(Segment(follow(arm, limits, path, q_start, 0.0, 0.0), resting(t_s)))
    notes: tuple[MoveNote, ...] = ()
    if t_s > 0.0:
        profile = trapezoid_lasting(path.length, t_s, v_max, a_max)
        if profile is not None:
            track = follow(arm, limits, path, q_start, profile.peak_speed, profile.acceleration(0.0))
            if keeps_limits(track, limits, profile):
                law = _law_of(profile, a_max)
                return Plan(Segment(track, profile), (), law, law.a if path.unit == "m" else 0.0, t_s)
        fastest = _law(v_max, a_max, r)
        law = fastest if profile is None else _law_of(profile, a_max)
    else:
        notes = _lowered(path.length, v, v_max, a, a_max, path.unit)
        fastest = law = _law(min(v, v_max), min(a, a_max), r)
    wanted = trapezoid_of(path.length, fastest)
    _check_end(wanted, a, v)
    track = follow(arm, limits, path, q_start, law.v if is_entered else wanted.peak_speed, fastest.a)
    result = retimed(track, limits, wanted, fastest)
    profile = result.profile
    if t_s > 0.0:
        if profile.duration_s <= t_s:
            profile = profile.stretched(t_s)
        else:
            notes = (_t_too_short(t_s, profile),)
    elif result.slow_place is not None and profile.duration_s > (1.0 + NOTEWORTHY) * wanted.duration_s:
        notes = (*notes, _speed_lowered(arm, limits, track, profile, wanted, result.slow_place))
    return Plan(Segment(track, profile), notes, law, law.a if path.unit == "m" else 0.0, t_s)


def _law(v: float, a: float, r: float) -> Law:
    return Law(v, a, APPROACH_SHARE * a if r > 0.0 else a)


def _law_of(lasting: TimeLaw, a_max: float) -> Law:
    """Return the law of a move of a prescribed duration; a blend may use a little more acceleration to turn."""
    a = lasting.acceleration(0.0)
    return Law(lasting.peak_speed, min(a_max, a / APPROACH_SHARE), a)


def _with_zone(plan: Plan, arm: Arm, T_flange_tcp: Transform, r: float) -> Plan:
    path = plan.segment.path
    if r == 0.0 or path.length == 0.0:
        return plan
    zone = zone_before(path, r, arm, T_flange_tcp)
    # The zone of half a move is a little less than half of it by rounding.
    if not zone.is_shortened or zone.radius >= r * (1.0 - NOTEWORTHY):
        return replace(plan, zone=zone)
    note = MoveNote(
        MoveNoteKind.RADIUS_SHORTENED,
        said(RADIUS_SHORTENED, r=r, most=zone.radius),
        "W235",
        said(RADIUS_HINT, most=zone.radius),
    )
    return replace(plan, zone=zone, notes=(*plan.notes, note))


def _check_numbers(name: str, numbers: Six, a: float, v: float, t_s: float, r: float) -> None:
    """Refuse numbers that are not finite or have the wrong sign."""
    for index, number in enumerate(numbers):
        if not isfinite(number):
            raise MotionError(
                said("{name}[{index}] is {number}, not a finite number", name=name, index=index, number=number),
                code="R102",
                value=number,
            )
    for symbol, value, unit, low in (("t", t_s, "s", 0.0), ("r", r, "m", 0.0)):
        if not low <= value < inf:
            raise MotionError(
                said("{symbol} is {value} {unit}; it has to be 0 or more", symbol=symbol, value=value, unit=unit),
                code="R102",
                value=value,
                limit=">= 0",
                unit=unit,
            )
    for symbol, value, unit in (("a", a, "per s^2"), ("v", v, "per s")):
        # A given duration makes both meaningless.
        if t_s == 0.0 and not 0.0 < value < inf:
            raise MotionError(
                said(
                    "{symbol} is {value}; it has to be more than 0 (m or rad {unit})",
                    symbol=symbol,
                    value=value,
                    unit=unit,
                ),
                code="R102",
                value=value,
                limit="> 0",
            )


def _check_end(profile: TimeLaw, a: float, v: float) -> None:
    """Refuse speeds so small that the duration overflows."""
    if not isfinite(profile.duration_s):
        raise MotionError(
            said("with a = {a} and v = {v} the move would never end", a=a, v=v),
            code="R102",
            value=min(a, v),
            limit="> 0",
        )


def _t_too_short(t_s: float, profile: TimeLaw) -> MoveNote:
    return MoveNote(
        MoveNoteKind.T_TOO_SHORT,
        said(
            "t = {t_s:.4g} s is too short for the limits of the arm; the move takes {duration_s:.4f} "
            "s, the shortest possible time",
            t_s=t_s,
            duration_s=profile.duration_s,
        ),
    )


def _lowered(length: float, v: float, v_max: float, a: float, a_max: float, unit: str) -> tuple[MoveNote, ...]:
    """Return the note for a speed or an acceleration above the limits, if that makes a difference."""
    if v <= v_max and a <= a_max:
        return ()
    if (
        trapezoid(length, min(v, v_max), min(a, a_max)).duration_s
        <= (1.0 + NOTEWORTHY) * trapezoid(length, v, a).duration_s
    ):
        return ()
    lowered = [
        said(
            "{symbol} = {value:g} {unit}/{per} is lowered to {limit:.4g}",
            symbol=symbol,
            value=value,
            unit=unit,
            per=per,
            limit=limit,
        )
        for symbol, value, limit, per in (("v", v, v_max, "s"), ("a", a, a_max, "s^2"))
        if value > limit
    ]
    return (MoveNote(MoveNoteKind.LOWERED_TO_LIMITS, said("{lowered}, its limit", lowered=" and ".join(lowered))),)


def _orientation_not_used(T_base_tcp_end: Transform, T_base_tcp_asked: Transform) -> tuple[MoveNote, ...]:
    """Return the note for an arc that ends in another orientation than that of its end pose."""
    turn = multiply(transpose(rotation_of(T_base_tcp_end)), rotation_of(T_base_tcp_asked))
    angle = hypot(*rotvec_from_rotation(turn))
    if angle <= NOTEWORTHY_TURN:
        return ()
    text = said(
        "mode 0 keeps the orientation of the tool relative to the arc: it ends {angle_deg:.3g} "
        "deg away from the orientation of pose_to, which does not count; mode=1 turns the tool "
        "to it",
        angle_deg=degrees(angle),
    )
    return (MoveNote(MoveNoteKind.ORIENTATION_NOT_USED, text),)


def _speed_lowered(
    arm: Arm, limits: MotionLimits, track: JointTrack, profile: TimeLaw, wanted: TimeLaw, place: SlowPlace
) -> MoveNote:
    """Return the note for a move that joint limits slow down, with joint, place and numbers."""
    distance = singularity(arm, track.q(place.s))
    nearness = {
        "wrist": distance.wrist / NEAR_WRIST_SINE,
        "elbow": distance.elbow / NEAR_ELBOW_SINE,
        "shoulder": distance.shoulder / NEAR_SHOULDER_M,
    }
    name = min(nearness, key=nearness.__getitem__)
    slowed = said(
        "the move takes {duration_s:.3f} s instead of {wanted_duration_s:.3f} s: {place} the "
        "tool moves at {speed:.4f} instead of {speed_wanted:.4f} {unit}/s, because of the limits "
        "of joint {joint} ({qd_max:.4g} rad/s, {qdd_max:.4g} rad/s^2)",
        duration_s=profile.duration_s,
        wanted_duration_s=wanted.duration_s,
        place=track.path.place(place.s),
        speed=place.speed,
        speed_wanted=place.speed_wanted,
        unit=track.unit,
        joint=JOINT_NAMES[place.joint],
        qd_max=limits.qd_max[place.joint],
        qdd_max=limits.qdd_max[place.joint],
    )
    if nearness[name] < 1.0:
        return MoveNote(
            MoveNoteKind.SPEED_LOWERED_NEAR_SINGULARITY,
            said("{slowed}; the {name} singularity is near", slowed=slowed, name=name),
        )
    return MoveNote(MoveNoteKind.SPEED_LOWERED_FOR_JOINT_LIMITS, slowed)
