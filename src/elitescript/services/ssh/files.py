"""The files that SSH clients of a robot see: a small file system in memory, never one of this computer.

Clients write below `/tmp` alone. Everything else is made by the robot and can only be read (*assumed*). There are no
links. Bytes, names and open files are bounded; bytes of a removed file count until it is closed.
"""

from __future__ import annotations

import errno
import posixpath
import time
from collections.abc import Callable, Mapping
from os import strerror
from typing import Final

from elitescript.records import record

BYTES_MAX: Final = 32 * 1024 * 1024
"""Of all files that clients have written."""
ENTRIES_MAX: Final = 256
"""Files and folders that clients have made."""
OPEN_MAX: Final = 64
"""Files that are open at once."""
PAGE: Final = 64 * 1024
"""Bytes of a file that are kept together; those that were never written take no memory."""
PATH_MAX: Final = 1024
"""Bytes of a path."""
NAME_MAX: Final = 255
"""Bytes of a name."""
DEPTH_MAX: Final = 16
"""Folders above an entry."""
WRITABLE: Final = "/tmp"

FOLDER_MODE: Final = 0o755
FILE_MODE: Final = 0o644
READ_ONLY_MODE: Final = 0o444


@record
class Status:
    """Return what is known of a file or folder."""

    is_folder: bool
    size: int
    mode: int
    """Permission bits."""
    time_s: int
    """Of the last change, in seconds since 1970."""


class _File:
    """A file that clients write, in pages.

    Attributes:
        size: bytes, with those that were never written.
    """

    __slots__ = ("_pages", "handles", "is_linked", "size", "time_s")

    def __init__(self, time_s: int) -> None:
        self._pages: dict[int, bytearray] = {}
        self.size = 0
        self.handles = 0
        self.is_linked = True
        self.time_s = time_s

    def read(self, offset: int, size: int) -> bytes:
        end = min(offset + size, self.size)
        parts: list[bytes] = []
        while offset < end:
            number, start = divmod(offset, PAGE)
            count = min(PAGE - start, end - offset)
            page = self._pages.get(number)
            parts.append(bytes(count) if page is None else bytes(page[start : start + count]))
            offset += count
        return b"".join(parts)

    def write(self, offset: int, data: bytes) -> None:
        """Write where there is room already."""
        done = 0
        while done < len(data):
            number, start = divmod(offset + done, PAGE)
            count = min(PAGE - start, len(data) - done)
            page = self._pages.get(number)
            if page is None:
                page = self._pages[number] = bytearray(PAGE)
            page[start : start + count] = data[done : done + count]
            done += count

    def resize(self, size: int) -> None:
        if size < self.size:
            last, start = divmod(size, PAGE)
            for number in [number for number in self._pages if number > last or (number == last and not start)]:
                del self._pages[number]
            if start and (page := self._pages.get(last)) is not None:
                page[start:] = bytes(PAGE - start)
        self.size = size


class _Made(_File):
    """A file that the robot makes, as it was when it was opened."""

    __slots__ = ("_content",)

    def __init__(self, time_s: int, content: bytes) -> None:
        super().__init__(time_s)
        self._content = content
        self.size = len(content)

    def read(self, offset: int, size: int) -> bytes:
        return self._content[offset : offset + size]


