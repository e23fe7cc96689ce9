"""Copies of a run that stand at earlier positions, so that going back does not begin at the start.

A copy is a process that was forked from the one in which the run goes on: stacks, locks and devices are in it as they
were, and it costs what the run changes afterwards. An `Engine` lives in a process of its own then, and the session
talks to it through a socket, with frozen records only. While it runs it forks a copy of itself for each `EACH_S` of
processor time and passes the end of a new socket on. Of the copies few are kept, most of them close to the present
position.

Counting is a small part of the time of a program that moves, but more than half of one that only computes. Such a run
gets company: another process runs the same without counting, and if that comes to the end first, the run is over.

A process ends when its socket is closed, so none is left when the session ends in whatever way. Only for POSIX, and for
a process that has no other threads and may be forked. `NoSnapshots` is what a session has elsewhere.
"""

from __future__ import annotations

import gc
import os
import select
import signal
import socket
import struct
from collections.abc import Callable
from contextlib import suppress
from time import process_time
from typing import Any, Final, cast

from elitescript.debugger.api import Output, Position, Stop
from elitescript.debugger.engine import Engine, Goal
from elitescript.debugger.engine_records import read, written
from elitescript.environment.process import cores
from elitescript.errors import DebugError

EACH_S: Final = 0.05
"""Processor time of a run from one copy to the next. A copy takes 2 to 3 ms, with the pages that both change then."""
COUNTING_MAX: Final = 5e6
"""Statements in a second of processor time, from which on counting them is a good part of it: each costs 28 ns."""
COPIES_MAX: Final = 20

Hear = Callable[[int, Output], None]
_LENGTH: Final = struct.Struct("!I")
_REPLY, _REFUSAL, _SAID, _COPY = range(4)


def snapshots(hear: Hear, *, forks: bool) -> NoSnapshots:
    """Return what keeps the copies of a session."""
    return Snapshots(hear) if forks and hasattr(os, "fork") else NoSnapshots(hear)


class NoSnapshots:
    """Engines in this process, and no copies.

    Args:
        hear: receives what a run says.
    """

    forks = False

    def __init__(self, hear: Hear) -> None:
        self._hear = hear

    def first(self, make: Callable[[Hear], Engine], *, is_heard: bool) -> Engine:
        """Return a new engine at the start of the run."""
        engine = make(self._hear)
        engine.is_heard = is_heard
        return engine

    def before(self, position: Position) -> tuple[Engine, Position] | None:
        """Return a copy of the engine nearest before a position, and where it stands; None if there is none."""
        return None

    def before_tick(self, tick: int) -> tuple[Engine, Position] | None:
        """Return a copy of the engine nearest before a tick, and where it stands; None if there is none."""
        return None

    def tick_before(self, tick: int) -> int:
        """Return the tick at which the copy nearest before another tick stands; -1 if there is none."""
        return -1

    def copy_of(self, engine: Engine) -> Engine | None:
        """Return a copy of an engine as it stands; None where there are no copies."""
        return None

    def nearest(self, position: Position) -> int:
        """Return the count at which the copy nearest before a position stands; -1 if there is none."""
        return -1

    def run(self, engine: Engine, goal: Goal, make: Callable[[Hear], Engine]) -> tuple[Engine, Stop | None]:
        """Run an engine; if counting slows it down, another one that does not count may come to the end first.

        Args:
            engine: counts.
            goal: without any stop that is found by counting.
            make: makes an engine at the start that does not count.

        Returns:
            The engine that has arrived, and its stop.
        """
        return engine, engine.run(goal)

    def keep(self, engine: Engine) -> None:
        """Keep a copy of an engine as it stands."""

    def thin(self, present: Position) -> None:
        """Drop copies that are not worth their memory."""

    def forget_from(self, position: Position) -> None:
        """Drop copies at a position and behind it: the history has changed."""

    def close(self) -> None:
        """Drop all copies."""


