"""Whole programs: from process start to exit, and simulated time per wall time."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import NamedTuple

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


class Start(NamedTuple):
    """What a process takes from its start to its exit, with its children."""

    cpu_s: float
    wall_s: float

    def __str__(self) -> str:
        return f"{self.cpu_s * 1e3:.0f} ms of CPU, {self.wall_s * 1e3:.0f} ms"


def starts(commands: list[list[str]], runs: int = RUNS) -> list[Start]:
    """Return the medians of processor time and wall time of processes that take turns."""
    # As users have it: modules are compiled once, and the seed of hashes is a random one.
    left_out = ("PYTHONDONTWRITEBYTECODE", "PYTHONHASHSEED")
    environment = {name: value for name, value in os.environ.items() if name not in left_out}
    environment["PYTHONPATH"] = str(ROOT / "src")
    measured: list[list[Start]] = [[] for _ in commands]
    for run in range(runs + 1):
        for command, found in zip(commands, measured, strict=True):
            before, began = _cpu_of_children_s(), perf_counter()
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
            if run:
                found.append(Start(_cpu_of_children_s() - before, perf_counter() - began))
    return [
        Start(median(start.cpu_s for start in found), median(start.wall_s for start in found)) for found in measured
    ]


def _cpu_of_children_s() -> float:
    # `os.times` counts in hundredths of a second.
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _start_rows() -> list[tuple[str, str, str, str]]:
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "hello.script"
        program.write_text('textmsg("hello")\n')
        call = [sys.executable, "-m", "elitescript"]
        run, check, python = starts(
            [[*call, "run", str(program)], [*call, "check", str(program)], [sys.executable, "-c", "pass"]]
        )
    return [
        (what, str(ours), f"{python} (python -c pass)", f"{ours.cpu_s / python.cpu_s:.1f}")
        for what, ours in (("start to exit, one-line program", run), ("the same, check", check))
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
    return _start_rows() + _free_run_rows() + _day_rows()
