"""How benchmarks measure: CPU beside wall time of calls, of runs and of processes."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

import elitescript
from benchmarks.table import Time

ROOT = Path(__file__).resolve().parent.parent
SOURCE = Path(elitescript.__file__).resolve().parent.parent
"""The folder of the package that is measured: `src` of this checkout, or of the one that `--against` names."""


def environment(source: Path = SOURCE) -> dict[str, str]:
    """Return the environment of a measured process: the package of `source`, bytecode kept as it is for users."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**kept, "PYTHONPATH": f"{source}{os.pathsep}{ROOT}"}


def time_of(run: Callable[[], object]) -> Time:
    """Return the time of one run in this process."""
    wall, cpu = perf_counter(), process_time()
    run()
    return Time(perf_counter() - wall, process_time() - cpu)


def best_of_calls(call: Callable[[], object], runs: int = 7, run_s: float = 0.05) -> Time:
    """Return the best time of one call over some runs, each of which makes calls for about `run_s`."""
    once_s = min(time_of(call).wall_s for _ in range(5))
    number = max(1, int(run_s / max(once_s, 1e-7)))

    def run() -> None:
        for _ in range(number):
            call()

    best = least([time_of(run) for _ in range(runs)])
    return Time(best.wall_s / number, best.cpu_s / number)


def best_in_turn(runs: Sequence[Callable[[], object]], rounds: int) -> list[Time]:
    """Return the best time of each; they run in turn, so that a busy machine disturbs all alike."""
    times = [[time_of(run) for run in runs] for _ in range(rounds)]
    return [least(column) for column in zip(*times, strict=True)]


def process_times(commands: Sequence[list[str]], rounds: int = 10) -> list[Time]:
    """Return the median time of each process with its children; they run in turn, a first round does not count.

    It needs Unix.
    """
    from resource import RUSAGE_CHILDREN, getrusage

    def once(command: list[str]) -> Time:
        before, began = getrusage(RUSAGE_CHILDREN), perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment(), cwd=ROOT)
        wall_s, after = perf_counter() - began, getrusage(RUSAGE_CHILDREN)
        return Time(wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)

    times = [[once(command) for command in commands] for _ in range(rounds + 1)][1:]
    return [middle(column) for column in zip(*times, strict=True)]


def least(times: Sequence[Time]) -> Time:
    """Return the least wall and the least CPU time."""
    return Time(min(time.wall_s for time in times), min(time.cpu_s for time in times))


def middle(times: Sequence[Time]) -> Time:
    """Return the median wall and the median CPU time."""
    return Time(median(time.wall_s for time in times), median(time.cpu_s for time in times))
