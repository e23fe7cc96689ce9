"""What decision records count with: switches of threads, imports, one pose with and without arrays, the jail."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from threading import Lock, Thread

from benchmarks.kinematics import Q
from benchmarks.measure import best_of_calls, environment, least, middle, process_times, time_of
from benchmarks.table import Row, Time, timed_row

SWITCHES = 20_000
MODULES = (
    "argparse",
    "click",
    "asyncio",
    "trio",
    "greenlet",
    "msgspec",
    "numpy",
    "asyncssh",
    "serial",
    "pygls.lsp.server",
    "mcp.server.mcpserver",
    "websockets.asyncio.server",
    "distributed",
    "optuna",
    "pyarrow",
    "mcap.writer",
)
JAIL = """
from time import perf_counter, process_time
from elitescript.services.child.jail import enter_jail
wall, cpu = perf_counter(), process_time()
enter_jail()
print(perf_counter() - wall, process_time() - cpu)
"""


def rows() -> list[Row]:
    """Each choice beside what was not chosen."""
    there = _per_switch(_greenlets()), _per_switch(_threads)
    table = [
        timed_row("a thread of a program: there and back", there[0], "us", other=there[1].cpu_s, beside="OS threads")
    ]
    ours = best_of_calls(_floats())
    if find_spec("numpy"):
        theirs = best_of_calls(_arrays())
        table.append(timed_row("forward kinematics of one pose", ours, "us", other=theirs.cpu_s, beside="4x4 arrays"))
    else:
        table.append(timed_row("forward kinematics of one pose", ours, "us"))
    names = [name for name in MODULES if find_spec(name.partition(".")[0])]
    empty, *times = process_times([[sys.executable, "-c", text] for text in ("pass", *(f"import {n}" for n in names))])
    for name, took in zip(names, times, strict=True):
        beyond = Time(max(0.0, took.wall_s - empty.wall_s), max(0.0, took.cpu_s - empty.cpu_s))
        table.append(timed_row(f"import {name}", beyond))
    if sys.platform == "linux":
        table.append(timed_row("enter the jail", middle([_jail() for _ in range(7)])))
    return table


def _jail() -> Time:
    done = subprocess.run([sys.executable, "-c", JAIL], capture_output=True, check=True, env=environment())
    wall, cpu = done.stdout.split()
    return Time(float(wall), float(cpu))


def _per_switch(run: Callable[[], object]) -> Time:
    best = least([time_of(run) for _ in range(5)])
    return Time(best.wall_s / SWITCHES, best.cpu_s / SWITCHES)


def _greenlets() -> Callable[[], object]:
    """Return what switches to another greenlet and back, `SWITCHES` times."""
    from greenlet import getcurrent, greenlet

    main = getcurrent()

    def run() -> None:
        while True:
            main.switch()

    other = greenlet(run)
    other.switch()

    def switch() -> None:
        for _ in range(SWITCHES):
            other.switch()

    return switch


def _threads() -> None:
    """Pass control to another thread of the operating system and back, `SWITCHES` times."""
    there, back = Lock(), Lock()
    there.acquire()
    back.acquire()

    def run() -> None:
        for _ in range(SWITCHES):
            there.acquire()
            back.release()

    thread = Thread(target=run)
    thread.start()
    for _ in range(SWITCHES):
        there.release()
        back.acquire()
    thread.join()


def _floats() -> Callable[[], object]:
    from elitescript.models.model import load_model

    arm = load_model("CS66").arm
    return lambda: arm.forward(Q)


def _arrays() -> Callable[[], object]:
    """Return six 4x4 products, with the six matrices made beforehand."""
    import numpy

    links = [numpy.eye(4) for _ in Q]

    def forward() -> object:
        T = links[0]
        for link in links[1:]:
            T = T @ link
        return T

    return forward
