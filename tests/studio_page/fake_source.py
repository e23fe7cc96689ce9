"""A source of the page that says what a test gives it, behind the studio's own port, and a program that it plays.

with FakeSource(Play()) as source:
    page.goto(source.address)
    source.wait("program")
    source.say(notice("warning", "text"))
"""

from __future__ import annotations

import asyncio
import json
import threading
from array import array
from collections.abc import Callable, Iterable, Mapping
from math import cos, sin
from typing import Any, Final

from elitescript.conversation.describe import Moment as State
from elitescript.conversation.describe import Thread as ThreadState
from elitescript.conversation.describe import Variable, hello
from elitescript.conversation.describe import moment as moment_data
from elitescript.conversation.rows import frames
from elitescript.models.model import load_model
from elitescript.solids.scene import scene
from elitescript.studio.outbox import Outbox
from elitescript.studio.server import Door

Message = Mapping[str, Any]

WAIT_S: Final = 20.0


class FakeSource:
    """A port whose conversation is given by a test.

    Args:
        play: what it says and answers.

    Attributes:
        heard: messages of the page, the oldest first.
    """

    def __init__(self, play: Play) -> None:
        self.play = play
        self.heard: list[dict[str, Any]] = []
        self._news = threading.Condition()
        self._ready = threading.Event()
        self._loop = asyncio.new_event_loop()
        self._outboxes: list[Outbox] = []
        self._door = Door(self._begin)
        self._port = 0
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> FakeSource:
        self._thread.start()
        assert self._ready.wait(WAIT_S)
        return self

    def __exit__(self, *_: object) -> None:
        self._call(self._door.close())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(WAIT_S)
        self._loop.close()

    @property
    def address(self) -> str:
        """The address of the page, with the token."""
        return self._door.address

    def say(self, *messages: Message | bytes) -> None:
        """Send messages to all pages."""

        def put() -> None:
            for outbox in self._outboxes:
                for message in messages:
                    outbox.put(message)

        self._loop.call_soon_threadsafe(put)

    def lose(self) -> None:
        """Close the port and every connection."""
        self._call(self._door.close())

    def come_back(self) -> None:
        """Listen on the same port again, with the same token."""
        self._call(self._door.open(self._port))

    def wait(self, kind: str, fits: Callable[[dict[str, Any]], bool] = lambda _: True) -> dict[str, Any]:
        """Return the newest message of the page of that type that fits; wait for it if there is none."""

        def newest() -> dict[str, Any] | None:
            found = (message for message in reversed(self.heard) if message["type"] == kind and fits(message))
            return next(found, None)

        with self._news:
            assert self._news.wait_for(lambda: newest() is not None, WAIT_S), f"the page never sent such a {kind!r}"
            found = newest()
        assert found is not None
        return found

    def forget(self) -> None:
        """Forget what the page has sent."""
        with self._news:
            self.heard.clear()

    # ---------------------------------------------------------------- inside

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_until_complete(self._door.open(0))
        self._port = self._door.port
        self._ready.set()
        self._loop.run_forever()

    def _call(self, work: Any) -> None:
        asyncio.run_coroutine_threadsafe(work, self._loop).result(WAIT_S)

    async def _begin(self, outbox: Outbox) -> _Conversation:
        self._outboxes.append(outbox)
        for message in self.play.first():
            outbox.put(message)
        return _Conversation(self, outbox)

    def _take(self, message: dict[str, Any], outbox: Outbox) -> None:
        with self._news:
            self.heard.append(message)
            self._news.notify_all()
        for answer in self.play.answer(message):
            outbox.put(answer)

    def _end(self, outbox: Outbox) -> None:
        self._outboxes.remove(outbox)


class _Conversation:
    def __init__(self, source: FakeSource, outbox: Outbox) -> None:
        self._source = source
        self._outbox = outbox

    async def take(self, text: str | bytes) -> None:
        self._source._take(json.loads(text), self._outbox)

    async def close(self) -> None:
        self._source._end(self._outbox)


PROGRAM: Final = """\
# Pick and place
global count
count = 0
movej(d2r([0, -90, 90, -90, -90, 0]), v=1.05)
while count < 2:
    movej(d2r([40, -90, 90, -90, -90, 0]))
    set_standard_digital_out(0, True)
    sleep(0.5)
    count = count + 1
end
textmsg("done")
"""

END_S: Final = 4.0
_ROW_TICKS: Final = 10