class Snapshots(NoSnapshots):
    """Engines in processes of their own, and copies of them."""

    forks = True

    def __init__(self, hear: Hear) -> None:
        super().__init__(hear)
        self._copies: list[tuple[Position, EngineProcess]] = []
        self._sockets: set[socket.socket] = set()

    def first(self, make: Callable[[Hear], Engine], *, is_heard: bool) -> Engine:
        """See `NoSnapshots.first`."""
        engine = self._begun(make, self._hear)
        engine.refresh()
        engine.is_heard = is_heard
        return cast("Engine", engine)

    def _begun(self, make: Callable[[Hear], Engine], hear: Hear) -> EngineProcess:
        """Return an engine in a new process."""
        ours, theirs = socket.socketpair()
        _reap()
        child = os.fork()
        if child == 0:
            for other in (ours, *self._sockets):
                other.close()
            _serve_new(theirs, make)
        _children.add(child)
        theirs.close()
        return self._process(ours, hear)

    def _process(self, link: socket.socket, hear: Hear | None = None) -> EngineProcess:
        self._sockets.add(link)
        return EngineProcess(link, hear or self._hear, self._came, self._sockets.discard)

    def _came(self, link: socket.socket, position: Position) -> None:
        process = self._process(link)
        if any(at == position for at, _ in self._copies):
            process.close()
            return
        self._copies.append((position, process))
        self._copies.sort(key=lambda item: (item[0].statement, item[0].events, item[0].tick))
        self.thin(position)

    def before(self, position: Position) -> tuple[Engine, Position] | None:
        """See `NoSnapshots.before`."""
        return self._copied([item for item in self._copies if item[0].is_before(position)])

    def before_tick(self, tick: int) -> tuple[Engine, Position] | None:
        """See `NoSnapshots.before_tick`."""
        return self._copied([item for item in self._copies if item[0].tick < tick])

    def tick_before(self, tick: int) -> int:
        """See `NoSnapshots.tick_before`."""
        return max((at.tick for at, _ in self._copies if at.tick < tick), default=-1)

    def _copied(self, near: list[tuple[Position, EngineProcess]]) -> tuple[Engine, Position] | None:
        """Return a copy of the last of some copies, and where it stands."""
        if not near:
            return None
        at, process = near[-1]
        return self.copy_of(cast("Engine", process)), at

    def copy_of(self, engine: Engine) -> Engine:
        """See `NoSnapshots.copy_of`."""
        copy = self._process(cast("EngineProcess", engine).copied())
        copy.refresh()
        return cast("Engine", copy)

    def nearest(self, position: Position) -> int:
        """See `NoSnapshots.nearest`."""
        near = [at for at, _ in self._copies if at.is_before(position)]
        return near[-1].statement if near else -1

    def run(self, engine: Engine, goal: Goal, make: Callable[[Hear], Engine]) -> tuple[Engine, Stop | None]:
        """See `NoSnapshots.run`."""
        counting = cast("EngineProcess", engine)
        counting.ask("run", goal)
        if cores() < 2:
            return engine, counting.answer()
        said: list[tuple[int, Output]] = []
        plain: EngineProcess | None = None
        has_tried, count = False, counting.count
        try:
            while True:
                readable, _, _ = select.select([counting, *filter(None, [plain])], [], [])
                if counting in readable:
                    is_answer, stop = counting.take()
                    if is_answer:
                        return engine, stop
                    if not has_tried and counting.count - count > COUNTING_MAX * EACH_S:
                        has_tried = True
                        plain = self._begun(make, lambda *item: said.append(item))
                        plain.refresh()
                        plain.ask("run", goal)
                    count = counting.count
                elif plain is not None:
                    try:
                        is_answer, stop = plain.take()
                    except (DebugError, OSError, EOFError):
                        is_answer, stop = True, None
                    if not is_answer:
                        continue
                    ended, plain = plain, None
                    if stop is None or not stop.result:
                        # A stop can be looked at and gone back from only where all is counted.
                        ended.close()
                        continue
                    for item in said:
                        self._hear(*item)
                    return cast("Engine", ended), stop
        finally:
            if plain is not None:
                plain.kill()

    def keep(self, engine: Engine) -> None:
        """See `NoSnapshots.keep`."""
        process = cast("EngineProcess", engine)
        self._came(process.copied(), process.position)

    def thin(self, present: Position) -> None:
        """See `NoSnapshots.thin`. The distances between the copies grow with the distance from the present position."""
        while len(self._copies) > COPIES_MAX:
            places = [at.statement + at.tick for at, _ in self._copies]
            here = present.statement + present.tick
            worth = [
                (places[index + 1] - places[index - 1]) / (1 + abs(here - places[index]))
                for index in range(1, len(places) - 1)
            ]
            _, process = self._copies.pop(1 + worth.index(min(worth)))
            process.close()

    def forget_from(self, position: Position) -> None:
        """See `NoSnapshots.forget_from`."""
        for at, process in self._copies:
            if not at.is_before(position):
                process.close()
        self._copies = [item for item in self._copies if item[0].is_before(position)]

    def close(self) -> None:
        """See `NoSnapshots.close`."""
        self.forget_from(Position(-1, 0, 0, "statement"))


