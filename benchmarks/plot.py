"""Pages of `elitescript plot`: how large they are and how long they take; beside each the plain page of the same run.

The runs last two minutes of robot time: one with moves and waits, one of blended lines, and one in which all joints
change in every control period.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

from benchmarks.measure import ROOT
from benchmarks.studio import BLENDED, SERVOJ
from benchmarks.table import Row, Time, print_rows, timed_row, words
from elitescript.language.text.source import SourceFile
from elitescript.page import NOT_BUILT, is_built
from elitescript.plotting.page import page
from elitescript.plotting.plain_page import plain_page
from elitescript.plotting.recorder import RunRecorder
from elitescript.plotting.recording import Recording
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot

ROUNDS = int(os.environ.get("PLOT_ROUNDS", "3"))
UNTIL_S = 120.0


def recorded(text: str) -> Recording:
    """Return the recording of a program."""
    robot = VirtualRobot()
    source = SourceFile("program.script", text)
    recorder = RunRecorder(robot, Sampling())
    run = robot.run(robot.compile(source), until_s=UNTIL_S, trace=recorder.sampling, watch=recorder.watch)
    return recorder.recording("program.script", robot, source, run)


def timed(work: Callable[[], object]) -> Time:
    """Return the median time of calls."""
    walls, cpus = [], []
    for _ in range(ROUNDS):
        began, cpu = perf_counter(), process_time()
        work()
        walls.append(perf_counter() - began)
        cpus.append(process_time() - cpu)
    return Time(median(walls), median(cpus))


def rows() -> list[Row]:
    """Return the table."""
    if not is_built():
        return [words("pages of plot", NOT_BUILT)]
    programs = {
        "pick_and_place": (ROOT / "examples" / "pick_and_place.script").read_text(encoding="utf-8"),
        "1,200 blended lines": BLENDED,
        "servoj in every tick": SERVOJ,
    }
    table: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, text in programs.items():
            found = recorded(text)
            sizes = []
            for number, make in enumerate((page, plain_page)):
                file = Path(folder, f"{number}.html")
                file.write_text(make(found), encoding="utf-8")
                sizes.append(file.stat().st_size)
            ours, plain = timed(lambda found=found: page(found)), timed(lambda found=found: plain_page(found))  # type: ignore[misc]
            whole = timed(lambda text=text: page(recorded(text)))  # type: ignore[misc]
            table += [
                Row(f"{name}: page", "kB", value=sizes[0] / 1000, other=sizes[1] / 1000, beside="plain page"),
                timed_row(f"{name}: writing it", ours, other=plain.cpu_s, beside="plain page"),
                timed_row(f"{name}: running and writing it", whole),
            ]
    return table


if __name__ == "__main__":
    print_rows(rows())
