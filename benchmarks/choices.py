"""What decision records count with: switches of threads, imports, one pose with and without arrays, the jail."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from statistics import median
from threading import Lock, Thread
from time import perf_counter
from timeit import repeat

from benchmarks.kinematics import Q
from benchmarks.programs import starts

SWITCHES = 20_000
MODULES = ("argparse", "click", "asyncio", "trio", "greenlet", "msgspec", "numpy", "asyncssh", "serial")
JAIL = """
from time import perf_counter
from elitescript.services.child.jail import enter_jail
began = perf_counter()
enter_jail()
print(perf_counter() - began)
"""


def rows() -> list[tuple[str, str, str, str]]:
    """What, ours, the other, ratio."""
    ours, other = _greenlet_us(), _thread_us()
    table = [
        (
            "a thread of a program: there and back",
            f"{ours:.2f} us",
            f"{other:.0f} us (OS threads)",
            f"{ours / other:.2g}",
        )
    ]
    ours, other = _floats_us(), _numpy_us() if find_spec("numpy") else 0.0
    table.append(
        ("forward kinematics of one pose", f"{ours:.1f} us", f"{other:.1f} us (4x4 arrays)" if other else "-", "-")
    )
    found = list(filter(find_spec, MODULES))
    empty, *loaded = starts([[sys.executable, "-c", text] for text in ("pass", *(f"import {name}" for name in found))])
    for name, start in zip(found, loaded, strict=True):
        took_s = max(0.0, start.cpu_s - empty.cpu_s)
        table.append((f"import {name}", f"{took_s * 1e3:.0f} ms of CPU", "-", "-"))
    if sys.platform == "linux":
        taken = [
            float(subprocess.run([sys.executable, "-c", JAIL], capture_output=True, check=True).stdout)
            for _ in range(7)
        ]
        table.append(("enter the jail", f"{median(taken) * 1e3:.1f} ms", "-", "-"))
    return table


def _greenlet_us() -> float:
    """Return the time of a switch to another greenlet and back, us."""
    from greenlet import getcurrent, greenlet

    main = getcurrent()

    def run() -> None:
        while True:
            main.switch()

    other = greenlet(run)
    other.switch()
    return min(repeat(other.switch, number=SWITCHES)) / SWITCHES * 1e6


def _thread_us() -> float:
    """Return the time that two threads of the operating system take to pass control there and back, us."""
    there, back = Lock(), Lock()
    there.acquire()
    back.acquire()

    def run() -> None:
        for _ in range(SWITCHES):
            there.acquire()
            back.release()

    thread = Thread(target=run)
    thread.start()
    began = perf_counter()
    for _ in range(SWITCHES):
        there.release()
        back.acquire()
    took = perf_counter() - began
    thread.join()
    return took / SWITCHES * 1e6


def _floats_us() -> float:
    from elitescript.models.model import load_model

    arm = load_model("CS66").arm
    return min(repeat(lambda: arm.forward(Q), number=SWITCHES)) / SWITCHES * 1e6


def _numpy_us() -> float:
    """Return the time of six 4x4 products, with the six matrices made beforehand, us."""
    import numpy

    links = [numpy.eye(4) for _ in Q]

    def forward() -> object:
        T = links[0]
        for link in links[1:]:
            T = T @ link
        return T

    return min(repeat(forward, number=SWITCHES)) / SWITCHES * 1e6
