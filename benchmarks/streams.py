"""Simulated time per wall time of motions that go from period to period.

A stream gives the robot something to do in every control period, so nothing can be skipped. The alternative to such a
program is the robot, at one second a second. Ruckig called once in every period stands beside it; that is the motion
alone, without program and robot.
"""

from __future__ import annotations

from importlib.util import find_spec
from math import inf, sin
from statistics import median
from time import perf_counter

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


def rows() -> list[tuple[str, str, str, str]]:
    """What, ours, the other, ratio."""
    from elitescript import VirtualRobot

    table = []
    for what, text in PROGRAMS.items():
        times = []
        simulated = 0.0
        for _ in range(RUNS):
            robot = VirtualRobot("CS66")
            began = perf_counter()
            simulated = robot.run(text).check().time_s
            times.append(perf_counter() - began)
        wall_s = median(times)
        table.append(
            (what, f"{wall_s * 1e3:.0f} ms", f"{simulated:.1f} s (the robot)", f"{simulated / wall_s:.0f} x real time")
        )
    if find_spec("ruckig"):
        table.append(("the motion of such a stream alone", "-", f"{_ruckig_s() * 1e3:.0f} ms (ruckig)", "-"))
    else:
        table.append(("compared with ruckig", "-", "not installed", "-"))
    return table


def _ruckig_s() -> float:
    """Wall time of following the same stream with Ruckig, one update in each period."""
    import ruckig

    solver = ruckig.Ruckig(6, 0.004)
    problem, answer = ruckig.InputParameter(6), ruckig.OutputParameter(6)
    problem.max_velocity, problem.max_acceleration, problem.max_jerk = [2.6] * 6, [40.0] * 6, [inf] * 6
    began = perf_counter()
    for period in range(PERIODS):
        problem.target_position = [0.4 * sin(period * 0.004), 0.0, 0.0, 0.0, 0.0, 0.0]
        solver.update(problem, answer)
        answer.pass_to_input(problem)
    return perf_counter() - began


if __name__ == "__main__":
    for row in rows():
        print("  ".join(cell.ljust(36) for cell in row).rstrip())
