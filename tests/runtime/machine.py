"""A controller of a few lines: moves take a fixed time, signals are a dict, time is what `run` makes it."""

from __future__ import annotations

from typing import Any

from elitescript.language.compiler import CompiledUnit, compile_unit
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Alarm, Popup, Printed, TextMessage, Warned
from elitescript.messages.machine import PauseTask, ResumeTask, SetLineMark, WriteSignal
from elitescript.messages.profile import profile
from elitescript.runtime.environment import EmptyEnvironment
from elitescript.runtime.host import ScriptHost

EPOCH_S = 1_704_067_200.0


class FakeMachine:
    """Implements the part of `commands.definition.context.Machine` that programs without kinematics use."""

    def __init__(self, move_ticks: int = 100) -> None:
        self.tick = 0
        self.move_ticks = move_ticks
        self.events: list[Any] = []
        self.observed: list[Any] = []
        self.requests: list[Any] = []
        self.cancelled: list[int] = []
        self.signals: dict[tuple[str, int], Any] = {}
        self.default_motion = (1.4, 1.05, 1.2, 0.25)
        self.moves: dict[int, int] = {}
        self.host: ScriptHost | None = None

    def request_motion(self, request: Any, line: int, thread: str) -> int:
        self.requests.append((self.tick, request, line, thread))
        number = len(self.moves) + 1
        self.moves[number] = self.tick + self.move_ticks
        return number

    def is_move_done(self, move: int) -> bool:
        return self.moves[move] <= self.tick

    def cancel_move(self, move: int) -> None:
        if not self.is_move_done(move):
            self.cancelled.append(move)
            self.moves[move] = self.tick

    def request(self, request: Any) -> None:
        self.requests.append((self.tick, request))
        if isinstance(request, PauseTask):
            self.host.pause()
        elif isinstance(request, ResumeTask):
            self.host.resume()

    def write(self, name: str, index: int, value: Any) -> None:
        self.requests.append((self.tick, WriteSignal(name, index, value)))
        self.signals[name, index] = value

    def read(self, name: str, index: int = 0) -> Any:
        return self.signals.get((name, index), False)

    def timestamp_s(self) -> float:
        return EPOCH_S + self.tick / 250

    def emit(self, event: Any) -> None:
        self.events.append(event)

    def observe(self, seen: Any) -> None:
        self.observed.append(seen)


class Bench:
    """A host on a fake machine.

    Args:
        firmware: of the profile.
        move_ticks: how long a move takes.
        steps: run every tick instead of leaping.
        options: for `ScriptHost`.
    """

    def __init__(self, firmware: str = "2.14", move_ticks: int = 100, steps: bool = False, **options: Any) -> None:
        self.machine = FakeMachine(move_ticks)
        self.ends: list[str] = []
        self.host = ScriptHost(self.machine, profile=profile(firmware), on_end=self.ends.append, **options)
        self.channels = (options.get("world") or EmptyEnvironment()).channels
        self.machine.host = self.host
        self.steps = steps
        self.ticks: list[int] = []

    def start(self, text: str, **presets: object) -> Bench:
        """Start a program text."""
        self.host.start(compiled(text), presets)
        return self

    def secondary(self, text: str) -> Bench:
        """Hand in a secondary program."""
        self.host.start_secondary(compiled(text, kind="secondary"))
        return self

    def run(self, until: int = 25_000) -> Bench:
        """Run until nothing is due, or up to a tick."""
        machine, host = self.machine, self.host
        while machine.tick <= until:
            for number, end in machine.moves.items():
                if end <= machine.tick:
                    host.motion_ended(number, True)
            self.ticks.append(machine.tick)
            for event in self.channels.arrivals(machine.tick):
                host.channel_event(event)
            host.run_tick(machine.tick)
            pending = [end for end in machine.moves.values() if end > machine.tick]
            arrives = self.channels.next_tick(machine.tick)
            due = [tick for tick in (host.next_tick(machine.tick), arrives, *pending) if tick is not None]
            if not due:
                break
            machine.tick = machine.tick + 1 if self.steps else max(min(due), machine.tick + 1)
        return self

    def texts(self, kind: type = TextMessage) -> list[str]:
        """Texts of the events of one kind."""
        return [event.text for event in self.machine.events if isinstance(event, kind)]

    @property
    def log(self) -> list[str]:
        """What `textmsg` wrote."""
        return self.texts()

    @property
    def printed(self) -> list[str]:
        """What `print` wrote."""
        return self.texts(Printed)

    @property
    def warnings(self) -> list[str]:
        """Warnings of the run."""
        return self.texts(Warned)

    @property
    def popups(self) -> list[Popup]:
        """Message windows."""
        return [event for event in self.machine.events if isinstance(event, Popup)]

    @property
    def alarms(self) -> list[Alarm]:
        """Alarms of the run."""
        return [event for event in self.machine.events if isinstance(event, Alarm)]

    @property
    def trace(self) -> list[tuple[Any, ...]]:
        """Everything that happened, as plain values."""
        return [(type(event).__name__, event.tick, getattr(event, "text", "")) for event in self.machine.events]

    @property
    def marks(self) -> list[tuple[int, str]]:
        """Line marks that were passed."""
        found = [request[1] for request in self.machine.requests if isinstance(request[1], SetLineMark)]
        return [(mark.number, mark.label) for mark in found]


def compiled(text: str, **options: Any) -> CompiledUnit:
    """A program, from a text that may be indented as a whole."""
    lines = text.strip("\n").split("\n")
    margin = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    text = "\n".join(line[margin:] for line in lines) + "\n"
    return compile_unit(SourceFile("<program>", text), Options(**options))


def run(text: str, *, until: int = 25_000, presets: dict[str, object] | None = None, **options: Any) -> Bench:
    """Run a program to its end."""
    return Bench(**options).start(text, **(presets or {})).run(until)
