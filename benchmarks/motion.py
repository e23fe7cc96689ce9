"""Planning and sampling one move, one period of a drive, whole paths and looking for contacts; against other packages.

Ruckig finds time laws only: it knows no path in Cartesian space, no inverse kinematics and no
singularities; compare it with `movej`. The Robotics Toolbox interpolates poses and solves each
of them numerically; its time for a line of fifty poses stands beside planning and sampling ours
fifty times.
"""

from __future__ import annotations

from functools import partial
from importlib.util import find_spec
from io import BytesIO
from math import inf, pi, sin
from typing import Any

from benchmarks.kinematics import Calls, compared
from benchmarks.measure import ROOT, best_in_turn, best_of_calls, least, time_of
from benchmarks.table import Row, not_installed, print_rows, timed_row
from elitescript import VirtualRobot
from elitescript.commands.micro_file import read_points
from elitescript.kinematics.transforms import Transform, pose_from_transform, transform_from_pose
from elitescript.messages.motion import MicroLine, MoveC, MoveJ, MoveL, MoveML, Six
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import RobotModel, load_model
from elitescript.motion.limits import MotionLimits
from elitescript.motion.microline import plan_moveml
from elitescript.motion.planner import Plan, plan_movec, plan_movej, plan_movel
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.servo import begun, followed
from elitescript.motion.streaming.speed import Obstacle, accelerated
from elitescript.motion.streaming.twist import ToolMotion, TwistState

Q_START: Six = (0.3, -1.5, -1.6, -1.5, 1.5, 0.2)
Q_END: Six = (1.0, -1.0, -1.2, -1.6, 1.2, 0.3)
Q_NEAR_WRIST: Six = (0.3, -1.5, -1.6, -1.5, 0.12, 0.2)
"""A start near the wrist singularity, where joint limits bind."""
QD: Six = (0.2, -0.1, 0.3, 0.0, 0.1, -0.2)
"""Speeds from which drives begin, rad/s."""
QD_END: Six = (0.5, 0.3, -0.2, 0.1, 0.0, 0.4)
XD: Six = (0.05, -0.1, 0.02, 0.0, 0.1, 0.0)
LOOKAHEAD_TICKS = 25
GAIN = 300.0
T_FLANGE_TCP: Transform = transform_from_pose((0.0, 0.0, 0.15, 0.0, 0.0, 0.0))
POSES = 50
RUNS = 7
POINTS = 100_000


def rows() -> list[Row]:
    """Moves and drives, whole paths, point files; beside every package that has the same."""
    model = load_model("CS66")
    peers = {name: build(model) for name, build in PEERS.items() if find_spec(name)}
    table = compared(_our_calls(model), peers) + _path_rows() + _point_file_rows(model) + _contact_rows()
    return table + [not_installed(name) for name in PEERS if name not in peers]


