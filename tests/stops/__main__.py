"""`make stops`: endless programs on a served robot, and how soon a stop, a pause, an emergency stop or a new one acts.

    python -m tests.stops --shard 1/8              every eighth program
    python -m tests.stops --only movel --only re   those whose names have one of these words

One `serve` runs many programs. Beside them an RTSI client reads 250 packages a second: from what it gets when follows
how late the stream is, how much robot time passes, and when what was asked for shows. A package counts as it was at the
socket of the client, by the stamp of the operating system: how soon this process reads it is no matter of the robot.
Its lateness is its robot time against the wall clock, less that of the best package of the rest before the program.

Another `serve` beside it has a program that only calls `sync()`. Its stream, measured in the same way at the same time,
shows what this computer adds. The p99 of a program is that of its packages of all actions together (some 800); one that
does not hold is measured again, `--again` times, since what a computer does beside it comes once and a mechanism
comes back. A program is late if it never holds.
"""

from __future__ import annotations

import argparse
import asyncio
import gc
import json
import os
import struct
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

from benchmarks.serving import Stream, message
from elitescript.services.control.channel import exchange
from tests.stops.programs import FURTHER, programs

ACTIONS: Final = ("stop", "pause", "estop", "replace")
WARM_S: Final = 0.1
"""The begin of a program, whose figures do not count: the first ticks are free, and modules are loaded in them."""
RUN_S: Final = 0.8
"""How long it runs on before something is asked for."""
REST_S: Final = 0.15
"""Between two programs; the best package of it is the base of what comes later."""
ENDS: Final = 20
"""Packages at both ends of a run whose best ones say how much robot time has passed."""
PATIENCE_S: Final = 6.0
STOP_MS: Final = 20.0
LATE_MS: Final = 10.0
SHARE: Final = 0.99
PLAYING, PAUSED, STOPPED = 1, 2, 3
NAMES: Final = "timestamp,runtime_state,safety_status,output_int_register0"
_PACKAGE: Final = struct.Struct(">dIii")
IDLE: Final = "def idle():\n  while True:\n    sync()\n  end\nend\n"
"""The program of the robot beside it."""


class Row(NamedTuple):
    """One program and one action."""

    program: str
    action: str
    acted_ms: float | None
    late_ms: tuple[float, ...]
    """Of each package while the program ran."""
    beside_ms: tuple[float, ...]
    """The same of the robot beside it."""
    share: float
    """Robot time against the wall clock, while the program ran."""
    alarm: str
    """Code and line of an alarm; empty without one."""


class Verdict(NamedTuple):
    """One program with all actions."""

    program: str
    acted_ms: float | None
    """The latest of the actions; None if one never acted."""
    late_p99_ms: float
    beside_p99_ms: float
    share: float
    """The one that is furthest from 1."""
    alarm: str

    @property
    def holds(self) -> bool:
        """Whether it is within the limits; an alarm on a line is an answer too."""
        if self.acted_ms is None or self.acted_ms > STOP_MS:
            return False
        return bool(self.alarm) or (self.late_p99_ms <= LATE_MS and abs(1.0 - self.share) <= 1.0 - SHARE)


def verdict(rows: Sequence[Row]) -> Verdict:
    """Return what the rows of one program make together."""
    acted = [row.acted_ms for row in rows if row.acted_ms is not None]
    return Verdict(
        rows[0].program,
        max(acted) if len(acted) == len(rows) else None,
        quantile([late for row in rows for late in row.late_ms], 0.99),
        quantile([late for row in rows for late in row.beside_ms], 0.99),
        max((row.share for row in rows), key=lambda share: abs(1.0 - share)),
        next((row.alarm for row in rows if row.alarm), ""),
    )


def quantile(values: Iterable[float], part: float) -> float:
    """Return the value that so many are not above; 0 without any."""
    found = sorted(values)
    return found[min(len(found) - 1, int(len(found) * part))] if found else 0.0


