"""What a look at the clock costs a served program, and what calls cost of which nothing is counted.

Each loop runs in a robot in this process, without a meter and with one whose share is never used up: the same passes,
as many as a tick has work for. The difference is what looking costs; of a refusal the whole is of interest, since the
work of a tick lets so many happen.
"""

from __future__ import annotations

import time
from typing import Final

from benchmarks.measure import best_in_turn
from benchmarks.table import Row, Time, print_rows, timed_row
from elitescript.environment.memory import MemoryFiles
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import RunUnit
from elitescript.messages.timing import WORK_PER_TICK
from elitescript.runtime.threads.meter import ClockMeter

LOOPS: Final = {
    "a pass of a loop": "n = n + 1",
    "a call of a command": "get_steptime()",
    "a refused `movel`": "movel([2.0, 0, 0.3, 3.14, 0, 0])",
    "a refused `re.match`": 're.match("(", "")',
}
ROUNDS: Final = 5


def kernel_with(call: str, *, is_metered: bool) -> Kernel:
    """Return a robot in the middle of a loop that makes a call in `try` without end; of a plain pass, without `try`."""
    meter = ClockMeter(time.monotonic_ns, time.thread_time_ns, share_ns=10**15) if is_metered else None
    robot = Kernel(RobotOptions(power_on=True), RequestEnvironment(MemoryFiles({})), meter=meter)
    body = (
        f"    {call}\n"
        if "=" in call or "step" in call
        else f"    try:\n      {call}\n    except:\n      pass\n    end\n"
    )
    text = f"def job():\n  import re\n  n = 0\n  while True:\n{body}  end\nend\n"
    robot.tick([RunUnit("benchmark", "program", text)])
    for _ in range(3):
        robot.tick()
    return robot


def rows() -> list[Row]:
    """The rows of this module."""
    found = []
    for what, call in LOOPS.items():
        robots = [kernel_with(call, is_metered=is_metered) for is_metered in (False, True)]
        free, metered = best_in_turn([lambda robot=robot: robot.tick() for robot in robots], ROUNDS)  # type: ignore[misc]
        one = Time(metered.wall_s / WORK_PER_TICK, metered.cpu_s / WORK_PER_TICK)
        other = free.cpu_s / WORK_PER_TICK
        words = f"{(one.cpu_s - other) * 1e9:.0f} ns more"
        found.append(timed_row(f"{what}, metered", one, "us", words=words, other=other, beside="in a free run"))
    return found


if __name__ == "__main__":
    print_rows(rows())
