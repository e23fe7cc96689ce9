"""The debugged runs of a server: a worker process each, by number."""

from __future__ import annotations

from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.mcp.workers import Worker

MOST: Final = 4
"""Debugged runs at a time; the one that was asked for longest ago makes room for a new one."""


class DebuggedRuns:
    """Holds the debugged runs.

    Args:
        wall_s: most wall time of one answer.
    """

    __slots__ = ("_next", "_wall_s", "_workers")

    def __init__(self, wall_s: float) -> None:
        self._wall_s = wall_s
        self._workers: dict[int, Worker] = {}
        self._next = 1

    async def start(self, request: dict[str, Any]) -> dict[str, Any]:
        """Begin a run; return its first stop with the number of the run.

        Raises:
            UsageError: the request makes no sense, or takes too long.
        """
        worker = Worker(self._wall_s)
        try:
            stop = await worker.ask(request)
        except BaseException:
            await worker.end()
            raise
        while len(self._workers) >= MOST:
            await self.end(next(iter(self._workers)))
        number, self._next = self._next, self._next + 1
        self._workers[number] = worker
        return {"session": number, **stop}

    async def ask(self, number: int, request: dict[str, Any]) -> dict[str, Any]:
        """Return the answer of a run to a request.

        Raises:
            UsageError: there is no such run, or as `start`.
        """
        worker = self._workers.pop(number, None)
        if worker is None:
            runs = ", ".join(map(str, self._workers)) or "none"
            raise UsageError(f"no debugged run has the number {number}; under way: {runs}")
        self._workers[number] = worker
        try:
            return {"session": number, **await worker.ask(request)}
        finally:
            if not worker.is_alive:
                self._workers.pop(number, None)

    async def end(self, number: int) -> None:
        """Give a run up.

        Raises:
            UsageError: there is no such run.
        """
        if number not in self._workers:
            raise UsageError(f"no debugged run has the number {number}")
        await self._workers.pop(number).end()

    async def end_all(self) -> None:
        """Give all runs up."""
        for number in list(self._workers):
            await self.end(number)
