"""Conversations of pages with real sources, as files that the tests of the page play, and the form of their messages.

`python -m tests.conversation.conversations` records them again: `web/test/conversations/*.jsonl`, one message a line,
`{"page": message}`, `{"source": message}` or `{"rows": frame in base 64}`; and `examples.ts`, where the compiler
compares a message of each form with the types of `web/src/source/messages.ts`.
"""

from __future__ import annotations

import asyncio
import json
import tempfile
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from elitescript.conversation.recording import RecordedRun, recording
from elitescript.language.text.source import SourceFile
from elitescript.plotting.conversation import recorded_run
from elitescript.plotting.recorder import RunRecorder
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot
from elitescript.studio.files import Programs
from elitescript.studio.live.engine import Setting
from elitescript.studio.live_source import LiveSource
from elitescript.studio.memory import Memory
from elitescript.studio.opened import OpenFile
from elitescript.studio.session import Session, Workplace
from tests.studio.connected.fake_controller import faked

FOLDER = Path(__file__).parents[2] / "web" / "test" / "conversations"

Entry = dict[str, Any]

JOB = """def job():
  global n
  n = 0
  def other():
    sleep(0.2)
    set_standard_digital_out(1, True)
  end
  start_thread(other, ())
  while n < 2:
    n = n + 1
    movej([0.1 * n, -1.57, -1.57, -1.57, 1.57, 0])
  end
  textmsg("</script> <!-- \\u2028 done")
end
"""
BROKEN = JOB.replace("while n < 2:", "while n < :")
EDITED = JOB.replace("n < 2", "n < 3")
ALARM = """def job():
  movel([0.4, -0.1, 0.3, 3.14, 0, 0])
  movel([3.0, -0.1, 0.3, 3.14, 0, 0])
end
"""
WORLD = """[[box]]
name = "post"
size = [0.1, 0.1, 1.0]
pose = [0.45, -0.1, 0.1, 0, 0, 0]
"""


class Page:
    """Says what is in a script, and keeps what is said on both sides."""

    def __init__(self, folder: Path, text: str, world: str = "") -> None:
        self.said: list[Entry] = []
        self._news = asyncio.Event()
        path = folder / "job.script"
        path.write_text(text)
        setting = Setting()
        if world:
            (folder / "cell.toml").write_text(world)
            setting = Setting(world=folder / "cell.toml")
        programs, memory = Programs(path), Memory(folder / "state")
        source = LiveSource("job.script", setting)
        file = OpenFile(programs, memory, self._hear)
        source.belong_to(file, self._room)
        self.session = Session(Workplace(programs, memory, {}, setting.world), source, file, self._hear)

    async def _room(self) -> None:
        pass

    def _hear(self, message: Mapping[str, Any] | bytes) -> None:
        if isinstance(message, bytes):
            self.said.append({"rows": b64encode(message).decode()})
        else:
            self.said.append({"source": json.loads(json.dumps(message))})
        self._news.set()

    async def say(self, type_: str, **fields: Any) -> None:
        message = {"type": type_, **fields}
        self.said.append({"page": message})
        await self.session.take(json.dumps(message))

    async def until(self, **wanted: Any) -> dict[str, Any]:
        """Return the newest message with these fields, when it has come after what was said last."""
        begin = max(index for index, entry in enumerate(self.said) if "page" in entry)
        async with asyncio.timeout(30.0):
            while True:
                for entry in self.said[begin:]:
                    found: dict[str, Any] = entry.get("source", {})
                    if found and all(found.get(name) == value for name, value in wanted.items()):
                        return found
                self._news.clear()
                await self._news.wait()


async def _edits(page: Page) -> None:
    await page.say("program", version=1, text=JOB)
    await page.until(type="run_ended")
    await page.say("program", version=2, text=BROKEN)
    await page.until(type="problems", version=2)
    await page.say("program", version=3, text=EDITED)
    ended = await page.until(type="run_ended")
    run = ended["run"]
    await page.say("seek", run=run, ask=1, t=0.4)
    await page.until(ask=1)
    await page.say("step", run=run, ask=2, by=1, thread="main", t=0.0)
    await page.until(ask=2)
    await page.say("detail", run=run, ask=3, from_s=0.2, to_s=0.24, step_s=0.004)
    await page.until(type="detail_ended")
    seen = next(entry["source"]["digest"] for entry in page.said if entry.get("source", {}).get("type") == "file")
    await page.say("save", ask=4, text=EDITED, seen=seen)
    await page.until(ask=4)
    await page.say("save", ask=5, text=JOB, seen="another")
    await page.until(ask=5)
    await page.say("record", ask=6, name="old.script", text=JOB, form="recording")
    await page.until(ask=6)
    await page.say("service", ask=7, service="signals", version=3)
    await page.until(ask=7)


async def _alarm(page: Page) -> None:
    await page.say("program", version=1, text=ALARM)
    await page.until(type="run_ended")


async def _live(text: str, script: Callable[[Page], Any], world: str = "") -> list[Entry]:
    with tempfile.TemporaryDirectory() as folder:
        page = Page(Path(folder), text, world)
        await page.session.begin()
        try:
            await script(page)
        finally:
            await page.session.close()
    return page.said


