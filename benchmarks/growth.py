"""How time and memory grow: more robots, longer programs, more devices, longer runs, more served robots.

Every size is measured in a process of its own. A row is the share of one robot, line, device or hour; after the sizes
stands the exponent with which the whole has grown between the last two: 1 is linear. `GROWTH_HOURS` is the longest run
(30 days take some minutes), `GROWTH_SECONDS` how long robots are served. `python -m benchmarks.growth robots worlds`
prints tables apart.
"""

from __future__ import annotations

import gc
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from math import log
from pathlib import Path
from re import findall
from tempfile import TemporaryDirectory, TemporaryFile
from time import perf_counter, process_time, sleep
from typing import TYPE_CHECKING, NamedTuple

from benchmarks.day import PROGRAM as DAY
from benchmarks.day import resident_mb
from benchmarks.measure import ROOT, environment, time_of
from benchmarks.table import Row, Time, print_rows, timed_row

if TYPE_CHECKING:
    from elitescript import VirtualRobot
    from elitescript.language.compiler import CompiledUnit

HOURS = int(os.environ.get("GROWTH_HOURS", "720"))
SERVED_S = float(os.environ.get("GROWTH_SECONDS", "4"))
LEAST_S = 1e-9
"""Served robots at rest may sleep through the whole measurement."""
SMALL = """
def job():
  movej([0.3, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  set_standard_digital_out(0, True)
  sleep(0.5)
  textmsg("the arm is at ", get_actual_tcp_pose())
end
"""
WITH_CAMERA = """
def job():
  n = 0
  while n < 100:
    n = n + 1
    movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    set_standard_digital_out(0, True)
    socket_open("127.0.0.1", 5000, "camera")
    socket_send_string("shot", "camera")
    got = socket_read_string("camera", timeout=0.5)
    socket_close("camera")
    movej([-0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    set_standard_digital_out(0, False)
  end
end
"""
CAMERA = """
[[tcp]]
name = "camera{number}"
port = {port}
latency_s = 0.1
replies = [{{ match = 'shot', send = 'seen' }}]
"""
WIRE = """
[[wire]]
when = "standard_digital_out[{output}]"
then = "input_bool_register[{register}]"
after_s = 0.1
"""


class Figure(NamedTuple):
    """What was done, or what was held after it."""

    what: str
    time: Time = Time(0.0, 0.0)
    collector_s: float = 0.0
    """CPU time of the garbage collector in it."""
    amount: float | None = None
    unit: str = "kB"


class Collector:
    """Sums the CPU time of the garbage collector: it goes through all that lives when that has grown by a quarter."""

    def __init__(self) -> None:
        self.used_s = self._began = 0.0
        gc.callbacks.append(self._called)

    def _called(self, phase: str, _: object) -> None:
        if phase == "start":
            self._began = process_time()
        else:
            self.used_s += process_time() - self._began


COLLECTOR = Collector()


def done(what: str, step: Callable[[], object]) -> Figure:
    """Do it, and return what it took."""
    before = COLLECTOR.used_s
    time = time_of(step)
    return Figure(what, time, COLLECTOR.used_s - before)


def held(what: str, before_mb: float) -> Figure:
    """Return the memory that has come since there was so much."""
    return Figure(f"memory after {what}", amount=(resident_mb() - before_mb) * 1e3)


def peaked(what: str, step: Callable[[], object]) -> Iterator[Figure]:
    """Do it, and return what it took, and by how much more memory it has held at most; Linux tells that."""
    status = Path("/proc/self/status")
    gc.collect()
    before_kb = 0.0
    if status.exists():
        # The most that was held begins anew.
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
        before_kb = _kb(status, "VmHWM:")
    yield done(what, step)
    yield Figure(f"peak memory of {what}", amount=_kb(status, "VmHWM:") - before_kb if status.exists() else 0.0)


def _kb(status: Path, name: str) -> float:
    lines = status.read_text(encoding="ascii").splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith(name))


def begin(robot: VirtualRobot, program: str | CompiledUnit) -> None:
    """Begin a program, and leave the robot in the middle of it."""
    robot.start(program)
    robot.advance(0.5)


