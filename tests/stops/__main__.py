"""`make stops`: endless programs on a served robot, and how soon a stop, a pause, an emergency stop or a new one acts.

    python -m tests.stops --shard 1/8              every eighth program
    python -m tests.stops --only movel --only re   those whose names have one of these words

One `serve` runs many programs. Beside them an RTSI client reads 250 packages a second: from what it gets when follows
how late the stream is (its time against the wall clock, less the best of the session), how much robot time passes, and
when what was asked for shows. Figures are of this computer at that time; programs beyond a limit are listed.
"""

from __future__ import annotations

import argparse
import asyncio
import gc
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Final, NamedTuple

from elitescript.client.rtsi import RtsiClient, rtsi_client
from elitescript.services.control.channel import exchange
from tests.stops.programs import FURTHER, programs

ACTIONS: Final = ("stop", "pause", "estop", "replace")
WARM_S: Final = 0.1
"""The begin of a program, whose figures do not count: the first ticks are free, and modules are loaded in them."""
RUN_S: Final = 0.8
"""How long it runs on before something is asked for."""
PATIENCE_S: Final = 6.0
STOP_MS: Final = 20.0
LATE_MS: Final = 10.0
SHARE: Final = 0.99
PLAYING, PAUSED, STOPPED = 1, 2, 3
NAMES: Final = ("timestamp", "runtime_state", "safety_status", "output_int_register0")


class Row(NamedTuple):
    """One program and one action."""

    program: str
    action: str
    acted_ms: float | None
    late_p99_ms: float
    share: float
    """Robot time against the wall clock, while the program ran."""
    alarm: str
    """Code and line of an alarm; empty without one."""

    @property
    def holds(self) -> bool:
        """Whether it is within the limits; an alarm on a line is an answer too."""
        acted = self.acted_ms is not None and self.acted_ms <= STOP_MS
        return acted and (self.late_p99_ms <= LATE_MS or bool(self.alarm)) and (self.share >= SHARE or bool(self.alarm))


class Stream:
    """What the RTSI client has got: wall time, robot time, state, safety, register of each package."""

    def __init__(self, client: RtsiClient) -> None:
        self._client = client
        self.rows: list[tuple[float, float, int, int, int]] = []
        self.best_s = float("inf")
        self._news = asyncio.Event()

    async def run(self) -> None:
        layout = await self._client.set_up_outputs(NAMES, 250.0)
        assert tuple(layout.names) == NAMES, layout.names
        getters = [layout.getter(name) for name in NAMES]
        await self._client.start()
        while True:
            found = await self._client.packages(60.0)
            now = time.monotonic()
            for layout, payload in found:
                values = layout.flat(payload)
                row = (now, *(get(values) for get in getters))
                self.best_s = min(self.best_s, now - row[1])
                self.rows.append(row)  # type: ignore[arg-type]
            self._news.set()

    async def until(self, index: int, wanted: int, begin: int, limit_s: float) -> float | None:
        """Return the wall time of the first package from `begin` on whose column has a value."""
        end = time.monotonic() + limit_s
        while True:
            for row in self.rows[begin:]:
                if row[index] == wanted:
                    return row[0]
            begin = max(begin, len(self.rows) - 1)
            self._news.clear()
            try:
                await asyncio.wait_for(self._news.wait(), end - time.monotonic())
            except TimeoutError:
                return None


