"""A world in memory: nothing of its task folder outlives it, and no two runs see each other."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO, TextIOWrapper
from typing import IO, Any, Final

from elitescript.runtime.world import Channels

FOLDERS_MAX: Final = 1000
"""Folders that a program may make."""
BYTES_MAX: Final = 64 * 1024 * 1024
"""Of all files together: they take memory of whoever serves the programs."""
FILES_MAX: Final = 10_000


class MemoryWorld:
    """A world of files in memory.

    Args:
        files: content by name relative to the task folder.
        channels: the network; nothing listens on any port if None.

    Attributes:
        files: the task folder, with `contents` to look into.
        channels: the network.
    """

    __slots__ = ("channels", "files")

    def __init__(self, files: Mapping[str, bytes] | None = None, channels: Channels | None = None) -> None:
        self.files = MemoryFiles(files or {})
        if channels is None:
            from elitescript.worlds.virtual.network import VirtualNetwork

            channels = VirtualNetwork()
        self.channels = channels


class MemoryFiles:
    """A task folder in memory.

    Attributes:
        contents: bytes of each file that is not being written just now, by name.
    """

    __slots__ = ("_folders", "contents")

    def __init__(self, files: Mapping[str, bytes]) -> None:
        self.contents = dict(files)
        self._folders: set[str] = set()

    def open(self, name: str, mode: str, encoding: str | None, newline: str | None) -> IO[Any]:
        """See `runtime.world.Files.open`. What is written is seen by others when the file is flushed or closed."""
        self._check_openable(name, mode)
        is_new = name not in self.contents
        if "r" in mode and is_new:
            raise FileNotFoundError(2, "No such file or directory", name)
        if "x" in mode and not is_new:
            raise FileExistsError(17, "File exists", name)
        if is_new and len(self.contents) >= FILES_MAX:
            raise OSError(28, f"more than {FILES_MAX} files", name)
        if is_new or "w" in mode:
            self.contents[name] = b""
        file = _MemoryFile(self, name, mode)
        if encoding is None:
            return file
        # A text file writes through, so that what is flushed is all that was written.
        return TextIOWrapper(file, encoding=encoding, newline=newline, write_through=True)

    def check_room(self, name: str, size: int) -> None:
        """Let a file have so many bytes.

        Raises:
            OSError: the task folder is full.
        """
        if size > len(self.contents.get(name, b"")):
            others = sum(len(content) for other, content in self.contents.items() if other != name)
            if size + others > BYTES_MAX:
                raise OSError(28, f"No space left: files in memory have {BYTES_MAX} bytes together", name)

    def _check_openable(self, name: str, mode: str) -> None:
        if self.kind(name) == "folder":
            raise IsADirectoryError(21, "Is a directory", name)
        folder, slash, _ = name.rpartition("/")
        if slash and self.kind(folder) != "folder":
            raise FileNotFoundError(2, "No such file or directory", name)

    def kind(self, name: str) -> str:
        """See `runtime.world.Files.kind`."""
        if name in self.contents:
            return "file"
        if name == "" or name in self._folders or any(other.startswith(name + "/") for other in self.contents):
            return "folder"
        return ""

    def size(self, name: str) -> int:
        """See `runtime.world.Files.size`."""
        if name not in self.contents:
            raise FileNotFoundError(2, "No such file or directory", name)
        return len(self.contents[name])

    def names(self, name: str) -> list[str]:
        """See `runtime.world.Files.names`."""
        if self.kind(name) != "folder":
            raise FileNotFoundError(2, "No such file or directory", name)
        start = name + "/" if name else ""
        inside = (other[len(start) :] for other in (*self.contents, *self._folders) if other.startswith(start))
        return sorted({other.partition("/")[0] for other in inside if other})

    def remove(self, name: str) -> None:
        """See `runtime.world.Files.remove`."""
        if name not in self.contents:
            raise FileNotFoundError(2, "No such file or directory", name)
        del self.contents[name]

    def make_folder(self, name: str) -> None:
        """See `runtime.world.Files.make_folder`."""
        if self.kind(name):
            raise FileExistsError(17, "File exists", name)
        if "/" in name and self.kind(name.rpartition("/")[0]) != "folder":
            raise FileNotFoundError(2, "No such file or directory", name)
        if len(self._folders) >= FOLDERS_MAX:
            raise OSError(28, f"more than {FOLDERS_MAX} folders", name)
        self._folders.add(name)


class _MemoryFile(BytesIO):
    """An open file; puts its bytes back when it is flushed, if something was written."""

    def __init__(self, files: MemoryFiles, name: str, mode: str) -> None:
        super().__init__(files.contents[name])
        self._files = files
        self._file_name = name
        self._can_read = "r" in mode or "+" in mode
        self._can_write = mode.strip("bt") != "r"
        self._appends = "a" in mode
        self._is_changed = False
        if self._appends:
            self.seek(0, 2)

    def readable(self) -> bool:
        return self._can_read

    def writable(self) -> bool:
        return self._can_write

    def _check_readable(self) -> None:
        if not self._can_read:
            raise OSError("not readable")

    def read(self, size: int | None = -1, /) -> bytes:
        self._check_readable()
        return super().read(size)

    def read1(self, size: int | None = -1, /) -> bytes:
        self._check_readable()
        return super().read1(-1 if size is None else size)

    def readline(self, size: int | None = -1, /) -> bytes:
        self._check_readable()
        return super().readline(size)

    def readlines(self, hint: int | None = None, /) -> list[bytes]:
        self._check_readable()
        return super().readlines(hint)

    def write(self, data: Any, /) -> int:
        if not self._can_write:
            raise OSError("not writable")
        if self._appends:
            self.seek(0, 2)
        with memoryview(data) as view:
            self._files.check_room(self._file_name, self.tell() + view.nbytes)
        self._is_changed = True
        return super().write(data)

    def truncate(self, size: int | None = None, /) -> int:
        if not self._can_write:
            raise OSError("not writable")
        self._is_changed = True
        return super().truncate(size)

    def flush(self) -> None:
        super().flush()
        if self._is_changed and self._file_name in self._files.contents:
            self._is_changed = False
            self._files.contents[self._file_name] = self.getvalue()

    def close(self) -> None:
        try:
            if not self.closed:
                self.flush()
        finally:
            super().close()
