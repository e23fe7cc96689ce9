"""Programs, clients and requests that come and go without a pause: memory and descriptors of `serve` stay flat.

`CHURN_SECONDS=3600 pytest -m slow tests/services/test_churn.py` does it for an hour.
"""

from __future__ import annotations

import json
import os
import random
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")]

SECONDS = float(os.environ.get("CHURN_SECONDS", "60"))
WARM_S = min(SECONDS / 4, 60.0)
"""Until then caches fill."""
SERVE = (sys.executable, "-m", "elitescript", "serve", "--port", "all=0", "--power-on", "--json")
GROWTH_MAX = 1.15
LINGER_S = 20.0
PROGRAMS = (
    b"def p():\n  set_standard_digital_out(0, True)\nend\n",
    b"def p():\n  while True:\n    sleep(0.004)\n  end\nend\n",
    b"sec q():\n  set_standard_digital_out(1, False)\nend\n",
    b"def p():\n  movej([2.0, 0, 0.3, 3.14, 0, 0])\nend\n",
    b"def p():\n  x = [0] * 10000\n  textmsg(len(x))\n  raise ValueError('x')\nend\n",
    b"def p(:\n",
    b"def p():\n  f = open('x', 'w')\n  f.write('x' * 1000)\n  f.close()\nend\n",
    b"def p():\n  start_thread(lambda: sleep(1), ())\n  sleep(0.01)\nend\n",
)


class Served:
    """A `serve` of its own."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.problems: list[str] = []
        tasks = folder / "tasks"
        tasks.mkdir()
        self.process = subprocess.Popen(
            [*SERVE, "--task-dir", str(tasks), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**os.environ, "XDG_RUNTIME_DIR": str(folder)},
            text=True,
        )
        assert self.process.stdout is not None
        ready = self.process.stdout.readline()
        if not ready:
            assert self.process.stderr is not None
            raise RuntimeError(self.process.stderr.read())
        self.robots: list[dict[str, Any]] = json.loads(ready)["robots"]
        self.thread = threading.Thread(target=self._read)
        self.thread.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            row = json.loads(line)
            if row.get("what") in ("bug", "library") or row.get("code") == "R132":
                self.problems.append(line)

    def sizes(self) -> tuple[int, int]:
        """Memory of the server and its children (KiB), and the descriptors of the server."""
        pid = self.process.pid
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        memory = sum(_rss(int(number)) for number in (pid, *children))
        return memory, sum(1 for _ in Path(f"/proc/{pid}/fd").iterdir())

    def stop(self) -> str:
        self.process.terminate()
        assert self.process.stderr is not None
        errors = self.process.stderr.read()
        self.process.stderr.close()
        self.process.wait(20)
        self.thread.join()
        assert self.process.stdout is not None
        self.process.stdout.close()
        return errors


def _rss(pid: int) -> int:
    line = next(line for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1])


def connect(port: int) -> socket.socket:
    peer = socket.create_connection(("127.0.0.1", port))
    peer.settimeout(10)
    return peer


def churn(robot: dict[str, Any], chance: random.Random) -> int:
    """Do one thing that a client does; return the number of programs that it sent."""
    ports, what = robot["ports"], chance.random()
    if what < 0.5:
        with connect(ports[chance.choice(("primary", "secondary", "realtime"))]) as peer:
            programs = chance.choices(PROGRAMS, k=chance.randrange(1, 5))
            for program in programs:
                peer.sendall(program)
        return len(programs)
    if what < 0.65:
        with connect(ports["dashboard"]) as peer:
            peer.recv(4096)
            peer.sendall(chance.choice((b"stop\r\n", b"robotMode\r\n", b"nonsense\r\n", b"quit\r\n")))
            peer.recv(4096)
    elif what < 0.8:
        with connect(ports["rtsi"]) as peer:
            recipe = struct.pack(">d", 250.0) + chance.choice((b"timestamp", b"nothing", b"timestamp,actual_TCP_pose"))
            peer.sendall(struct.pack(">HB", 3 + len(recipe), ord("O")) + recipe + b"\0\3S")
            peer.recv(4096)
    elif what < 0.9:
        with connect(ports["interpreter"]) as peer:
            peer.sendall(b"x=1\nnonsense(\n")
            peer.recv(4096)
    else:
        with socket.socket(socket.AF_UNIX) as peer:
            peer.settimeout(10)
            peer.connect(robot["ctl"])
            peer.sendall(chance.choice((b'{"verb":"state"}\n', b'{"verb":"stop"}\n', b"{\n", b'{"verb":"ports"}\n')))
            peer.recv(65536)
    return 0


@pytest.mark.parametrize("options", [(), ("--in-process",)], ids=["in a child", "in process"])
def test_memory_and_descriptors_stay_flat(options: tuple[str, ...]) -> None:
    # Paths of sockets must be short.
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        served = Served(Path(folder), *options)
        try:
            programs, seen = _churned(served)
        finally:
            errors = served.stop()
    print(f"{programs} programs in {SECONDS:g} s; memory (KiB) and descriptors, at the end those left: {seen}")
    (first, _), *_, (last, left) = seen
    assert programs > SECONDS
    assert last < GROWTH_MAX * first
    assert left <= 0
    assert not served.problems
    assert not errors


def _churned(served: Served) -> tuple[int, list[tuple[int, int]]]:
    chance, programs, idle = random.Random(1), 0, served.sizes()[1]
    seen: list[tuple[int, int]] = []
    begin = time.monotonic()
    next_look = begin + WARM_S
    while (now := time.monotonic()) < begin + SECONDS:
        if now >= next_look:
            seen.append(served.sizes())
            next_look += (SECONDS - WARM_S) / 5
        with suppress(TimeoutError, ConnectionError):
            programs += churn(served.robots[0], chance)
    # Clients that ended their half have 5 s to take what they asked for.
    end = time.monotonic() + LINGER_S
    while served.sizes()[1] > idle and time.monotonic() < end:
        time.sleep(0.1)
    seen.append((served.sizes()[0], served.sizes()[1] - idle))
    return programs, seen