def robots(count: int) -> Iterator[Figure]:
    """Make robots that all live on, run a small program on each, and leave each in the middle of one."""
    from elitescript import VirtualRobot

    VirtualRobot().run(SMALL).check()
    made: list[VirtualRobot] = []
    steps: dict[str, Callable[[], object]] = {
        "make": lambda: made.extend([VirtualRobot() for _ in range(count)]),
        "run a small program": lambda: [robot.run(SMALL).check() for robot in made],
        "begin a program": lambda: [begin(robot, SMALL) for robot in made],
    }
    gc.collect()
    before = resident_mb()
    for what, step in steps.items():
        yield done(what, step)
        yield held(what, before)


def programs(lines: int) -> Iterator[Figure]:
    """Compile, check and start a program of movements, outputs, loops and functions.

    One line in 34 begins a function. Python's own compiler takes a time that grows with functions times names of the
    function around them: 600 us for each of 16,000 functions in one block.
    """
    from elitescript import VirtualRobot
    from elitescript.language.compiler import compile_task
    from elitescript.language.parser import parse
    from elitescript.language.symbols import Symbols
    from elitescript.language.text.source import SourceFile
    from elitescript.lint.engine import check_source
    from elitescript.messages.profile import profile
    from elitescript.values.program import Values

    part = (
        "  movej([{k}, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)\n"
        "  set_standard_digital_out(1, True)\n"
        "  for i in range(3):\n    count = i + {k}\n  end\n"
        "  movel([0.4, -0.2, {k}, 3.14, 0, 0], a=1.2, v=0.25, r=0.001)\n"
        "  if count > {n}:\n    textmsg(count)\n  end\n"
        "  sleep(0.1)\n"
    )
    function = "  def place{n}(x):\n    return x + 1\n  end\n  place{n}(count)\n"
    text = "".join(
        part.format(n=n, k=0.3 + n % 100 * 0.001) + (function.format(n=n) if n % 3 == 2 else "")
        for n in range(max(1, (lines - 3) * 3 // 34))
    )
    source = SourceFile("long.script", f"def job():\n  sleep(1)\n{text}end\n")
    compile_task(SourceFile("short.script", SMALL))
    check_source(SourceFile("short.script", SMALL), profile())
    before, units, robot = resident_mb(), [], VirtualRobot()
    yield done("compile", lambda: units.append(compile_task(source)))
    yield held("compile", before)
    yield done("check", lambda: check_source(source, profile()))
    symbols = Symbols(parse(source))
    yield done("check: values of expressions", lambda: Values(symbols))
    yield done("start", lambda: begin(robot, units[0]))


def checks(lines: int) -> Iterator[Figure]:
    """Check texts of so many lines, of each kind."""
    from benchmarks.checking import KINDS, text_of
    from elitescript.language.text.source import SourceFile
    from elitescript.lint.engine import check_source
    from elitescript.messages.profile import profile

    for kind in KINDS:
        # What is loaded and computed once does not count.
        check_source(SourceFile("short.script", text_of(kind, 20)), profile())
    for kind in KINDS:
        source = SourceFile("long.script", text_of(kind, lines))
        yield from peaked(f"check of {kind}", lambda source=source: check_source(source, profile()))  # type: ignore[misc]


STRAIGHT: dict[str, str] = {
    "straight movej": "  movej([0.{k}, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)\n",
    "straight movel": "  movel([0.4, -0.2, 0.{k}, 3.14, 0, 0], a=1.2, v=0.25)\n",
    "straight servoj": "  servoj([0.{k}, -1.4, -1.7, -1.6, 1.57, 0], t=0.004, lookahead_time=0.1, gain=300)\n",
    "outputs": "  set_standard_digital_out({d}, {is_odd})\n",
    "nested functions": (
        "  def part{n}(x):\n    def inner(y):\n      return y + {d}\n    end\n    return inner(x)\n  end\n"
        "  set_standard_digital_out({d}, part{n}({d}) > 3)\n"
    ),
    "elif": (
        "  n = {d}\n  if n == 0:\n    set_standard_digital_out(0, True)\n"
        + "".join(f"  elif n == {k}:\n    set_standard_digital_out({k}, {k % 2 == 0})\n" for k in range(1, 8))
        + "  end\n"
    ),
    "long list": "    [0.{k}, -1.4, -1.7, -1.6, 1.57, 0],\n",
    "long text": '    "{n} {k}"\n',
    "point file": "0.{k} -1.4 -1.7 -1.6 1.57 0\n",
}
"""Lines of programs that are run to their end; the last three are of one list, one text, and a file
that a program of a few lines goes through."""
POINTS = "points.txt"
POINT_READER = """
def job():
  for row in open("points.txt"):
    q = [float(part) for part in row.split()]
    set_standard_digital_out(0, q[0] > 0.3)
  end
end
"""


def straight_text(kind: str, lines: int) -> str:
    """Return a program of about so many lines, most of which run once."""
    part = STRAIGHT[kind]
    count = max(1, lines // part.count("\n"))
    body = "".join(part.format(n=n, k=100 + n * 7 % 400, d=n % 8, is_odd=n % 16 < 8) for n in range(count))
    if kind == "long list":
        body = f"  points = [\n{body}  ]\n  for q in points:\n    set_standard_digital_out(0, q[0] > 0.3)\n  end\n"
    elif kind == "long text":
        body = f"  words = (\n{body}  )\n  textmsg(len(words))\n"
    elif kind == "point file":
        return body
    return f"def job():\n{body}end\n"


def straight(lines: int) -> Iterator[Figure]:
    """Run programs of so many lines to their end."""
    from elitescript import VirtualRobot
    from elitescript.language.compiler import compile_task
    from elitescript.language.text.source import SourceFile

    robot = VirtualRobot(task_dir={POINTS: straight_text("point file", lines).encode()})
    programs = {kind: POINT_READER if kind == "point file" else straight_text(kind, lines) for kind in STRAIGHT}
    for kind in STRAIGHT:
        # What is loaded and computed once does not count.
        VirtualRobot(task_dir={POINTS: b""}).run(POINT_READER).check()
        robot.run(straight_text(kind, 20) if kind != "point file" else SMALL).check()
    for kind, program in programs.items():
        source = SourceFile("straight.script", program)
        units: list[CompiledUnit] = []
        yield from peaked(f"compile {kind}", lambda source=source, units=units: units.append(compile_task(source)))  # type: ignore[misc]
        yield from peaked(f"run of {kind}", lambda units=units: robot.run(units.pop()).check())  # type: ignore[misc]


def worlds(devices: int) -> Iterator[Figure]:
    """Make a robot with cameras and wires around it, and run a program that uses the first camera."""
    from elitescript import VirtualRobot

    with TemporaryDirectory() as folder:
        file = Path(folder) / "world.toml"

        def robot_with(cameras: int, wires: int) -> VirtualRobot:
            file.write_text(
                "".join(CAMERA.format(number=n, port=5000 + n) for n in range(cameras))
                + "".join(WIRE.format(output=n % 8, register=n % 64) for n in range(wires)),
                encoding="utf-8",
            )
            return VirtualRobot(world=file)

        robot_with(1, 1).run(WITH_CAMERA).check()
        made: list[VirtualRobot] = []
        before = resident_mb()
        yield done("make", lambda: made.append(robot_with((devices + 1) // 2, devices // 2)))
        yield held("make", before)
        yield done("run 313 s", lambda: made[0].run(WITH_CAMERA).check())


def runs(hours: int) -> Iterator[Figure]:
    """Run pick and place for so many hours, with a listener that keeps nothing; memory is what the run has added."""
    from elitescript import VirtualRobot

    robot = VirtualRobot("CS66")
    run = robot.start(DAY)
    robot.advance(60.0)
    before = resident_mb()
    yield done("run", lambda: robot.advance(hours * 3600.0 - 60.0))
    yield held("run", before)
    records = len(run.events) + len(run.log) + len(run.trace) + len(run.warnings)
    yield Figure("records kept", amount=records, unit="records")


def served(count: int) -> Iterator[Figure]:
    """Serve robots without clients, arms at rest; needs Linux.

    On a computer that is too slow for so many, ticks are left out, which `serve` says; they do not count.
    """
    from benchmarks.serving import processes_of, served, used_s

    began = perf_counter()
    with TemporaryFile() as said, served("--robots", str(count), stderr=said) as (_, pid):
        yield Figure("begin to serve", Time(perf_counter() - began, sum(used_s(processes_of(pid)))))
        sleep(1.0)
        processes = processes_of(pid)
        before, place, began = sum(used_s(processes)), os.fstat(said.fileno()).st_size, perf_counter()
        sleep(SERVED_S)
        seconds, used = perf_counter() - began, sum(used_s(processes)) - before
        new = os.pread(said.fileno(), 1 << 24, place)
        left_out = sum(map(int, findall(rb"(\d+) ticks of the robot are left out", new)))
        ticks = count * seconds * 250 - left_out
        yield Figure("tick at rest", Time(count * seconds / ticks, count * used / ticks))
        yield Figure("ticks left out in a second", amount=left_out / seconds, unit="ticks")
        yield Figure("memory", amount=sum(map(_proportional_kb, processes)))


def _proportional_kb(pid: int) -> float:
    """Return the memory of a process, shared pages divided among those that share them, kB."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii").splitlines()
    return next(float(line.split()[1]) for line in lines if line.startswith("Pss:"))


TABLES: dict[str, tuple[Callable[[int], Iterator[Figure]], tuple[int, ...], str]] = {
    "robots": (robots, (1, 10, 100, 1000), "robot"),
    "programs": (programs, (100, 1000, 10_000, 100_000), "line"),
    "checks": (checks, (1000, 5000, 10_000, 20_000, 40_000), "line"),
    "straight": (straight, (1000, 5000, 10_000, 20_000, 40_000), "line"),
    "worlds": (worlds, (1, 10, 100, 1000), "device"),
    "runs": (runs, (*[hours for hours in (1, 10, 100) if hours < HOURS], HOURS), "hour"),
    "served": (served, (1, 5, 10, 25), "robot"),
}


def rows() -> list[Row]:
    """Every table."""
    return [row for name in TABLES if name != "served" or sys.platform == "linux" for row in table(name)]


def table(name: str) -> list[Row]:
    """The rows of one table: each figure at each size, and how it grows."""
    _, sizes, one = TABLES[name]
    found = [_measured(name, size) for size in sizes]
    lines: list[Row] = []
    for column in zip(*found, strict=True):
        for size, figure in zip(sizes, column, strict=True):
            title = f"{name}, {size}: {figure.what}, of one {one}"
            if figure.amount is not None:
                lines.append(Row(title, figure.unit, value=figure.amount / size))
                continue
            time = Time(figure.time.wall_s / size, figure.time.cpu_s / size)
            share = figure.collector_s / max(figure.time.cpu_s, LEAST_S)
            words = f"of it {share:.0%} garbage collector" if share >= 0.01 else ""
            lines.append(timed_row(title, time, _unit(time.cpu_s), words=words))
        if len(sizes) == 1:
            # `GROWTH_HOURS=1` leaves one.
            continue
        words = f"from {sizes[-2]} to {sizes[-1]}"
        if column[0].amount is None:
            with_collector = _exponent(sizes, [max(figure.time.cpu_s, LEAST_S) for figure in column])
            without = _exponent(sizes, [max(figure.time.cpu_s - figure.collector_s, LEAST_S) for figure in column])
            words += f"; {with_collector:.2f} with the garbage collector"
            lines.append(Row(f"{name}: growth of {column[0].what}", value=without, words=words))
        else:
            amounts = [max(1.0, figure.amount or 0.0) for figure in column]
            lines.append(Row(f"{name}: growth of {column[0].what}", value=_exponent(sizes, amounts), words=words))
    return lines


def _exponent(sizes: tuple[int, ...], totals: list[float]) -> float:
    """Return how the total has grown between the last two sizes: 1 is linear, 2 quadratic."""
    return log(totals[-1] / totals[-2]) / log(sizes[-1] / sizes[-2])


def _unit(time_s: float) -> str:
    return "s" if time_s >= 1.0 else "ms" if time_s >= 1e-3 else "us"


def _measured(name: str, size: int) -> list[Figure]:
    command = [sys.executable, "-m", "benchmarks.growth", name, str(size)]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT, env=environment())
    return [Figure(what, Time(*time), *rest) for what, time, *rest in json.loads(done.stdout)]


if __name__ == "__main__":
    if sys.argv[-1].isdecimal():
        print(json.dumps(list(TABLES[sys.argv[1]][0](int(sys.argv[2])))))
    else:
        print_rows(row for name in sys.argv[1:] or TABLES for row in table(name))
