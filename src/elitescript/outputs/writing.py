"""Writes files that people name: what was there stays until the new content is whole.

An ordinary file is written beside the one that it will replace, as `.NAME.elitescript`, and takes its name when it is
whole, with owner, group, mode and attributes of the old one; a link goes on to lead to it. Where that would part hard
links, or the owner cannot be kept, the old file is overwritten, once the new content is whole. Pipes, devices and
streams of the shell are written straight. `.NAME.elitescript` is locked as long as it is written: two processes do not
write one file.
"""

from __future__ import annotations

import errno
import io
import os
import stat
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, Final, cast

from elitescript.outputs.locking import lock
from elitescript.page import MARK
from elitescript.paths import kind_of, real_path, stream_of
from elitescript.untrusted.files import opened

BESIDE: Final = ".elitescript"
"""End of the names of files that are being written."""

_OLD_PAGES: Final = (b" elitescript plot</title>", b"--missed-back: #ffebe9")
"""In the head of pages that had no mark yet."""

_HEAD_BYTES: Final = 8192
_BLOCK: Final = 1 << 20
_NAME_BYTES_MAX: Final = 240
_TRIES: Final = 200
_PAUSE_S: Final = 0.01
_FLAGS: Final = (
    os.O_RDWR
    | getattr(os, "O_CLOEXEC", 0)
    | getattr(os, "O_BINARY", 0)
    | getattr(os, "O_NOFOLLOW", 0)
    | getattr(os, "O_NONBLOCK", 0)
)
_NO_PLACE: Final = (errno.EACCES, errno.EPERM, errno.EROFS)
"""Errors of a folder in which nothing can be made, although a file in it may be overwritten."""
_NO_MOVE: Final = (*_NO_PLACE, errno.EBUSY, errno.EXDEV, errno.ETXTBSY)
"""Errors of a move onto a file that may be overwritten, such as one that is a mount of its own."""


class WriteError(OSError):
    """A file cannot be written.

    Args:
        called: the file, as the caller has named it.
        error: of the system.
    """

    def __init__(self, called: str, error: OSError) -> None:
        super().__init__(error.errno, error.strerror or str(error), called)

    def __str__(self) -> str:
        return f"{self.filename}: {self.strerror}"


