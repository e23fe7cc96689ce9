"""The figures of docs/explanation/motion.md on chains of points, corrections of the motion, and the plant."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import cos, pi, sin, sqrt
from typing import Final

from elitescript import PlantConfig, VirtualRobot
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.views.trace import TraceRow
from elitescript.devices.memory import MemoryEnvironment
from elitescript.models.model import load_model
from elitescript.plotting.curves import tcp_speeds
from tools.motion_runs import HOME, MODEL, program, times_of, traced
from tools.svg_chart import Curve, Panel, drawing

PLANTS: Final = {
    "lag 20 ms": PlantConfig(lag_s=0.02),
    "lag 50 ms": PlantConfig(lag_s=0.05),
    "lag 50 ms, friction": PlantConfig(lag_s=0.05, coulomb_friction=0.1, viscous_friction=0.2),
}
"""Plants that figure and table show."""

TURN: Final = program("sleep(0.1)", f"movej({[1.2, *HOME[1:]]}, a=3, v=1)", "sleep(0.8)")


def plant_rows(plant: PlantConfig) -> list[TraceRow]:
    """A move of the base joint over 1.2 rad with a plant."""
    return traced(TURN, robot=VirtualRobot(MODEL, joints=HOME, plant=plant))


def tracking_errors(rows: list[TraceRow]) -> list[float]:
    """Target less actual of the base joint, rad."""
    return [row.q[0] - (row.q if row.q_actual is None else row.q_actual)[0] for row in rows]


def plant() -> str:
    """Target, actual and the difference for several plants."""
    positions, errors = [], []
    for colour, (name, config) in enumerate(PLANTS.items()):
        rows = plant_rows(config)
        times = times_of(rows)
        if not colour:
            positions.append(Curve("target", times, [row.q[0] for row in rows], 3, True))
        positions.append(Curve(name, times, [(row.q_actual or row.q)[0] for row in rows], colour))
        errors.append(Curve(name, times, [1e3 * error for error in tracking_errors(rows)], colour))
    return drawing(
        "movej over 1.2 rad with a = 3, v = 1, and three plants",
        (Panel("base, rad", tuple(positions)), Panel("behind, mrad", tuple(errors))),
    )


POINT_FILE_S: Final = 0.8
"""What the file of the figure is to last."""
POINTS_INTERVAL_S: Final = 0.02


def points() -> str:
    """A file of points that asks for more than a joint can do in its middle."""
    count = round(POINT_FILE_S / POINTS_INTERVAL_S)
    times = [POINTS_INTERVAL_S * index for index in range(count + 1)]
    angles = [0.8 * (1.0 - cos(pi * time / POINT_FILE_S)) for time in times]
    text = "".join(f"{angle} {' '.join(map(str, HOME[1:]))}\n" for angle in angles)
    robot = VirtualRobot(MODEL, joints=HOME, world=MemoryEnvironment({"turn.txt": text.encode()}))
    rows = traced(program('line = load_micro_line_file("turn.txt", 20)', "moveml(line)", "sleep(0.1)"), robot=robot)
    asked = [0.8 * pi / POINT_FILE_S * sin(pi * time / POINT_FILE_S) for time in times]
    limit = load_model(MODEL).joints[0].qd_max
    row_times = times_of(rows)
    return drawing(
        "moveml: a file of 0.8 s whose middle is too fast for the base joint",
        (
            Panel(
                "q, rad",
                (
                    Curve("file", times, angles, 1, True),
                    Curve("base", row_times, [row.q[0] for row in rows]),
                ),
            ),
            Panel(
                "qd, rad/s",
                (Curve("file", times, asked, 1, True), Curve("base", row_times, [row.qd[0] for row in rows])),
                (limit,),
            ),
        ),
    )


BELT: Final = program(
    "encoder_enable_pulse_decode(0, 1, 16, 17)",
    "sleep(0.1)",
    "track_conveyor_linear([0, 1, 0, 0, 0, 0], 10000, 0)",
    "sleep(1.4)",
    "stop_conveyor_tracking()",
    "sleep(0.1)",
)


def belt() -> str:
    """A tool that catches up with a belt, which then changes its speed, and leaves it."""
    robot = VirtualRobot(MODEL, joints=HOME)
    robot.signals["encoder_speed[0]"] = 1000
    rows = traced(BELT, robot=robot, meanwhile=((0.9, lambda robot: _belt_speed(robot, 2000)),))
    times = times_of(rows)
    # The way of the belt counts from the call at 0.1 s.
    speeds = [0.1 if time <= 0.9 else 0.2 for time in times]
    ways = [0.1 * (min(time, 0.9) - 0.1) + 0.2 * max(0.0, time - 0.9) for time in times]
    start = rows[0].tcp_pose[1]
    tool = tcp_speeds(rows)
    last = next(index for index, time in enumerate(times) if time > 1.494)
    behind = [
        1e3 * (way - (row.tcp_pose[1] - start)) if way > 0.0 else 0.0 for way, row in zip(ways, rows, strict=True)
    ]
    return drawing(
        "track_conveyor_linear at 0.1 s; the belt goes from 0.1 to 0.2 m/s at 0.9 s; stop at 1.5 s",
        (
            Panel("m/s", (Curve("belt", times, speeds, 1, True), Curve("tool", times, tool))),
            Panel("tool behind, mm", (Curve("tool", times[:last], behind[:last]),), (), 110),
        ),
    )


def _belt_speed(robot: VirtualRobot, counts_per_s: float) -> None:
    robot.signals["encoder_speed[0]"] = counts_per_s


def path_offsets() -> str:
    """A step of an offset, with and without a filter."""
    steps, speeds = [], []
    for colour, alpha in enumerate((1.0, 0.1)):
        rows = traced(
            program(
                "path_offset_enable()",
                f"path_offset_set_alpha_filter({alpha})",
                "sleep(0.02)",
                "path_offset_set([0, 0, 0.005, 0, 0, 0], 1)",
                "sleep(0.3)",
            )
        )
        rows = [row for row in rows if row.t <= 0.25]
        name, times, start = f"alpha {alpha:g}", times_of(rows), rows[0].tcp_pose[2]
        steps.append(Curve(name, times, [1e3 * (row.tcp_pose[2] - start) for row in rows], colour))
        speeds.append(Curve(name, times, tcp_speeds(rows), colour))
    return drawing(
        "An offset of 5 mm that is set at 0.02 s",
        (
            Panel("mm", tuple(steps), (5.0,), 150, "offset"),
            Panel("TCP, m/s", tuple(speeds), (), 110),
        ),
    )


def weaving() -> str:
    """A thread that weaves across a line."""
    rows = traced(
        program(
            "def weave():",
            "  k = 0",
            "  while True:",
            "    k = k + 1",
            "    path_offset_set([0, 0.003 * sin(0.04 * k), 0, 0, 0, 0], 3)",
            "    sync()",
            "  end",
            "end",
            "path_offset_enable()",
            "p = get_target_tcp_pose()",
            "p[1] = p[1] + 0.06",
            "start_thread(weave, ())",
            "movel(p, a=1.2, v=0.02)",
        )
    )
    times, (x0, y0) = times_of(rows), rows[0].tcp_pose[:2]
    return drawing(
        "Weaving by 3 mm across a movel at 0.02 m/s, in the frame of motion",
        (
            Panel("along, mm", (Curve("TCP", times, [1e3 * (row.tcp_pose[1] - y0) for row in rows]),), (), 110),
            Panel("across, mm", (Curve("TCP", times, [1e3 * (x0 - row.tcp_pose[0]) for row in rows]),), (), 110),
        ),
    )


SURFACE_DEPTH_M: Final = 0.005
STIFFNESSES: Final = (1e3, 1e4, 1e5)
PRESS_N: Final = 20.0


def pressed(stiffness: float, scaling: float, duration_s: float) -> tuple[list[float], list[float]]:
    """Times and force on a surface below the tool, N, of pressing from above at 0.02 m/s."""
    height = load_model(MODEL).arm.forward(HOME)[11]
    plane = Plane((0.0, 0.0, height - SURFACE_DEPTH_M), (0.0, 0.0, 1.0), stiffness)
    robot = VirtualRobot(MODEL, joints=HOME, contact=ContactConfig((plane,)))
    rows = traced(
        program(
            f"force_mode_set_gain_scaling({scaling})",
            "limits = [0.02, 0.02, 0.02, 0.5, 0.5, 0.5]",
            f"force_mode([0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [0, 0, {-PRESS_N}, 0, 0, 0], 0, limits)",
            f"sleep({duration_s})",
        ),
        robot=robot,
    )
    rows = [row for row in rows if row.t < duration_s]
    forces = [max(0.0, stiffness * (height - SURFACE_DEPTH_M - row.tcp_pose[2])) for row in rows]
    return times_of(rows), forces


def force() -> str:
    """Coming down on surfaces of three stiffnesses, and with three gains on the hardest."""
    surfaces, gains = [], []
    for colour, stiffness in enumerate(STIFFNESSES):
        surfaces.append(Curve(f"{stiffness:g} N/m", *pressed(stiffness, 0.2, 1.0), colour))
    for colour, scaling in enumerate((0.1, 0.2, 0.5)):
        times, forces = pressed(1e5, scaling, 1.0)
        gains.append(Curve(f"scaling {scaling:g}", times, forces, colour))
    return drawing(
        "force_mode: 20 N downwards, from 5 mm above a surface, at most 0.02 m/s",
        (
            Panel("N: scaling 0.2", tuple(surfaces), (PRESS_N,), level="target"),
            Panel("N: 1e5 N/m", tuple(gains), (PRESS_N,), level="target"),
        ),
    )


RADII: Final = (0.0, 0.01, 0.04)


def blend_rows(radius: float) -> list[TraceRow]:
    """Two lines of 0.1 m at a right angle, blended."""
    return traced(
        program(
            "p = get_target_tcp_pose()",
            "h = 0.1 / sqrt(2)",
            f"movel([p[0] + h, p[1] + h, p[2], p[3], p[4], p[5]], a=1.2, v=0.25, r={radius})",
            "movel([p[0] + 2 * h, p[1], p[2], p[3], p[4], p[5]], a=1.2, v=0.25)",
        )
    )


def blend_speeds() -> str:
    """The speed of the tool round a corner, with three radii."""
    curves = []
    for colour, radius in enumerate(RADII):
        rows = blend_rows(radius)
        curves.append(Curve(f"r = {1e3 * radius:g} mm", times_of(rows), tcp_speeds(rows), colour))
    return drawing(
        "movel, movel: two lines of 0.1 m at a right angle, a = 1.2, v = 0.25", (Panel("tool, m/s", tuple(curves)),)
    )


def blend_paths() -> str:
    """The way of the tool round the corner, seen from above."""
    curves = []
    for colour, radius in enumerate(RADII):
        rows = blend_rows(radius)
        x0, y0, *_ = rows[0].tcp_pose
        moving = [row for row, later in pairwise(rows) if later.tcp_pose[0] > row.tcp_pose[0] + 1e-9]
        places = [(1e3 * (row.tcp_pose[0] - x0), 1e3 * (row.tcp_pose[1] - y0)) for row in moving]
        near = [(x, y) for x, y in places if abs(x - 100.0 / sqrt(2.0)) < 35.0]
        curves.append(Curve(f"r = {1e3 * radius:g} mm", [x for x, _ in near], [y for _, y in near], colour))
    return drawing("The same corner from above", (Panel("y, mm", tuple(curves), (), 300),), "x, mm")


FIGURES: Final[dict[str, Callable[[], str]]] = {
    "belt.svg": belt,
    "path-offset.svg": path_offsets,
    "weaving.svg": weaving,
    "force.svg": force,
    "blend-path.svg": blend_paths,
    "blend-speed.svg": blend_speeds,
    "points.svg": points,
    "plant.svg": plant,
}
"""File name and what draws it."""