class Watched(Stream):
    """What an RTSI client has got: wall time at its socket, robot time, state, safety, register of each package."""

    def __init__(self, port: int) -> None:
        super().__init__(port, NAMES)
        self.rows: list[tuple[float, float, int, int, int]] = []
        self._news = asyncio.Event()
        self.socket.sendall(message("S"))
        self.socket.setblocking(False)
        asyncio.get_running_loop().add_reader(self.socket, self._read)

    def take(self, package: bytes, arrived: float) -> None:
        """See `Stream.take`."""
        self.rows.append((arrived, *_PACKAGE.unpack_from(package, 4)))

    def _read(self) -> None:
        try:
            self.read()
        except BlockingIOError:
            return
        self._news.set()

    def close(self) -> None:
        """Hang up."""
        asyncio.get_running_loop().remove_reader(self.socket)
        self.socket.close()

    def late_ms(self, rows: Iterable[tuple[float, float, int, int, int]], base_s: float) -> tuple[float, ...]:
        """Return how late packages were against the least delay."""
        return tuple((row[0] - row[1] - base_s) * 1000.0 for row in rows)

    async def until(self, index: int, wanted: int, begin: int, limit_s: float) -> float | None:
        """Return the wall time of the first package from `begin` on whose column has a value."""
        end = time.perf_counter() + limit_s
        while True:
            for row in self.rows[begin:]:
                if row[index] == wanted:
                    return row[0]
            begin = max(begin, len(self.rows) - 1)
            self._news.clear()
            try:
                await asyncio.wait_for(self._news.wait(), end - time.perf_counter())
            except TimeoutError:
                return None


class Served:
    """A `serve` of its own, and what it says."""

    def __init__(self, words: Sequence[str], *, is_verbose: bool = False) -> None:
        self._words = words
        self._is_verbose = is_verbose
        self.alarms: list[dict[str, Any]] = []

    async def __aenter__(self) -> Served:
        command = [sys.executable, "-m", "elitescript", "serve", "--json", "--power-on", "--port", "all=0"]
        self._process = await asyncio.create_subprocess_exec(
            *command, *self._words, stdout=subprocess.PIPE, limit=1 << 26
        )
        assert self._process.stdout is not None
        while True:
            ready = json.loads(await self._process.stdout.readline())
            if ready.get("type") == "ready":
                break
        robot = ready["robots"][0]
        self.ports: dict[str, int] = robot["ports"]
        self.ctl = Path(robot["ctl"])
        self._reading = asyncio.create_task(self._read())
        self.stream = Watched(self.ports["rtsi"])
        return self

    async def __aexit__(self, *details: object) -> None:
        self.stream.close()
        self._reading.cancel()
        self._process.terminate()
        await self._process.wait()

    async def _read(self) -> None:
        assert self._process.stdout is not None
        while line := await self._process.stdout.readline():
            record = json.loads(line)
            if record.get("type") == "alarm":
                self.alarms.append(record)
            if self._is_verbose and record.get("type") not in ("text", "message", "print", "printed", "channel"):
                print(line.decode()[:300].rstrip(), file=sys.stderr)

    async def send(self, text: str) -> None:
        _, writer = await asyncio.open_connection("127.0.0.1", self.ports["primary"])
        writer.write(text.encode())
        await writer.drain()
        writer.close()