class Output:
    """A file that is written: as a context it is whole at the end of the body, or as it was if that raises.

    Args:
        path: of the file; links are followed.
        called: how messages call it, as `--page out.html`; the path if empty.
        mode: permissions of a new file, before the umask.
        waits_s: how long to wait for another process that writes it, s.
        is_synced: whether the disk has it when it takes its name, so that the power may fail.
        is_new: whether a file that has come to be there is left: the error is `EEXIST`.

    Attributes:
        path: as it was given.
        called: see above.

    Raises:
        WriteError: it cannot be written, or another process writes it.
    """

    __slots__ = (
        "_beside",
        "_descriptor",
        "_file",
        "_is_new",
        "_is_synced",
        "_mode",
        "_real",
        "_there",
        "called",
        "path",
    )

    def __init__(
        self,
        path: str | os.PathLike[str],
        called: str = "",
        *,
        mode: int = 0o666,
        waits_s: float = 0.0,
        is_synced: bool = False,
        is_new: bool = False,
    ) -> None:
        self.path = Path(path)
        self.called = called or str(path)
        self._mode = mode
        self._is_synced = is_synced
        self._is_new = is_new
        self._file: BinaryIO | None = None
        self._descriptor = -1
        """Of what is written, until a file object has it; -1 where nothing is open."""
        self._beside: Path | None = None
        """Name under which the new content is written; None where it has none."""
        self._there: os.stat_result | None = None
        """What stood at the path; None if nothing did."""
        self._real: Path | None = None
        """The ordinary file that is replaced; None for what is written straight."""
        try:
            self._claim(os.fspath(path), waits_s)
        except BaseException as error:
            self.drop()
            if isinstance(error, OSError) and not isinstance(error, WriteError):
                raise WriteError(self.called, error) from error
            raise

    # ---------------------------------------------------------------- the place

    def _claim(self, name: str, waits_s: float) -> None:
        stream = stream_of(name)
        if stream is not None:
            if stream == 1 and sys.stdout is not None:
                # What has been printed comes before.
                sys.stdout.flush()
            self._descriptor = os.dup(stream)
            return
        real = real_path(name)
        self._there = _status(real)
        if self._there is not None and not stat.S_ISREG(self._there.st_mode):
            kind = kind_of(self._there.st_mode)
            if kind in ("a folder", "a socket"):
                raise OSError(errno.EINVAL, f"it is {kind}, not a file")
            # Opened when there is something to be written: a pipe waits for its reader.
            return
        self._real = real
        if self._there is not None and not os.access(real, os.W_OK):
            # To replace it would succeed: that depends on the permissions of the folder alone.
            raise PermissionError(errno.EACCES, "it is read-only")
        if not real.parent.is_dir():
            raise OSError(errno.ENOENT, f"there is no folder {real.parent}")
        end_s = time.monotonic() + waits_s
        while True:
            try:
                self._claim_beside(real)
                return
            except BlockingIOError:
                if time.monotonic() >= end_s:
                    raise OSError(errno.EBUSY, "another process writes it") from None
                time.sleep(_PAUSE_S)

    def _claim_beside(self, real: Path) -> None:
        """Make the file for the new content.

        Raises:
            BlockingIOError: another process has made it.
        """
        beside = real.with_name(_name_beside(real.name))
        mode = self._mode if self._there is None else 0o600
        for _ in range(_TRIES):
            try:
                self._descriptor = os.open(beside, _FLAGS | os.O_CREAT | os.O_EXCL, mode)
            except FileExistsError:
                _remove_left_over(beside)
                continue
            except OSError as error:
                if error.errno not in _NO_PLACE or self._there is None:
                    raise
                self._claim_elsewhere(real)
                return
            if self._is_locked() and _is_same(_status(beside), os.fstat(self._descriptor)):
                self._beside = beside
                return
            os.close(self._descriptor)
            self._descriptor = -1
        raise BlockingIOError(errno.EBUSY, "another process writes it")

    def _is_locked(self) -> bool:
        """Lock the new file; return whether that was in time.

        Before it is locked another process may take it for one that was left over: then that one locks and removes it.
        """
        try:
            _lock(self._descriptor)
        except BlockingIOError:
            return False
        return True

    def _claim_elsewhere(self, real: Path) -> None:
        """Make a file without a name for content that will overwrite the old one: there is no place beside it."""
        from tempfile import TemporaryFile

        with TemporaryFile() as file:
            self._descriptor = os.dup(file.fileno())

    # ---------------------------------------------------------------- content

    @property
    def file(self) -> BinaryIO:
        """What the content is written to.

        Raises:
            WriteError: it cannot be opened.
        """
        if self._file is None:
            if self._descriptor < 0:
                try:
                    flags = os.O_WRONLY | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
                    self._descriptor = os.open(self.path, flags)
                except OSError as error:
                    raise WriteError(self.called, error) from error
            raw = _Raw(self._descriptor, self.called, may_lose_reader=stream_of(self.path) == 1)
            self._descriptor = -1
            self._file = cast("BinaryIO", io.BufferedWriter(raw, 1 << 16))
        return self._file

    @property
    def is_file(self) -> bool:
        """Whether it is an ordinary file, and not a pipe, a device or a stream of the shell."""
        return self._real is not None

    def finish(self, content: bytes | str | None = None) -> None:
        """Put the content in its place.

        Args:
            content: all of it; None if it has been written to `file`. Halves of surrogate pairs are escaped.

        Raises:
            WriteError: that cannot be; what was there is left.
        """
        try:
            if content is not None:
                self.file.write(content if isinstance(content, bytes) else content.encode("utf-8", "backslashreplace"))
            self.file.flush()
            if self._real is not None:
                self._put(self._real)
        except OSError as error:
            self.drop()
            if isinstance(error, WriteError):
                raise
            raise WriteError(self.called, error) from error
        except BaseException:
            self.drop()
            raise
        self._close()

    def drop(self) -> None:
        """Leave what was there."""
        self._leave_beside()
        self._close()

    def _leave_beside(self) -> None:
        """Remove the file with the new content."""
        beside, self._beside = self._beside, None
        if beside is None or not self._owns(beside):
            return
        if os.name != "posix":
            # Other systems do not remove a file that is open.
            self._close()
        with suppress(OSError):
            beside.unlink()

    def _owns(self, beside: Path) -> bool:
        """Return whether the name of the new content still is that of the file that is written."""
        descriptor = self._descriptor if self._file is None else self._file.fileno()
        return _is_same(_status(beside), os.fstat(descriptor))

    def __enter__(self) -> BinaryIO:
        return self.file

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.finish()
        else:
            self.drop()

    def _close(self) -> None:
        file, self._file = self._file, None
        descriptor, self._descriptor = self._descriptor, -1
        if file is not None:
            # What is in its buffer is written already, or not to be written.
            cast("Any", file).raw.is_dropped = True
            with suppress(OSError, RuntimeError):
                file.close()
        if descriptor >= 0:
            os.close(descriptor)

    # ---------------------------------------------------------------- what takes the place

    def _put(self, real: Path) -> None:
        """Let the new content take the place of the old one."""
        descriptor = self.file.fileno()
        if self._is_synced:
            os.fsync(descriptor)
        there = _status(real)
        if there is not None and self._is_new:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
        if there is not None and not stat.S_ISREG(there.st_mode):
            raise OSError(errno.EINVAL, f"it is {kind_of(there.st_mode)} now, not a file")
        if self._beside is not None and not self._owns(self._beside):
            raise OSError(errno.EBUSY, "another process writes it")
        old = there if there is not None else self._there
        can_move = self._beside is not None and (there is None or there.st_nlink == 1)
        if can_move and old is not None:
            can_move = _takes_after(descriptor, old, real if there is not None else None)
        if can_move:
            assert self._beside is not None
            try:
                self._move(self._beside, real)
                self._beside = None
                return
            except OSError as error:
                if there is None or error.errno not in _NO_MOVE:
                    raise
        if there is None:
            raise OSError(errno.ENOENT, "it was removed, and nothing can be made in its folder")
        _overwrite(real, descriptor)
        self._leave_beside()

    def _move(self, beside: Path, real: Path) -> None:
        if os.name != "posix":
            # Other systems do not move a file that is open.
            self._close()
        if self._is_new:
            _move_to_new(beside, real)
        else:
            beside.replace(real)
        if self._is_synced:
            sync(real.parent)


