"""Robots of one `serve`, each with a client at 250 Hz and a program that moves the arm: how many two cores hold.

Each robot has an address of its own and the usual ports (`--host 127.0.0.101-110`), and one RTSI client that asks for
what a driver asks for; `FLEET_MOVES=0` leaves the arms at rest. How late packages are is measured as in
`benchmarks.serving`; the CPU time is that of the server and its children for a second of the wall clock, so that 1.00
is one core. `FLEET` names the rows, such as `FLEET=children:10,in-process:20`; `SERVING_SECONDS` sets how long each is
measured.
"""

from __future__ import annotations

import json
import os
import selectors
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks.measure import environment
from benchmarks.serving import MOVING, OUTPUTS, SECONDS, Stream, _late, message, used_s
from benchmarks.table import Row, print_rows

ROWS = os.environ.get("FLEET", "children:5,children:10,in-process:10,in-process:20")
MOVES = os.environ.get("FLEET_MOVES", "1") != "0"
FIRST = 101
"""Last number of the first robot's address."""


@contextmanager
def fleet(robots: int, *options: str) -> Iterator[tuple[list[dict[str, Any]], int]]:
    """Serve robots at loopback addresses of their own; give their `ready` records and the number of the process."""
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        words = ["serve", "--json", "--power-on", "--robots", str(robots), *options]
        process = subprocess.Popen(
            [sys.executable, "-m", "elitescript", *words, "--host", f"127.0.0.{FIRST}-{FIRST + robots - 1}"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**environment(), "XDG_RUNTIME_DIR": folder},
            text=True,
        )
        assert process.stdout is not None
        try:
            records = map(json.loads, process.stdout)
            yield next(record for record in records if record["type"] == "ready")["robots"], process.pid
        finally:
            process.terminate()
            process.wait()


def measured(robots: int, place: str) -> list[Row]:
    """Measure robots in children or in one process."""
    options = ["--in-process"] if place == "in-process" else []
    with fleet(robots, *options) as (found, pid):
        selector = selectors.DefaultSelector()
        streams: list[Stream] = []
        for robot in found:
            if MOVES:
                with socket.create_connection((robot["host"], robot["ports"]["primary"])) as peer:
                    peer.sendall(MOVING)
            stream = Stream(robot["ports"]["rtsi"], OUTPUTS, host=robot["host"])
            stream.socket.sendall(message("S"))
            selector.register(stream.socket, selectors.EVENT_READ, stream)
            streams.append(stream)
        for seconds in (3.0, SECONDS):
            for stream in streams:
                stream.times.clear()
            used = _used_s(pid)
            begin = perf_counter()
            while (left := begin + seconds - perf_counter()) > 0:
                for key, _ in selector.select(left):
                    key.data.read()
            used, wall_s = _used_s(pid) - used, perf_counter() - begin
        for stream in streams:
            stream.socket.close()
    slowest, delays = 1.0, [0.0]
    for stream in streams:
        robot_s = stream.times[-1][0] - stream.times[0][0] if stream.times else 0.0
        slowest = min(slowest, robot_s / wall_s)
        own = [arrived - robot for robot, arrived, _ in stream.times]
        delays += [delay - min(own) for delay in own]
    where, state = "in one process" if options else "in children", "moving" if MOVES else "at rest"
    what = f"{robots} robots {where}, a client at 250 Hz each, {state}"
    words = f"{_late(delays)}; slowest {100 * slowest:.1f} % of real time; {used / wall_s:.2f} cores"
    return [Row(what, words=words, beside="aim: p99 < 10 ms, 99 %")]


def _used_s(pid: int) -> float:
    """Return the CPU time of the server and of all processes below it so far, s."""
    found = [pid]
    for process in found:
        for task in Path(f"/proc/{process}/task").iterdir():
            found += map(int, (task / "children").read_text(encoding="ascii").split())
    return sum(used_s(found))


def rows() -> list[Row]:
    found: list[Row] = []
    for text in ROWS.split(","):
        place, _, robots = text.partition(":")
        found += measured(int(robots), place)
    return found


if __name__ == "__main__":
    print_rows(rows())
