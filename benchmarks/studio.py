"""The live engine as a page feels it: from the moment a text is sent to its findings, its first and its last rows.

Of each program: a text that differs from the one before in a number; then moments: in the middle of the run, later and
earlier as while dragging, and steps. Beside the whole run stands `elitescript run --trace` of the same text as a
process of its own, which imports the product first. CPU is that of the worker process and of the engine together.
"""

from __future__ import annotations

import asyncio
import os
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

from benchmarks.measure import ROOT, process_times
from benchmarks.table import Row, Time, print_rows, timed_row, words
from elitescript.conversation.messages import Program, RunOptions, Seek, Step
from elitescript.studio.live.engine import LiveEngine

ROUNDS = int(os.environ.get("STUDIO_ROUNDS", "5"))
UNTIL_S = 120.0

BLENDED = """def blended():
  movej([0, -1.57, -1.57, -1.57, 1.57, 0])
  for row in range(60):
    for n in range(20):
      movel([-0.3 - 0.01 * n, -0.15 + 0.002 * row, 0.4, 3.14, 0, 1.57], a=1.2, v=0.25, r=0.003)
    end
  end
end
"""
POLLING = """def polling():
  def watch():
    while True:
      if get_standard_digital_in(0):
        textmsg("in")
      end
      sleep(0.01)
    end
  end
  start_thread(watch, ())
  for n in range(30):
    movej([0.3, -1.57, -1.57, -1.57, 1.57, 0])
    movej([-0.3, -1.57, -1.57, -1.57, 1.57, 0])
    sleep(1)
  end
end
"""
SERVOJ = """def servo():
  n = 0
  q = get_actual_joint_positions()
  first = q[0]
  while True:
    q[0] = first + 0.2 * sin(n * 0.004)
    servoj(q, t=0.004)
    n = n + 1
  end
end
"""
PROGRAMS = {
    "pick_and_place, 119 s": (ROOT / "examples" / "pick_and_place.script").read_text(encoding="utf-8"),
    "1,200 blended lines": BLENDED,
    "polling thread, sleep 10 ms": POLLING,
    "servoj in every tick, 120 s": SERVOJ,
}


class Page:
    """A page that takes everything, and notes when it came."""

    def __init__(self) -> None:
        self.engine = LiveEngine(self._take, self._take_rows)
        self.began_s = 0.0
        self.at: dict[str, float] = {}
        self.last: dict[str, Any] = {}
        self._news = asyncio.Event()

    async def _take(self, message: dict[str, Any]) -> None:
        self.last[message["type"]] = message
        self.at.setdefault(message["type"], perf_counter() - self.began_s)
        self._news.set()

    async def _take_rows(self, frame: bytes) -> None:
        self.at.setdefault("rows", perf_counter() - self.began_s)

    def begin(self) -> None:
        """Count time from now on."""
        self.at.clear()
        self.last.clear()
        self.began_s = perf_counter()

    async def until(self, kind: str) -> dict[str, Any]:
        """Return the first message of a type since `begin`."""
        while kind not in self.last:
            self._news.clear()
            await asyncio.wait_for(self._news.wait(), 60.0)
        found: dict[str, Any] = self.last[kind]
        return found

    async def edit(self, turn: int, text: str) -> dict[str, Any]:
        """Send another text; return the end of its run."""
        self.begin()
        # Another number each time, so that nothing is known of its run.
        changed = text.replace("():\n", f"():\n  turn = {turn}\n", 1)
        await self.engine.program(Program(turn, changed, RunOptions(until_s=UNTIL_S)))
        return await self.until("run_ended")

    async def moment(self, asked: Seek | Step) -> float:
        """Ask for a moment; return how long it took, s."""
        self.begin()
        await (self.engine.seek(asked) if isinstance(asked, Seek) else self.engine.step(asked))
        await self.until("state")
        return perf_counter() - self.began_s


async def _measured(text: str) -> list[Time]:
    """Return the times to findings, first rows and all rows of an edit; then those of moments, without their CPU."""
    page = Page()
    await page.engine.start()
    try:
        await page.edit(0, text)
        keeper = (await page.engine._workers()).pid
        await page.engine.stop()
        walls: list[list[float]] = []
        before_s = process_time() + _children_s(keeper)
        for turn in range(1, ROUNDS + 1):
            await page.edit(turn, text)
            walls.append([page.at["problems"], page.at["rows"], page.at["run_ended"]])
            await page.engine.stop()
        await asyncio.sleep(0.1)
        cpu_s = (process_time() + _children_s(keeper) - before_s) / ROUNDS
        moments: list[list[float]] = []
        for turn in range(ROUNDS):
            ended = await page.edit(100 + turn, text)
            run, half_s = ended["run"], round(125 * ended["moment"]["t"]) / 250
            times = [await page.moment(Seek(run, 1, t)) for t in (half_s, half_s + 0.4, 0.9 * half_s)]
            position = page.last["state"]["moment"]["position"]
            times.append(await page.moment(Step(run, 1, 1, "main", 0.0, position)))
            position = page.last["state"]["moment"]["position"]
            times.append(await page.moment(Step(run, 1, -1, "main", 0.0, position)))
            moments.append(times)
    finally:
        await page.engine.close()
    found = [median(column) for column in zip(*walls, strict=True)]
    asked = [median(column) for column in zip(*moments, strict=True)]
    return [Time(wall_s, cpu_s) for wall_s in found] + [Time(wall_s, 0.0) for wall_s in asked]


def _children_s(process: int) -> float:
    """Return the processor time of the children of a process that have ended, s, to 10 ms."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[13]) + int(fields[14])) / os.sysconf("SC_CLK_TCK")


def rows() -> list[Row]:
    """Return the table; it needs Linux."""
    if sys.platform != "linux":
        return [words("live engine", "needs Linux")]
    table: list[Row] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, text in PROGRAMS.items():
            file = Path(folder, "program.script")
            file.write_text(text, encoding="utf-8")
            command = [
                sys.executable,
                "-m",
                "elitescript",
                "run",
                str(file),
                "--until",
                f"{UNTIL_S:g}",
                "--step",
                "0.04",
            ]
            (alone,) = process_times([["sh", "-c", f"{' '.join(command)} --trace {folder}/rows.csv || true"]], ROUNDS)
            findings, first, whole, *moments = asyncio.run(_measured(text))
            table += [
                Row(f"{name}: edit to findings", "ms", wall_s=findings.wall_s),
                Row(f"{name}: edit to first rows", "ms", wall_s=first.wall_s),
                timed_row(f"{name}: edit to all rows", whole, other=alone.cpu_s, beside="run --trace --step 0.04"),
            ]
            kinds = ("first moment, in the middle", "0.4 s later", "earlier", "step", "step back")
            table += [
                Row(f"{name}: {kind}", "ms", wall_s=time.wall_s) for kind, time in zip(kinds, moments, strict=True)
            ]
    return table


if __name__ == "__main__":
    print_rows(rows())
