"""Worker processes as the engine sees them: begun, spoken to, killed."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import sys
from contextlib import suppress
from itertools import count
from tempfile import TemporaryFile
from typing import IO, Any, Final

from elitescript.environment.process import Life, module_command, module_environment, place_in_trace
from elitescript.services.child.process import processor_time_s
from elitescript.studio.live.link import COMMAND, EVENT, Board, framed, read_frame

CAN_COPY: Final = hasattr(os, "fork")
"""Whether workers are copies of a keeper."""
TRACE_S: Final = 0.05
"""How long the trace of a worker that is about to be killed is waited for, s."""
TRACE_BYTES: Final = 1 << 16
END_S: Final = 2.0
"""How long the end of a killed process is waited for, s."""

_BEFORE_ROWS: Final = 1 << 18
"""Bytes of a worker that are read ahead."""


class Worker:
    """A worker process.

    Attributes:
        ended: its exit code, when it has ended; below 0 the signal that has killed it.
    """

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer
        self.ended: asyncio.Future[int] = asyncio.get_running_loop().create_future()

    async def frame(self) -> tuple[int, bytes]:
        """Return kind and content of the next frame.

        Raises:
            EOFError: there is none any more.
        """
        return await read_frame(self._reader)

    def ask(self, request: dict[str, Any]) -> None:
        """Send a request."""
        if not self._writer.is_closing():
            self._writer.write(framed(request))

    def processor_time_s(self) -> float | None:
        """Return its processor time, s; None if that is not known here."""
        return None

    async def line(self) -> int:
        """Return the line of the program that runs at this moment, also inside a call that computes; 0 if unknown."""
        return 0

    def tick(self) -> int:
        """Return the last tick before the one in which its run is; 0 if unknown."""
        return 0

    def kill(self) -> None:
        """End it and its copies at once; does not wait for it."""
        self._writer.close()


class Keeper:
    """The keeper process (`keeper`), and the workers that are copies of it.

    Attributes:
        is_alive: whether it can start workers.
    """

    def __init__(self, process: asyncio.subprocess.Process, life: Life, commands: socket.socket) -> None:
        self._process = process
        self._life = life
        self._commands = commands
        self._numbers = count(1)
        self._workers: dict[int, CopiedWorker] = {}
        self.is_alive = True
        self._events = b""
        asyncio.get_running_loop().add_reader(commands, self._read)

    @classmethod
    async def start(cls) -> Keeper:
        """Start it; it takes commands at once, and carries them out when it has imported everything."""
        life = Life()
        ours, theirs = socket.socketpair()
        ours.setblocking(False)
        options = life.options
        try:
            process = await asyncio.create_subprocess_exec(
                *module_command("elitescript.studio.live.keeper", [life.descriptor, theirs.fileno()]),
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.DEVNULL,
                env=module_environment(),
                **{**options, "pass_fds": [*options["pass_fds"], theirs.fileno()]},
            )
        except BaseException:
            life.close()
            ours.close()
            raise
        finally:
            theirs.close()
        life.started()
        return cls(process, life, ours)

    @property
    def pid(self) -> int:
        """Number of its process."""
        return self._process.pid

    async def begin(self) -> CopiedWorker:
        """Start a worker.

        Raises:
            OSError: the keeper has ended.
        """
        ours, theirs = socket.socketpair()
        with theirs:
            reader, writer = await asyncio.open_connection(sock=ours, limit=_BEFORE_ROWS)
            # Nothing waits from here on: whoever has begun it may end it, and no event comes before it is known.
            trace, trace_end = os.pipe()
            os.set_blocking(trace, False)
            life = Life()
            number = next(self._numbers)
            with _memory() as file:
                file.truncate(Board.SIZE)
                board = Board(file.fileno())
                worker = CopiedWorker(reader, writer, self, number, trace, life, board)
                given = [theirs.fileno(), trace_end, life.descriptor, file.fileno()]
                try:
                    socket.send_fds(self._commands, [COMMAND.pack(b"n", number)], given)
                except OSError:
                    worker.kill()
                    raise
                finally:
                    os.close(trace_end)
        life.started()
        self._workers[number] = worker
        if not self.is_alive:
            self._over(number, -signal.SIGKILL)
        return worker

    def command(self, command: bytes, number: int) -> None:
        """Send a command about a worker."""
        with suppress(OSError):
            self._commands.send(COMMAND.pack(command, number))

    def _read(self) -> None:
        try:
            data = self._commands.recv(1 << 12)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._has_ended()
            return
        self._events += data
        while len(self._events) >= EVENT.size:
            kind, number, value = EVENT.unpack(self._events[: EVENT.size])
            self._events = self._events[EVENT.size :]
            if kind == b"e":
                self._over(number, value)
            elif number in self._workers:
                self._workers[number].pid = value

    def _over(self, number: int, code: int) -> None:
        worker = self._workers.pop(number, None)
        if worker is not None and not worker.ended.done():
            worker.ended.set_result(code)

    def _has_ended(self) -> None:
        self.is_alive = False
        asyncio.get_running_loop().remove_reader(self._commands)
        self._life.close()
        for number, worker in list(self._workers.items()):
            worker.kill()
            self._over(number, -signal.SIGKILL)

    async def close(self) -> None:
        """End it, and all its workers."""
        if self.is_alive:
            self._has_ended()
        self._commands.close()
        with suppress(ProcessLookupError):
            self._process.kill()
        await self._process.wait()


def _memory() -> IO[bytes]:
    """Return a file for memory that processes share; on no disk where that is possible."""
    return os.fdopen(os.memfd_create("board"), "r+b") if sys.platform == "linux" else TemporaryFile()


class CopiedWorker(Worker):
    """A worker that is a copy of the keeper.

    Attributes:
        pid: number of its process; 0 before it has begun.
    """

    def __init__(
        self,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        keeper: Keeper,
        number: int,
        trace: int,
        life: Life,
        board: Board,
    ) -> None:
        super().__init__(reader, writer)
        self._keeper = keeper
        self._number = number
        self._trace = trace
        self._life = life
        self._board = board
        self.pid = 0

    def processor_time_s(self) -> float | None:
        """See `Worker`."""
        return processor_time_s(self.pid) if self.pid else None

    async def line(self) -> int:
        """See `Worker`."""
        if self._trace < 0:
            return 0
        self._keeper.command(b"t", self._number)
        found = b""
        for _ in range(10):
            await asyncio.sleep(TRACE_S / 10)
            with suppress(BlockingIOError, OSError):
                found += os.read(self._trace, TRACE_BYTES)
            if (place := place_in_trace(found)) is not None:
                return place[1]
        return 0

    def tick(self) -> int:
        """See `Worker`."""
        return self._board.read() if self._trace >= 0 else 0

    def kill(self) -> None:
        """See `Worker`."""
        super().kill()
        # The pipe ends it and its copies where the system can, the keeper itself everywhere.
        self._life.close()
        self._keeper.command(b"k", self._number)
        if self._trace >= 0:
            os.close(self._trace)
            self._trace = -1
            self._board.close()


class SpareWorker(Worker):
    """A worker that was started by itself, where processes cannot be copied."""

    def __init__(self, process: asyncio.subprocess.Process, life: Life) -> None:
        assert process.stdout is not None
        assert process.stdin is not None
        super().__init__(process.stdout, process.stdin)
        self._process = process
        self._life = life
        self._end = asyncio.get_running_loop().create_task(self._wait())

    async def _wait(self) -> None:
        self.ended.set_result(await self._process.wait())

    def kill(self) -> None:
        """See `Worker`."""
        super().kill()
        self._life.close()
        with suppress(ProcessLookupError):
            self._process.kill()


class Spares:
    """Keeps one worker started ahead: does what `Keeper` does where processes cannot be copied."""

    is_alive = True

    def __init__(self) -> None:
        self._next = _ahead()
        self._one = asyncio.Lock()
        """Held while a worker is waited for: it is for one request only."""
        self._workers: set[SpareWorker] = set()
        """Those that have not ended."""

    @classmethod
    async def start(cls) -> Spares:
        """Start the first one."""
        return cls()

    async def begin(self) -> SpareWorker:
        """Return the worker that was started ahead, and start another one.

        Raises:
            OSError: it cannot be started.
        """
        async with self._one:
            worker = await self._started_ahead()
            if worker.ended.done():
                worker = await self._started_ahead()
        self._workers = {other for other in self._workers if not other.ended.done()} | {worker}
        return worker

    async def _started_ahead(self) -> SpareWorker:
        # It stays for the next request if this one is not waited for any more.
        await asyncio.wait({self._next})
        started, self._next = self._next, _ahead()
        return started.result()

    async def close(self) -> None:
        """End all of them; none is waited for longer than `END_S`."""
        self._next.cancel()
        await asyncio.wait({self._next}, timeout=END_S)
        if self._next.done() and not self._next.cancelled() and self._next.exception() is None:
            self._workers.add(self._next.result())
        for worker in self._workers:
            worker.kill()
        if self._workers:
            await asyncio.wait({worker.ended for worker in self._workers}, timeout=END_S)


def _ahead() -> asyncio.Task[SpareWorker]:
    return asyncio.get_running_loop().create_task(_started())


async def _started() -> SpareWorker:
    life = Life()
    try:
        process = await asyncio.create_subprocess_exec(
            *module_command("elitescript.studio.live.worker", [life.descriptor]),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            limit=_BEFORE_ROWS,
            env=module_environment(),
            **life.options,
        )
    except BaseException:
        life.close()
        raise
    life.started()
    return SpareWorker(process, life)


async def start_workers() -> Keeper | Spares:
    """Return what starts workers on this system."""
    return await (Keeper.start() if CAN_COPY else Spares.start())
