"""The programs whose motion the figures and tables of docs/explanation/motion.md show, run on a CS66.

Everything is measured at the robot's own interface: a program text goes in, the trace of every period comes out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin
from typing import Final

from elitescript import VirtualRobot
from elitescript.controller.views.trace import TraceRow
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import IDENTITY
from elitescript.messages.motion import Six
from elitescript.messages.timing import PERIOD_S

MODEL: Final = "CS66"
HOME: Final[Six] = (0.0, -pi / 2, -pi / 2, -pi / 2, pi / 2, 0.0)

LOOKAHEADS_S: Final = (0.03, 0.05, 0.1, 0.15, 0.2)
GAINS: Final = (100, 300, 1000, 2000)

RAMP: Final = 0.5
"""Speed of the ramp that a stream follows, rad/s."""
STEP: Final = 0.1
"""Step of a stream, rad."""
SINE: Final = 0.2
"""Amplitude of the sine, rad, at 1 Hz."""


def program(*lines: str) -> str:
    """A program of these lines."""
    return "\n".join(["def program():", *(f"  {line}" for line in lines), "end"]) + "\n"


def traced(
    text: str,
    *,
    robot: VirtualRobot | None = None,
    until_s: float = 60.0,
    meanwhile: Sequence[tuple[float, Callable[[VirtualRobot], object]]] = (),
) -> list[TraceRow]:
    """The rows of a run, from its first tick until the arm has come to rest after it.

    Args:
        text: the program.
        robot: a new one at `HOME` if None.
        until_s: longest time.
        meanwhile: what is done to the robot at which time, s; in order.
    """
    robot = robot or VirtualRobot(MODEL, joints=HOME)
    run = robot.start(text, trace=True)
    for time_s, act in meanwhile:
        robot.advance(time_s - robot.time_s)
        act(robot)
    while not run.state and robot.time_s < until_s:
        robot.advance(0.1)
    run.check()
    return list(run.trace)


def times_of(rows: Sequence[TraceRow]) -> list[float]:
    """The times of what the rows show, which is the state after the tick of each, s."""
    return [row.t + PERIOD_S for row in rows]


def tool_speeds(arm: Arm, rows: Sequence[TraceRow]) -> list[float]:
    """Speed of the flange at each row, m/s."""
    return [hypot(*tcp_twist(arm, row.q, row.qd, IDENTITY)[:3]) for row in rows]


@dataclass(frozen=True, slots=True)
class Following:
    """What `servoj` made of one stream of the base joint."""

    times: list[float]
    """s from the first target on, strictly increasing."""
    asked: list[float]
    """Target of the stream at that time, rad."""
    q: list[float]
    """Where the joint was, rad."""
    qd: list[float]
    """How fast it turned, rad/s."""


def following(asked: Callable[[float], float], duration_s: float, lookahead_s: float, gain: int) -> Following:
    """Stream a function of time, starting at 0 rad, one target in each control period; then hold its last value."""
    count = round(duration_s / PERIOD_S)
    targets = [asked((index + 1) * PERIOD_S) for index in range(count)]
    text = program(
        "global targets",
        f"q = {list(HOME)}",
        "for target in targets:",
        "  q[0] = target",
        f"  servoj(q, t={PERIOD_S}, lookahead_time={lookahead_s}, gain={gain})",
        "end",
        "sleep(1)",
    )
    run = VirtualRobot(MODEL, joints=HOME).run(text, presets={"targets": targets}, trace=True).check()
    rows = run.trace
    late = [targets[min(index, count - 1)] for index in range(len(rows))]
    return Following(
        [0.0, *((index + 1) * PERIOD_S for index in range(len(rows)))],
        [0.0, *late],
        [HOME[0], *(row.q[0] for row in rows)],
        [0.0, *(row.qd[0] for row in rows)],
    )


@dataclass(frozen=True, slots=True)
class ServoFigures:
    """Lag and overshoot of one pair of settings."""

    lookahead_s: float
    gain: int
    ramp_lag_s: float
    """How late the arm is behind a ramp of 0.5 rad/s when that has settled."""
    ramp_overshoot: float
    """How far it goes beyond the end of the ramp, rad."""
    step_90_s: float
    """Time after which 90 % of a step of 0.1 rad are done."""
    step_overshoot: float
    """How far it goes beyond the step, as a fraction of it."""
    sine_lag_s: float
    """How late the arm is behind a sine of 1 Hz."""
    sine_gain: float
    """Its amplitude, as a fraction of the stream's."""


def servo_figures(lookahead_s: float, gain: int) -> ServoFigures:
    """Measure one pair of settings of `servoj`."""
    ramp = following(lambda t: RAMP * t, 1.6, lookahead_s, gain)
    settled = round(1.5 / PERIOD_S)
    step = following(lambda t: STEP, 1.2, lookahead_s, gain)
    sine = following(lambda t: SINE * sin(2.0 * pi * t), 3.0, lookahead_s, gain)
    # The last whole period, against sine and cosine of the stream.
    first, last = round(2.0 / PERIOD_S) + 1, round(3.0 / PERIOD_S) + 1
    angles = [2.0 * pi * t for t in sine.times[first:last]]
    count = last - first
    in_phase = 2.0 / count * sum(q * sin(angle) for q, angle in zip(sine.q[first:last], angles, strict=True))
    behind = -2.0 / count * sum(q * cos(angle) for q, angle in zip(sine.q[first:last], angles, strict=True))
    reached = next(t for t, q in zip(step.times, step.q, strict=True) if q >= 0.9 * STEP)
    return ServoFigures(
        lookahead_s,
        gain,
        (ramp.asked[settled] - ramp.q[settled]) / RAMP,
        max(0.0, max(ramp.q) - ramp.asked[-1]),
        reached,
        max(0.0, max(step.q) / STEP - 1.0),
        atan2(behind, in_phase) / (2.0 * pi),
        hypot(in_phase, behind) / SINE,
    )
