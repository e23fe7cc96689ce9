"""Keeps a task folder in memory: nothing of it outlives the run, and no two runs see each other."""

from __future__ import annotations

import os
from collections.abc import Mapping
from io import UnsupportedOperation
from pathlib import Path
from typing import IO, Any, Final

from elitescript.environment.allowance import Allowance, check_writable
from elitescript.runtime.environment import Channels, NoChannels, WholeReads, opened
from elitescript.untrusted.files import TASK_FILE, UnreadableError, read_bytes

FILES_MAX: Final = 200
"""Files of a folder that are copied; so many of their bytes in all:"""
FILES_BYTES_MAX: Final = 10_000_000
LEFT_OUT: Final = (
    f"the program has a copy of the folder {{folder}} that ends before {{name}}: at most {FILES_MAX} files and "
    f"{FILES_BYTES_MAX // 10**6} MB are copied; `elitescript run` takes the folder itself"
)


class FolderCopy(dict[str, bytes]):
    """Contents of the files of a folder by their names.

    Attributes:
        left_out: a sentence about files that are not in it; empty if all are.
    """

    __slots__ = ("left_out",)

    def __init__(self) -> None:
        super().__init__()
        self.left_out = ""


def folder_contents(folder: Path) -> FolderCopy:
    """Return the contents of the files of a folder, within the limits; without hidden ones and links.

    A program that has them as its task folder in memory changes nothing of the folder.
    """
    found = FolderCopy()
    size = 0
    for home, inner, names in os.walk(folder):
        inner[:] = sorted(name for name in inner if not name.startswith(".") and name != "node_modules")
        for name in sorted(names):
            path = Path(home, name)
            if name.startswith(".") or path.is_symlink() or not path.is_file():
                continue
            if len(found) == FILES_MAX or size + path.stat().st_size > FILES_BYTES_MAX:
                name = path.relative_to(folder).as_posix()
                found.left_out = LEFT_OUT.format(folder=folder.name, name=name)
                return found
            try:
                data = read_bytes(path, TASK_FILE)
            except UnreadableError:
                continue  # as if it were not there: the program says if it misses it
            size += len(data)
            found[path.relative_to(folder).as_posix()] = data
    return found


class MemoryEnvironment:
    """Gives programs files in memory, and the network that it is given.

    Args:
        files: content by name relative to the task folder.
        channels: the network; there is none if None.
        allowance: what programs may write; the default limit if None.

    Attributes:
        files: the task folder, with `contents` to look into.
        channels: the network.
    """

    __slots__ = ("channels", "files")

    def __init__(
        self,
        files: Mapping[str, bytes] | None = None,
        channels: Channels | None = None,
        allowance: Allowance | None = None,
    ) -> None:
        self.files = MemoryFiles(files or {}, allowance)
        self.channels: Channels = NoChannels() if channels is None else channels


class _Content:
    """The bytes of one file, which all its handles share, and how many handles are open."""

    __slots__ = ("data", "handles", "is_removed")

    def __init__(self, data: bytes = b"") -> None:
        self.data = bytearray(data)
        self.handles = 0
        self.is_removed = False