class _Raw(io.FileIO):
    """A file whose errors name it as the caller does."""

    def __init__(self, descriptor: int, called: str, *, may_lose_reader: bool) -> None:
        super().__init__(descriptor, "wb")
        self._called = called
        self._may_lose_reader = may_lose_reader
        """Whether the end of the reader is no error, as for all that goes to standard output."""
        self.is_dropped = False
        """Whether nothing more is written."""

    def write(self, data: Any) -> int:
        if self.is_dropped:
            return len(data)
        try:
            return super().write(data)
        except OSError as error:
            if self._may_lose_reader and isinstance(error, BrokenPipeError):
                self.is_dropped = True
                return len(data)
            raise WriteError(self._called, error) from None


# ---------------------------------------------------------------- whole contents


def write_file(path: str | os.PathLike[str], content: bytes | str, called: str = "", **settings: Any) -> None:
    """Write a file.

    Args:
        path: see `Output`; so are the others.
        content: all of it; a text becomes UTF-8, halves of surrogate pairs, which programs may hold, are escaped.
        called: see there.
        **settings: see there.

    Raises:
        WriteError: it cannot be written; what was there is left.
    """
    Output(path, called, **{"waits_s": 2.0, **settings}).finish(content)


def why_no_page(path: str | os.PathLike[str]) -> str:
    """Return why a page must not be written to a path, as `it is no page of elitescript`; empty if it may.

    Nothing, an empty file, a page of ours, pipes and devices may stand there.
    """
    there = _status(Path(path))
    if there is None or not stat.S_ISREG(there.st_mode) or not there.st_size or stream_of(os.fspath(path)) is not None:
        return ""
    with opened(path) as file:
        head = file.read(_HEAD_BYTES)
    is_ours = any(mark in head for mark in (MARK.encode(), *_OLD_PAGES))
    return "" if is_ours else "it is no page of elitescript, and would be lost"


def opened_new(path: str | os.PathLike[str]) -> int:
    """Return the descriptor of a new file, or of a device that is there, to which a recording or journal is appended.

    Raises:
        FileExistsError: there is one: of two processes that choose a name at the same moment one gets it.
        OSError: it cannot be made.
    """
    # Appending, so that what is written behind the cut of another process shows in the size.
    flags = os.O_WRONLY | os.O_APPEND | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
    there = _status(Path(path))
    is_device = there is not None and stat.S_ISCHR(there.st_mode)
    return os.open(path, flags | (0 if is_device else os.O_CREAT | os.O_EXCL), 0o666)