class RobotFiles:
    """Folders and files of one robot.

    Args:
        made: contents of the files that the robot makes, by path; called when a file is opened or looked at.
        clock: seconds since 1970.
    """

    __slots__ = ("_clock", "_files", "_folders", "_made", "_open", "_used")

    def __init__(self, made: Mapping[str, Callable[[], bytes]], clock: Callable[[], float] = time.time) -> None:
        self._made = dict(made)
        self._clock = clock
        now = int(clock())
        self._folders: dict[str, int] = {"/": now, WRITABLE: now}
        """Time of each in seconds since 1970."""
        for path in self._made:
            while (path := posixpath.dirname(path)) != "/":
                self._folders[path] = now
        self._files: dict[str, _File] = {}
        self._open = 0
        self._used = 0

    # ---------------------------------------------------------------- looking

    @property
    def free(self) -> int:
        """Bytes that clients may still write."""
        return BYTES_MAX - self._used

    def status(self, path: str) -> Status:
        """Return what is known of a file or folder.

        Raises:
            FileNotFoundError: there is none.
        """
        place = absolute(path)
        if place in self._folders:
            return Status(True, 0, FOLDER_MODE, self._folders[place])
        if place in self._made:
            return Status(False, len(self._made[place]()), READ_ONLY_MODE, int(self._clock()))
        if place in self._files:
            file = self._files[place]
            return Status(False, file.size, FILE_MODE, file.time_s)
        raise _error(errno.ENOENT, place)

    def names(self, path: str) -> list[str]:
        """Return names of what is in a folder, sorted.

        Raises:
            OSError: there is no such folder.
        """
        place = absolute(path)
        if place not in self._folders:
            raise _error(errno.ENOTDIR if self._is_there(place) else errno.ENOENT, place)
        inside = (entry for entry in (*self._folders, *self._made, *self._files) if entry != "/")
        return sorted(posixpath.basename(entry) for entry in inside if posixpath.dirname(entry) == place)

    def _is_there(self, place: str) -> bool:
        return place in self._folders or place in self._made or place in self._files

    # ---------------------------------------------------------------- changing

    def open(
        self,
        path: str,
        *,
        writes: bool = False,
        appends: bool = False,
        creates: bool = False,
        truncates: bool = False,
        is_new: bool = False,
    ) -> OpenFile:
        """Open a file.

        Args:
            path: of the file.
            writes: whether it may be written.
            appends: what is written goes to its end, whatever the offset.
            creates: make it if there is none.
            truncates: make it empty.
            is_new: refuse a file that is there.

        Raises:
            OSError: it cannot be.
        """
        place = absolute(path)
        if self._open >= OPEN_MAX:
            raise OSError(errno.EMFILE, f"{OPEN_MAX} files are open")
        if place in self._folders:
            raise _error(errno.EISDIR, place)
        if writes:
            _check_writable(place)
        if place in self._made:
            return OpenFile(self, _Made(int(self._clock()), self._made[place]()), writes=False, appends=False)
        found = self._files.get(place)
        if found is None:
            if not (creates and writes):
                raise _error(errno.ENOENT, place)
            self._check_room(place)
            found = self._files[place] = _File(int(self._clock()))
        elif is_new:
            raise _error(errno.EEXIST, place)
        opened = OpenFile(self, found, writes=writes, appends=appends)
        if truncates and writes:
            opened.truncate(0)
        return opened

    def make_folder(self, path: str) -> None:
        """Make a folder.

        Raises:
            OSError: it cannot be.
        """
        place = absolute(path)
        if self._is_there(place):
            raise _error(errno.EEXIST, place)
        _check_writable(place)
        self._check_room(place)
        self._folders[place] = int(self._clock())

    def remove_folder(self, path: str) -> None:
        """Remove an empty folder.

        Raises:
            OSError: it cannot be.
        """
        place = absolute(path)
        if self.names(place):
            raise _error(errno.ENOTEMPTY, place)
        _check_writable(place)
        del self._folders[place]

    def remove(self, path: str) -> None:
        """Remove a file.

        Raises:
            OSError: it cannot be.
        """
        place = absolute(path)
        if place in self._folders:
            raise _error(errno.EISDIR, place)
        if not self._is_there(place):
            raise _error(errno.ENOENT, place)
        _check_writable(place)
        self._unlink(place)

    def rename(self, old: str, new: str, *, replaces: bool) -> None:
        """Give a file another path. Folders keep theirs.

        Args:
            old: its path.
            new: the other path.
            replaces: whether a file that is there goes.

        Raises:
            OSError: it cannot be.
        """
        source, target = absolute(old), absolute(new)
        if source in self._folders or target in self._folders:
            raise _error(errno.EISDIR, source if source in self._folders else target)
        if not self._is_there(source):
            raise _error(errno.ENOENT, source)
        _check_writable(source)
        _check_writable(target)
        if source == target:
            return
        if target in self._files:
            if not replaces:
                raise _error(errno.EEXIST, target)
            self._unlink(target)
        self._check_parent(target)
        self._files[target] = self._files.pop(source)

    def _unlink(self, place: str) -> None:
        file = self._files.pop(place)
        file.is_linked = False
        self._forget(file)

    def _check_room(self, place: str) -> None:
        self._check_parent(place)
        made_by_clients = len(self._files) + sum(path.startswith(WRITABLE + "/") for path in self._folders)
        if made_by_clients >= ENTRIES_MAX:
            raise OSError(errno.ENOSPC, f"{ENTRIES_MAX} files and folders are there")

    def _check_parent(self, place: str) -> None:
        parent = posixpath.dirname(place)
        if parent not in self._folders:
            raise _error(errno.ENOTDIR if self._is_there(parent) else errno.ENOENT, parent)

    # ---------------------------------------------------------------- called by open files

    def _begin(self, file: _File) -> None:
        file.handles += 1
        self._open += 1

    def _end(self, file: _File) -> None:
        file.handles -= 1
        self._open -= 1
        self._forget(file)

    def _forget(self, file: _File) -> None:
        """Give back the bytes of a file that cannot be read any more."""
        if not file.is_linked and not file.handles:
            self._resize(file, 0)

    def _resize(self, file: _File, size: int) -> None:
        grown = size - file.size
        if grown > 0 and self._used + grown > BYTES_MAX:
            raise OSError(errno.ENOSPC, f"the files of the robot have {BYTES_MAX // 2**20} MiB at most")
        file.resize(size)
        self._used += grown
        file.time_s = int(self._clock())


