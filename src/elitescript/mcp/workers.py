"""Starts worker processes and ends those that take too long."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from typing import Any, Final

from elitescript.environment.process import Life, module_command, module_environment
from elitescript.errors import UsageError
from elitescript.untrusted.json_text import json_value

ANSWER_BYTES_MAX: Final = 8 * 1024 * 1024
"""Longest answer of a worker."""

GRACE: Final = 1.5


class Worker:
    """A process that answers one request after the other.

    Args:
        wall_s: most wall time of one run. A process that does not answer within `GRACE` times as much is ended.

    Attributes:
        is_alive: whether it takes requests.
    """

    __slots__ = ("_life", "_lock", "_process", "_wall_s", "is_alive")

    def __init__(self, wall_s: float) -> None:
        self._wall_s = wall_s
        self._process: asyncio.subprocess.Process | None = None
        self._life = Life()
        self._lock = asyncio.Lock()
        self.is_alive = True

    async def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Return the result of a request.

        Raises:
            UsageError: the request makes no sense, or takes too long or too much memory.
        """
        async with self._lock:
            if not self.is_alive:
                raise UsageError("the process has ended")
            try:
                asked = {"wall_s": self._wall_s, **request}
                return await asyncio.wait_for(self._exchange(asked), GRACE * self._wall_s)
            except TimeoutError:
                await self.end()
                raise UsageError(
                    f"there was no answer within {GRACE * self._wall_s:g} s of wall time, and the process was ended"
                ) from None
            except asyncio.CancelledError:
                await self.end()
                raise

    async def _exchange(self, request: dict[str, Any]) -> dict[str, Any]:
        if self._process is None:
            self._process = await asyncio.create_subprocess_exec(
                *module_command("elitescript.mcp.worker", [self._life.descriptor]),
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                limit=ANSWER_BYTES_MAX,
                env=module_environment(),
                **self._life.options,
            )
            self._life.started()
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        line = b""
        try:
            # A process that has ended meanwhile takes nothing.
            with suppress(ConnectionError):
                process.stdin.write(json.dumps(request).encode() + b"\n")
                await process.stdin.drain()
                line = await process.stdout.readline()
        except ValueError:
            await self.end()
            raise UsageError(f"the answer is longer than {ANSWER_BYTES_MAX} bytes") from None
        if not line:
            await self.end()
            raise UsageError("the process that ran the program has ended: it may have needed too much memory")
        answer: dict[str, Any] = json_value(line, depth_max=None)
        if "error" in answer:
            raise UsageError(answer["error"])
        result: dict[str, Any] = answer["result"]
        return result

    async def end(self) -> None:
        """End the process."""
        self.is_alive = False
        self._life.close()
        process = self._process
        if process is not None and process.returncode is None:
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()
        self._process = None


async def ask_once(request: dict[str, Any], wall_s: float) -> dict[str, Any]:
    """Return the result of a request, answered by a process of its own.

    Raises:
        UsageError: as `Worker.ask`.
    """
    worker = Worker(wall_s)
    try:
        return await worker.ask(request)
    finally:
        await worker.end()