def _point_file_rows(model: RobotModel) -> list[Row]:
    """A file of 100,000 points: read, planned as joint positions and as poses; text to numbers with numpy beside it."""
    arm, limits = model.arm, _limits(model)
    swings = [[0.2 * sin(0.0012 * k * (1.0 + 0.1 * joint)) for joint in range(6)] for k in range(POINTS)]
    x, y, z, rx, ry, rz = pose_from_transform(arm.forward_tcp(Q_START, T_FLANGE_TCP))
    rows_by_kind = {
        "joint positions": [[q + s for q, s in zip(Q_START, swing, strict=True)] for swing in swings],
        "poses": [[x + 0.5 * s[0], y + 0.5 * s[1], z, rx + s[2], ry, rz] for s in swings],
    }
    table = []
    for what, rows in rows_by_kind.items():
        is_cartesian = what == "poses"
        data = "\n".join(" ".join(f"{number:.6f}" for number in row) for row in rows).encode()

        def load(data: bytes = data, is_cartesian: bool = is_cartesian) -> tuple[bytes, bytes]:
            return read_points(data, "p", is_cartesian=is_cartesian, is_degrees=False)

        def plan(request: MoveML) -> Plan:
            return plan_moveml(arm, limits, Q_START, T_FLANGE_TCP, request)

        name = f"point file, {POINTS} {what}"
        if find_spec("numpy"):
            import numpy as np

            ours, theirs = best_in_turn([load, lambda data=data: np.loadtxt(BytesIO(data))], 3)  # type: ignore[misc]
            table.append(timed_row(f"{name}: load", ours, other=theirs.cpu_s, beside="numpy.loadtxt"))
        else:
            table.append(timed_row(f"{name}: load", best_in_turn([load], 3)[0]))
        numbers, lines = load()
        request = MoveML(MicroLine("p", 0.004, is_cartesian, numbers, lines), 1, POINTS, 1.4, 1.05)
        table.append(timed_row(f"{name}: plan", best_in_turn([partial(plan, request)], 3)[0]))
        segment = plan(request).segment
        table.append(timed_row(f"{name}: sample with speed", best_of_calls(partial(segment.setpoint, 123.4567)), "us"))
    return table


LINES = 200
LINE_M = 0.0015
PATHS = {
    "movel, r = 0.5 mm, at 20 mm/s": "movel(p, a=1.2, v=0.02, r=0.0005)",
    "movel, r = 0.5 mm, at 250 mm/s (braking too long for r)": "movel(p, a=1.2, v=0.25, r=0.0005)",
    "movel, r = 0, at 20 mm/s (stops at each)": "movel(p, a=1.2, v=0.02)",
    "movep at 6 mm/s": "movep(p, 1.2, 0.006)",
    "movep at 250 mm/s": "movep(p, 1.2, 0.25)",
}


PROGRAM = f"""def path():
  import math
  p = get_target_tcp_pose()
  for i in range({LINES}):
    p[1] += {LINE_M} * math.cos(0.01 * i)
    p[2] -= {LINE_M} * math.sin(0.01 * i)
    {{call}}
  end
end
"""


def _path_rows() -> list[Row]:
    """A program of many short lines: what it takes, and its robot time."""
    rows = []
    for what, call in PATHS.items():
        text = PROGRAM.format(call=call)
        robots = [VirtualRobot("CS66") for _ in range(RUNS)]
        best = least([time_of(lambda robot=robot: robot.run(text).check()) for robot in robots])  # type: ignore[misc]  # noqa: B023
        simulated_s = robots[0].time_s
        rows.append(timed_row(f"{LINES} lines of {LINE_M * 1e3:g} mm, {what}", best, simulated_s=simulated_s))
    return rows


CELL = ROOT / "examples/pick_and_place.toml"
SERVO_PROGRAM = """def servo():
  import math
  movej([0, -1.5708, -1.5708, -1.5708, 1.5708, 0], a=2, v=1)
  q = get_target_joint_positions()
  for i in range(30000):
    a = 0.004 * i
    servoj([0.4 * math.sin(a), q[1] + 0.1 * math.sin(1.5 * a), q[2], q[3], q[4], q[5]], t=0.004)
  end
  stopj(2)
end
"""


def _contact_rows() -> list[Row]:
    """Runs in a world with things, whose contacts are looked for, in turn with the same ones without things."""
    programs = {
        "pick and place": ((ROOT / "examples/pick_and_place.script").read_text(), RUNS),
        "servoj for two minutes": (SERVO_PROGRAM, 2),
    }
    rows = []
    for what, (text, rounds) in programs.items():
        simulated_s = [0.0, 0.0]

        def run(number: int, text: str = text, simulated_s: list[float] = simulated_s) -> None:
            robot = VirtualRobot("CS66", world=(None, CELL)[number])
            robot.run(text).check()
            simulated_s[number] = robot.time_s

        names = (f"{what}, no things", f"{what}, three things and a tool")
        times = best_in_turn([partial(run, 0), partial(run, 1)], rounds)
        for name, time, robot_s in zip(names, times, simulated_s, strict=True):
            rows.append(timed_row(name, time, simulated_s=robot_s))
    return rows


