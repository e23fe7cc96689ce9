"""Parameters of an arm from a recording of its controller: what it determines, and what it does not."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from math import inf, isfinite, sqrt
from typing import Any, Final

from elitescript.audit.fit.least_squares import NORMAL_95, Solution, solve, student_quantile
from elitescript.audit.fit.lengths import LENGTHS, LengthFit, fit_lengths
from elitescript.audit.fit.moves import RESOLUTION, Estimate, RecordedMove, recorded_moves, six_columns
from elitescript.audit.fit.pairs import ARITHMETIC, NO_TCP, Point, Points
from elitescript.audit.fit.parameters import AT_LEAST, DETERMINED, Parameter, determined, not_determined
from elitescript.audit.fit.program_moves import ProgramMove, moves_of
from elitescript.audit.settings import TCP_LATE_S
from elitescript.errors import UsageError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.dynamics import RigidBody, mass_chain, torques_of
from elitescript.messages.motion import Six
from elitescript.models.model import RobotModel
from elitescript.motion.limits import JOINT_NAMES
from elitescript.recorder.recording import Recording
from elitescript.records import NamedTuple, record, replace

LENGTH_ROWS: Final = 60
"""Rows that the lengths are fitted to."""
LENGTH_DISTANCE_RAD: Final = 0.02
"""Distance between two of them, sum over the joints."""

LAG_ROWS: Final = 10
"""Fewest rows of a cruise, behind the transient, for the lag."""
TRANSIENT_LAGS: Final = 8.0
"""Time after the begin of a cruise, in lags, after which the lag is that of the constant speed: the drive then is
within 2e-6 of it (critically damped, time constant half the lag)."""
REST_ROWS: Final = 50
"""Fewest rows at rest for the noise."""
SETTLED_S: Final = 0.5
"""Time at rest after which every drive has settled."""
SAME_SPEED: Final = 1e-3
"""Relative difference of two speeds that counts as none."""
TRAPEZOID_BEND: Final = 2e-3
"""Share of the largest speed by which a ramp may leave a straight line."""


@record
class RecordingFit:
    """What a recording says of an arm.

    Attributes:
        parameters: in a fixed order.
        words: what the table does not say, one sentence each.
        lengths: the fit of the lengths; None if the recording has no poses.
    """

    parameters: tuple[Parameter, ...]
    words: tuple[str, ...]
    lengths: LengthFit | None

    @property
    def differs(self) -> bool:
        """Whether a parameter of the model is contradicted."""
        return any(parameter.differs for parameter in self.parameters) or (
            self.lengths is not None and self.lengths.differs
        )

    def json(self) -> dict[str, Any]:
        """Return the fit as JSON has it: `parameters` by name, `words`."""
        return {
            "parameters": {parameter.name: parameter.json() for parameter in self.parameters},
            "words": list(self.words),
        }


def fit_recording(recording: Recording, model: RobotModel, program: str | None = None) -> RecordingFit:
    """Return what a recording determines of an arm.

    Args:
        recording: target joints and speeds at least.
        model: that it is compared with.
        program: text of the program that ran; without it nobody knows which moves left speed and acceleration to their
            defaults, and which were limited.
    """
    words: list[str] = []
    recording = _rising(recording, words)
    lengths = _lengths(recording, model, words)
    moves = recorded_moves(recording)
    texts = {} if program is None else moves_of(program, "program")
    if program is None:
        words.append("no program was given: defaults and joint limits are not looked for")
    parameters: list[Parameter] = []
    if lengths is not None:
        parameters.extend(lengths.parameters)
        words.extend(lengths.words)
        found = {row.name: row.found for row in lengths.parameters if row.found is not None}
        d1, a2, a3, d4, d5, d6 = (found.get(name, getattr(model.arm, name)) for name in LENGTHS)
        model = replace(model, arm=Arm(d1, a2, a3, d4, d5, d6))
    else:
        parameters.extend(
            not_determined(name, "m", getattr(model.arm, name), "the recording has no poses") for name in LENGTHS
        )
    limited = _limited_moves(recording, moves, texts)
    parameters.extend(_defaults(recording, moves, texts, limited, model, words))
    parameters.extend(_limits(recording, limited, model))
    parameters.append(_ramp_shape(moves, texts, words))
    parameters.extend(_drives(recording, moves, model))
    parameters.extend(_reported(recording, words))
    parameters.append(_payload_of_torques(recording, model))
    return RecordingFit(tuple(parameters), tuple(dict.fromkeys(words)), lengths)


def _rising(recording: Recording, words: list[str]) -> Recording:
    """Return a recording without rows that repeat the time of the row before: a controller that is late sends some."""
    t = recording.t
    restarts = set(recording.restarts)
    kept = [index for index in range(len(t)) if index == 0 or t[index] > t[index - 1] or index in restarts]
    if len(kept) == len(t):
        return recording
    words.append(f"{len(t) - len(kept)} of {len(t)} rows repeat the time of the row before and are left out")
    place = {index: number for number, index in enumerate(kept)}
    return replace(
        recording,
        t=array("d", [t[index] for index in kept]),
        arrived_s=array("d", [recording.arrived_s[index] for index in kept]),
        columns={name: array("d", [column[index] for index in kept]) for name, column in recording.columns.items()},
        restarts=tuple(place[index] for index in recording.restarts),
    )


# ---------------------------------------------------------------- lengths


def _lengths(recording: Recording, model: RobotModel, words: list[str]) -> LengthFit | None:
    q, pose = six_columns(recording, "target_joint_positions"), six_columns(recording, "target_TCP_pose")
    _compare_reported(recording, model, words)
    if q is None or pose is None or model.arm.calibration is not None:
        return None
    offsets = _tcp_offsets(recording)
    if offsets:
        said = "the TCP offset is the one that the controller shows"
    else:
        said = "the controller showed no TCP offset, so poses are taken as those of the flange: one is part of d6"
    points: list[Point] = []
    last: Sequence[float] | None = None
    for index, t in enumerate(recording.t):
        joints = [column[index] for column in q]
        place = [column[index] for column in pose]
        tcp = _tcp_at(offsets, t) if offsets else NO_TCP
        if tcp is None or not all(map(isfinite, (*joints, *place))):
            continue
        if last is not None and sum(abs(a - b) for a, b in zip(joints, last, strict=True)) < LENGTH_DISTANCE_RAD:
            continue
        last = joints
        q1, q2, q3, q4, q5, q6 = joints
        x, y, z, rx, ry, rz = place
        points.append(Point((q1, q2, q3, q4, q5, q6), (x, y, z, rx, ry, rz), index, f"row at {t:.3f} s", tcp))
    if not points:
        return None
    step = max(1, len(points) // LENGTH_ROWS)
    kept = Points(tuple(points[::step]), said, ARITHMETIC, ARITHMETIC, ARITHMETIC)
    try:
        return fit_lengths(kept, model.arm)
    except UsageError as error:
        words.append(f"lengths: {error}")
        return None


def _tcp_offsets(recording: Recording) -> list[tuple[float, Six]]:
    """Return the TCP offsets that the controller showed, each with the time from which on it did, s."""
    shown = [
        (message.t, offset)
        for message in recording.messages
        if (offset := message.data.get("TCP offset")) is not None and None not in offset
    ]
    if not shown and "tcp_offset" in recording.facts:
        shown = [(-inf, recording.facts["tcp_offset"])]
    found: list[tuple[float, Six]] = []
    for t, (a, b, c, d, e, f) in shown:
        offset = (float(a), float(b), float(c), float(d), float(e), float(f))
        if not found:
            found.append((-inf, offset))
        elif found[-1][1] != offset:
            found.append((t, offset))
    return found


def _tcp_at(offsets: Sequence[tuple[float, Six]], t: float) -> Six | None:
    """Return the TCP offset at a time; None near a change, whose moment the primary port tells only roughly."""
    if any(abs(t - since) < TCP_LATE_S for since, _ in offsets):
        return None
    return [offset for since, offset in offsets if since <= t][-1]


def _compare_reported(recording: Recording, model: RobotModel, words: list[str]) -> None:
    """Say where the controller's own configuration differs from the model."""
    lengths, limits, defaults = (recording.facts.get(name, {}) for name in ("lengths", "limits", "defaults"))
    a, d, alpha = model.arm.modified_dh
    joints = model.joints
    rows: dict[str, tuple[Sequence[float] | None, Sequence[float]]] = {
        "a": (lengths.get("a"), a),
        "d": (lengths.get("d"), d),
        "alpha": (lengths.get("alpha"), alpha),
        "qd_max": (limits.get("qd_max"), [joint.qd_max for joint in joints]),
    }
    for name, (theirs, ours) in rows.items():
        if theirs is not None and any(abs(x - y) > 1e-6 for x, y in zip(theirs, ours, strict=False)):
            values = ", ".join(f"{value:.6g}" for value in theirs)
            words.append(f"the controller's own configuration has {name} = [{values}], which the model has not")
    for name, value in defaults.items():
        own = getattr(model, f"default_{name}", None)
        if own is not None and abs(value - own) > 1e-6:
            words.append(f"the controller's own configuration has default_{name} = {value:.6g}, the model {own:.6g}")


