"""The debug adapter as editors feel it: `elitescript dap` as a process, three long programs, a client that waits.

Of each program: the whole run without a breakpoint and with one that is never hit, each beside `elitescript run`, from
the start of the process to its end; from the start to a breakpoint at its end, and there the first step back, later
ones, and `next`. CPU of debugged runs is that of all processes at the stop, snapshots included; a run that ends has no
such figure, since its processes are gone then.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from statistics import median
from time import perf_counter
from typing import Any

from benchmarks.framed import FramedProcess
from benchmarks.measure import ROOT, environment, middle
from benchmarks.table import Row, Time, timed_row

ROUNDS = int(os.environ.get("DEBUGGER_ROUNDS", "3"))
STEPS_BACK = 6

PICK_AND_PLACE = """
def pick_and_place():
  parts = 0
  def go_to(pose):
    movej(get_inverse_kin(pose), a=3.2, v=2.1)
  end
  def grip(closed):
    set_standard_digital_out(0, closed)
    sleep(0.35)
  end
  while parts < 105:
    go_to([0.46, -0.32, 0.205, 3.14, 0, -1.57])
    movel([0.46, -0.32, 0.085, 3.14, 0, -1.57], a=1.8, v=0.18)
    grip(True)
    movel([0.46, -0.32, 0.205, 3.14, 0, -1.57], a=1.8, v=0.18)
    go_to([0.38, 0.29, 0.23, 3.14, 0, -1.57])
    movel([0.38, 0.29, 0.11, 3.14, 0, -1.57], a=1.8, v=0.18)
    grip(False)
    movel([0.38, 0.29, 0.23, 3.14, 0, -1.57], a=1.8, v=0.18)
    parts = parts + 1
  end
  if parts < 0:
    parts = 0
  end
  parts = parts + 1
  parts = parts + 1
end
"""
SERVOJ = """
def streaming():
  count = 0
  q = get_actual_joint_positions()
  start = q[0]
  while count < 75000:
    q[0] = start + 0.2 * sin(count * 0.008)
    servoj(q, t=0.008, lookahead_time=0.1, gain=300)
    count = count + 1
  end
  if count < 0:
    count = 0
  end
  count = count + 1
  count = count + 1
end
"""
COMPUTING = """
def computing():
  count = 0
  total = 0.0
  while count < 3333333:
    total = total + count * 0.5
    count = count + 1
  end
  if count < 0:
    count = 0
  end
  count = count + 1
  count = count + 1