class Session:
    """The served robot that is measured, its clients, and the robot beside it."""

    def __init__(self, options: argparse.Namespace, folder: Path) -> None:
        words = ["--instance", str(options.instance)]
        if options.journal:
            journal = folder / "stops.journal"
            journal.unlink(missing_ok=True)
            words += ["--journal", str(journal)]
        if options.in_process:
            words += ["--in-process"]
        self._robot = Served(words, is_verbose=options.verbose)
        self._beside = Served(["--instance", str(options.instance + 1)])
        self.number = 0

    async def __aenter__(self) -> Session:
        await self._robot.__aenter__()
        await self._beside.__aenter__()
        await self._beside.send(IDLE)
        self._dashboard = await asyncio.open_connection("127.0.0.1", self._robot.ports["dashboard"])
        await self._dashboard[0].readline()
        await asyncio.sleep(1.0)
        return self

    async def __aexit__(self, *details: object) -> None:
        self._dashboard[1].close()
        await self._robot.__aexit__()
        await self._beside.__aexit__()

    async def dashboard(self, line: str) -> None:
        self._dashboard[1].write(line.encode() + b"\n")

    async def measure(self, name: str, text: str, action: str) -> Row:
        """Run a program, and do something to it."""
        stream, beside = self._robot.stream, self._beside.stream
        self._robot.alarms.clear()
        # What has come before is not looked at any more.
        del stream.rows[:], stream.times[:], beside.rows[:], beside.times[:]
        await asyncio.sleep(REST_S)
        while not (stream.rows and beside.rows):
            await asyncio.sleep(REST_S)
        self._base_s = [min(row[0] - row[1] for row in found.rows) for found in (stream, beside)]
        begin = len(stream.rows)
        await self._robot.send(text)
        if await stream.until(2, PLAYING, begin, PATIENCE_S) is None:
            return Row(name, action, None, (), (), 1.0, self._alarm() or "did not start")
        await asyncio.sleep(WARM_S)
        began = len(stream.rows)
        # What hangs for 0.7 s is ended anyhow: what is asked for has to come before.
        await asyncio.sleep(RUN_S if "one call" not in name else WARM_S)
        if stream.rows[-1][2] != PLAYING and self._alarm():
            end = len(stream.rows)
            await self._calm()
            return self._row(name, action, 0.0, began, end)
        alarm = self._alarm()
        at, since = len(stream.rows), time.perf_counter()
        acted = await self._act(action, at)
        end = len(stream.rows)
        acted_ms = None if acted is None else (acted - since) * 1000.0
        await self._calm()
        return self._row(name, action, acted_ms, began, end)._replace(alarm=alarm)

    async def _act(self, action: str, at: int) -> float | None:
        if action == "stop":
            await self.dashboard("stop")
            return await self._robot.stream.until(2, STOPPED, at, PATIENCE_S)
        if action == "pause":
            await self.dashboard("pause")
            return await self._robot.stream.until(2, PAUSED, at, PATIENCE_S)
        if action == "replace":
            self.number += 1
            await self._robot.send(f"def other():\n  write_output_integer_register(0, {self.number})\nend\n")
            return await self._robot.stream.until(4, self.number, at, PATIENCE_S)
        normal = self._robot.stream.rows[-1][3]
        asking = asyncio.create_task(exchange(self._robot.ctl, "estop", [], {}))
        found = None
        end = time.perf_counter() + PATIENCE_S
        place = at
        while found is None and time.perf_counter() < end:
            rows = self._robot.stream.rows
            found = next((row[0] for row in rows[place:] if row[3] != normal), None)
            place = len(rows)
            await asyncio.sleep(0.0005)
        await asking
        return found

    async def _calm(self) -> None:
        """Bring the robot back to where it was."""
        at = len(self._robot.stream.rows)
        await self.dashboard("stop")
        await self._robot.stream.until(2, STOPPED, at, 3 * PATIENCE_S)
        if self._needs_power:
            await exchange(self._robot.ctl, "release", [], {})
            await self.dashboard("robotControl -on")
            await asyncio.sleep(0.2)
            await self.dashboard("brakeRelease")
            await asyncio.sleep(0.3)
        await asyncio.sleep(0.1)

    @property
    def _needs_power(self) -> bool:
        return self._robot.stream.rows[-1][3] != 1

    def _alarm(self) -> str:
        return " ".join(f"{alarm.get('code')}:{alarm.get('line')}" for alarm in self._robot.alarms[:2])

    def _row(self, name: str, action: str, acted_ms: float | None, began: int, end: int) -> Row:
        stream, beside = self._robot.stream, self._beside.stream
        base_s, beside_base_s = self._base_s
        rows = stream.rows[began:end]
        first, last = (rows[0][0], rows[-1][0]) if rows else (0.0, 0.0)
        late = stream.late_ms(rows, base_s)
        beside_late = beside.late_ms((row for row in beside.rows if first <= row[0] <= last), beside_base_s)
        # Of the best of some packages at both ends: one that is late by itself is no robot time that is missing.
        lost_ms = min(late[-ENDS:]) - min(late[:ENDS]) if len(late) >= 2 * ENDS else 0.0
        share = 1.0 - lost_ms / 1000.0 / (last - first) if last > first else 1.0
        return Row(name, action, acted_ms, late, beside_late, share, self._alarm())


