"""The state file: what a controller remembers when it is switched off (`Signal.is_kept`), as JSON.

```
{"format": "elitescript state", "version": 1, "signals": {"flag[3]": true, "general_register[0]": 700}}
```

Only points that are not at their default are in it, under the names that `--set` takes. There is the old file or the
new one at every moment, whatever happens to process or computer (`outputs.writing`). A file that is not understood, or
that another process has changed since it was read, is left as it is.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any, Final

from elitescript.controller.signals.by_name import signal_write
from elitescript.errors import UsageError
from elitescript.messages.signals import KEPT, SIGNALS, Value, parse_signal_name, signal_name
from elitescript.outputs.locking import locked
from elitescript.outputs.writing import write_file
from elitescript.paths import real_path, why_no_file
from elitescript.untrusted.json_text import JsonError, json_value

FORMAT: Final = "elitescript state"
VERSION: Final = 1
SIZE_MAX: Final = 1_000_000
"""Bytes; a longer file is none of ours."""

Levels = Mapping[str, tuple[Value, ...]]


class Disk:
    """What a state file does to the disk of this computer, step by step."""

    __slots__ = ()

    def read(self, path: Path, size_max: int) -> bytes:
        """Return the first bytes of a file.

        Raises:
            OSError: there is none, or it cannot be read.
        """
        with path.open("rb") as file:
            return file.read(size_max)

    def put(self, path: Path, data: bytes) -> None:
        """Let a file have this content, whole and on the disk, or the one that it had.

        Raises:
            OSError: it cannot be written.
        """
        write_file(path, data, is_synced=True)

    def lock(self, path: Path) -> IO[bytes]:
        """Lock a file, which is made if there is none, until what this returns is closed.

        Raises:
            BlockingIOError: another process has it.
        """
        return locked(path)


class StateFile:
    """One state file. It need not exist before something is saved.

    Args:
        path: where it is.
        disk: what it is on.

    Raises:
        UsageError: there is no such folder, or no file can be there.
    """

    __slots__ = ("_disk", "_lock", "_path", "_seen")

    def __init__(self, path: str | Path, disk: Disk | None = None) -> None:
        # Two names of one file are one file.
        self._path = real_path(path)
        self._disk = Disk() if disk is None else disk
        self._lock: IO[bytes] | None = None
        self._seen: bytes | None = None
        """What was there when it was looked at last; None without a file."""
        if disk is None and not self._path.parent.is_dir():
            raise UsageError(f"state file {self._path}: there is no folder {self._path.parent}")
        for used in (self._path, self._lock_path):
            if why := why_no_file(used):
                raise UsageError(f"state file {self._path}: {used} {why}")

    @property
    def path(self) -> Path:
        """Where it is."""
        return self._path

    @property
    def _lock_path(self) -> Path:
        return self._path.with_name(self._path.name + ".lock")

    def hold(self) -> None:
        """Lock out other processes until `release`.

        Raises:
            UsageError: another process has it.
        """
        if self._lock is not None:
            return
        try:
            self._lock = self._disk.lock(self._lock_path)
        except BlockingIOError:
            raise UsageError(
                f"state file {self._path}: another `elitescript` uses it; give each its own with --state"
            ) from None
        except OSError as error:
            raise self._trouble("cannot be locked", error) from error

    def release(self) -> None:
        """Let others have it."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def load(self) -> dict[str, Value]:
        """Read what is kept, by the names of `--set`; nothing if there is no file.

        Raises:
            UsageError: another process uses it, it cannot be read, or it is no state file of this version.
        """
        with self._held():
            self._seen = self._read()
            return {} if self._seen is None else self._levels(self._seen)

    def save(self, levels: Levels) -> None:
        """Write what is to be kept, unless the file has it already.

        Args:
            levels: every family of signals; those that are not kept may be missing.

        Raises:
            UsageError: another process uses it, has changed it since it was read, or it cannot be written.
        """
        data = state_text(levels).encode()
        if data == self._seen or (self._seen is None and not _kept(levels)):
            return
        with self._held():
            if self._read() != self._seen:
                raise UsageError(f"state file {self._path}: somebody else has changed it; it was left as it is")
            try:
                self._disk.put(self._path, data)
                self._seen = data
            except OSError as error:
                raise self._trouble("cannot be written", error) from error

    @contextlib.contextmanager
    def _held(self) -> Iterator[None]:
        was_held = self._lock is not None
        self.hold()
        try:
            yield
        finally:
            if not was_held:
                self.release()

    def _read(self) -> bytes | None:
        try:
            data = self._disk.read(self._path, SIZE_MAX + 1)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise self._trouble("cannot be read", error) from error
        if len(data) > SIZE_MAX:
            raise self._foreign(f"it has more than {SIZE_MAX} bytes")
        return data

    def _levels(self, data: bytes) -> dict[str, Value]:
        try:
            content = json_value(data)
        except JsonError as error:
            raise self._foreign(f"it is not JSON: {error}") from error
        if not isinstance(content, dict) or content.get("format") != FORMAT:
            raise self._foreign(f'it does not say "format": "{FORMAT}"')
        if content.get("version") != VERSION:
            raise self._foreign(f"it has version {content.get('version')!r}, and this program knows {VERSION}")
        if unknown := content.keys() - {"format", "version", "signals"}:
            raise self._foreign(f"it has the unknown key {min(unknown)!r}")
        signals = content.get("signals")
        if not isinstance(signals, dict):
            raise self._foreign("its `signals` are not a table of names and values")
        return {name: self._level(name, value) for name, value in signals.items()}

    def _level(self, name: str, value: Any) -> Value:
        try:
            row, _ = parse_signal_name(name)
            level = signal_write(name, value).value
        except UsageError as error:
            raise self._foreign(str(error)) from error
        if not row.is_kept:
            raise self._foreign(f"{name} is not kept")
        if row.low is not None and row.high is not None and not row.low <= level <= row.high:
            raise self._foreign(f"{name} must be in [{row.low:g}, {row.high:g}], got {level}")
        return level

    def _foreign(self, why: str) -> UsageError:
        return UsageError(f"state file {self._path}: {why}. It was left as it is; give another file, or remove it")

    def _trouble(self, what: str, error: OSError) -> UsageError:
        return UsageError(f"state file {self._path}: {what}: {error.strerror or error}")


def state_text(levels: Levels) -> str:
    """Return the content of a state file.

    Args:
        levels: see `StateFile.save`.
    """
    content = {"format": FORMAT, "version": VERSION, "signals": _kept(levels)}
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def kept_levels(signals: Levels) -> dict[str, tuple[Value, ...]]:
    """Return the families that are kept."""
    return {name: signals[name] for name in KEPT}


def _kept(levels: Levels) -> dict[str, Value]:
    return {
        signal_name(row, index): value
        for row in map(SIGNALS.__getitem__, KEPT)
        for index, value in enumerate(levels.get(row.name, ()))
        if value != row.default
    }