def _our_calls(model: RobotModel) -> Calls:
    arm, limits = model.arm, _limits(model)

    def pose_by(*offset: float, q: Six = Q_START) -> Six:
        x, y, z, rx, ry, rz = pose_from_transform(arm.forward_tcp(q, T_FLANGE_TCP))
        dx, dy, dz, turn = offset
        return x + dx, y + dy, z + dz, rx, ry, rz + turn

    def line(q: Six, p_target: Six, v: float = 0.25) -> Plan:
        return plan_movel(arm, limits, q, T_FLANGE_TCP, MoveL(p_target, 1.2, v))

    def arc(is_orientation_fixed: bool) -> Plan:
        request = MoveC(p_via, p_end, 1.2, 0.25, is_orientation_fixed=is_orientation_fixed)
        return plan_movec(arm, limits, Q_START, T_FLANGE_TCP, request)

    def joints() -> Plan:
        return plan_movej(arm, limits, Q_START, MoveJ(Q_END, 1.396263, 1.047197))

    def fifty() -> None:
        segment = line(Q_START, p_line).segment
        for k in range(POSES):
            segment.sample(segment.duration_s * k / (POSES - 1))

    p_line, p_turning = pose_by(0.1, 0.15, -0.08, 0.0), pose_by(0.1, 0.15, -0.08, 0.5)
    p_passing = pose_by(0.05, 0.2, -0.05, 0.0, q=Q_NEAR_WRIST)
    p_via, p_end = pose_by(0.1, 0.1, 0.0, 0.0), pose_by(0.2, 0.0, 0.0, 0.3)
    moves = {
        "movej": joints,
        "movel 0.2 m": lambda: line(Q_START, p_line),
        "movel 0.2 m, turning": lambda: line(Q_START, p_turning),
        "movel 0.2 m near a singularity": lambda: line(Q_NEAR_WRIST, p_passing, 0.5),
        "movec, half a circle of 0.1 m": lambda: arc(True),
        "movec, free orientation": lambda: arc(False),
    }
    calls: Calls = {}
    for name, plan in moves.items():
        segment = plan().segment
        middle_s = 0.5 * segment.duration_s
        calls[f"{name}: plan"] = plan
        calls[f"{name}: sample"] = lambda segment=segment, t_s=middle_s: segment.sample(t_s)
        calls[f"{name}: sample with speed"] = lambda segment=segment, t_s=middle_s: segment.setpoint(t_s)
    calls[f"movel 0.2 m: plan and {POSES} samples"] = fifty
    calls.update(_drive_calls(model, limits))
    return calls


def _drive_calls(model: RobotModel, limits: MotionLimits) -> Calls:
    start = Setpoint(Q_START, QD)
    profile = accelerated(start, QD_END, 2.0, limits)
    middle_s = 0.5 * profile.duration_s
    motion = ToolMotion(model.arm, limits, T_FLANGE_TCP, model.stop_joint_deceleration)
    moving: TwistState = motion.begin(start)
    # A stream of targets a little ahead, with a look-ahead time that is full.
    stream = begun(start)
    for _ in range(LOOKAHEAD_TICKS):
        step = followed(stream._replace(left=1), Q_END, LOOKAHEAD_TICKS, GAIN, limits)
        if isinstance(step, Obstacle):
            raise RuntimeError("the stream of this benchmark has to go on")
        stream = step._replace(left=1)
    return {
        "speedj: plan": lambda: accelerated(start, QD_END, 2.0, limits),
        "speedj: sample with speed": lambda: profile.at(middle_s),
        "speedl: one period": lambda: motion.next(moving, XD, 0.8, 0.8),
        "servoj: one period": lambda: followed(stream, Q_END, LOOKAHEAD_TICKS, GAIN, limits),
    }


