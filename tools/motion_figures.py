"""The figures of docs/explanation/motion.md: each one a run, or several, as a chart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Final

from elitescript import VirtualRobot
from elitescript.controller.views.trace import TraceRow
from elitescript.models.model import load_model
from elitescript.plotting.curves import accelerations
from tools.motion_runs import (
    GAINS,
    HOME,
    LOOKAHEADS_S,
    MODEL,
    ServoFigures,
    following,
    program,
    servo_figures,
    times_of,
    tool_speeds,
    traced,
)
from tools.svg_chart import Curve, Panel, drawing

BEFORE_WRIST: Final = (0.5235, -1.6834, -1.1633, -3.3019, 0.2255, 1.6396)
"""Start of a line of 0.2 m that passes the wrist singularity at sin q5 = 0.03, rad."""
BEHIND_WRIST: Final = (0.5364, -0.1894, 0.6019, -1.7207, -1.3686, -2.6947)
"""Its end, m and rad."""


@cache
def servo_table() -> tuple[ServoFigures, ...]:
    """All measured pairs of look-ahead time and gain."""
    return tuple(servo_figures(lookahead_s, gain) for lookahead_s in LOOKAHEADS_S for gain in GAINS)


def _joint(rows: Sequence[TraceRow], joint: int) -> list[float]:
    return [row.q[joint] for row in rows]


def _speed(rows: Sequence[TraceRow], joint: int) -> list[float]:
    return [row.qd[joint] for row in rows]


def _moved(radians: float) -> list[float]:
    return [radians, *HOME[1:]]


def trapezoids() -> str:
    """A long move, one too short to reach its speed, and one of a given duration."""
    rows = traced(
        program(
            "sleep(0.1)",
            f"movej({_moved(1.5)}, a=1.4, v=1.05)",
            "sleep(0.2)",
            f"movej({_moved(1.1)}, a=1.4, v=1.05)",
            "sleep(0.2)",
            f"movej({_moved(0.0)}, t=2)",
            "sleep(0.1)",
        )
    )
    times, speeds = times_of(rows), _speed(rows, 0)
    return drawing(
        "movej: 1.5 rad and 0.4 rad with a = 1.4, v = 1.05; 1.1 rad with t = 2",
        (
            Panel("q, rad", (Curve("base", times, _joint(rows, 0)),)),
            Panel("qd, rad/s", (Curve("base", times, speeds, 1),), (-1.05, 1.05), level="v"),
            Panel("qdd, rad/s^2", (Curve("base", times, accelerations(times, speeds), 2),), (-1.4, 1.4), 120, "a"),
        ),
    )


def speed_percentage() -> str:
    """The slider, a pause and its end in the middle of a move."""
    move = program("sleep(0.1)", f"movej({_moved(1.8)}, a=1.4, v=1.05)")
    asked = traced(move)
    rows = traced(
        move,
        meanwhile=(
            (0.6, lambda robot: robot.set_speed(0.3)),
            (1.6, lambda robot: robot.set_speed(1.0)),
            (2.2, VirtualRobot.pause),
            (2.8, VirtualRobot.resume),
        ),
    )
    return drawing(
        "Slider to 30 % at 0.6 s and back at 1.6 s, pause from 2.2 to 2.8 s",
        (
            Panel(
                "q, rad",
                (
                    Curve("undisturbed", times_of(asked), _joint(asked, 0), 1, True),
                    Curve("base", times_of(rows), _joint(rows, 0)),
                ),
            ),
            Panel(
                "qd, rad/s",
                (
                    Curve("undisturbed", times_of(asked), _speed(asked, 0), 1, True),
                    Curve("base", times_of(rows), _speed(rows, 0)),
                ),
            ),
        ),
    )


STOPS: Final = ("stopj(8)", "stopj(2)", "stopl(3)", "stopl(0.8)")


def stops() -> str:
    """Four stop commands in the middle of a line, and what the base joint does."""
    arm = load_model(MODEL).arm
    curves, joints = [], []
    for colour, stop in enumerate(STOPS):
        rows = traced(
            program(
                "p = get_target_tcp_pose()",
                "p[1] = p[1] + 0.3",
                "def brake():",
                "  sleep(0.5)",
                f"  {stop}",
                "end",
                "start_thread(brake, ())",
                "movel(p, a=1.2, v=0.25)",
                "sleep(0.2)",
            )
        )
        rows = [row for row in rows if 0.4 <= row.t <= 0.9]
        curves.append(Curve(stop, times_of(rows), tool_speeds(arm, rows), colour))
        joints.append(Curve(stop, times_of(rows), _speed(rows, 0), colour))
    return drawing(
        "Stops at 0.5 s in a movel at 0.25 m/s",
        (Panel("flange, m/s", tuple(curves)), Panel("base, rad/s", tuple(joints))),
    )


def handovers() -> str:
    """speedj, speedl, servoj and stopj, each taking over from the one before."""
    rows = traced(
        program(
            "speedj([0.6, 0, 0, 0, 0, 0], 2, 0.6)",
            "speedl([0, -0.2, 0, 0, 0, 0], 0.8, 0.8)",
            "q = get_target_joint_positions()",
            "for n in range(150):",
            "  q[0] = q[0] + 0.002",
            "  servoj(q, t=0.004, lookahead_time=0.1, gain=300)",
            "end",
            "stopj(4)",
        )
    )
    times = times_of(rows)
    return drawing(
        "speedj, at 0.6 s speedl, at 1.4 s a stream of servoj, at 2.0 s stopj",
        (
            Panel("q, rad", (Curve("base", times, _joint(rows, 0)),), (), 120),
            Panel(
                "qd, rad/s",
                tuple(
                    Curve(name, times, _speed(rows, joint), joint)
                    for joint, name in enumerate(("base", "shoulder", "elbow"))
                ),
            ),
        ),
    )


def singularity() -> str:
    """A line past the wrist singularity: what was asked for, and what the joints allow."""
    model = load_model(MODEL)
    robot = VirtualRobot(MODEL, joints=BEFORE_WRIST)
    rows = traced(program(f"movel({list(BEHIND_WRIST)}, a=1.2, v=0.25)"), robot=robot)
    times = times_of(rows)
    ramp_s, cruise_s = 0.25 / 1.2, 0.2 / 0.25 - 0.25 / 1.2
    corners = [0.0, ramp_s, ramp_s + cruise_s, 2.0 * ramp_s + cruise_s]
    limit = model.joints[3].qd_max
    return drawing(
        "movel over 0.2 m past the wrist singularity, at sin q5 = 0.03",
        (
            Panel(
                "tool, m/s",
                (
                    Curve("asked for", corners, [0.0, 0.25, 0.25, 0.0], 1, True),
                    Curve("tool", times, tool_speeds(model.arm, rows)),
                ),
            ),
            Panel(
                "qd, rad/s",
                (Curve("wrist 1", times, _speed(rows, 3), 3), Curve("wrist 3", times, _speed(rows, 5), 5)),
                (-limit, limit),
            ),
        ),
    )


def servo_step() -> str:
    """A step of 0.1 rad with several look-ahead times and gains."""
    return drawing(
        "servoj: a step of 0.1 rad",
        (
            Panel("q, rad: gain 300", tuple(_steps((0.03, 0.1, 0.2), (300,)))),
            Panel("q, rad: look-ahead 0.1 s", tuple(_steps((0.1,), GAINS))),
        ),
        "time since the first target, s",
    )


def _steps(lookaheads_s: Sequence[float], gains: Sequence[int]) -> list[Curve]:
    curves = []
    for lookahead_s in lookaheads_s:
        for gain in gains:
            run = following(lambda t: 0.1, 0.5, lookahead_s, gain)
            end = next(index for index, time in enumerate(run.times) if time >= 0.5)
            label = f"{lookahead_s:g} s" if len(gains) == 1 else f"gain {gain}"
            curves.append(Curve(label, run.times[:end], run.q[:end], len(curves)))
    return curves


def servo_ramp() -> str:
    """A ramp of 0.5 rad/s that ends, with several look-ahead times."""
    curves = []
    speeds = []
    for colour, lookahead_s in enumerate((0.03, 0.1, 0.2)):
        run = following(lambda t: 0.5 * t, 0.5, lookahead_s, 300)
        end = next(index for index, time in enumerate(run.times) if time >= 1.0)
        if not colour:
            curves.append(Curve("stream", run.times[:end], run.asked[:end], 3, True))
        curves.append(Curve(f"{lookahead_s:g} s", run.times[:end], run.q[:end], colour))
        speeds.append(Curve(f"{lookahead_s:g} s", run.times[:end], run.qd[:end], colour))
    return drawing(
        "servoj with gain 300: a ramp of 0.5 rad/s that ends after 0.5 s",
        (Panel("q, rad", tuple(curves)), Panel("qd, rad/s", tuple(speeds))),
        "time since the first target, s",
    )


def servo_lag() -> str:
    """Lag behind a ramp against look-ahead time and gain."""
    curves = []
    for colour, gain in enumerate(GAINS):
        lags_s = [row.ramp_lag_s for row in servo_table() if row.gain == gain]
        curves.append(Curve(f"gain {gain}", LOOKAHEADS_S, lags_s, colour))
    return drawing(
        "servoj: lag behind a ramp of 0.5 rad/s", (Panel("lag, s", tuple(curves), (), 220),), "look-ahead time, s"
    )


def circle_speed() -> str:
    """Half a circle with the tool held to the path, and turned evenly."""
    curves = []
    turns = []
    for colour, (mode, name) in enumerate(((0, "mode 0"), (1, "mode 1"))):
        rows = traced(
            program(
                "p = get_target_tcp_pose()",
                "via = p.copy()",
                "to = p.copy()",
                "via[0] = p[0] - 0.05",
                "via[1] = p[1] + 0.05",
                "to[1] = p[1] + 0.1",
                f"movec(via, to, a=0.8, v=0.15, mode={mode})",
            )
        )
        times = times_of(rows)
        curves.append(Curve(name, times, tool_speeds(load_model(MODEL).arm, rows), colour))
        turns.append(Curve(name, times, _joint(rows, 5), colour))
    return drawing(
        "movec: half a circle of 0.05 m radius, a = 0.8, v = 0.15",
        (Panel("flange, m/s", tuple(curves)), Panel("wrist 3, rad", tuple(turns))),
    )


FIGURES: Final[dict[str, Callable[[], str]]] = {
    "trapezoids.svg": trapezoids,
    "circle.svg": circle_speed,
    "singularity.svg": singularity,
    "speed-percentage.svg": speed_percentage,
    "stops.svg": stops,
    "handovers.svg": handovers,
    "servo-step.svg": servo_step,
    "servo-ramp.svg": servo_ramp,
    "servo-lag.svg": servo_lag,
}
"""File name and what draws it."""