# ---------------------------------------------------------------- defaults and limits


def _defaults(
    recording: Recording,
    moves: Sequence[RecordedMove],
    texts: dict[int, ProgramMove],
    limited: Sequence[LimitedMove],
    model: RobotModel,
    words: list[str],
) -> Iterable[Parameter]:
    """Yield the speeds and accelerations that moves have which give none."""
    limits = _speed_limits(recording, limited, model)
    for name, unit, argument, joint in (
        ("default_joint_speed", "rad/s", "v", True),
        ("default_joint_acceleration", "rad/s^2", "a", True),
        ("default_tool_speed", "m/s", "v", False),
        ("default_tool_acceleration", "m/s^2", "a", False),
    ):
        seen: list[tuple[int, Estimate | None]] = []
        at_limit: list[tuple[Estimate, str]] = []
        for move in moves:
            text = texts.get(move.line)
            if text is None or text.is_joint != joint or not text.has_default(argument):
                continue
            if argument == "v":
                estimate = move.cruise if joint else move.tool_cruise
            else:
                estimate = move.ramp if joint else move.tool_ramp
            its_limit = _limit_reached(recording, move, limits) if argument == "v" else ""
            if estimate is not None and its_limit:
                at_limit.append((estimate, its_limit))
            else:
                seen.append((move.line, estimate))
        yield _default(name, unit, getattr(model, name), argument, seen, at_limit, words)


