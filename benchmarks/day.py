"""`python -m benchmarks.day HOURS [lag]`: wall and CPU time of pick and place, s, and memory, MB, on the way."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from time import perf_counter, process_time

from elitescript import PlantConfig, VirtualRobot

PROGRAM = """
while True:
  movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  movel([0.4, -0.2, 0.4, 3.14, 0, 0], a=1.2, v=0.25)
  set_standard_digital_out(0, True)
  set_payload(1, [0, 0, 0.05])
  sleep(0.3)
  movel([0.4, -0.2, 0.5, 3.14, 0, 0], a=1.2, v=0.25)
  movej([-0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  set_standard_digital_out(0, False)
  set_payload(0, [0, 0, 0])
  sleep(0.3)
end
"""
STRETCHES = 24


def resident_mb() -> float:
    """Memory that this process has now, MB; needs Linux."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main(hours: float, has_lag: bool) -> None:
    """Print both times and the memory after a 24th, a half and all of the time."""
    robot = VirtualRobot("CS66", plant=PlantConfig(lag_s=0.02) if has_lag else None)
    robot.start(PROGRAM)
    wall, cpu = perf_counter(), process_time()
    memory = []
    for _ in range(STRETCHES):
        robot.advance(hours * 3600 / STRETCHES)
        memory.append(resident_mb())
    print(perf_counter() - wall, process_time() - cpu, memory[0], memory[STRETCHES // 2 - 1], memory[-1])


if __name__ == "__main__":
    main(float(sys.argv[1]), "lag" in sys.argv[2:])