class Play:
    """A program of four seconds with everything that lists show, run again with each text.

    Attributes:
        text: of the file.
        abilities: of the source.
        mode: of the source.
        draft: kept unsaved text, as `file` has it; None without one.
        settings: what the page has asked to remember.
        problems: of each text.
        ended: further fields of `run_ended`.
        refusal: answers of `save`; None: it is written.
    """

    def __init__(self) -> None:
        self.text = PROGRAM
        self.digest = "first"
        self.abilities = ["edit", "save", "services", "seek", "step", "inputs", "connect"]
        self.mode = "live"
        self.draft: Message | None = None
        self.settings: dict[str, Any] = {}
        self.problems: list[Message] = []
        self.compiles = True
        self.empties = False
        """Whether texts hold nothing."""
        self.ended: dict[str, Any] = {"state": "finished"}
        self.refusal: Message | None = None
        self.contacts: list[Message] = []
        self.programs = ["pick.script"]
        self.tree: Message | None = None
        """Of the file; None: it is a text that people write."""
        self.marks: list[tuple[float, int]] = []
        """Times at which nodes of the tree begin."""
        self.runs = 0
        self.version = 0

    def first(self) -> list[Message]:
        """Return what is said to a page that connects."""
        file: dict[str, Any] = {"type": "file", "name": "pick.script", "text": self.text, "digest": self.digest}
        if self.tree is not None:
            file["tree"] = self.tree
        given = hello(self.mode, "elitescript 0", self.abilities, "pick.script", programs=self.programs)
        return [
            {**given, "settings": self.settings},
            scene(load_model("cs66")),
            file if self.draft is None else {**file, "draft": self.draft},
        ]

    def answer(self, message: dict[str, Any]) -> Iterable[Message | bytes]:
        """Return what is said to a message of the page."""
        ask = message.get("ask")
        match message["type"]:
            case "program":
                self.version = message["version"]
                checked = {
                    "type": "problems",
                    "version": self.version,
                    "list": self.problems,
                    "compiles": self.compiles,
                }
                yield {**checked, "start": moment(0.0)} if self.empties else checked
                if self.compiles and not self.empties:
                    yield from self.run()
            case "seek":
                yield {"type": "state", "ask": ask, "run": message["run"], "moment": moment(message["t"])}
            case "step":
                t = min(max(message["t"] + 0.5 * message["by"], 0.0), END_S)
                yield {"type": "state", "ask": ask, "run": message["run"], "moment": moment(t)}
            case "detail":
                yield {"type": "detail_ended", "ask": ask, "run": message["run"]}
            case "save":
                yield (
                    {"type": "saved", "ask": ask, "digest": "second"}
                    if self.refusal is None
                    else {
                        **self.refusal,
                        "ask": ask,
                    }
                )
            case "service":
                yield {"type": "answer", "ask": ask, "result": SERVICES.get(message["service"], None)}
            case "open":
                yield {"type": "refused", "ask": ask, "text": f"{message['name']}: only pick.script is open"}
            case _:
                return

    def run(self) -> Iterable[Message | bytes]:
        """Return a whole run."""
        self.runs += 1
        run = self.runs
        began = {"version": self.version, "same_until_s": 0, "options": {"robot": "cs66", "until_s": 120}}
        yield {"type": "run_began", "run": run, **began}
        ticks = range(0, int(END_S * 250) + 1, _ROW_TICKS)
        columns = {f"q{joint + 1}": array("f", [joints(tick / 250)[joint] for tick in ticks]) for joint in range(6)}
        columns |= {name: array("f", [value(tick / 250) for tick in ticks]) for name, value in _CURVES.items()}
        yield from frames(run, list(ticks), columns)
        lines = [(0.0, 2), (0.0, 4), (1.0, 6), (2.0, 8), (2.5, 6), (3.5, 8), (4.0, 11)]
        yield {"type": "lines", "run": run, "thread": "main", "t": [t for t, _ in lines], "line": [n for _, n in lines]}
        moves = [(0.0, 1.0, 4), (1.0, 2.0, 6), (2.5, 3.5, 6)]
        listed = [{"start_s": start, "end_s": end, "kind": "movej", "line": line} for start, end, line in moves]
        yield {"type": "moves", "run": run, "list": listed}
        if self.marks:
            yield {"type": "marks", "run": run, "t": [t for t, _ in self.marks], "node": [n for _, n in self.marks]}
        yield {"type": "events", "run": run, "list": EVENTS}
        yield {"type": "progress", "run": run, "t": END_S}
        yield {"type": "cycle", "run": run, "table": CYCLE}
        yield {"type": "contacts", "run": run, "list": self.contacts}
        yield {"type": "run_ended", "run": run, "moment": moment(END_S), **self.ended}


def joints(t: float) -> tuple[float, ...]:
    """Return the joints at a time, rad."""
    return (0.35 * t, -1.5708 + 0.2 * sin(t), 1.5708, -1.5708 + 0.1 * cos(t), -1.5708, 0.1 * t)


