"""Keeps a served robot's state file up to date, off the event loop: soon after a change, and at the end.

A change is written at once if nothing was written for `INTERVAL_S`, otherwise when that time is over; so a
process that is killed loses what changed in that time at most.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from typing import Final

from elitescript.environment.state_file import StateFile, kept_levels
from elitescript.errors import UsageError
from elitescript.messages.signals import Value

INTERVAL_S: Final = 0.5
RETRY_S: Final = 10.0
"""After a write that failed."""

Levels = Mapping[str, tuple[Value, ...]]


class StateKeeper:
    """Writes one robot's state.

    Args:
        file: its file, which is held until `close`.
        warn: called with the reason of a write that fails.

    Raises:
        UsageError: another process uses the file.
    """

    __slots__ = ("_ending", "_file", "_kept", "_saved", "_signals", "_task", "warn")

    def __init__(self, file: StateFile, warn: Callable[[str], None] = lambda _text: None) -> None:
        file.hold()
        self._file = file
        self.warn = warn
        self._ending = asyncio.Event()
        self._signals: Levels | None = None
        self._kept: dict[str, tuple[Value, ...]] = {}
        self._saved: dict[str, tuple[Value, ...]] = {}
        self._task: asyncio.Task[None] | None = None

    def load(self) -> dict[str, Value]:
        """Return what is kept, by the names of `--set`.

        Raises:
            UsageError: see `StateFile.load`.
        """
        return self._file.load()

    def take(self, signals: Levels) -> None:
        """Note the signals of a tick; must be called in the event loop."""
        if signals is self._signals:
            return
        self._signals = signals
        kept = kept_levels(signals)
        if kept != self._kept:
            self._kept = kept
            if self._task is None or self._task.done():
                self._task = asyncio.get_running_loop().create_task(self._write_changes())

    async def close(self) -> None:
        """Write what is not written yet, and let the file go."""
        self._ending.set()
        try:
            if self._task is not None:
                await self._task
            await self._write()
        finally:
            self._file.release()

    async def _write_changes(self) -> None:
        while self._kept != self._saved and not self._ending.is_set():
            pause_s = INTERVAL_S if await self._write() else RETRY_S
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._ending.wait(), pause_s)

    async def _write(self) -> bool:
        """Write what is kept now; return whether that went well."""
        kept = self._kept
        if kept == self._saved:
            return True
        try:
            await asyncio.get_running_loop().run_in_executor(None, self._file.save, kept)
        except UsageError as error:
            self.warn(str(error))
            return False
        self._saved = kept
        return True