class Session:
    """A `serve` and its clients."""

    def __init__(self, options: argparse.Namespace, folder: Path) -> None:
        self._options = options
        self.journal = folder / "stops.journal"
        self.alarms: list[dict[str, Any]] = []
        self.number = 0

    async def __aenter__(self) -> Session:
        command = [sys.executable, "-m", "elitescript", "serve", "--json", "--power-on", "--port", "all=0"]
        command += ["--instance", str(self._options.instance)]
        if self._options.journal:
            self.journal.unlink(missing_ok=True)
            command += ["--journal", str(self.journal)]
        if self._options.in_process:
            command += ["--in-process"]
        self._process = await asyncio.create_subprocess_exec(*command, stdout=subprocess.PIPE, limit=1 << 26)
        assert self._process.stdout is not None
        while True:
            ready = json.loads(await self._process.stdout.readline())
            if ready.get("type") == "ready":
                break
        robot = ready["robots"][0]
        self._ports: dict[str, int] = robot["ports"]
        self.ctl = Path(robot["ctl"])
        self._reading = asyncio.create_task(self._read())
        self._client = rtsi_client("127.0.0.1", self._ports["rtsi"])
        self.stream = Stream(await self._client.__aenter__())
        self._streaming = asyncio.create_task(self.stream.run())
        self._dashboard = await asyncio.open_connection("127.0.0.1", self._ports["dashboard"])
        await self._dashboard[0].readline()
        await asyncio.sleep(1.0)
        return self

    async def __aexit__(self, *details: object) -> None:
        for task in (self._reading, self._streaming):
            task.cancel()
        self._dashboard[1].close()
        self._process.terminate()
        await self._process.wait()

    async def _read(self) -> None:
        assert self._process.stdout is not None
        while line := await self._process.stdout.readline():
            record = json.loads(line)
            if record.get("type") == "alarm":
                self.alarms.append(record)
            if self._options.verbose and record.get("type") not in ("text", "message", "print", "printed", "channel"):
                print(line.decode()[:300].rstrip(), file=sys.stderr)

    async def send(self, text: str) -> None:
        _, writer = await asyncio.open_connection("127.0.0.1", self._ports["primary"])
        writer.write(text.encode())
        await writer.drain()
        writer.close()

    async def dashboard(self, line: str) -> None:
        self._dashboard[1].write(line.encode() + b"\n")

    async def measure(self, name: str, text: str, action: str) -> Row:
        """Run a program, and do something to it."""
        stream = self.stream
        self.alarms.clear()
        begin = len(stream.rows)
        await self.send(text)
        if await stream.until(2, PLAYING, begin, PATIENCE_S) is None:
            return Row(name, action, None, 0.0, 1.0, self._alarm() or "did not start")
        await asyncio.sleep(WARM_S)
        began = len(stream.rows)
        # What hangs for 0.7 s is ended anyhow: what is asked for has to come before.
        await asyncio.sleep(RUN_S if "one call" not in name else WARM_S)
        if stream.rows[-1][2] != PLAYING and self._alarm():
            await self._calm()
            return self._row(name, action, 0.0, began, len(stream.rows))
        alarm = self._alarm()
        at, since = len(stream.rows), time.monotonic()
        acted = await self._act(action, at)
        end = len(stream.rows)
        acted_ms = None if acted is None else (acted - since) * 1000.0
        await self._calm()
        return self._row(name, action, acted_ms, began, end)._replace(alarm=alarm)

    async def _act(self, action: str, at: int) -> float | None:
        if action == "stop":
            await self.dashboard("stop")
            return await self.stream.until(2, STOPPED, at, PATIENCE_S)
        if action == "pause":
            await self.dashboard("pause")
            return await self.stream.until(2, PAUSED, at, PATIENCE_S)
        if action == "replace":
            self.number += 1
            await self.send(f"def other():\n  write_output_integer_register(0, {self.number})\nend\n")
            return await self.stream.until(4, self.number, at, PATIENCE_S)
        normal = self.stream.rows[-1][3]
        asking = asyncio.create_task(exchange(self.ctl, "estop", [], {}))
        found = None
        end = time.monotonic() + PATIENCE_S
        place = at
        while found is None and time.monotonic() < end:
            rows = self.stream.rows
            found = next((row[0] for row in rows[place:] if row[3] != normal), None)
            place = len(rows)
            await asyncio.sleep(0.0005)
        await asking
        return found

    async def _calm(self) -> None:
        """Bring the robot back to where it was."""
        at = len(self.stream.rows)
        await self.dashboard("stop")
        await self.stream.until(2, STOPPED, at, 3 * PATIENCE_S)
        if self._needs_power:
            await exchange(self.ctl, "release", [], {})
            await self.dashboard("robotControl -on")
            await asyncio.sleep(0.2)
            await self.dashboard("brakeRelease")
            await asyncio.sleep(0.3)
        await asyncio.sleep(0.1)

    @property
    def _needs_power(self) -> bool:
        return self.stream.rows[-1][3] != 1

    def _alarm(self) -> str:
        return " ".join(f"{alarm.get('code')}:{alarm.get('line')}" for alarm in self.alarms[:2])

    def _row(self, name: str, action: str, acted_ms: float | None, began: int, end: int) -> Row:
        rows = self.stream.rows[began:end]
        late = sorted(row[0] - row[1] - self.stream.best_s for row in rows)
        p99 = late[min(len(late) - 1, int(len(late) * 0.99))] * 1000.0 if late else 0.0
        wall = rows[-1][0] - rows[0][0] if len(rows) > 1 else 0.0
        share = (rows[-1][1] - rows[0][1]) / wall if wall > 0 else 1.0
        return Row(name, action, acted_ms, p99, share, self._alarm())


async def run(options: argparse.Namespace) -> int:
    """Measure what was asked for; return how many rows do not hold."""
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
    rows: list[Row] = []
    async with Session(options, folder) as session:
        for name, text in chosen.items():
            for action in options.actions.split(","):
                row = await session.measure(name, text, action)
                rows.append(row)
                if options.verbose or not row.holds:
                    print(shown(row), flush=True)
    (folder / f"{number}.json").write_text(json.dumps([row._asdict() for row in rows], indent=1))
    bad = [row for row in rows if not row.holds]
    acted = sorted(row.acted_ms for row in rows if row.acted_ms is not None)
    late = sorted(row.late_p99_ms for row in rows)
    shares = sorted(row.share for row in rows)
    if acted:
        print(
            f"{len(rows)} runs of {len(chosen)} programs: {len(rows) - len(bad)} hold; acted after "
            f"{acted[len(acted) // 2]:.1f} ms (median), {acted[int(len(acted) * 0.99)]:.1f} (p99), "
            f"{acted[-1]:.1f} (most); "
            f"streams late by {late[len(late) // 2]:.1f} ms (median of p99), {late[-1]:.1f} (most); "
            f"robot time {shares[0]:.3f} of wall time (least)"
        )
    return len(bad)


def shown(row: Row) -> str:
    """Return a row as a line."""
    acted = "never" if row.acted_ms is None else f"{row.acted_ms:7.1f} ms"
    return (
        f"{'ok  ' if row.holds else 'LATE'} {row.program:45} {row.action:8} {acted:>11}"
        f"  late p99 {row.late_p99_ms:7.1f} ms  robot time {row.share:.3f}  {row.alarm}"
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
    parser.add_argument("--verbose", action="store_true")
    return 1 if asyncio.run(run(parser.parse_args())) else 0


if __name__ == "__main__":
    sys.exit(main())
