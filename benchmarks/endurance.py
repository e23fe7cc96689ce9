"""Memory of programs that run for a day, each measured in a process of its own.

The program is a cell that works without end: it moves, switches an output, waits, and writes a message for each part.
What grows is the record of the run: its events, messages included.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parent.parent
HOURS = (1, 24)
PROGRAM = """
def endless():
  global parts
  parts = 0
  HOME = [0, -1.5708, -1.5708, -1.5708, 1.5708, 0]
  movej(HOME)
  p = get_target_tcp_pose()
  while True:
    movel([p[0], p[1] + 0.15, p[2], p[3], p[4], p[5]], a=1.2, v=0.25)
    set_standard_digital_out(0, True)
    sleep(0.4)
    movej([0.6, -1.5, -1.6, -1.6, 1.57, 0], a=1.4, v=1.05)
    set_standard_digital_out(0, False)
    sleep(0.4)
    movej(HOME, a=1.4, v=1.05)
    parts = parts + 1
    textmsg("part ", parts)
  end
end
"""
CHILD = """
import resource, sys
from elitescript import VirtualRobot
hours = float(sys.argv[1])
run = VirtualRobot("CS66").run(sys.stdin.read(), until_s=3600 * hours)
assert run.state == "time_limit", run
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024), len(run.events))
"""


def rows() -> list[tuple[str, str, str, str]]:
    """What, ours, the other, ratio."""
    if sys.platform == "win32":
        return [("memory of a long program", "-", "not measured on Windows", "-")]
    table = []
    for hours in HOURS:
        used, events, wall_s = _measured(hours)
        table.append(
            (
                f"{hours} h of a cell that moves: largest memory",
                f"{used / 2**20:.0f} MiB",
                f"{events} events kept",
                f"{3600 * hours / wall_s:.0f} x real time",
            )
        )
    return table


def _measured(hours: float) -> tuple[int, int, float]:
    """Largest memory of the process, bytes; events of the run; wall time, s."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    began = perf_counter()
    child = subprocess.run(
        [sys.executable, "-c", CHILD, str(hours)],
        input=PROGRAM,
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    wall_s = perf_counter() - began
    used, events = child.stdout.split()
    return int(used), int(events), wall_s


if __name__ == "__main__":
    for row in rows():
        print("  ".join(cell.ljust(44) for cell in row).rstrip())