def sync(path: Path) -> None:
    """Bring a file, or the names in a folder, to the disk."""
    if os.name != "posix" and path.is_dir():
        return  # Other systems cannot, and need not.
    handle = os.open(path, os.O_RDONLY if os.name == "posix" else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


# ---------------------------------------------------------------- steps


def _status(path: Path) -> os.stat_result | None:
    try:
        return path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None


def _is_same(one: os.stat_result | None, other: os.stat_result) -> bool:
    return one is not None and (one.st_dev, one.st_ino) == (other.st_dev, other.st_ino)


def _name_beside(name: str) -> str:
    """Return the name of the file that is written for another; the system bounds the length of both."""
    if len(os.fsencode(name)) > _NAME_BYTES_MAX:
        from zlib import crc32

        name = f"{name[:48]}-{crc32(os.fsencode(name)):08x}"
    return f".{name}{BESIDE}"


def _move_to_new(beside: Path, real: Path) -> None:
    """Move a file to a name that no other file has, also if another process makes one at the same moment.

    Raises:
        FileExistsError: one has it.
    """
    try:
        os.link(beside, real)
    except FileExistsError:
        raise
    except OSError:
        # Some file systems have no links.
        beside.replace(real)
        return
    beside.unlink()


def _lock(descriptor: int) -> None:
    """Lock a file, if its file system has locks, which those of some clusters have not.

    Raises:
        BlockingIOError: another process has it.
    """
    try:
        lock(descriptor)
    except BlockingIOError:
        raise
    except OSError:
        return


def _remove_left_over(beside: Path) -> None:
    """Remove what a process that was killed has left.

    Raises:
        BlockingIOError: it is alive, and writes.
    """
    try:
        descriptor = os.open(beside, _FLAGS)
    except FileNotFoundError:
        return
    except OSError:
        # No file of this user, or none at all.
        beside.unlink(missing_ok=True)
        return
    try:
        _lock(descriptor)
        if os.name == "posix" and _is_same(_status(beside), os.fstat(descriptor)):
            beside.unlink(missing_ok=True)
    finally:
        os.close(descriptor)
    if os.name != "posix":
        # Other systems do not remove a file that is open, and that of a living process is.
        with suppress(OSError):
            beside.unlink(missing_ok=True)


def _takes_after(descriptor: int, old: os.stat_result, path: Path | None) -> bool:
    """Give a file owner, group, mode and attributes of another one; return whether it has them all.

    Args:
        descriptor: of the file.
        old: of the other one.
        path: of the other one; None if it is gone.
    """
    if os.name != "posix":
        return True
    try:
        mine = os.fstat(descriptor)
        if (mine.st_uid, mine.st_gid) != (old.st_uid, old.st_gid):
            os.fchown(descriptor, old.st_uid, old.st_gid)
        # Behind the owner, with whom some bits go.
        os.fchmod(descriptor, stat.S_IMODE(old.st_mode))
        if path is not None and hasattr(os, "listxattr"):
            _copy_attributes(path, descriptor)
    except OSError:
        return False
    mine = os.fstat(descriptor)
    return (mine.st_uid, mine.st_gid, mine.st_mode) == (old.st_uid, old.st_gid, old.st_mode)


def _copy_attributes(path: Path, descriptor: int) -> None:
    """Copy what a file has beside its content, such as an access list.

    Raises:
        OSError: something cannot be.
    """
    try:
        wanted = {name: os.getxattr(path, name) for name in os.listxattr(path)}
        there = {name: os.getxattr(descriptor, name) for name in os.listxattr(descriptor)}
    except OSError as error:
        if error.errno in (errno.ENOTSUP, errno.ENOSYS):
            return
        raise
    for name in there.keys() - wanted.keys():
        os.removexattr(descriptor, name)
    for name, value in wanted.items():
        if there.get(name) != value:
            os.setxattr(descriptor, name, value)


def _overwrite(path: Path, descriptor: int) -> None:
    """Overwrite a file with the content of another: first what needs new room, so that a full disk changes nothing.

    Raises:
        OSError: it cannot be; if there was no room, it is as it was.
    """
    size = os.fstat(descriptor).st_size
    flags = os.O_WRONLY | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
    target = os.open(path, flags)
    try:
        before = os.fstat(target)
        try:
            _copy(descriptor, target, before.st_size, size)
        except OSError:
            os.ftruncate(target, before.st_size)
            raise
        _copy(descriptor, target, 0, min(before.st_size, size))
        os.ftruncate(target, size)
        if os.name == "posix" and os.fstat(target).st_mode != before.st_mode:
            # To write into a file takes some bits from it.
            os.fchmod(target, stat.S_IMODE(before.st_mode))
    finally:
        os.close(target)


def _copy(source: int, target: int, begin: int, end: int) -> None:
    """Copy the bytes of a file from one offset to another."""
    os.lseek(source, begin, os.SEEK_SET)
    os.lseek(target, begin, os.SEEK_SET)
    while begin < end and (data := os.read(source, min(_BLOCK, end - begin))):
        view = memoryview(data)
        while view:
            view = view[os.write(target, view) :]
        begin += len(data)