class OpenFile:
    """A file that a client has open."""

    __slots__ = ("_appends", "_file", "_files", "_is_open", "_writes")

    def __init__(self, files: RobotFiles, file: _File, *, writes: bool, appends: bool) -> None:
        self._files = files
        self._file = file
        self._writes = writes
        self._appends = appends
        self._is_open = True
        files._begin(file)

    @property
    def status(self) -> Status:
        """What is known of it."""
        mode = FILE_MODE if self._writes else READ_ONLY_MODE
        return Status(False, self._file.size, mode, self._file.time_s)

    def read(self, offset: int, size: int) -> bytes:
        """Return bytes from an offset on, fewer at the end."""
        return self._file.read(max(offset, 0), max(size, 0))

    def write(self, offset: int, data: bytes) -> int:
        """Write at an offset; zeros fill what lies before it.

        Raises:
            OSError: not opened to be written, or there is no room.
        """
        self._check_writes()
        at = self._file.size if self._appends else max(offset, 0)
        if at + len(data) > self._file.size:
            self._files._resize(self._file, at + len(data))
        self._file.write(at, data)
        return len(data)

    def truncate(self, size: int) -> None:
        """Cut it, or fill it up with zeros.

        Raises:
            OSError: not opened to be written, or there is no room.
        """
        self._check_writes()
        self._files._resize(self._file, max(size, 0))

    def set_time(self, time_s: int) -> None:
        """Set the time of the last change, in seconds since 1970; a later write sets another one.

        Raises:
            OSError: not opened to be written.
        """
        self._check_writes()
        self._file.time_s = time_s

    def close(self) -> None:
        """Let it go."""
        if self._is_open:
            self._is_open = False
            self._files._end(self._file)

    def _check_writes(self) -> None:
        if not self._writes:
            raise OSError(errno.EBADF, strerror(errno.EBADF))


def absolute(path: str) -> str:
    """Return a path without `.` and `..`; nothing is above the root.

    Raises:
        OSError: too long, too deep, or with a character that no path has.
    """
    if "\0" in path:
        raise OSError(errno.EINVAL, "a path has no null characters")
    if len(path.encode(errors="surrogateescape")) > PATH_MAX:
        raise OSError(errno.ENAMETOOLONG, f"a path has {PATH_MAX} bytes at most")
    place = posixpath.normpath("/" + path.lstrip("/"))
    names = place.split("/")[1:]
    if any(len(name.encode(errors="surrogateescape")) > NAME_MAX for name in names):
        raise OSError(errno.ENAMETOOLONG, f"a name has {NAME_MAX} bytes at most")
    if len(names) > DEPTH_MAX:
        raise OSError(errno.ENAMETOOLONG, f"folders are {DEPTH_MAX} deep at most")
    return place


def _check_writable(place: str) -> None:
    if not place.startswith(WRITABLE + "/"):
        raise OSError(errno.EACCES, f"clients write below {WRITABLE} alone", place)


def _error(number: int, place: str) -> OSError:
    return OSError(number, strerror(number), place)