_CURVES: Final[Mapping[str, Callable[[float], float]]] = {
    "qd1": lambda t: 0.35,
    "qd2": lambda t: 0.2 * cos(t),
    "qd3": lambda t: 0.0,
    "qd4": lambda t: -0.1 * sin(t),
    "qd5": lambda t: 0.0,
    "qd6": lambda t: 0.1,
    "x": lambda t: 0.4 + 0.1 * sin(t),
    "y": lambda t: 0.1 * t,
    "z": lambda t: 0.5 + 0.05 * cos(t),
    "speed": lambda t: 0.15 + 0.1 * sin(2 * t),
}


def moment(t: float) -> Message:
    """Return the state at a time."""
    count = 0 if t < 2.5 else 1 if t < END_S else 2
    line = 4 if t < 1 else 6 if t < 2 else 8 if t < 2.5 else 6 if t < 3.5 else 8 if t < END_S else 11
    signals = {"standard_digital_in[3]": True} | ({"standard_digital_out[0]": True} if t >= 2 else {})
    return moment_data(
        State(
            t=t,
            line=line,
            joints=joints(t),  # type: ignore[arg-type]
            tcp_pose=(0.4 + 0.1 * sin(t), 0.1 * t, 0.5, 3.14, 0.0, 0.0),
            globals=(Variable("count", str(count), "int", t >= 2.5), Variable("limit_mm", "0.25", "float")),
            signals=signals,
            threads=(
                ThreadState("main", line, "the end of its move, until 2.500 s", ""),
                ThreadState("watch", 9, "data on socket 'plc'", "look"),
            ),
            position=f"at {t}",
        )
    )


EVENTS: Final[list[Message]] = [
    {"type": "log", "t": 0.0, "level": "info", "text": "begin", "thread": "main", "line": 2},
    {
        "type": "channel",
        "t": 1.0,
        "channel": "plc",
        "kind": "socket",
        "what": "open",
        "data": "192.168.1.5:5000",
        "line": 4,
    },
    {"type": "signal", "t": 2.0, "name": "standard_digital_out[0]", "value": True, "by": "program", "line": 7},
    {"type": "print", "t": 2.0, "text": "part 1", "thread": "main", "line": 7},
    {"type": "warning", "t": 2.5, "text": "movej: v is 60 rad/s", "thread": "main", "line": 6, "code": "W232"},
    {"type": "log", "t": 4.0, "level": "info", "text": "<img src=x onerror=alert(1)>", "thread": "main", "line": 11},
]

CYCLE: Final[list[Message]] = [
    {"line": 4, "moving_s": 1.0, "standing_s": 0.0, "visits": 1},
    {"line": 6, "moving_s": 2.0, "standing_s": 0.0, "visits": 2},
    {"line": 8, "moving_s": 0.0, "standing_s": 1.0, "visits": 2},
]


def _family(name: str, kind: str, size: int, is_input: bool, **more: Any) -> Message:
    given = {"low": None, "high": None, "unit": "", "default": False if kind == "bool" else 0, "summary": "", **more}
    return {"name": name, "kind": kind, "size": size, "is_input": is_input, "is_kept": False, **given}


SERVICES: Final[dict[str, Any]] = {
    "signals": [
        _family("standard_digital_in", "bool", 16, True),
        _family("standard_digital_out", "bool", 16, False),
        _family("standard_analog_in", "float", 2, True, low=0.0, high=10.0, unit="V or A", default=0.0),
        _family("input_int_register", "int", 48, True, low=-(2**31), high=2**31 - 1),
    ],
    "robots": {
        "robots": [{"name": "cs63"}, {"name": "cs66"}],
        "firmwares": ["2.14"],
        "defaults": {"robot": "cs66", "firmware": "2.14"},
    },
    "completion": [],
    "examples": [{"name": "first", "title": "First moves", "text": PROGRAM}],
    "folding": [],
    "hints": [],
    "outline": [],
    "references": [],
    "tokens": {"types": [], "modifiers": [], "rows": []},
}
"""Answers of services; those without one are null."""


def problem(line: int, column: int, code: str = "E304", *, fix: str | None = None) -> dict[str, Any]:
    """Return a finding, with a fix that puts a text at its place."""
    place = {"line": line, "column": column, "end_line": line, "end_column": column + 1}
    found = {"severity": "error", "code": code, "text": "sleep: unexpected argument", "hint": "take it out", **place}
    return found if fix is None else {**found, "fix": {"title": "Take it out", "edits": [{**place, "text": fix}]}}