def _default(
    name: str,
    unit: str,
    ours: float,
    argument: str,
    seen: list[tuple[int, Estimate | None]],
    at_limit: list[tuple[Estimate, str]],
    words: list[str],
) -> Parameter:
    kind = "movej" if "joint" in name else "movel"
    if at_limit and not any(estimate for _, estimate in seen):
        largest = max(estimate.value for estimate, _ in at_limit)
        its_limits = ", ".join(dict.fromkeys(its_limit for _, its_limit in at_limit))
        why = f"every {kind} without {argument} that cruises has a joint at its limit ({its_limits})"
        return Parameter(name, unit, ours, largest, None, AT_LEAST, why)
    if not seen:
        return not_determined(name, unit, ours, f"no {kind} without {argument} was recorded")
    usable = [(line, estimate) for line, estimate in seen if estimate is not None]
    if not usable:
        why = "is long enough to cruise" if argument == "v" else "has a ramp of ten rows"
        return not_determined(name, unit, ours, f"no {kind} without {argument} {why}, at one speed scaling")
    # A joint that is at its limit makes a move slower, never faster.
    largest = max(estimate.value for _, estimate in usable)
    same = [estimate for _, estimate in usable if estimate.value >= largest * (1.0 - SAME_SPEED)]
    slower = sorted({line for line, estimate in usable if estimate.value < largest * (1.0 - SAME_SPEED)})
    if slower:
        words.append(
            f"{name}: moves of line {', '.join(map(str, slower))} are slower, as where a joint is at its limit, a move "
            f"is blended or runs along a path that bends"
        )
    if len(same) < 2 and slower:
        return Parameter(name, unit, ours, largest, None, AT_LEAST, "moves without it differ: all may be limited")
    best = _combined(same)
    return determined(name, unit, ours, best.value, best.half, f"{len(same)} moves")


