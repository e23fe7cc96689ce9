"""What runs in the processes of a Dask cluster: tasks that drive a child process, the same as that of this computer.

Tasks are functions of this module, and take and return bytes of JSON. The child has the hash seed and the limits that
Dask's own workers do not have, and can be ended when a run hangs.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from operator import attrgetter
from threading import Lock, Timer
from time import monotonic
from typing import Any, Final

from elitescript.errors import ElitescriptError
from elitescript.sweep.engines.executor import Executor, Result
from elitescript.sweep.engines.reference import Platform, platform_of_child

IDLE_S: Final = 30.0
"""Wall time without work after which a child is ended: its sweep is over, or whoever gave it is gone."""


def work_bytes(job: str, description: Any, max_wall_s: float | None, memory_bytes: int | None) -> bytes:
    """Return what every task of a sweep is given: the arguments of `Executor`."""
    return json.dumps([job, description, max_wall_s, memory_bytes], separators=(",", ":")).encode()


def platform_here() -> list[str]:
    """Return the platform of this worker, or the one text of why it has none."""
    try:
        return list(_platform())
    except (RuntimeError, OSError) as problem:
        return [f"the reference run failed: {problem}"]


def run_range(work: bytes, first: int, count: int) -> bytes:
    """Do so many numbered pieces of work, and return what came of them in the order of their numbers."""

    def do(executor: Executor) -> list[Result]:
        results = [result for piece in executor.results([range(first, first + count)]) for result in piece]
        # Those of a child that has died come again after others.
        return sorted(results, key=attrgetter("number"))

    return _answer(work, do)


def run_order(work: bytes, order: bytes) -> bytes:
    """Do one piece of work that has no number, given as JSON, in the same way."""
    return _answer(work, lambda executor: [executor.result_of(json.loads(order))])


def run_about(work: bytes, number: int) -> bytes:
    """Return what is known of a number without doing it, in the same way."""
    return _answer(work, lambda executor: [executor.about(number)])


def end_children() -> None:
    """End the children of this process that have no work."""
    _CHILDREN.end(older_than_s=0.0)


def _answer(work: bytes, do: Callable[[Executor], list[Result]]) -> bytes:
    from distributed import get_worker

    began = monotonic()
    platform = platform_here()
    answer: dict[str, Any] = {"worker": get_worker().address, "platform": platform}
    if len(platform) > 1:
        try:
            with _CHILDREN.one(work) as executor:
                began = monotonic()
                answer["results"] = do(executor)
        except ElitescriptError as error:
            answer["refused"] = str(error)
        except OSError as error:
            answer["failed"] = str(error)
    answer["took_s"] = monotonic() - began
    return json.dumps(answer, separators=(",", ":")).encode()


@cache
def _platform() -> Platform:
    return platform_of_child()


class _Children:
    """The children of this process: at most one for each thread that works."""

    __slots__ = ("_idle", "_lock", "_timer")

    def __init__(self) -> None:
        self._lock = Lock()
        self._idle: list[tuple[str, Executor, float]] = []
        self._timer: Timer | None = None

    @contextmanager
    def one(self, work: bytes) -> Iterator[Executor]:
        """Hold a child that has been given this work; it is kept for the next task unless something is raised."""
        digest = sha256(work).hexdigest()
        executor = self._taken(digest)
        if executor is None:
            job, description, max_wall_s, memory_bytes = json.loads(work)
            executor = Executor(job, description, jobs=1, max_wall_s=max_wall_s, memory_bytes=memory_bytes)
            executor.__enter__()
        try:
            yield executor
        except BaseException:
            executor.__exit__(None, None, None)
            raise
        with self._lock:
            self._idle.append((digest, executor, monotonic()))
            if self._timer is None:
                self._wait()

    def end(self, older_than_s: float) -> None:
        """End those that have been idle for so long, and look again later if some are left."""
        now = monotonic()
        with self._lock:
            ended = [executor for _, executor, since in self._idle if now - since >= older_than_s]
            self._idle = [entry for entry in self._idle if now - entry[2] < older_than_s]
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
            if self._idle:
                self._wait()
        for executor in ended:
            executor.__exit__(None, None, None)

    def _taken(self, digest: str) -> Executor | None:
        """Take an idle child of this work; one of other work that is in its place is ended."""
        other = None
        with self._lock:
            for index in range(len(self._idle) - 1, -1, -1):
                if self._idle[index][0] == digest:
                    return self._idle.pop(index)[1]
            if self._idle:
                other = self._idle.pop(0)[1]
        if other is not None:
            other.__exit__(None, None, None)
        return None

    def _wait(self) -> None:
        self._timer = Timer(IDLE_S, self.end, [IDLE_S])
        self._timer.daemon = True
        self._timer.start()


_CHILDREN: Final = _Children()
"""Kept between tasks, and ended with this process by their own means."""