end
"""
PROGRAMS = {
    "ten minutes of pick and place": PICK_AND_PLACE,
    "ten minutes of servoj": SERVOJ,
    "ten million statements": COMPUTING,
}


class Client(FramedProcess):
    """A debug adapter as a process, and the client of it."""

    def __init__(self) -> None:
        super().__init__("dap")
        self._next = 0
        self._group = 0
        self.ask("initialize", {"adapterID": "elitescript"})

    def tell(self, command: str, arguments: dict[str, Any] | None = None) -> int:
        """Send a request; return its number."""
        self._next += 1
        self.send({"seq": self._next, "type": "request", "command": command, "arguments": arguments or {}})
        return self._next

    def ask(self, command: str, arguments: dict[str, Any] | None = None) -> dict[str, Any]:
        """Return the response to a request."""
        number = self.tell(command, arguments)
        return self.until(lambda message: message.get("request_seq") == number)

    def start(self, program: Path, line: int | None) -> dict[str, Any]:
        """Launch a program with a breakpoint; return the event of its stop or its end."""
        self.tell("launch", {"program": str(program)})
        self.until(lambda message: message.get("event") == "initialized")
        if line is not None:
            self.ask("setBreakpoints", {"source": {"path": str(program)}, "breakpoints": [{"line": line}]})
        self.ask("setExceptionBreakpoints", {"filters": ["alarm"]})
        self.tell("configurationDone")
        process = self.until(lambda message: message.get("event") == "process")
        self._group = int(process["body"]["systemProcessId"])
        return self.stop()

    def cpu_s(self) -> float:
        """Return the CPU time so far of the adapter, of the process that debugs and of its snapshots, s."""
        total_s = super().cpu_s()
        for path in Path("/proc").glob("[0-9]*/stat"):
            with suppress(OSError):
                fields = path.read_text().rpartition(")")[2].split()
                if int(fields[2]) == self._group:
                    total_s += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        return total_s

    def go(self, command: str) -> float:
        """Return the time from a request to the call in which the program stands then, s."""
        began = perf_counter()
        self.tell(command, {"threadId": 1})
        if self.stop()["event"] != "stopped":
            raise RuntimeError(f"the program has ended at {command}")
        self.ask("stackTrace", {"threadId": 1})
        return perf_counter() - began

    def stop(self) -> dict[str, Any]:
        """Wait for a stop or the end."""
        return self.until(lambda message: message.get("event") in ("stopped", "terminated"))

    def close(self) -> None:
        """End the session."""
        self.ask("disconnect")
        self.process.communicate()


def rows() -> list[Row]:
    """Runs, stops, steps back and forth of each program."""
    table = []
    with tempfile.TemporaryDirectory() as folder:
        for name, text in PROGRAMS.items():
            path = Path(folder) / "job.script"
            path.write_text(text)
            lines = text.splitlines()
            never, last = 1 + len(lines) - 5, len(lines) - 1
            table += _runs(name, path, never) + _at_end(name, path, last)
    return table


def _runs(name: str, path: Path, never: int) -> list[Row]:
    """Whole runs in turn: by the command line, without a breakpoint, with one that is never hit."""
    ways: list[Callable[[], None]] = [
        lambda: _run(path),
        lambda: _debug(path, None),
        lambda: _debug(path, never),
    ]
    times = [[_timed(way) for way in ways] for _ in range(ROUNDS)]
    run, free, with_line = (middle(column) for column in zip(*times, strict=True))
    return [
        timed_row(f"{name}: run", run),
        *(
            Row(f"{name}: {what}", "ms", wall_s=time.wall_s, words=f"{time.wall_s / run.wall_s:.2f} x run in wall time")
            for what, time in (("debugged", free), ("debugged, a breakpoint never hit", with_line))
        ),
    ]


def _run(path: Path) -> None:
    command = [sys.executable, "-m", "elitescript", "run", str(path)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment(), cwd=ROOT)


def _debug(path: Path, line: int | None) -> None:
    client = Client()
    if client.start(path, line)["event"] != "terminated":
        raise RuntimeError(f"{path} did not run to its end")
    client.close()


def _timed(call: Callable[[], None]) -> Time:
    before, began = getrusage(RUSAGE_CHILDREN), perf_counter()
    call()
    wall_s, after = perf_counter() - began, getrusage(RUSAGE_CHILDREN)
    return Time(wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def _at_end(name: str, path: Path, line: int) -> list[Row]:
    """At a breakpoint near the end: the way there, back and forth."""
    to_stop: list[Time] = []
    first, later, forth = [], [], []
    for _ in range(ROUNDS):
        began = perf_counter()
        client = Client()
        if client.start(path, line)["event"] != "stopped":
            raise RuntimeError(f"{path} did not stop in line {line}")
        to_stop.append(Time(perf_counter() - began, client.cpu_s()))
        first.append(client.go("stepBack"))
        later += [client.go("stepBack") for _ in range(STEPS_BACK)]
        forth += [client.go("next") for _ in range(STEPS_BACK)]
        client.close()
    return [
        timed_row(f"{name}: to a stop at its end", middle(to_stop)),
        _walls(f"{name}: first step back", first),
        _walls(f"{name}: later steps back", later),
        _walls(f"{name}: next", forth),
    ]


def _walls(what: str, walls_s: list[float]) -> Row:
    return Row(what, "ms", wall_s=median(walls_s), words=f"at most {1e3 * max(walls_s):.3g} ms")
