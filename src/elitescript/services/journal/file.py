"""The file of a journal, written by a thread of its own: no disk, however slow, holds up a robot.

Lines are written within about `LAG_S`, in the order in which they came, and a failure never leaves half a line behind
where the system lets us take it back. A file that is renamed meanwhile goes on under its new name. One that is
removed, or that another process writes to or cuts, ends the journal.
"""

from __future__ import annotations

import errno
import os
import stat
import threading
import time
from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.outputs.writing import opened_new
from elitescript.paths import CHANGED, REMOVED, what_became_of

LAG_S: Final = 0.02
"""Lines that come within this time are written together."""
WAITING_MAX: Final = 64 * 1024 * 1024
"""Bytes that may wait for the disk."""
CHECK_S: Final = 1.0
"""How often it is checked whether the file is still what was written."""
SYNC_S: Final = 5.0
"""How often the disk is asked to keep what was written even if the power goes."""
CLOSE_S: Final = 5.0
"""How long the end waits for the disk."""


class JournalFile:
    """Takes lines and has them written.

    Args:
        path: a file that does not exist yet, or a device.

    Attributes:
        failure: why nothing more is written; empty while all is well.

    Raises:
        UsageError: the file exists, or cannot be written.
    """

    __slots__ = (
        "_checked_s",
        "_descriptor",
        "_is_closing",
        "_is_file",
        "_lines",
        "_news",
        "_path",
        "_synced_s",
        "_taken",
        "_thread",
        "_written",
        "failure",
    )

    def __init__(self, path: Path) -> None:
        self._path = path
        self._descriptor = _opened(path)
        self._is_file = stat.S_ISREG(os.fstat(self._descriptor).st_mode)
        self._lines: deque[bytes] = deque()
        self._taken = 0
        """Bytes that were put; only the caller changes it, and only the thread what is written."""
        self._written = 0
        self._news = threading.Event()
        self._is_closing = False
        self._checked_s = self._synced_s = time.monotonic()
        self.failure = ""
        self._thread = threading.Thread(target=self._run, name="journal", daemon=True)
        self._thread.start()

    def put(self, line: bytes) -> None:
        """Have a line written; never waits."""
        if self.failure:
            return
        if self._taken - self._written + len(line) > WAITING_MAX:
            self.failure = f"the disk is too slow: {WAITING_MAX >> 20} MiB wait for it"
            return
        self._taken += len(line)
        self._lines.append(line)
        self._news.set()

    def close(self) -> None:
        """Write what is left, for a limited time."""
        self._is_closing = True
        self._news.set()
        self._thread.join(CLOSE_S)

    # ---------------------------------------------------------------- the thread

    def _run(self) -> None:
        try:
            while not self._is_closing:
                self._news.wait()
                self._news.clear()
                self._write_all()
                if not self._is_closing:
                    time.sleep(LAG_S)
            self._write_all()
            self._check()
            self._sync()
        except OSError as error:
            # A full disk ends the journal, not the session.
            self._give_up(error.strerror or str(error))
        os.close(self._descriptor)

    def _write_all(self) -> None:
        now_s = time.monotonic()
        if now_s - self._checked_s >= CHECK_S:
            self._checked_s = now_s
            self._check()
        while self._lines:
            data = b"".join(self._lines.popleft() for _ in range(len(self._lines)))
            write(self._descriptor, data)
            self._written += len(data)
        if now_s - self._synced_s >= SYNC_S:
            self._synced_s = now_s
            self._sync()

    def _check(self) -> None:
        fate = what_became_of(self._path, self._descriptor, self._written)
        if fate in (REMOVED, CHANGED):
            # What another process has made of it stays as it is.
            self._is_file = False
            raise OSError(errno.EIO, f"the file {fate}")

    def _sync(self) -> None:
        if self._is_file:
            os.fsync(self._descriptor)

    def _give_up(self, why: str) -> None:
        self.failure = self.failure or why
        self._lines.clear()
        if self._is_file:
            with suppress(OSError):
                os.ftruncate(self._descriptor, self._written)


def write(descriptor: int, data: bytes) -> None:
    """Write all of it.

    Raises:
        OSError: it cannot be.
    """
    view = memoryview(data)
    while view:
        view = view[os.write(descriptor, view) :]


def _opened(path: Path) -> int:
    """Open a new file, or a device that is there; return its descriptor."""
    try:
        if path.exists() and not path.is_char_device():
            what = "is a folder" if path.is_dir() else "exists"
            raise UsageError(f"--journal {path}: the file {what}; name another one, or remove it")
        return opened_new(path)
    except OSError as error:
        raise UsageError(f"--journal {path}: {error.strerror or error}") from error