class EngineProcess:
    """An `Engine` in another process: the same methods, carried out there.

    Args:
        link: to the process.
        hear: receives what the run says.
        came: receives the link to a copy, and where that stands.
        gone: called with the link when it is closed.
    """

    def __init__(
        self,
        link: socket.socket,
        hear: Hear,
        came: Callable[[socket.socket, Position], None],
        gone: Callable[[socket.socket], None],
    ) -> None:
        self._link = link
        self._hear = hear
        self._came = came
        self._gone = gone
        self._facts: tuple[Any, ...] = (0, False, Position(0, 0, 0, "tick"), 0, True)
        self._process = 0

    count = property(lambda self: self._facts[0])
    is_over = property(lambda self: self._facts[1])
    position = property(lambda self: self._facts[2])
    outputs = property(lambda self: self._facts[3])
    is_counted = property(lambda self: self._facts[4])
    is_heard = property(None, lambda self, value: self._asked("hear", value))

    @property
    def collected(self) -> list[Position]:
        """See `Engine.collected`."""
        return cast("list[Position]", self._asked("collected"))

    def refresh(self) -> None:
        """Ask where it stands."""
        self._process = self._asked("process")

    def copied(self) -> socket.socket:
        """Return the link to a copy of it."""
        ours, theirs = socket.socketpair()
        with theirs:
            _write(self._link, ("copy", ()))
            socket.send_fds(self._link, [b"f"], [theirs.fileno()])
            self.answer()
        return ours

    def pause(self) -> None:
        """See `Engine.pause`; from any thread, and also when the process has just been dropped for another one."""
        with suppress(ProcessLookupError):
            os.kill(self._process, signal.SIGUSR1)

    def close(self) -> None:
        """End it."""
        self._gone(self._link)
        self._link.close()

    def kill(self) -> None:
        """End it while it runs."""
        with suppress(ProcessLookupError):
            os.kill(self._process, signal.SIGKILL)
        self.close()

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_") or not hasattr(Engine, name):
            raise AttributeError(name)
        return lambda *arguments: self._asked(name, *arguments)

    def _asked(self, name: str, *arguments: Any) -> Any:
        self.ask(name, *arguments)
        return self.answer()

    def fileno(self) -> int:
        """Return the descriptor that is readable when `take` does not wait."""
        return self._link.fileno()

    def ask(self, name: str, *arguments: Any) -> None:
        """Have a method called; `answer` returns what it returns."""
        _write(self._link, (name, arguments))

    def answer(self) -> Any:
        """Return the answer when it has come.

        Raises:
            DebugError: that is the answer.
        """
        while True:
            is_answer, value = self.take()
            if is_answer:
                return value

    def take(self) -> tuple[bool, Any]:
        """Take the next that comes; return whether it is the answer, and that. See `answer`."""
        kind, value, self._facts = _read(self._link)
        if kind == _SAID:
            self._hear(*value)
        elif kind == _COPY:
            _, (number,), _, _ = socket.recv_fds(self._link, 1, 1)
            self._came(socket.socket(fileno=number), value)
        elif kind == _REPLY:
            return True, value
        else:
            raise DebugError(value)
        return False, None