def _combined(estimates: Sequence[Estimate]) -> Estimate:
    """Return the mean of estimates, weighted by their intervals; as wide as their spread asks for."""
    weights = [1.0 / (estimate.half * estimate.half) for estimate in estimates]
    total = sum(weights)
    mean = sum(w * estimate.value for w, estimate in zip(weights, estimates, strict=True)) / total
    half = 1.0 / sqrt(total)
    if len(estimates) > 1:
        square = sum(w * (e.value - mean) ** 2 for w, e in zip(weights, estimates, strict=True)) * NORMAL_95**2
        spread = sqrt(square / (len(estimates) - 1))
        if spread > 2.0:
            half *= spread * student_quantile(len(estimates) - 1) / NORMAL_95
    return Estimate(mean, max(half, RESOLUTION * abs(mean)))


class LimitedMove(NamedTuple):
    """A `movej` that cruises below the speed that it gives, so that one of its joints is at its limit."""

    speeds: dict[int, Estimate]
    """Speed of each joint that can be the one, rad/s, at full scaling."""


def _limited_moves(
    recording: Recording, moves: Sequence[RecordedMove], texts: dict[int, ProgramMove]
) -> list[LimitedMove]:
    """Return the moves that a joint has limited.

    No joint can be at its limit in one move and faster in another, so what remains is often one joint.
    """
    speeds = six_columns(recording, "target_joint_speeds") or []
    largest = [_largest(column) for column in speeds]
    found = []
    for move in moves:
        text = texts.get(move.line)
        if text is None or not text.is_joint or move.cruise is None or text.given.get("t", 0.0) != 0.0:
            continue
        asked = text.given.get("v")
        if asked is None or move.cruise.value >= asked * (1.0 - SAME_SPEED) or move.scaling is None:
            continue
        shares = {joint: abs(share) for joint, share in enumerate(move.shares) if abs(share) > 1e-6}
        found.append(
            LimitedMove(
                {
                    joint: Estimate(move.cruise.value * share, move.cruise.half * share)
                    for joint, share in shares.items()
                    if share * move.cruise.value * move.scaling >= largest[joint] * (1.0 - SAME_SPEED)
                }
            )
        )
    return found


def _speed_limits(recording: Recording, limited: Sequence[LimitedMove], model: RobotModel) -> list[list[float]]:
    """Return for each joint what may be its limit, rad/s.

    It is the one that the controller shows, else the model's; and the speeds of moves that the joint may have limited.
    """
    shown = recording.facts.get("limits", {}).get("qd_max", ())
    found = [[shown[joint] if joint < len(shown) else model.joints[joint].qd_max] for joint in range(6)]
    for move in limited:
        for joint, speed in move.speeds.items():
            found[joint].append(speed.value)
    return found


def _limit_reached(recording: Recording, move: RecordedMove, limits: Sequence[Sequence[float]]) -> str:
    """Return the first joint that is at a limit in a move, with the limit, in words; empty if none is."""
    speeds = six_columns(recording, "target_joint_speeds")
    if speeds is None or move.scaling is None:
        return ""
    for joint, name in enumerate(JOINT_NAMES):
        largest = _largest(speeds[joint][move.first : move.last + 1]) / move.scaling
        for limit in limits[joint]:
            if limit > 0.0 and abs(largest - limit) <= SAME_SPEED * limit:
                return f"{name} {limit:.6g} rad/s"
    return ""


def _largest(speeds: Sequence[float]) -> float:
    return max((abs(value) for value in speeds if isfinite(value)), default=0.0)


