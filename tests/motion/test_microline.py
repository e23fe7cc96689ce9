"""The points of a file as a planned move, and why they are refused."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from math import cos, pi, sin
from random import Random

import pytest

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import solve_branch
from elitescript.kinematics.jacobian import singularity
from elitescript.kinematics.transforms import compose, inverse, pose_from_transform, transform_from_pose
from elitescript.messages.motion import MicroLine, MoveML, Six
from elitescript.motion.microline import START_TOLERANCE_RAD, _solved, plan_moveml
from elitescript.motion.planner import Plan
from elitescript.motion.segment import Setpoint
from tests.invariants.cases import CASES
from tests.motion.moves import (
    ARM,
    FULL_TURN,
    LIMITS,
    Q_WORK,
    T_FLANGE_TCP,
    largest_difference,
    limits_of,
    shifted,
    six,
    tcp_pose,
    wrist_passage,
)

H = 0.004


def file_of(
    rows: Sequence[Six],
    *,
    interval_s: float = H,
    is_cartesian: bool = False,
    frame: Six = (0.0,) * 6,
    file_lines: Sequence[int] | None = None,
) -> MicroLine:
    numbers = array("d", [number for row in rows for number in row])
    lines = array("I", file_lines or range(1, len(rows) + 1))
    return MicroLine("path.txt", interval_s, is_cartesian, numbers.tobytes(), lines.tobytes(), frame)


def wave(count: int, size: float = 0.1, rate: float = 3.0, h: float = H) -> list[Six]:
    """Joint positions that swing about the work place; the first is that place, left at a speed."""
    return [six(q + size * sin(rate * (1.0 + 0.1 * j) * k * h) for j, q in enumerate(Q_WORK)) for k in range(count)]


def circle(count: int, radius: float = 0.05, rate: float = 2.0) -> list[Six]:
    """Poses on a circle through the pose of the work place, the tool tilting a little."""
    return [
        shifted(Q_WORK, radius * (cos(rate * k * H) - 1.0), radius * sin(rate * k * H), 0.0, 0.1 * sin(rate * k * H))
        for k in range(count)
    ]


def planned(file: MicroLine, q_start: Six = Q_WORK, first: int = 1, last: int = 0, arm: Arm = ARM) -> Plan:
    return plan_moveml(arm, LIMITS, q_start, T_FLANGE_TCP, MoveML(file, first, last or len(file), 1.4, 1.05))


def refused(file: MicroLine, q_start: Six = Q_WORK, first: int = 1, last: int = 0) -> MotionError:
    with pytest.raises(MotionError) as caught:
        planned(file, q_start, first, last)
    return caught.value


def passes(plan: Plan, point: Six, near_s: float) -> float:
    """The smallest joint difference from a point, around a time: looked for in periods of 1 ms, then of 10 us."""
    for step_s, count in ((1e-3, 30), (1e-5, 100)):
        times = [near_s + k * step_s for k in range(-count, count + 1)]
        near_s = min(times, key=lambda t_s: largest_difference(plan.segment.sample(t_s), point))
    return largest_difference(plan.segment.sample(near_s), point)


def test_joint_points_are_passed_in_order_and_the_last_is_the_end() -> None:
    rows = wave(200)
    plan = planned(file_of(rows))
    assert plan.notes == ()
    assert plan.segment.q_start == rows[0]
    assert plan.segment.q_end == plan.segment.sample(99.0) == rows[-1]
    # Two ramps of v / a: a few milliseconds at 0.3 to 0.45 rad/s and 40 rad/s^2.
    assert 199 * H < plan.segment.duration_s < 199 * H + 0.02
    late_s = 0.5 * 0.45 / 40.0
    for k in range(20, 180):
        assert passes(plan, rows[k], k * H + late_s) < 5e-6


def test_a_file_from_rest_to_rest_is_played_to_the_tick() -> None:
    rows = [six(q + 0.3 * (1.0 - cos(pi * k / 100)) for q in Q_WORK) for k in range(101)]
    plan = planned(file_of(rows))
    assert plan.segment.duration_s == 100 * H
    for k, row in enumerate(rows):
        assert plan.segment.sample(k * H) == pytest.approx(row, abs=1e-12)


def test_poses_are_those_of_the_tcp() -> None:
    rows = circle(300)
    plan = planned(file_of(rows, is_cartesian=True))
    worst = 0.0
    for k in range(1, 1000):
        q = plan.segment.sample(k * plan.segment.duration_s / 1000)
        x, y, z = ARM.forward_tcp(q, T_FLANGE_TCP)[9:]
        x0, y0, z0, *_ = tcp_pose(Q_WORK)
        worst = max(worst, abs(((x - x0 + 0.05) ** 2 + (y - y0) ** 2) ** 0.5 - 0.05), abs(z - z0))
    # Between the points too, although the joints are interpolated there.
    assert worst < 1e-7
    assert ARM.forward_tcp(plan.segment.q_end, T_FLANGE_TCP) == pytest.approx(transform_from_pose(rows[-1]), abs=1e-9)


def test_poses_in_a_part_frame_are_the_same_as_in_the_base_frame() -> None:
    frame = (0.3, -0.2, 0.1, 0.2, -0.4, 0.9)
    T_part_base = inverse(transform_from_pose(frame))
    rows = circle(50)
    inside = [pose_from_transform(compose(T_part_base, transform_from_pose(row))) for row in rows]
    plain = planned(file_of(rows, is_cartesian=True)).segment
    framed = planned(file_of(inside, is_cartesian=True, frame=frame)).segment
    assert framed.duration_s == pytest.approx(plain.duration_s, abs=1e-9)
    for k in range(20):
        assert framed.sample(k * 0.01) == pytest.approx(plain.sample(k * 0.01), abs=1e-9)


def test_joints_stay_on_their_turn() -> None:
    q_start = six((*Q_WORK[:5], Q_WORK[5] - FULL_TURN))
    segment = planned(file_of(circle(50), is_cartesian=True), q_start).segment
    assert segment.q_start == q_start
    assert abs(segment.q_end[5] - q_start[5]) < 0.5


def test_part_of_a_file() -> None:
    rows = wave(100)
    segment = planned(file_of(rows), rows[19], first=20, last=60).segment
    assert (segment.q_start, segment.q_end) == (rows[19], rows[59])
    assert 40 * H < segment.duration_s < 40 * H + 0.03


def test_a_start_a_little_aside_is_made_up_for() -> None:
    rows = wave(100)
    q_start = six(q + offset for q, offset in zip(rows[0], (0.0, 0.004, -0.008, 0.0, 0.001, 0.0), strict=True))
    segment = planned(file_of(rows), q_start).segment
    exact = planned(file_of(rows)).segment
    lead_s = 2.0 * (0.008 / 1.4) ** 0.5
    assert segment.q_start == q_start
    assert segment.duration_s == pytest.approx(exact.duration_s + lead_s)
    assert segment.sample(lead_s) == pytest.approx(rows[0], abs=1e-9)
    assert segment.sample_speed(lead_s) == pytest.approx((0.0,) * 6, abs=1e-6)
    for t_s in (0.05, 0.2):
        assert segment.sample(lead_s + t_s) == pytest.approx(exact.sample(t_s), abs=1e-9)
    assert segment.q_end == rows[-1]


def test_rounding_of_the_start_takes_no_time() -> None:
    rows = wave(100)
    q_start = six(q + 5e-10 for q in rows[0])
    segment = planned(file_of(rows), q_start).segment
    assert segment.q_start == segment.sample(0.0) == q_start
    assert segment.duration_s == pytest.approx(planned(file_of(rows)).segment.duration_s, abs=1e-6)


def test_one_point_is_a_small_move_or_none() -> None:
    file = file_of(wave(10))
    assert planned(file, first=1, last=1).segment.duration_s == 0.0
    aside = six(q + 0.005 for q in Q_WORK)
    segment = planned(file, aside, first=1, last=1).segment
    assert (segment.q_start, segment.q_end) == (aside, Q_WORK)
    assert segment.duration_s > 0.0


def test_away_from_the_first_point_it_is_refused_with_the_way_there() -> None:
    rows = wave(100)
    error = refused(file_of(rows), six((*Q_WORK[:2], Q_WORK[2] + 1.01 * START_TOLERANCE_RAD, *Q_WORK[3:])))
    assert error.code == "R116"
    assert "line 1 of path.txt: joint elbow is 0.0101 rad away" in str(error)
    assert "mm" in str(error)
    assert "get_micro_line_values_by_index(index, 0, 1)" in (error.hint or "")
    far = refused(file_of(circle(10), is_cartesian=True), six((Q_WORK[0] + 0.3, *Q_WORK[1:])), first=3)
    assert far.code == "R116"
    assert "index, 0, 3)" in (far.hint or "")
    beyond = [shifted(Q_WORK, 0.001 * k) for k in range(600)]
    assert refused(file_of(beyond, is_cartesian=True), six((Q_WORK[0] + 0.3, *Q_WORK[1:]))).code == "R116"


def test_points_too_fast_are_played_more_slowly_and_said_so() -> None:
    rows = wave(400, size=0.5, rate=12.0)
    plan = planned(file_of(rows, file_lines=[k + 3 for k in range(400)]))
    (note,) = plan.notes
    assert "path.txt come faster than the arm can move: behind point " in note.text
    assert " of path.txt) joint " in note.text
    assert "rad/s; it can" in note.text
    assert plan.segment.duration_s > 1.5 * 399 * H
    largest = [0.0] * 6
    for k in range(3000):
        qd = plan.segment.sample_speed(k * plan.segment.duration_s / 3000)
        largest = [max(a, abs(b)) for a, b in zip(largest, qd, strict=True)]
    assert all(speed <= limit * (1.0 + 1e-9) for speed, limit in zip(largest, LIMITS.qd_max, strict=True))


def test_a_jump_of_joint_points_is_located() -> None:
    rows = wave(100)
    rows[50] = six((*rows[50][:3], rows[50][3] + 0.5, *rows[50][4:]))
    error = refused(file_of(rows))
    assert error.code == "R117"
    assert "from line 50 of path.txt to the next point joint wrist1 would jump by 0.5" in str(error)
    assert error.unit == "rad"


def test_the_first_jump_is_the_one_reported() -> None:
    rows = wave(100)
    rows[70] = six((rows[70][0] + 1.0, *rows[70][1:]))
    rows[30] = six((*rows[30][:5], rows[30][5] + 1.0))
    assert "from line 30 of" in str(refused(file_of(rows)))


def test_a_jump_of_poses_is_located() -> None:
    rows = circle(100)
    rows[40] = six((rows[40][0] + 0.1, *rows[40][1:]))
    error = refused(file_of(rows, is_cartesian=True))
    assert error.code == "R117"
    assert "from line 40 of path.txt" in str(error)


def test_slow_intervals_allow_wide_steps_of_joints() -> None:
    rows = [six((Q_WORK[0] + 0.8 * k, *Q_WORK[1:])) for k in range(4)]
    segment = planned(file_of(rows, interval_s=1.0)).segment
    assert segment.duration_s == pytest.approx(3.0 + 0.8 / 40.0)


def test_a_joint_outside_its_range_is_located() -> None:
    rows = [six((*Q_WORK[:5], 6.2 + 0.001 * k)) for k in range(200)]
    error = refused(file_of(rows, file_lines=[k + 2 for k in range(200)]), rows[0])
    assert error.code == "R110"
    assert "at point 85 (line 86 of path.txt), joint wrist3 would be at 6.284" in str(error)


def test_degrees_taken_for_rad_are_recognised() -> None:
    error = refused(file_of([six(57.3 * q for q in row) for row in wave(10)]))
    assert error.code == "R110"
    assert "unit_type 1" in (error.hint or "")


def test_a_curve_that_leaves_the_range_between_points_is_refused() -> None:
    top = LIMITS.q_max[5]
    rows = [six((*Q_WORK[:5], top - (1e-3 if k < 40 or k > 41 else 0.0))) for k in range(80)]
    error = refused(file_of(rows, interval_s=0.1), rows[0])
    assert error.code == "R110"
    assert "behind line 41 of path.txt, joint wrist3" in str(error)
    within = [six((*Q_WORK[:5], top - 1e-3 + 1e-3 * sin(0.05 * k))) for k in range(31)]
    assert planned(file_of(within), within[0]).notes == ()


def test_a_pose_out_of_reach_is_located() -> None:
    rows = [shifted(Q_WORK, 0.001 * k) for k in range(600)]
    error = refused(file_of(rows, is_cartesian=True))
    assert error.code == "R111"
    assert "line 320 of path.txt is out of reach: the arm would have to change" in str(error)
    error = refused(file_of([*circle(4), shifted(Q_WORK, 1.0)], is_cartesian=True))
    assert error.code == "R111"
    assert "line 5 of path.txt is out of reach: too far by" in str(error)


def test_millimetres_taken_for_metres_are_recognised() -> None:
    rows = [six((*(1000.0 * x for x in row[:3]), *row[3:])) for row in circle(10)]
    assert "mm" in (refused(file_of(rows, is_cartesian=True)).hint or "")


@pytest.mark.parametrize("nearest_sine", [0.0, 0.0005, 0.002])
def test_points_through_a_singularity_are_refused(nearest_sine: float) -> None:
    q_start, request = wrist_passage(nearest_sine)
    start = tcp_pose(q_start)
    rows = [six(a + (b - a) * k / 400 for a, b in zip(start, request.p_target, strict=True)) for k in range(401)]
    error = refused(file_of(rows, is_cartesian=True), q_start)
    assert error.code == "R112"
    # The middle of the line is at point 201.
    number = int(str(error).partition("line ")[2].partition(" of path.txt")[0])
    assert abs(number - 201) <= 4


def test_tool_speed_is_that_of_the_poses() -> None:
    segment = planned(file_of(circle(100), is_cartesian=True)).segment
    assert segment.kind == "points"
    for k in range(10, 90):
        # 0.05 m at 2 rad/s.
        assert segment.tool_speed(k * H)[0] == pytest.approx(0.1, rel=1e-4)


def test_samples_do_not_depend_on_the_order() -> None:
    segment = planned(file_of(wave(100))).segment
    times = [segment.duration_s * k / 57 for k in range(58)]
    in_order = {t_s: segment.setpoint(t_s) for t_s in times}
    Random(5).shuffle(times)
    assert {t_s: segment.setpoint(t_s) for t_s in times} == in_order
    assert segment.setpoint(-1.0) == Setpoint(segment.q_start, (0.0,) * 6)


SHAPES: dict[str, Callable[[Random, float, int], float]] = {
    "swing": lambda chance, t, j: 0.3 * sin((2.0 + j) * t),
    "turn": lambda chance, t, j: 0.4 * t,
    "rough": lambda chance, t, j: 0.2 * t + chance.uniform(-1e-4, 1e-4),
    "dwell": lambda chance, t, j: 0.3 * max(0.0, t - 0.3) ** 2,
    "corner": lambda chance, t, j: 0.5 * abs(t - 0.25),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("interval_s", [0.002, 0.004, 0.02])
@pytest.mark.parametrize("seed", range(3))
def test_limits_and_continuity_of_whole_moves(shape: str, interval_s: float, seed: int) -> None:
    chance = Random(f"{shape} {interval_s} {seed}")
    limits = limits_of("CS66", qd_max=(chance.uniform(0.3, 3.0),) * 6, qdd_max=(chance.uniform(5.0, 40.0),) * 6)
    function = SHAPES[shape]
    rows = [six(q + function(chance, k * interval_s, j) for j, q in enumerate(Q_WORK)) for k in range(80)]
    q_start = six(q + chance.choice((0.0, 0.003)) for q in rows[0])
    request = MoveML(file_of(rows, interval_s=interval_s), 1, 80, 1.4, 1.05)
    segment = plan_moveml(ARM, limits, q_start, T_FLANGE_TCP, request).segment
    steps = 2500
    d = segment.duration_s / steps
    before = segment.setpoint(0.0)
    assert before == Setpoint(q_start, (0.0,) * 6)
    for k in range(1, steps + 1):
        now = segment.setpoint(k * d)
        for joint in range(6):
            assert abs(now.qd[joint]) <= limits.qd_max[joint] * (1.0 + 1e-9)
            assert abs(now.qd[joint] - before.qd[joint]) <= limits.qdd_max[joint] * d * (1.0 + 1e-6) + 1e-11
            mean = 0.5 * (now.qd[joint] + before.qd[joint])
            assert abs(now.q[joint] - before.q[joint] - mean * d) <= limits.qdd_max[joint] * d * d
        before = now
    assert largest_difference(before.q, rows[-1]) < 1e-9
    assert segment.setpoint(segment.duration_s) == Setpoint(rows[-1], (0.0,) * 6)


@pytest.mark.invariants
@pytest.mark.parametrize("frame", [(0.0,) * 6, (-0.0,) * 6, (0.1, -0.2, 0.05, 0.3, -0.1, 0.2)])
@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_poses_are_solved_to_the_last_bit_as_one_by_one(frame: Six, tilt: float) -> None:
    chance = Random(f"{frame} {tilt}")
    T_base_part = transform_from_pose(frame)
    solved, count = 0, max(3 * CASES, 120)
    for _ in range(count):
        # The tool straight down: many elements of its rotation are nearly or exactly 0 then.
        T_flange_tcp = chance.choice((T_FLANGE_TCP, transform_from_pose((0.0, 0.0, 0.15, 0.0, 0.0, 0.0))))
        place = [chance.gauss(mean, 0.1) for mean in (-0.1, -0.6, 0.1)]
        start = six((*place, chance.choice((pi, 0.0)), 0.0, chance.choice((0.0, 0.5 * pi, 1.0))))
        amounts = [chance.uniform(-0.02, 0.02) * (1.0 if axis < 3 else tilt) for axis in range(6)]
        rows = [six(a + d * k for a, d in zip(start, amounts, strict=True)) for k in range(6)]
        wanted: list[Six] = []
        for row in rows:
            T_base_flange = compose(compose(T_base_part, transform_from_pose(row)), inverse(T_flange_tcp))
            near = wanted[-1] if wanted else six([0.0] * 6)
            q = solve_branch(ARM, T_base_flange, 0, near[5])
            if q is None or singularity(ARM, q).blocked:
                break
            wanted.append(six(a + FULL_TURN * round((n - a) / FULL_TURN) for a, n in zip(q, near, strict=True)))
        if len(wanted) < len(rows):
            continue
        solved += 1
        request = MoveML(file_of(rows, is_cartesian=True, frame=frame), 1, len(rows), 1.4, 1.05)
        found = _solved(ARM, LIMITS, wanted[0], T_flange_tcp, request)
        assert [[angle.hex() for angle in column] for column in found] == [
            [q[joint].hex() for q in wanted] for joint in range(6)
        ]
    assert solved > count // 6
