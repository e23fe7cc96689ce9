"""Child processes that do numbered pieces of work: given ranges, replaced when they die, ended when they hang.

The parent knows which numbers each child has. Those of a child that dies or hangs are given out again, the nearest ones
one by one: so what ends a child is found, and costs nothing but itself.
"""

from __future__ import annotations

import os
import subprocess
import time
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any, Final

from elitescript.environment.process import Life, module_command, module_environment
from elitescript.errors import ElitescriptError, PeerError, UsageError
from elitescript.records import NamedTuple
from elitescript.sweep.engines.frames import Frames, framed
from elitescript.sweep.plans.plan import CRASHED, HUNG

MAX_WALL_S: Final = 60.0
"""Wall time of one piece of work after which its process is ended, *assumed*."""

DEATHS_MAX: Final = 2
"""Times that a piece of work that is done alone may end its process."""

STARTS_MAX: Final = 3
"""Processes, one after the other, that may end before they have done anything."""

KILLED_STARTS_MAX: Final = 30
"""The same if a signal ends them, or if one has begun before: something outside ends processes."""

LOOK_S: Final = 1.0
"""Wall time between two looks at the clock: on Windows, Ctrl-C waits for the next one."""

STOPPED_S: Final = 1.0
"""A wait that takes this much longer than it should: this process was stopped (Ctrl-Z), or had no processor."""

RANGE_S: Final = 0.5
"""Wall time that a range shall take: long enough that nobody waits, short enough that all end together."""

FIRST_RANGE: Final = 4
"""Pieces of work of the first range, from which the next ones are sized."""

RANGE_MAX: Final = 10_000

ALONE: Final = 64
"""Numbers of a process that died which are done one by one before the rest of its range."""


class Result(NamedTuple):
    """What came of one piece of work.

    Attributes:
        number: of it; -1 of an order.
        value: what the job returned; if it did not, what it has said about this number; None if nothing.
        lost: empty if it did; `hung` if it took too long, `crashed` if its process died twice.
    """

    number: int
    value: Any
    lost: str = ""


