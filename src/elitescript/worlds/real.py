"""A task folder and the network of this computer."""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

from elitescript.errors import ScriptPermissionError, UsageError
from elitescript.runtime.world import Channels
from elitescript.worlds.real_channels import RealChannels


class RealWorld:
    """The world of a program that runs on this computer.

    Args:
        task_dir: folder that stands for the robot's task folder; nothing outside it is reached.
        channels: the network; that of this computer if None.

    Raises:
        UsageError: there is no such folder.
    """

    __slots__ = ("channels", "files")

    def __init__(self, task_dir: Path, channels: Channels | None = None) -> None:
        if not task_dir.is_dir():
            raise UsageError(f"the task folder {str(task_dir)!r} does not exist")
        self.files = RealFiles(task_dir.resolve())
        self.channels: Channels = RealChannels() if channels is None else channels


class RealFiles:
    """The files below one folder. Links that lead out of it are refused."""

    __slots__ = ("_root",)

    def __init__(self, root: Path) -> None:
        self._root = root

    def open(self, name: str, mode: str, encoding: str | None, newline: str | None) -> IO[Any]:
        """See `runtime.world.Files.open`."""
        path = self._path(name)
        try:
            return path.open(mode, encoding=encoding, newline=newline)
        except OSError as error:
            raise _renamed(error, name) from None

    def kind(self, name: str) -> str:
        """See `runtime.world.Files.kind`."""
        path = self._path(name)
        return "file" if path.is_file() else "folder" if path.is_dir() else ""

    def size(self, name: str) -> int:
        """See `runtime.world.Files.size`."""
        path = self._path(name)
        try:
            return path.stat().st_size
        except OSError as error:
            raise _renamed(error, name) from None

    def names(self, name: str) -> list[str]:
        """See `runtime.world.Files.names`."""
        path = self._path(name)
        try:
            return sorted(entry.name for entry in path.iterdir())
        except OSError as error:
            raise _renamed(error, name) from None

    def remove(self, name: str) -> None:
        """See `runtime.world.Files.remove`."""
        path = self._path(name)
        try:
            path.unlink()
        except OSError as error:
            raise _renamed(error, name) from None

    def make_folder(self, name: str) -> None:
        """See `runtime.world.Files.make_folder`."""
        path = self._path(name)
        try:
            path.mkdir()
        except OSError as error:
            raise _renamed(error, name) from None

    def _path(self, name: str) -> Path:
        """Where a name leads once every link on the way is followed.

        Raises:
            ScriptPermissionError: outside the folder.
        """
        try:
            path = (self._root / name).resolve()
        except (OSError, RuntimeError):
            raise ScriptPermissionError(f"cannot open {name!r}: its links go round in circles", value=name) from None
        if path != self._root and self._root not in path.parents:
            raise ScriptPermissionError(f"cannot open {name!r}: it leads out of the task folder", value=name)
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise ScriptPermissionError(f"cannot open {name!r}: it is neither a file nor a folder", value=name)
        return path


def _renamed(error: OSError, name: str) -> OSError:
    """The same error, with the name in the task folder instead of a path of this computer."""
    return type(error)(error.errno, error.strerror or "cannot be opened", name)
