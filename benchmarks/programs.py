"""Whole programs: from process start to exit, and simulated time per wall time."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import tempfile
import tracemalloc
from pathlib import Path
from statistics import median
from time import perf_counter

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


def _trace_memory_rows() -> list[tuple[str, str, str, str]]:
    """What the rows of pick and place take, with those of the resting arm."""
    from elitescript import VirtualRobot

    def kept_by_a_run(*, has_trace: bool) -> tuple[int, int]:
        """Bytes and rows."""
        tracemalloc.start()
        run = VirtualRobot("CS66").run(PICK_AND_PLACE, trace=has_trace)
        gc.collect()
        kept = tracemalloc.get_traced_memory()[0]
        tracemalloc.stop()
        return kept, len(run.trace)

    VirtualRobot("CS66").run(PICK_AND_PLACE, trace=True)
    (with_rows, count), (without, _) = kept_by_a_run(has_trace=True), kept_by_a_run(has_trace=False)
    row = (with_rows - without) / count
    numbers = 8 * 19
    return [("memory of a trace row", f"{row:.0f} B", f"{numbers} B (its nineteen numbers)", f"{row / numbers:.2f}")]


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
    return _start_rows() + _free_run_rows() + _trace_memory_rows() + _day_rows()