# ---------------------------------------------------------------- in the process of an engine


def _serve_new(link: socket.socket, make: Callable[[Hear], Engine]) -> None:
    """Make an engine and serve it; never returns."""
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        server = _Server(link)
        try:
            server.begin(make(server.hear))
        except Exception as error:
            server.fail(error)
        server.serve()
    finally:
        os._exit(0)


class _Server:
    def __init__(self, link: socket.socket) -> None:
        self._link = link
        self._engine: Engine | None = None
        self._copied_s = process_time()

    def begin(self, engine: Engine) -> None:
        self._engine = engine
        if engine.is_counted:
            engine.pulse, engine.is_pulse_due = self.pulse, self.is_due
        # What is there now stays: a collection of garbage that looked at it would copy its pages in each process.
        gc.freeze()
        signal.signal(signal.SIGUSR1, lambda *_: engine.pause())

    def fail(self, error: Exception) -> None:
        """Answer the first request with why there is no engine."""
        _read(self._link)
        _write(self._link, (_REFUSAL, f"{type(error).__name__}: {error}", None))

    def hear(self, number: int, output: Output) -> None:
        self._say(_SAID, (number, output))

    def is_due(self) -> bool:
        """Return whether the last copy was some time ago."""
        return process_time() - self._copied_s >= EACH_S

    def pulse(self) -> None:
        """Leave a copy behind, if one is due."""
        if not self.is_due():
            return
        ours, theirs = socket.socketpair()
        if os.fork() == 0:
            theirs.close()
            self._become(ours)
        ours.close()
        assert self._engine is not None
        self._say(_COPY, self._engine.position)
        with theirs:
            socket.send_fds(self._link, [b"f"], [theirs.fileno()])
        self._copied_s = process_time()

    def _become(self, link: socket.socket) -> None:
        """Go on as a copy; never returns."""
        try:
            self._link.close()
            self._link = link
            self._copied_s = process_time()
            self.serve()
        finally:
            os._exit(0)

    def _say(self, kind: int, value: Any) -> None:
        engine = self._engine
        facts = None
        if engine is not None:
            facts = engine.count, engine.is_over, engine.position, engine.outputs, engine.is_counted
        _write(self._link, (kind, value, facts))

    def serve(self) -> None:
        """Answer requests until the link is closed."""
        while True:
            try:
                name, arguments = _read(self._link)
            except (EOFError, OSError):
                return
            try:
                value = self._done(name, arguments)
            except DebugError as error:
                self._say(_REFUSAL, str(error))
            except Exception as error:
                self._say(_REFUSAL, f"{type(error).__name__}: {error}")
            else:
                self._say(_REPLY, value)

    def _done(self, name: str, arguments: tuple[Any, ...]) -> Any:
        engine = self._engine
        assert engine is not None
        if name == "process":
            return os.getpid()
        if name == "hear":
            engine.is_heard = arguments[0]
            return None
        if name == "collected":
            return engine.collected
        if name == "copy":
            _, (number,), _, _ = socket.recv_fds(self._link, 1, 1)
            link = socket.socket(fileno=number)
            if os.fork() == 0:
                self._become(link)
            link.close()
            return None
        return getattr(engine, name)(*arguments)


_children: Final[set[int]] = set()
"""Processes that this one has started and not reaped; the copies are children of theirs."""


def _reap() -> None:
    """Forget the children that have ended."""
    for child in tuple(_children):
        with suppress(ChildProcessError):
            if os.waitpid(child, os.WNOHANG) == (0, 0):
                continue
        _children.discard(child)


def _write(link: socket.socket, message: object) -> None:
    data = written(message)
    link.sendall(_LENGTH.pack(len(data)) + data)


def _read(link: socket.socket) -> Any:
    (size,) = _LENGTH.unpack(_exactly(link, _LENGTH.size))
    return read(_exactly(link, size))


def _exactly(link: socket.socket, size: int) -> bytes:
    parts = []
    while size:
        part = link.recv(size)
        if not part:
            raise EOFError
        parts.append(part)
        size -= len(part)
    return b"".join(parts)
