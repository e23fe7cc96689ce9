"""What watching a run costs where nothing is found: loops that change, read, move and wait in every tick.

`python -m benchmarks observed --against CHECKOUT` compares it with an older state of the package; the observers may
take 2 %.
"""

from __future__ import annotations

from benchmarks.measure import least, time_of
from benchmarks.table import Row, timed_row

TURNS = 10_000
RUNS = 3
LOOP = """def job():
  n = 0
  level = False
  while n < {turns}:
    n = n + 1
    level = not level
{lines}  end
end
"""
TURN: dict[str, str] = {
    "nothing": "    sync()\n",
    "two outputs change": (
        "    set_standard_digital_out(0, level)\n    set_standard_digital_out(1, level)\n    sync()\n"
    ),
    "two registers change": (
        "    write_output_integer_register(0, n)\n    write_output_float_register(0, n * 0.5)\n    sync()\n"
    ),
    "two inputs are read": "    a = get_standard_digital_in(0)\n    b = get_standard_digital_in(1)\n    sync()\n",
    "servoj": "    servoj([0.0001 * n, -1.4, -1.7, -1.6, 1.57, 0], t=0.004, lookahead_time=0.1, gain=300)\n",
}
"""What the loop does in each of its turns, of which each is a tick."""


def rows() -> list[Row]:
    """A row for each loop."""
    from elitescript import VirtualRobot

    found = []
    for what, lines in TURN.items():
        text = LOOP.format(turns=TURNS, lines=lines)
        robots = [VirtualRobot("CS66") for _ in range(RUNS)]
        times = [time_of(lambda robot=robot: robot.run(text).check()) for robot in robots]  # type: ignore[misc]  # noqa: B023
        found.append(timed_row(f"{TURNS:,} ticks, in each: {what}", least(times)))
    return found
