"""Arms with hidden parameters are recorded, and what was hidden is looked for: `python -m tools.real_arm`.

Some arms are served by `elitescript serve` and recorded by `elitescript record` over loopback, through a relay that
loses packages of the RTSI port and delays others; they run by the wall clock. The rest is decoded from the same bytes
of the RTSI port in memory, with packages lost too. Then the fit is held against the truth: what is found, and how often
an interval of 95 % holds the true value. The result goes into docs/explanation/real-arm.md.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import random
import re
import signal
import struct
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from math import comb, inf
from pathlib import Path
from typing import Final, NamedTuple

from elitescript import VirtualRobot
from elitescript.audit.fit.lengths import fit_lengths
from elitescript.audit.fit.pairs import points_of_file
from elitescript.audit.fit.recordings import fit_recording
from elitescript.kinematics.transforms import pose_from_transform
from elitescript.models.model import load_model, parse_model
from elitescript.protocol.rtsi.recipes import DATA_PACKAGE
from elitescript.recorder.mcap_file import read_recording
from elitescript.recorder.recording import Recording
from elitescript.records import replace
from tests.audit.fit.hidden_arms import AUDITED_PROGRAM, HiddenArm, hidden_arm, recorded_in_memory

PAGE: Final = Path("docs/explanation/real-arm.md")
COMMAND: Final = "make real-arm"

LOST: Final = 0.02
"""Share of packages that the relay loses."""
LATE: Final = 0.02
"""Share of packages that come late, with all behind them."""
LATE_S: Final = 0.03
"""Longest delay."""
PATIENCE_S: Final = 300.0
"""Longest wall time of a wait."""
BEHIND_S: Final = 2.0
"""Time of a recording behind the end of the program."""
ODDS: Final = 1e-3
"""Probability below which a number of held intervals counts as refuted."""
POINTS: Final = 6
DIGITS: Final = 5
SHOWN: Final = 2
"""Arms whose parameters the page lists one by one."""


class Result(NamedTuple):
    """Parameters of one arm: true value, found value, interval, state."""

    seed: int
    rows: int
    gaps: int
    parameters: dict[str, tuple[float, float | None, tuple[float, float] | None, str]]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--network", type=int, default=40, metavar="N", help="arms recorded over the network")
    parser.add_argument("--memory", type=int, default=160, metavar="N", help="arms recorded in memory")
    parser.add_argument("--at-once", type=int, default=4, metavar="N", help="served arms at the same time")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes for those in memory")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the first arm")
    parser.add_argument("--no-page", action="store_true", help="print only")
    options = parser.parse_args()
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="real-arm-") as name:
        folder = Path(name)
        served = list(range(options.seed, options.seed + options.network))
        in_memory = list(range(options.seed + options.network, options.seed + options.network + options.memory))
        asyncio.run(_served(served, folder, options.at_once))
        with ProcessPoolExecutor(options.jobs) as pool:
            network = list(pool.map(partial(served_result, folder=name), served))
            memory = list(pool.map(partial(in_memory_result, folder=name), in_memory))
    points = [points_result(seed) for seed in (*served, *in_memory)]
    lines, is_good = report(network, memory, points, time.monotonic() - begin)
    print("\n".join(lines))
    if not options.no_page:
        _write(lines)
    return 0 if is_good else 1


# ---------------------------------------------------------------- one arm


def result_of(hidden: HiddenArm, recording: Recording) -> Result:
    """Return what a fit says of a recording beside the truth."""
    # The configuration that the controller shows has the lengths and limits: here they are to be found.
    kept = {name: value for name, value in recording.facts.items() if name not in ("lengths", "limits", "defaults")}
    fit = fit_recording(replace(recording, facts=kept), load_model("CS66"), AUDITED_PROGRAM)
    true = {**hidden.true, "payload_of_torques_kg": hidden.true["payload_kg"]}
    return Result(
        hidden.seed,
        len(recording.t),
        len(recording.gaps),
        {row.name: (true[row.name], row.found, row.interval, row.state) for row in fit.parameters if row.name in true},
    )


def in_memory_result(seed: int, folder: str) -> Result:
    """Return the result of one arm that is recorded in memory."""
    hidden = hidden_arm(seed)
    return result_of(hidden, recorded_in_memory(hidden, Path(folder), LOST))


def points_result(seed: int) -> Result:
    """Return the lengths of one arm from a few points of five digits."""
    hidden = hidden_arm(seed)
    arm = parse_model("hidden.toml", hidden.arm_file).arm
    rng = random.Random(seed)
    lines = []
    for _ in range(POINTS):
        q = [angle + rng.uniform(-0.8, 0.8) for angle in (0.4, -1.3, -1.7, -1.4, 1.5, 0.2)]
        lines.append(",".join(f"{value:.{DIGITS}f}" for value in (*q, *pose_from_transform(arm.forward(q)))))
    fit = fit_lengths(points_of_file("\n".join(lines), "points.csv"), load_model("CS66").arm)
    return Result(
        seed,
        POINTS,
        0,
        {row.name: (hidden.true[row.name], row.found, row.interval, row.state) for row in fit.parameters},
    )


# ---------------------------------------------------------------- over the network


async def _served(seeds: Sequence[int], folder: Path, at_once: int) -> None:
    free = asyncio.Semaphore(at_once)
    done = 0

    async def one(seed: int) -> None:
        nonlocal done
        async with free:
            await record_served(hidden_arm(seed), folder)
        done += 1
        print(f"{done} of {len(seeds)} served arms", file=sys.stderr, flush=True)

    async with asyncio.TaskGroup() as group:
        for seed in seeds:
            group.create_task(one(seed))


def served_result(seed: int, folder: str) -> Result:
    """Return the result of one arm that `record_served` has recorded."""
    return result_of(hidden_arm(seed), read_recording(Path(folder) / f"served{seed}.mcap"))


async def record_served(hidden: HiddenArm, folder: Path) -> None:
    """Serve an arm, and record it through the relay while its program runs."""
    arm, text = folder / f"served{hidden.seed}.toml", folder / f"served{hidden.seed}.script"
    arm.write_text(hidden.arm_file, encoding="utf-8")
    text.write_text(hidden.true_program, encoding="utf-8")
    slider = hidden.true["speed_slider"]
    lasts_s = VirtualRobot(str(arm), speed=slider).run(text, until_s=60.0).time_s
    out = folder / f"served{hidden.seed}.mcap"
    command = [sys.executable, "-P", "-m", "elitescript"]
    # Numbers of their own keep the addresses for `ctl` apart.
    serve = [*command, "serve", "--robot", str(arm), "--speed", str(slider), "--power-on", "--port", "all=0"]
    server = await asyncio.create_subprocess_exec(
        *serve,
        "--instance",
        str(60 + hidden.seed % 40),
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.DEVNULL,
    )
    try:
        ports = await _ports(server)
        async with _relay(ports["rtsi"], hidden.seed) as relay:
            recorder = await asyncio.create_subprocess_exec(
                *(*command, "record", "127.0.0.1", "--out", str(out)),
                *("--port", f"rtsi={relay.port}", "--port", f"primary={ports['primary']}"),
                *("--port", f"dashboard={ports['dashboard']}"),
                stdout=asyncio.subprocess.DEVNULL,
                stderr=asyncio.subprocess.DEVNULL,
            )
            # A busy computer serves time late: what counts is the time of the robot.
            await relay.passes(0.5)
            _, writer = await asyncio.open_connection("127.0.0.1", ports["primary"])
            writer.write(text.read_bytes())
            await writer.drain()
            await relay.passes(lasts_s + BEHIND_S)
            recorder.send_signal(signal.SIGINT)
            if await asyncio.wait_for(recorder.wait(), PATIENCE_S) != 0:
                raise RuntimeError(f"record has failed for arm {hidden.seed}")
            writer.close()
    finally:
        with contextlib.suppress(ProcessLookupError):
            server.terminate()
        await server.wait()


async def _ports(server: asyncio.subprocess.Process) -> dict[str, int]:
    assert server.stdout is not None
    while line := (await asyncio.wait_for(server.stdout.readline(), 60.0)).decode():
        if line.startswith("ready"):
            return {name: int(number) for name, number in re.findall(r"(\w+) (\d+)(?:,|$)", line.strip())}
    raise RuntimeError("serve has ended before it was ready")


class Relay:
    """Passes the packages of an RTSI port on, but for those that it loses, some of them late."""

    def __init__(self, port: int, seed: int) -> None:
        self._robot_port = port
        self._rng = random.Random(seed)
        self._tasks: set[asyncio.Task[None]] = set()
        self.port = 0
        """Where it listens."""
        self.robot_s = -inf
        """Time of the robot in the newest package."""

    async def passes(self, seconds: float) -> None:
        """Wait until so much time of the robot has passed."""
        async with asyncio.timeout(PATIENCE_S):
            while self.robot_s == -inf:
                await asyncio.sleep(0.1)
            end = self.robot_s + seconds
            while self.robot_s < end:
                await asyncio.sleep(0.1)

    async def client(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            robot_reader, robot_writer = await asyncio.open_connection("127.0.0.1", self._robot_port)
        except OSError:
            writer.close()
            return
        for work in (self._down(robot_reader, writer), self._up(reader, robot_writer)):
            self._tasks.add(asyncio.create_task(work))

    async def _down(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(asyncio.IncompleteReadError, ConnectionError):
            while True:
                head = await reader.readexactly(3)
                size, letter = struct.unpack(">HB", head)
                body = await reader.readexactly(size - 3)
                if letter == DATA_PACKAGE:
                    if body[0] == 1:
                        # The recorder asks for its rows first, and for the time first of all.
                        (self.robot_s,) = struct.unpack_from(">d", body, 1)
                    if self._rng.random() < LOST:
                        continue
                    if self._rng.random() < LATE:
                        await asyncio.sleep(self._rng.uniform(0.0, LATE_S))
                writer.write(head + body)
                await writer.drain()
        writer.close()

    async def _up(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(ConnectionError):
            while data := await reader.read(4096):
                writer.write(data)
        writer.close()

    def stop(self) -> None:
        for task in self._tasks:
            task.cancel()


@contextlib.asynccontextmanager
async def _relay(port: int, seed: int) -> AsyncIterator[Relay]:
    """Listen on a free port and pass the RTSI port on."""
    relay = Relay(port, seed)
    listener = await asyncio.start_server(relay.client, "127.0.0.1", 0)
    relay.port = listener.sockets[0].getsockname()[1]
    try:
        yield relay
    finally:
        listener.close()
        relay.stop()


# ---------------------------------------------------------------- the report


def report(
    network: Sequence[Result], memory: Sequence[Result], points: Sequence[Result], wall_s: float
) -> tuple[list[str], bool]:
    """Return the lines of the page, and whether no number refutes the intervals."""
    rows = sum(result.rows for result in network)
    lines = [
        f"`{COMMAND}`, elitescript: {len(network)} arms served and recorded over loopback ({rows:,} rows, "
        f"{sum(result.gaps for result in network):,} gaps, up to {1e3 * LATE_S:.0f} ms late), {len(memory)} arms "
        f"decoded in memory from the same bytes ({sum(result.gaps for result in memory):,} gaps); "
        f"{wall_s / 60.0:.0f} min.",
    ]
    is_good = True
    for title, results in (
        ("Recorded over the network", network),
        ("Recorded in memory", memory),
        (f"{POINTS} taught points of {DIGITS} digits", points),
    ):
        if not results:
            continue
        table, good = _coverage(results)
        is_good = is_good and good
        lines += ["", f"{title}, {len(results)} arms:", "", *table]
    for result in network[:SHOWN]:
        lines += ["", f"Arm {result.seed} over the network, {result.rows:,} rows with {result.gaps} gaps:", ""]
        lines += ["| parameter | true | found | 95 % interval |", "|---|---:|---:|---:|"]
        lines += [_row(name, *row) for name, row in result.parameters.items()]
    return lines, is_good


def _row(name: str, true: float, found: float | None, interval: tuple[float, float] | None, state: str) -> str:
    if found is None:
        return f"| `{name}` | {true:.7g} | | {state} |"
    if interval is None:
        return f"| `{name}` | {true:.7g} | at least {found:.5g} | |"
    return f"| `{name}` | {true:.7g} | {found:.7g} | ± {0.5 * (interval[1] - interval[0]):.1g} |"


def _coverage(results: Sequence[Result]) -> tuple[list[str], bool]:
    lines = [
        "| parameter | determined | held by the interval | share | largest error | median half width |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    is_good = True
    for name in results[0].parameters:
        rows = [result.parameters[name] for result in results]
        known = [
            (true, found, interval) for true, found, interval, _ in rows if interval is not None and found is not None
        ]
        if not known:
            bounds = [(true, found) for true, found, _, state in rows if state == "at least" and found is not None]
            held = sum(found <= true * (1.0 + 1e-9) for true, found in bounds)
            lines.append(f"| `{name}` | 0, at least x: {len(bounds)} | {held} | | | |")
            is_good = is_good and held == len(bounds)
            continue
        held = sum(low <= true <= high for true, _, (low, high) in known)
        errors = [abs(found - true) for true, found, _ in known]
        widths = sorted(0.5 * (high - low) for _, _, (low, high) in known)
        mark = ""
        if below(held, len(known)) < ODDS:
            mark, is_good = ": refuted", False
        lines.append(
            f"| `{name}` | {len(known)} of {len(rows)} | {held} | {100.0 * held / len(known):.1f} %{mark} | "
            f"{max(errors):.2g} | {widths[len(widths) // 2]:.2g} |"
        )
    return lines, is_good


def below(held: int, count: int, share: float = 0.95) -> float:
    """Return the probability that so many intervals of `count` hold the truth, or fewer."""
    return sum(comb(count, k) * share**k * (1.0 - share) ** (count - k) for k in range(held + 1))


def _write(lines: Sequence[str]) -> None:
    begin, end = f"<!-- begin results; written by `{COMMAND}`, do not edit -->", "<!-- end results -->"
    text = PAGE.read_text(encoding="utf-8")
    before, _, rest = text.partition(begin)
    _, _, after = rest.partition(end)
    PAGE.write_text(f"{before}{begin}\n" + "\n".join(lines) + f"\n{end}{after}", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
