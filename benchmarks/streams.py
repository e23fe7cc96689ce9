"""Simulated time per wall time of motions that go from period to period.

A stream gives the robot something to do in every control period, so nothing can be skipped. The alternative to such a
program is the robot, at one second a second. Ruckig called once in every period stands beside it; that is the motion
alone, without program and robot.
"""

from __future__ import annotations

from importlib.util import find_spec
from math import inf, sin

from benchmarks.measure import middle, time_of
from benchmarks.table import Row, not_installed, print_rows, timed_row

SERVOJ = """
def stream():
  q = get_target_joint_positions()
  middle = q[0]
  n = 0
  while n < 15000:
    n = n + 1
    q[0] = middle + 0.4 * sin(n * 0.004)
    servoj(q, t=0.004, lookahead_time=0.1, gain=300)
  end
  stopj(4)
end
"""
SPEEDL = """
def jog():
  n = 0
  while n < 30:
    n = n + 1
    speedl([0, 0.1, 0.02, 0, 0, 0.1], 0.8, 1)
    speedl([0, -0.1, -0.02, 0, 0, -0.1], 0.8, 1)
  end
  stopl(0.8)
end
"""
SPEEDJ = """
def jog():
  n = 0
  while n < 30:
    n = n + 1
    speedj([0.3, 0.1, 0, 0, 0, 0], 2, 1)
    speedj([-0.3, -0.1, 0, 0, 0, 0], 2, 1)
  end
  stopj(4)
end
"""
PROGRAMS = {
    "60 s of servoj, a target every 4 ms": SERVOJ,
    "60 s of speedl, there and back": SPEEDL,
    "60 s of speedj, there and back": SPEEDJ,
}
RUNS = 3
PERIODS = 15_000


def rows() -> list[Row]:
    """Each program; the first one beside the motion alone, where ruckig is installed."""
    from elitescript import VirtualRobot

    table = []
    for what, text in PROGRAMS.items():
        robots = [VirtualRobot("CS66") for _ in range(RUNS)]
        time = middle([time_of(lambda robot=robot, text=text: robot.run(text).check()) for robot in robots])  # type: ignore[misc]
        table.append(timed_row(what, time, simulated_s=robots[0].time_s))
        if text is SERVOJ and find_spec("ruckig"):
            other = middle([time_of(_ruckig) for _ in range(RUNS)]).cpu_s
            table.append(timed_row(f"{what}, beside ruckig", time, other=other, beside="ruckig, the motion alone"))
    if not find_spec("ruckig"):
        table.append(not_installed("ruckig"))
    return table


def _ruckig() -> None:
    """Follow the same stream with Ruckig, one update in each period."""
    import ruckig

    solver = ruckig.Ruckig(6, 0.004)
    problem, answer = ruckig.InputParameter(6), ruckig.OutputParameter(6)
    problem.max_velocity, problem.max_acceleration, problem.max_jerk = [2.6] * 6, [40.0] * 6, [inf] * 6
    for period in range(PERIODS):
        problem.target_position = [0.4 * sin(period * 0.004), 0.0, 0.0, 0.0, 0.0, 0.0]
        solver.update(problem, answer)
        answer.pass_to_input(problem)


if __name__ == "__main__":
    print_rows(rows())