async def run(options: argparse.Namespace) -> int:
    """Measure what was asked for; return how many programs never hold."""
    # A collection of what this process has kept would look like a late package.
    gc.disable()
    chosen = programs()
    if options.only:
        chosen = {name: text for name, text in chosen.items() if any(word in name for word in options.only)}
    if options.further:
        chosen = {name: text for name, text in chosen.items() if name in FURTHER}
    number, _, count = options.shard.partition("/")
    chosen = dict(list(chosen.items())[int(number) - 1 :: int(count)])
    folder = Path("build") / "stops"
    folder.mkdir(parents=True, exist_ok=True)
    found: dict[str, list[Verdict]] = {}
    rows: list[Row] = []
    async with Session(options, folder) as session:
        for attempt in range(1 + options.again):
            for name, text in chosen.items():
                if name in found and any(before.holds for before in found[name]):
                    continue
                own = [await session.measure(name, text, action) for action in options.actions.split(",")]
                rows += own
                found.setdefault(name, []).append(verdict(own))
                if options.verbose or not found[name][-1].holds:
                    print(shown(found[name][-1], own), flush=True)
            if not attempt and options.again:
                print(f"{sum(not tries[0].holds for tries in found.values())} are measured again", flush=True)
    kept = [verdict._asdict() for verdicts in found.values() for verdict in verdicts]
    (folder / f"{number}.json").write_text(json.dumps(kept, indent=1))
    print(summary(found, rows))
    return sum(not any(one.holds for one in tries) for tries in found.values())


def summary(found: dict[str, list[Verdict]], rows: Sequence[Row]) -> str:
    """Return what all programs together show, in lines."""
    tries = list(found.values())
    acted = sorted(row.acted_ms for row in rows if row.acted_ms is not None)
    late = [value for row in rows if not row.alarm for value in row.late_ms]
    beside = [value for row in rows if not row.alarm for value in row.beside_ms]
    lines = [
        f"{len(found)} programs, {len(rows)} runs: {sum(one[0].holds for one in tries)} hold, of the others "
        f"{sum(not one[0].holds and any(more.holds for more in one) for one in tries)} when measured again; "
        f"{sum(not any(more.holds for more in one) for one in tries)} never",
    ]
    if acted:
        lines.append(
            f"acted after {quantile(acted, 0.5):.1f} ms (median), {quantile(acted, 0.99):.1f} (p99), "
            f"{acted[-1]:.1f} (most); {sum(value > STOP_MS for value in acted)} of {len(acted)} beyond {STOP_MS:g}"
        )
    for what, values in (("packages", late), ("those of the robot beside it", beside)):
        lines.append(
            f"{what}: {len(values)}, late by {quantile(values, 0.5):.1f} ms (median), {quantile(values, 0.99):.1f} "
            f"(p99), {quantile(values, 0.999):.1f} (p99.9), {max(values, default=0.0):.1f} (most)"
        )
    shares = sorted((row.share for row in rows if not row.alarm), key=lambda share: abs(1.0 - share))
    if shares:
        lines.append(f"robot time {shares[-1]:.3f} of wall time (furthest from 1)")
    return "\n".join(lines)


def shown(found: Verdict, rows: Sequence[Row]) -> str:
    """Return the verdict of a program as a line."""
    acted = " ".join("never" if row.acted_ms is None else f"{row.acted_ms:.1f}" for row in rows)
    return (
        f"{'ok  ' if found.holds else 'LATE'} {found.program:45} acted {acted:>22} ms, late p99 "
        f"{found.late_p99_ms:6.1f} ms (beside {found.beside_p99_ms:5.1f}), robot time {found.share:.3f}  {found.alarm}"
    )


def main() -> int:
    """Return 0 if all programs hold."""
    parser = argparse.ArgumentParser(prog="python -m tests.stops")
    parser.add_argument("--shard", default="1/1")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--further", action="store_true", help="the programs that are no calls of the catalogue")
    parser.add_argument("--actions", default=",".join(ACTIONS))
    parser.add_argument("--instance", type=int, default=os.getpid() % 50 + 20)
    parser.add_argument("--journal", action="store_true")
    parser.add_argument("--in-process", action="store_true")
    parser.add_argument("--again", type=int, default=2, help="how often what does not hold is measured again")
    parser.add_argument("--verbose", action="store_true")
    return 1 if asyncio.run(run(parser.parse_args())) else 0


if __name__ == "__main__":
    sys.exit(main())