class Executor:
    """Starts child processes and gives them work. Used as a context manager: leaving it ends them.

    A child imports `job`, `module:function`, calls it once with `description`, and calls what that returns for each
    piece of work: with its number, or with what `result_of` is given. What it returns must be JSON-able. If it has an
    attribute `about`, that is called with a number before the work that may be given up, and says what is known of it.

    Args:
        job: `module:function`.
        description: JSON-able.
        jobs: number of processes.
        max_wall_s: wall time of one piece of work; None for no limit.
        memory_bytes: address space of a child, where the system can limit it; None for no limit.
    """

    def __init__(
        self,
        job: str,
        description: Any,
        *,
        jobs: int,
        max_wall_s: float | None = MAX_WALL_S,
        memory_bytes: int | None = None,
    ) -> None:
        self._job = job
        self._first_frame = framed(description)
        self._jobs = jobs
        self._max_wall_s = max_wall_s
        self._memory_bytes = memory_bytes
        self._children: list[_Child] = []
        self._news: SimpleQueue[tuple[_Child, list[Any] | None]] = SimpleQueue()
        self._dead_starts = 0
        self._has_begun = False
        self._each_s = 0.0
        """Wall time of one piece of work, about; 0 before the first."""

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *_: object) -> None:
        for child in self._children:
            child.kill()
        for child in self._children:
            child.wait()
        self._children.clear()

    @property
    def processes(self) -> list[int]:
        """Numbers of the processes that are there."""
        return [child.number for child in self._children]

    def results(self, wanted: Sequence[range]) -> Iterator[list[Result]]:
        """Yield what came of numbered work, a list for each piece: numbers that follow each other, in any order.

        Raises:
            UsageError: the job refuses its description.
            ElitescriptError: the job does not compile a program, has a mistake, or its processes die before they begin.
        """
        work = _Work(wanted)
        while not work.is_done:
            self._give_out(work)
            child, messages, lost = self._next_news()
            if lost:
                results = work.lost(child.unfinished, lost, child.about)
                child.unfinished = range(0)
                self._remove(child)
                if results:
                    yield results
                continue
            for message in messages:
                yield from self._values(child, message, work)

    def result_of(self, order: Any) -> Result:
        """Return what came of one piece of work that has no number: `order`, JSON-able, is given to the job.

        Raises:
            UsageError: see `results`.
            ElitescriptError: see there.
        """
        return self.results_of([order])[0]

    def results_of(self, orders: Sequence[Any]) -> list[Result]:
        """Return what came of several such pieces of work, in their order.

        Raises:
            UsageError: see `results`.
            ElitescriptError: see there.
        """
        return self._results_of([["order", order] for order in orders])

    def about(self, number: int) -> Result:
        """Return what the job says about a number, without doing it.

        Raises:
            UsageError: see `results`.
            ElitescriptError: see there.
        """
        return self._results_of([["about", number]])[0]

    def _results_of(self, questions: Sequence[list[Any]]) -> list[Result]:
        """Return what comes of messages that have one answer each, in their order."""
        found: dict[int, Result] = {}
        waiting = deque(range(len(questions)))
        under_way: dict[_Child, int] = {}
        deaths: Counter[int] = Counter()
        while len(found) < len(questions):
            for child in self._children:
                if child.is_free and waiting:
                    under_way[child] = waiting.popleft()
                    child.orders += 1
                    child.send(questions[under_way[child]])
            for _ in range(min(self._jobs - len(self._children), len(waiting) - self._starting)):
                self._start()
            child, messages, lost = self._next_news()
            if lost:
                index = under_way.pop(child, -1)
                self._remove(child)
                if index >= 0:
                    deaths[index] += 1
                    if lost == HUNG or deaths[index] >= DEATHS_MAX:
                        found[index] = Result(-1, None, lost)
                    else:
                        waiting.appendleft(index)
            for message in messages:
                self._note(child, message)
                if message[0] in ("value", "about"):
                    child.orders -= 1
                    found[under_way.pop(child)] = Result(-1, message[1])
        return [found[index] for index in range(len(questions))]

    # ---------------------------------------------------------------- children

    @property
    def _starting(self) -> int:
        """How many children have not begun."""
        return sum(not child.is_ready for child in self._children)

    def _start(self) -> _Child:
        child = _Child(self._job, self._first_frame, self._memory_bytes or 0, self._news)
        self._children.append(child)
        return child

    def _remove(self, child: _Child) -> None:
        child.kill()
        child.wait()
        self._children.remove(child)
        if not child.is_ready:
            self._dead_starts += 1
            is_killed = self._has_begun or (child.exit_code or 0) < 0
            if self._dead_starts >= (KILLED_STARTS_MAX if is_killed else STARTS_MAX):
                died = f"{self._dead_starts} processes have died before they did anything"
                raise ElitescriptError(f"{died}, with exit code {child.exit_code}")

    def _give_out(self, work: _Work) -> None:
        """Give work to every child that has none, and start children while there is more than they can have."""
        for child in self._children:
            if child.is_free and work.waiting:
                size = min(RANGE_MAX, int(RANGE_S / self._each_s)) if self._each_s else FIRST_RANGE
                child.unfinished = numbers = work.next_range(max(1, min(size, -(-work.waiting // (2 * self._jobs)))))
                child.about = None
                if len(numbers) == 1:
                    child.send(["about", numbers.start])
                child.send(["range", numbers.start, numbers.stop])
        for _ in range(min(self._jobs - len(self._children), work.waiting - self._starting)):
            self._start()

    def _next_news(self) -> tuple[_Child, list[Any], str]:
        """Return a child, its messages, and how it is lost: empty, `hung` or `crashed`.

        A child hangs only if nothing has come after a wait: what it has said while this process did something else, or
        was stopped, comes first.
        """
        while True:
            began_s = time.monotonic()
            wait_s = LOOK_S
            if self._max_wall_s is not None:
                since_s = min((child.since_s for child in self._children if child.is_busy), default=began_s)
                wait_s = min(LOOK_S, max(0.0, since_s + self._max_wall_s - began_s) + 0.01)
            try:
                child, messages = self._news.get(timeout=wait_s)
            except Empty:
                now_s = time.monotonic()
                for child in self._children:
                    if now_s - began_s > wait_s + STOPPED_S:
                        child.since_s = now_s
                    elif child.is_late(now_s, self._max_wall_s):
                        return child, [], HUNG
                continue
            if child in self._children:
                return child, messages or [], CRASHED if messages is None else ""

    def _values(self, child: _Child, message: list[Any], work: _Work) -> Iterator[list[Result]]:
        now_s = time.monotonic()
        if message[0] == "values":
            _, first, values, is_done = message
            numbers = range(first, first + len(values))
            each_s = (now_s - child.since_s) / len(values)
            self._each_s = each_s if not self._each_s else 0.8 * self._each_s + 0.2 * each_s
            child.unfinished = range(numbers.stop, child.unfinished.stop)
            assert is_done is not bool(child.unfinished)
            work.done(numbers)
            yield [Result(number, value) for number, value in zip(numbers, values, strict=True)]
        elif message[0] == "about":
            child.about = message[1]
        self._note(child, message)
        child.since_s = now_s

    def _note(self, child: _Child, message: list[Any]) -> None:
        if message[0] == "ready":
            child.is_ready = True
            child.since_s = time.monotonic()
            self._dead_starts = 0
            self._has_begun = True
        elif message[0] == "error":
            _, kind, text = message
            if kind == "usage":
                raise UsageError(text)
            raise ElitescriptError(text if kind == "program" else f"a process has failed:\n{text}")


class _Child:
    """One process, and what it has to do.

    Attributes:
        unfinished: numbers that it has, and that have not come back.
        orders: that it has, and that have not come back.
        about: what it has said about the one number that it has; None if nothing.
        since_s: when it last said something, by the clock of `time.monotonic`.
        is_ready: whether it has begun.
        exit_code: of the process, once it has ended.
    """

    __slots__ = ("_life", "_process", "_thread", "about", "exit_code", "is_ready", "orders", "since_s", "unfinished")

    def __init__(
        self,
        job: str,
        first_frame: bytes,
        memory_bytes: int,
        news: SimpleQueue[tuple[_Child, list[Any] | None]],
    ) -> None:
        self.unfinished = range(0)
        self.orders = 0
        self.about: Any = None
        self.since_s = time.monotonic()
        self.is_ready = False
        self.exit_code: int | None = None
        self._life = Life()
        self._process = subprocess.Popen(
            module_command("elitescript.sweep.engines.worker", [job, self._life.descriptor, memory_bytes]),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            env=module_environment(),
            # On Windows, Ctrl-C would reach it too.
            creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            **self._life.options,
        )
        self._life.started()
        self._thread = Thread(target=self._listen, args=(first_frame, news), daemon=True)
        self._thread.start()

    @property
    def number(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def is_free(self) -> bool:
        """Whether it waits for something to do."""
        return self.is_ready and not self.is_busy

    @property
    def is_busy(self) -> bool:
        """Whether it has something to do."""
        return bool(self.unfinished or self.orders)

    def is_late(self, now_s: float, max_wall_s: float | None) -> bool:
        """Return whether it has said nothing for too long. To begin takes as long as it takes."""
        return max_wall_s is not None and self.is_busy and now_s - self.since_s >= max_wall_s

    def send(self, message: list[Any]) -> None:
        """Give it work; one that has died meanwhile takes none, which its thread reports."""
        self.since_s = time.monotonic()
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.write(framed(message))

    def kill(self) -> None:
        """End it at once."""
        self._life.close()
        with suppress(ProcessLookupError):
            self._process.kill()

    def wait(self) -> None:
        """Wait until it has ended."""
        self.exit_code = self._process.wait()
        self._thread.join()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()

    def _listen(self, first_frame: bytes, news: SimpleQueue[tuple[_Child, list[Any] | None]]) -> None:
        """Pass on what it says, in a thread of its own, until it ends."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        frames = Frames()
        try:
            data = memoryview(first_frame)
            while data:
                data = data[self._process.stdin.write(data) :]
            while received := os.read(self._process.stdout.fileno(), 1 << 16):
                if messages := frames.feed(received):
                    news.put((self, messages))
        except (OSError, ValueError, PeerError):
            pass  # it has died, or what it says makes no sense: it is replaced
        news.put((self, None))


class _Work:
    """Numbers that are to be done: given out, done, or given back."""

    __slots__ = ("_alone", "_deaths", "_left", "_ranges", "waiting")

    def __init__(self, wanted: Sequence[range]) -> None:
        self._ranges = deque(numbers for numbers in wanted if numbers)
        self._alone: deque[int] = deque()
        """Numbers that are done one by one."""
        self._deaths: Counter[int] = Counter()
        """How often a number that was done alone has ended its process."""
        self.waiting = sum(map(len, self._ranges))
        self._left = self.waiting

    @property
    def is_done(self) -> bool:
        """Whether everything has come back."""
        return not self._left

    def next_range(self, size: int) -> range:
        """Take the next numbers, `size` at most."""
        if self._alone:
            number = self._alone.popleft()
            self.waiting -= 1
            return range(number, number + 1)
        numbers = self._ranges.popleft()
        if len(numbers) > size:
            self._ranges.appendleft(numbers[size:])
            numbers = numbers[:size]
        self.waiting -= len(numbers)
        return numbers

    def done(self, numbers: range) -> None:
        """Note that numbers have come back."""
        self._left -= len(numbers)

    def lost(self, numbers: range, lost: str, about: Any = None) -> list[Result]:
        """Take numbers back from a process that has ended; return what came of those that are given up.

        Args:
            numbers: that it had.
            lost: `hung` or `crashed`.
            about: what is known of the number, if it is one.
        """
        if not numbers:
            return []
        if len(numbers) == 1:
            number = numbers[0]
            self._deaths[number] += 1
            if lost == HUNG or self._deaths[number] >= DEATHS_MAX:
                self._left -= 1
                return [Result(number, about, lost)]
        self._alone.extend(numbers[:ALONE])
        if rest := numbers[ALONE:]:
            self._ranges.appendleft(rest)
        self.waiting += len(numbers)
        return []