class MemoryFiles:
    """A task folder in memory; implements `runtime.environment.Files`.

    A file that is removed while it is open can be used until it is closed, as on a disk, and counts until then.

    Args:
        files: content by name; it does not count as written by programs.
        allowance: what programs may write; the default limit if None.
    """

    __slots__ = ("_allowance", "_folders", "_nodes")

    def __init__(self, files: Mapping[str, bytes], allowance: Allowance | None = None) -> None:
        self._allowance = Allowance() if allowance is None else allowance
        self._nodes = {name: _Content(data) for name, data in files.items()}
        parts = (name.split("/") for name in files)
        self._folders = {"/".join(words[:end]) for words in parts for end in range(len(words))} | {""}

    @property
    def contents(self) -> dict[str, bytes]:
        """The bytes of each file at this moment, by name."""
        return {name: bytes(node.data) for name, node in self._nodes.items()}

    def open(self, name: str, mode: str, encoding: str | None, newline: str | None) -> IO[Any]:
        self._check_openable(name)
        if mode.strip("bt") != "r":
            check_writable(name)
        node = self._nodes.get(name)
        if "r" in mode and node is None:
            raise FileNotFoundError(2, "No such file or directory", name)
        if "x" in mode and node is not None:
            raise FileExistsError(17, "File exists", name)
        if node is None:
            self._allowance.check_entry(name)
            node = self._nodes[name] = _Content()
            self._allowance.add(0, 1)
        file = _MemoryFile(self._allowance, node, name, mode)
        if "w" in mode:
            file.truncate(0)
        return opened(file, mode, encoding, newline)

    def _check_openable(self, name: str) -> None:
        if name in self._folders:
            raise IsADirectoryError(21, "Is a directory", name)
        if name.rpartition("/")[0] not in self._folders:
            raise FileNotFoundError(2, "No such file or directory", name)

    def kind(self, name: str) -> str:
        return "file" if name in self._nodes else "folder" if name in self._folders else ""

    def size(self, name: str) -> int:
        return len(self._node(name).data)

    def names(self, name: str) -> list[str]:
        if name not in self._folders:
            raise FileNotFoundError(2, "No such file or directory", name)
        start = name + "/" if name else ""
        inside = (other[len(start) :] for other in (*self._nodes, *self._folders) if other.startswith(start))
        return sorted(other for other in inside if other and "/" not in other)

    def remove(self, name: str) -> None:
        node = self._node(name)
        check_writable(name)
        del self._nodes[name]
        node.is_removed = True
        self._allowance.add(0 if node.handles else -len(node.data), -1)

    def make_folder(self, name: str) -> None:
        if self.kind(name):
            raise FileExistsError(17, "File exists", name)
        if name.rpartition("/")[0] not in self._folders:
            raise FileNotFoundError(2, "No such file or directory", name)
        check_writable(name)
        self._allowance.check_entry(name)
        self._folders.add(name)
        self._allowance.add(0, 1)

    def _node(self, name: str) -> _Content:
        if name not in self._nodes:
            raise FileNotFoundError(2, "No such file or directory", name)
        return self._nodes[name]


class _MemoryFile(WholeReads):
    """One handle of a file: a position in the bytes that all handles share."""

    def __init__(self, allowance: Allowance, node: _Content, name: str, mode: str) -> None:
        super().__init__()
        self._allowance = allowance
        self._node = node
        self._file_name = name
        self._can_read = "r" in mode or "+" in mode
        self._can_write = mode.strip("bt") != "r"
        self._appends = "a" in mode
        self._position = len(node.data) if self._appends else 0
        node.handles += 1

    def readable(self) -> bool:
        return self._can_read

    def writable(self) -> bool:
        return self._can_write

    def seekable(self) -> bool:
        return True

    def readinto(self, buffer: Any, /) -> int:
        if not self._can_read:
            raise UnsupportedOperation("not readable")
        with memoryview(buffer).cast("B") as view:
            data = self._node.data[self._position : self._position + len(view)]
            view[: len(data)] = data
        self._position += len(data)
        return len(data)

    def write(self, data: Any, /) -> int:
        self._check_writable()
        content = self._node.data
        start = len(content) if self._appends else self._position
        with memoryview(data).cast("B") as view:
            end = start + len(view)
            if view:
                self._grow(max(start, len(content)), end)
                content[start:end] = view
        self._position = end
        return end - start

    def seek(self, offset: int, whence: int = 0, /) -> int:
        position = (0, self._position, len(self._node.data))[whence] + offset
        if position < 0:
            raise OSError(22, "Invalid argument")
        self._position = position
        return position

    def tell(self) -> int:
        return self._position

    def truncate(self, size: int | None = None, /) -> int:
        self._check_writable()
        size = self._position if size is None else size
        if size < 0:
            raise OSError(22, "Invalid argument")
        content = self._node.data
        if size < len(content):
            self._allowance.add(size - len(content))
            del content[size:]
        else:
            self._grow(size, size)
        return size

    def _grow(self, zeros_until: int, end: int) -> None:
        """Count what the file grows by, and put zeros between its end and a place behind it."""
        content = self._node.data
        growth = end - len(content)
        self._allowance.check_room(growth, self._file_name)
        if zeros_until > len(content):
            content.extend(bytes(zeros_until - len(content)))
        self._allowance.add(max(growth, 0))

    def _check_writable(self) -> None:
        if self.closed:
            raise ValueError("I/O operation on closed file.")
        if not self._can_write:
            raise UnsupportedOperation("not writable")

    def close(self) -> None:
        if not self.closed:
            super().close()
            node = self._node
            node.handles -= 1
            if node.is_removed and not node.handles:
                self._allowance.add(-len(node.data))
