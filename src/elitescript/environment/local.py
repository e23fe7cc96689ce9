"""A task folder and the network of this computer."""

from __future__ import annotations

import os
from io import FileIO
from pathlib import Path
from typing import IO, Any

from elitescript.environment.allowance import Allowance, check_writable
from elitescript.environment.local_channels import LocalChannels
from elitescript.errors import ScriptPermissionError, UsageError
from elitescript.runtime.environment import Channels, WholeReads, opened
from elitescript.said import said


class LocalEnvironment:
    """The world of a program that runs on this computer.

    Args:
        task_dir: folder that stands for the robot's task folder; nothing outside it is reached.
        channels: the network; that of this computer if None.
        allowance: what programs may write; the default limit if None.

    Raises:
        UsageError: there is no such folder.
    """

    __slots__ = ("channels", "files")

    def __init__(self, task_dir: Path, channels: Channels | None = None, allowance: Allowance | None = None) -> None:
        if not task_dir.is_dir():
            raise UsageError(f"the task folder {str(task_dir)!r} does not exist")
        self.files = LocalFiles(task_dir.resolve(), allowance)
        self.channels: Channels = LocalChannels() if channels is None else channels


class LocalFiles:
    """Implements `runtime.environment.Files` with one folder. Links that lead out of it are refused.

    Args:
        root: the folder, without links in its path.
        allowance: what programs may write; the default limit if None.
    """

    __slots__ = ("_allowance", "_root")

    def __init__(self, root: Path, allowance: Allowance | None = None) -> None:
        self._root = root
        self._allowance = Allowance() if allowance is None else allowance

    def open(self, name: str, mode: str, encoding: str | None, newline: str | None) -> IO[Any]:
        path = self._path(name)
        if mode.strip("bt") != "r":
            self._check_writable(path, name)
        try:
            size = path.stat().st_size if path.is_file() else None
            if size is None and "r" not in mode and not path.is_dir():
                self._allowance.check_entry(name)
            file = _RealFile(path, mode, name, self._allowance)
        except OSError as error:
            raise _renamed(error, name) from None
        if size is None:
            self._allowance.add(0, 1)
        elif "w" in mode:
            self._allowance.add(-size)
        return opened(file, mode, encoding, newline)

    def kind(self, name: str) -> str:
        path = self._path(name)
        return "file" if path.is_file() else "folder" if path.is_dir() else ""

    def size(self, name: str) -> int:
        path = self._path(name)
        try:
            return path.stat().st_size
        except OSError as error:
            raise _renamed(error, name) from None

    def names(self, name: str) -> list[str]:
        path = self._path(name)
        try:
            return sorted(entry.name for entry in path.iterdir())
        except OSError as error:
            raise _renamed(error, name) from None

    def remove(self, name: str) -> None:
        path = self._path(name)
        self._check_writable(path, name)
        try:
            size = path.stat().st_size
            path.unlink()
        except OSError as error:
            raise _renamed(error, name) from None
        self._allowance.add(-size, -1)

    def make_folder(self, name: str) -> None:
        path = self._path(name)
        self._check_writable(path, name)
        self._allowance.check_entry(name)
        try:
            path.mkdir()
        except OSError as error:
            raise _renamed(error, name) from None
        self._allowance.add(0, 1)

    def _check_writable(self, path: Path, name: str) -> None:
        """Let a file be changed that starts no program, and has no other name, perhaps outside the folder.

        Raises:
            ScriptPermissionError: it is such a file.
        """
        check_writable(name)
        check_writable(path.relative_to(self._root).as_posix())
        try:
            is_linked = path.is_file() and path.stat().st_nlink > 1
        except OSError as error:
            raise _renamed(error, name) from None
        if is_linked:
            raise ScriptPermissionError(
                said("cannot write {name!r}: it has another name too (a hard link)", name=name), value=name
            )

    def _path(self, name: str) -> Path:
        """Return where a name leads once every link on the way is followed.

        Raises:
            ScriptPermissionError: outside the folder.
        """
        try:
            path = (self._root / name).resolve()
            is_special = path.exists() and not (path.is_file() or path.is_dir())
        except RuntimeError:
            raise ScriptPermissionError(
                said("cannot open {name!r}: its links go round in circles", name=name), value=name
            ) from None
        except OSError as error:
            raise _renamed(error, name) from None
        if path != self._root and self._root not in path.parents:
            raise ScriptPermissionError(
                said("cannot open {name!r}: it leads out of the task folder", name=name), value=name
            )
        if is_special:
            raise ScriptPermissionError(
                said("cannot open {name!r}: it is neither a file nor a folder", name=name), value=name
            )
        return path


class _RealFile(WholeReads, FileIO):
    """An open file whose growth is counted."""

    def __init__(self, path: Path, mode: str, name: str, allowance: Allowance) -> None:
        super().__init__(path, mode.replace("b", "").replace("t", ""))
        self._appends = "a" in mode
        self._file_name = name
        self._allowance = allowance

    def write(self, data: Any, /) -> int:
        size = self._size()
        start = size if self._appends else self.tell()
        with memoryview(data) as view:
            self._allowance.check_room(start + view.nbytes - size, self._file_name)
        written = super().write(data)
        self._allowance.add(self._size() - size)
        return written

    def truncate(self, size: int | None = None, /) -> int:
        before = self._size()
        self._allowance.check_room((self.tell() if size is None else size) - before, self._file_name)
        size = super().truncate(size)
        self._allowance.add(self._size() - before)
        return size

    def _size(self) -> int:
        return os.fstat(self.fileno()).st_size


def _renamed(error: OSError, name: str) -> OSError:
    """Return the same error, with the name in the task folder instead of a path of this computer."""
    return type(error)(error.errno, error.strerror or "cannot be opened", name)