async def _connected() -> list[Entry]:
    async with faked(may_control=True) as (_, page):
        await page.until(lambda: page.of("scene") and page.of("moment") and page.controller()["serial"] and page.frames)
        done = await page.ask(type="speed", fraction=0.5)
        first = next(message for message in page.messages if message["type"] == "moment")
        last = page.of("moment")[-1]
        once = [message for message in page.messages if message["type"] not in ("moment", "done")]
        frames = [{"rows": b64encode(frame).decode()} for frame in page.frames[:2]]
        entries = [{"source": json.loads(json.dumps(message))} for message in (*once, first)]
        asked = {"page": {"type": "speed", "ask": done["ask"], "fraction": 0.5}}
        return [*entries, *frames, asked, {"source": done}, {"source": json.loads(json.dumps(last))}]


def made(text: str, model: str = "CS66") -> RecordedRun:
    """Return the recording of a program, with every row."""
    robot = VirtualRobot(model)
    source = SourceFile("job.script", text)
    recorder = RunRecorder(robot, Sampling())
    run = robot.run(robot.compile(source), trace=recorder.sampling, watch=recorder.watch)
    return recorded_run(recorder.recording("job.script", robot, source, run), recorder.sampling.rows)


def _recorded() -> list[Entry]:
    return [{"source": json.loads(json.dumps(message))} for message in made(JOB).said]


def recording_of_two() -> dict[str, Any]:
    """Return a recording of two runs in base 64, and rows of both: tick, then the columns of `names`."""
    runs = [made(JOB), made(EDITED, "CS612")]
    names = list(runs[0].columns)
    rows = []
    for run in runs:
        chosen = (0, 77, 150, len(run.ticks) - 1)
        rows.append([[run.ticks[row], *(run.columns[name][row] for name in names)] for row in chosen])
    return {"recording": b64encode(recording(runs)).decode(), "names": names, "rows": rows}


def conversations() -> dict[str, list[Entry]]:
    """Return each conversation by its name, held now."""
    return {
        "live_edits": asyncio.run(_live(JOB, _edits)),
        "live_alarm": asyncio.run(_live(ALARM, _alarm, WORLD)),
        "connected": asyncio.run(_connected()),
        "recorded": _recorded(),
    }


# ---------------------------------------------------------------- forms

_MAPS = frozenset(("signals", "settings"))
"""Fields whose names are data."""

_OPAQUE = frozenset(("result", "content", "parts"))
"""Fields that are what a service answers, a recording, and solids, of which one arm has not every kind."""


def forms(entries: Iterable[Entry]) -> dict[str, set[str]]:
    """Return for each type of message of a source the paths of its fields, each with the type of its value."""
    found: dict[str, set[str]] = {}
    for entry in entries:
        if (message := entry.get("source")) is not None:
            found.setdefault(message["type"], set()).update(_paths("", message))
    return found


def _paths(path: str, value: Any) -> Iterable[str]:
    if isinstance(value, dict):
        if path.endswith(".list[]") and "t" in value and "type" in value:
            path = f"{path}({value['type']})"
        for name, part in value.items():
            if name in _OPAQUE:
                yield f"{path}.{name}"
            elif name in _MAPS:
                yield f"{path}.{name}{{}}"
            else:
                yield from _paths(f"{path}.{name}", part)
    elif isinstance(value, list):
        for part in value:
            yield from _paths(f"{path}[]", part)
    else:
        kind = {bool: "boolean", int: "number", float: "number", str: "string", type(None): "null"}[type(value)]
        yield f"{path}: {kind}"


def read(name: str) -> list[Entry]:
    """Return a conversation as its file has it."""
    return [json.loads(line) for line in (FOLDER / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()]


def examples(held: Mapping[str, list[Entry]]) -> str:
    """Return the text of `examples.ts`: the first message of each form, as a literal of its type."""
    seen: set[tuple[str, ...]] = set()
    lines = []
    for entries in held.values():
        for entry in entries:
            message = entry.get("source")
            if message is None:
                continue
            form = tuple(sorted(set(_paths("", message))))
            if (message["type"], *form) not in seen:
                seen.add((message["type"], *form))
                shown = {name: "" if name == "content" else part for name, part in message.items()}
                lines.append(f"  {json.dumps(shown)},")
    head = [
        "/** Messages that sources have said, one of each form, whose types the compiler checks: see README.md. */",
        "",
        'import type { FromSource } from "../../src/source/messages.ts";',
        "",
        "export const EXAMPLES: readonly FromSource[] = [",
    ]
    return "\n".join([*head, *lines, "];", ""])


def main() -> None:
    """Record all of them again."""
    FOLDER.mkdir(exist_ok=True)
    held = conversations()
    for name, entries in held.items():
        text = "".join(json.dumps(entry, separators=(",", ":")) + "\n" for entry in entries)
        (FOLDER / f"{name}.jsonl").write_text(text, encoding="utf-8")
    (FOLDER / "recording.json").write_text(json.dumps(recording_of_two()) + "\n", encoding="utf-8")
    (FOLDER / "examples.ts").write_text(examples(held), encoding="utf-8")


if __name__ == "__main__":
    main()
