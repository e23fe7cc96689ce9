"""Whole programs: from process start to exit, and simulated time per wall time."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

ROOT = Path(__file__).resolve().parent.parent
RUNS = 10
PICK_AND_PLACE = ROOT / "examples" / "pick_and_place.script"
BELT_PICKING = ROOT / "examples" / "belt_picking.script"
BELT_COUNTS_PER_S = 2000.0
TRACKING_S = 60.0
TRACKING = f"""
def tracking():
  track_conveyor_linear([0, 1, 0, 0, 0, 0], 2000000)
  sleep({TRACKING_S})
  stop_conveyor_tracking()
end
"""
"""One minute of nothing but going along with a belt that creeps."""
POLLING_S = 20.0
POLLING = """
def polling():
  global n
  n = 0
  def poll():
    global n
    while True:
      n = n + 1
{body}
      sync()
    end
  end
  start_thread(poll, ())
{main}
end
"""
"""A thread that does something in every tick, beside a main thread that waits or moves."""
_SLEEPING = f"  sleep({POLLING_S})"
_MOVING = """
  for i in range(5):
    movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    movej([-0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  end"""


def process_s(command: list[str], runs: int = RUNS) -> float:
    """Median wall time of a process, s."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    times = []
    for _ in range(runs + 1):
        began = perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
        times.append(perf_counter() - began)
    return median(times[1:])


def _start_rows() -> list[tuple[str, str, str, str]]:
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "hello.script"
        program.write_text('textmsg("hello")\n')
        ours = process_s([sys.executable, "-m", "elitescript", "run", str(program)])
    python = process_s([sys.executable, "-c", "pass"])
    return [
        (
            "start to exit, one-line program",
            f"{ours * 1e3:.0f} ms",
            f"{python * 1e3:.0f} ms (python -c pass)",
            f"{ours / python:.1f}",
        )
    ]


def _free_run_rows() -> list[tuple[str, str, str, str]]:
    from elitescript import VirtualRobot

    rows = []
    for what, program, has_trace in (
        ("pick and place, free run", PICK_AND_PLACE, False),
        ("the same with a trace row every 4 ms", PICK_AND_PLACE, True),
        ("picking from a moving belt", BELT_PICKING, False),
        ("one minute on a moving belt", TRACKING, False),
    ):
        times = []
        simulated = 0.0
        for _ in range(RUNS):
            robot = VirtualRobot("CS66")
            robot.signals["encoder_speed[0]"] = BELT_COUNTS_PER_S
            began = perf_counter()
            run = robot.run(program, trace=has_trace).check()
            times.append(perf_counter() - began)
            simulated = run.time_s
        wall = median(times)
        rows.append(
            (what, f"{wall * 1e3:.1f} ms", f"{simulated:.1f} s (the robot)", f"{simulated / wall:.0f} x real time")
        )
    return rows


def _polling_rows() -> list[tuple[str, str, str, str]]:
    """Programs with a thread that polls: processor time for each tick."""
    from elitescript import VirtualRobot

    same, changed = (
        "\n".join(
            f"      write_output_float_register({index}, {value} * 0.5)\n"
            f"      write_output_integer_register({index}, {value})"
            for index in range(7)
        )
        for value in ("3", "n")
    )
    rows = []
    for what, body, main in (
        ("a thread that only waits for the next tick", "", _SLEEPING),
        ("a thread that reads an input in every tick", "      x = get_standard_digital_in(0)", _SLEEPING),
        ("the same beside moves", "      x = get_standard_digital_in(0)", _MOVING),
        ("a thread with 14 unchanged writes in every tick", same, _SLEEPING),
        ("the same beside moves", same, _MOVING),
        ("a thread with 14 changes in every tick", changed, _SLEEPING),
    ):
        used = []
        simulated = 0.0
        for _ in range(RUNS):
            robot = VirtualRobot("CS66")
            program = robot.compile(POLLING.format(body=body, main=main))
            began = process_time()
            run = robot.run(program).check()
            used.append(process_time() - began)
            simulated = run.time_s
        tick_us = median(used) / (simulated * 250) * 1e6
        rows.append(
            (what, f"{tick_us:.1f} us of CPU a tick", "4000 us (the robot)", f"{4000 / tick_us:.0f} x real time")
        )
    return rows


def _day_rows() -> list[tuple[str, str, str, str]]:
    """Twenty-four hours of pick and place: the memory after the first hour and at the end, each in its own process."""
    rows = []
    for what, plant in (("24 h of pick and place", ""), ("1 h of it with a lag of 20 ms", "lag")):
        hours = 1 if plant else 24
        command = [sys.executable, "-m", "benchmarks.day", str(hours), *filter(None, [plant])]
        environment = {**os.environ, "PYTHONPATH": f"{ROOT / 'src'}{os.pathsep}{ROOT}"}
        result = subprocess.run(command, check=True, capture_output=True, text=True, env=environment, cwd=ROOT)
        wall, first, half, last = map(float, result.stdout.split())
        rows.append(
            (
                what,
                f"{wall:.1f} s",
                f"{first:.0f}, {half:.0f}, {last:.0f} MB (after a 24th, a half, all)",
                f"{hours * 3600 / wall:.0f} x real time",
            )
        )
    return rows


def rows() -> list[tuple[str, str, str, str]]:
    """What, ours, the other, ratio."""
    return _start_rows() + _free_run_rows() + _polling_rows() + _day_rows()