def _limits(recording: Recording, limited: Sequence[LimitedMove], model: RobotModel) -> Iterable[Parameter]:
    """Yield the speed limit of each joint."""
    largest = [_largest(column) for column in six_columns(recording, "target_joint_speeds") or []]
    at_limit: dict[int, list[Estimate]] = {}
    for move in limited:
        if len(move.speeds) == 1:
            ((joint, speed),) = move.speeds.items()
            at_limit.setdefault(joint, []).append(speed)
    for joint, name in enumerate(JOINT_NAMES):
        ours = model.joints[joint].qd_max
        key = f"qd_max.{joint + 1}"
        if joint in at_limit:
            best = _combined(at_limit[joint])
            yield determined(key, "rad/s", ours, best.value, best.half, f"{name}: a move was limited by this joint")
        elif largest and largest[joint] > 0.0:
            why = f"{name}: no move was limited by this joint for sure"
            yield Parameter(key, "rad/s", ours, largest[joint], None, AT_LEAST, why)
        else:
            yield not_determined(key, "rad/s", ours, f"{name} did not move")


def _ramp_shape(moves: Sequence[RecordedMove], texts: dict[int, ProgramMove], words: list[str]) -> Parameter:
    """Return the jerk of the ramps; a trapezoid shows none."""
    # The joints of a straight line of the tool bend whatever the ramp is.
    joint_moves = [move for move in moves if move.line in texts and texts[move.line].is_joint]
    bends = [move.bend for move in joint_moves if move.bend is not None]
    if not bends:
        return not_determined("jerk", "rad/s^3", None, "no ramp of a movej has ten rows")
    if sorted(bends)[len(bends) // 2] <= TRAPEZOID_BEND:
        words.append("ramps are straight: a trapezoid, with no limit of the jerk that 250 Hz shows")
        return not_determined("jerk", "rad/s^3", None, "ramps are straight (trapezoid)")
    words.append("ramps are bent (S): accelerations are those in the middle of a ramp")
    return not_determined("jerk", "rad/s^3", None, "ramps are bent; how is not fitted")


# ---------------------------------------------------------------- drives


def _drives(recording: Recording, moves: Sequence[RecordedMove], model: RobotModel) -> Iterable[Parameter]:
    """Yield lag and noise of the drives."""
    plant = model.plant
    lag_model, noise_model = (0.0, 0.0) if plant is None else (plant.lag_s, plant.noise_rad)
    target, actual = (six_columns(recording, f"{side}_joint_positions") for side in ("target", "actual"))
    qd = six_columns(recording, "target_joint_speeds")
    if target is None or actual is None or qd is None:
        yield not_determined("plant.lag_s", "s", lag_model, "the recording has no actual positions")
        yield not_determined("plant.noise_rad", "rad", noise_model, "the recording has no actual positions")
        return
    noise = _noise_at_rest(recording, target, actual, qd, noise_model)
    yield _lag(recording, moves, target, actual, qd, lag_model)
    yield noise


def _lag(
    recording: Recording,
    moves: Sequence[RecordedMove],
    target: list[Sequence[float]],
    actual: list[Sequence[float]],
    qd: list[Sequence[float]],
    ours: float,
) -> Parameter:
    name = "plant.lag_s"
    lag_s = 0.0
    result: Parameter | None = None
    # How long the transient is depends on the lag: twice is enough, since rows only fall away.
    for _ in range(3):
        rows: list[tuple[float, float]] = []
        for move in moves:
            if move.cruise_rows is None or move.scaling is None:
                continue
            begin, end = move.cruise_rows
            settled = recording.t[begin] + max(TRANSIENT_LAGS * lag_s, 0.1)
            kept = [index for index in range(begin, end) if recording.t[index] >= settled]
            if len(kept) < LAG_ROWS:
                continue
            for joint in range(6):
                # On a bent path one joint may have a constant speed for a while, the others not.
                of_joint = [qd[joint][i] for i in kept]
                if min(map(abs, of_joint)) > 0.02 and max(of_joint) - min(of_joint) <= 1e-4 * abs(of_joint[0]):
                    rows.extend((qd[joint][i], target[joint][i] - actual[joint][i]) for i in kept)
        if not rows:
            break
        result, lag_s = _lag_of(rows, name, ours)
    if result is None:
        return not_determined(name, "s", ours, "no move cruises long enough for the drives to settle")
    return result


def _lag_of(rows: list[tuple[float, float]], name: str, ours: float) -> tuple[Parameter, float]:
    """Return lag and offset of the friction from speeds and distances."""
    signs = [(speed, 1.0 if speed > 0.0 else -1.0) for speed, _ in rows]
    values = [behind for _, behind in rows]
    both = solve(signs, values)
    spread = sqrt(both.chi_square / max(both.freedom, 1))
    speeds = [abs(speed) for speed, _ in rows]
    if both.freedom > 0 and max(speeds) > 1.2 * min(speeds):
        half = both.sigma_of(0) * spread * student_quantile(both.freedom)
        words = f"{len(rows)} distances at {min(speeds):.3g} to {max(speeds):.3g} rad/s, dry friction fitted too"
        found = both.values[0]
    else:
        only = solve([[speed] for speed, _ in rows], values)
        spread = sqrt(only.chi_square / max(only.freedom, 1))
        half = only.sigma_of(0) * spread * student_quantile(max(only.freedom, 1))
        words = f"{len(rows)} distances at one speed: without dry friction, which cannot be told apart"
        found = only.values[0]
    # Speeds of the controller are those of the end of a period; this is what rounding of positions leaves.
    return determined(name, "s", ours, found, max(half, 1e-9), words), max(found, 0.0)


def _noise_at_rest(
    recording: Recording,
    target: list[Sequence[float]],
    actual: list[Sequence[float]],
    qd: list[Sequence[float]],
    ours: float,
) -> Parameter:
    name = "plant.noise_rad"
    since: float | None = None
    differences: list[list[float]] = [[] for _ in range(6)]
    for index, t in enumerate(recording.t):
        if any(abs(column[index]) > 0.0 for column in qd):
            since = None
            continue
        if since is None or t < since:
            since = t
        if t - since >= SETTLED_S:
            for joint in range(6):
                differences[joint].append(actual[joint][index] - target[joint][index])
    if len(differences[0]) < REST_ROWS:
        return not_determined(name, "rad", ours, f"the arm rests in {len(differences[0])} rows, needs {REST_ROWS}")
    square, freedom = 0.0, 0
    for values in differences:
        mean = sum(values) / len(values)
        square += sum((value - mean) ** 2 for value in values)
        freedom += len(values) - 1
    sigma = sqrt(square / freedom)
    half = NORMAL_95 * sigma / sqrt(2.0 * freedom)
    return determined(name, "rad", ours, sigma, max(half, 1e-12), f"{len(differences[0])} rows at rest")


# ---------------------------------------------------------------- what the controller says itself


def _reported(recording: Recording, words: list[str]) -> Iterable[Parameter]:
    """Yield what RTSI has as it is: payload, slider, scaling."""
    for name, unit, variable in (
        ("payload_kg", "kg", "payload_mass"),
        ("speed_slider", "", "target_speed_fraction"),
        ("speed_scaling", "", "speed_scaling"),
    ):
        column = recording.columns.get(variable)
        values = [] if column is None else [value for value in column if isfinite(value)]
        ours = 1.0 if name != "payload_kg" else None
        if not values:
            yield not_determined(name, unit, ours, f"the recording has no {variable}")
            continue
        low, high = min(values), max(values)
        if high - low > 1e-9:
            words.append(f"{name} changes from {low:.6g} to {high:.6g} {unit}".rstrip())
            # The value of the last row is the one that holds.
        value = values[-1]
        yield determined(name, unit, ours, value, 1e-9, f"{variable} of the controller")


def _payload_of_torques(recording: Recording, model: RobotModel) -> Parameter:
    """Return the mass at the flange that explains the torques at rest.

    Torques are linear in mass and first moment of a payload. What the links weigh is taken from the model, which nobody
    outside has measured: the number is relative to it.
    """
    name = "payload_of_torques_kg"
    q, torque = six_columns(recording, "actual_joint_positions"), six_columns(recording, "actual_joint_torques")
    qd = six_columns(recording, "target_joint_speeds")
    reported = recording.columns.get("payload_mass")
    ours = None if reported is None or not len(reported) or not isfinite(reported[-1]) else reported[-1]
    if q is None or torque is None or qd is None:
        return not_determined(name, "kg", ours, "the recording has no torques")
    links = [RigidBody(link.mass, link.com, link.inertia) for link in model.links]
    alone = mass_chain(model.arm, links)
    massless = [RigidBody(0.0) for _ in links]
    unit = mass_chain(model.arm, massless, RigidBody(1.0))
    offsets = [
        mass_chain(model.arm, massless, RigidBody(1.0, com))
        for com in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    ]
    # Only rows with the payload of the last one: it is part of the torques.
    carried = None if reported is None else [value == reported[-1] for value in reported]
    still = (0.0,) * 6
    rows: list[list[float]] = []
    values: list[float] = []
    poses, last, since = 0, None, None
    for index, t in enumerate(recording.t):
        if any(abs(column[index]) > 0.0 for column in qd) or not (carried is None or carried[index]):
            since = None
            continue
        if since is None or t < since:
            since = t
        joints = [column[index] for column in q]
        # In the last row of a rest the speed is 0 still, and the torque that of the move that begins.
        is_last = index + 1 < len(recording.t) and any(abs(column[index + 1]) > 0.0 for column in qd)
        if is_last or t - since < 0.1 or not all(map(isfinite, (*joints, torque[0][index]))):
            continue
        if last is not None and sum(abs(a - b) for a, b in zip(joints, last, strict=True)) < LENGTH_DISTANCE_RAD:
            if len(rows) > 6 * 200 * poses:
                continue
        else:
            poses += 1
        last = joints
        own = torques_of(alone, joints, still, still, model.gravity)
        mass = torques_of(unit, joints, still, still, model.gravity)
        shifted = [torques_of(offset, joints, still, still, model.gravity) for offset in offsets]
        for joint in range(1, 6):
            rows.append([mass[joint], *(row[joint] - mass[joint] for row in shifted)])
            values.append(torque[joint][index] - own[joint])
    if poses < 2:
        return not_determined(
            name, "kg", ours, f"the arm rests in {poses} attitude{'' if poses == 1 else 's'}, needs two"
        )
    solution = solve(rows, values)
    # Joints of one moment err together, since one encoder moves the weights on all joints below it.
    half = clustered_sigma(solution, rows, 5) * student_quantile(max(solution.freedom, 1))
    if not half < 0.5:
        return not_determined(name, "kg", ours, "the attitudes at rest are too much alike")
    why = f"torques in {poses} attitudes at rest, relative to the links of the model; dry friction would add to it"
    return determined(name, "kg", ours, solution.values[0], max(half, 1e-6), why)


def clustered_sigma(solution: Solution, rows: Sequence[Sequence[float]], size: int) -> float:
    """Return the standard deviation of the first unknown if errors hang together within blocks of equations.

    Covariance of Liang and Zeger (1986): the sum of the squares of what each block adds to the unknown.
    """
    if any(direction.sigma == inf for direction in solution.directions):
        return inf
    weights = [
        sum(direction.vector[0] * direction.sigma**2 * direction.vector[index] for direction in solution.directions)
        for index in range(len(rows[0]))
    ]
    total = 0.0
    for begin in range(0, len(rows), size):
        block = zip(rows[begin : begin + size], solution.residuals[begin : begin + size], strict=True)
        total += sum(rest * sum(w * x for w, x in zip(weights, row, strict=True)) for row, rest in block) ** 2
    return sqrt(total)


def summary(fit: RecordingFit) -> list[str]:
    """Return which parameters are determined and which are not, one line each kind."""
    lines = []
    for state in (DETERMINED, AT_LEAST, "not determined"):
        names = [parameter.name for parameter in fit.parameters if parameter.state == state]
        if names:
            lines.append(f"{state}: {', '.join(names)}")
    return lines