def _ruckig(model: RobotModel) -> Calls:
    import ruckig

    problem = ruckig.InputParameter(6)
    problem.current_position, problem.target_position = list(Q_START), list(Q_END)
    problem.max_velocity = [joint.qd_max for joint in model.joints]
    problem.max_acceleration = [joint.qdd_max for joint in model.joints]
    problem.max_jerk = [inf] * 6
    problem.synchronization = ruckig.Synchronization.Phase
    solver, trajectory = ruckig.Ruckig(6), ruckig.Trajectory(6)
    solver.calculate(problem, trajectory)
    speeds = ruckig.InputParameter(6)
    speeds.control_interface = ruckig.ControlInterface.Velocity
    speeds.synchronization = ruckig.Synchronization.Phase
    speeds.current_position, speeds.current_velocity, speeds.target_velocity = list(Q_START), list(QD), list(QD_END)
    speeds.max_acceleration, speeds.max_jerk = [2.0] * 6, [inf] * 6
    change = ruckig.Trajectory(6)
    solver.calculate(speeds, change)
    online, answer = ruckig.Ruckig(6, PERIOD_S), ruckig.OutputParameter(6)
    following = ruckig.InputParameter(6)
    following.current_position, following.current_velocity = list(Q_START), list(QD)
    following.max_velocity, following.max_acceleration = problem.max_velocity, problem.max_acceleration
    following.max_jerk = [inf] * 6

    def period() -> None:
        # A new target each time, as a stream has it; with the same one Ruckig would not calculate again.
        following.target_position = list(Q_END if following.target_position[0] != Q_END[0] else Q_NEAR_WRIST)
        online.update(following, answer)

    return {
        "speedj: plan": lambda: solver.calculate(speeds, change),
        "speedj: sample with speed": lambda: change.at_time(0.5 * change.duration),
        "servoj: one period": period,
        "movej: plan": lambda: solver.calculate(problem, trajectory),
        "movej: sample with speed": lambda: trajectory.at_time(0.5 * trajectory.duration),
    }


def _toolbox(model: RobotModel) -> Calls:
    import numpy as np
    from roboticstoolbox import DHRobot, RevoluteDH, ctraj

    arm = model.arm
    alpha = (pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0)
    lengths = (0.0, arm.a2, arm.a3, 0.0, 0.0, 0.0)
    offsets = (arm.d1, 0.0, 0.0, arm.d4, arm.d5, arm.d6)
    links = [RevoluteDH(alpha=x, a=y, d=z) for x, y, z in zip(alpha, lengths, offsets, strict=True)]
    robot: Any = DHRobot(links)
    q_start = np.array(Q_START)
    T_start = robot.fkine(q_start)
    T_end = T_start * type(T_start).Trans(0.1, 0.15, -0.08)

    def fifty() -> None:
        q = q_start
        for T in ctraj(T_start, T_end, POSES):
            q = robot.ikine_LM(T, q0=q).q

    return {f"movel 0.2 m: plan and {POSES} samples": fifty}


def _limits(model: RobotModel) -> MotionLimits:
    def six(values: Any) -> Six:
        a, b, c, d, e, f = values
        return a, b, c, d, e, f

    joints = model.joints
    return MotionLimits(
        q_min=six(joint.q_min for joint in joints),
        q_max=six(joint.q_max for joint in joints),
        qd_max=six(joint.qd_max for joint in joints),
        qdd_max=six(joint.qdd_max for joint in joints),
        tool_speed_max=model.max_tool_speed,
        tool_acceleration_max=model.max_tool_acceleration,
        equivalent_radius_m=model.equivalent_radius_m,
    )


PEERS = {"ruckig": _ruckig, "roboticstoolbox": _toolbox}

if __name__ == "__main__":
    print_rows(rows())
