"""Reads files that others wrote: what stands at a path is looked at first, and no more is read than a limit.

Every file whose content is read at once is read here, so that a pipe, a device, a file without an end or one that grows
while it is read gives one sentence and never a process that waits or fills the memory.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator
from typing import BinaryIO, Final

from elitescript.errors import UsageError
from elitescript.paths import STREAMS, kind_of, why_no_file
from elitescript.records import NamedTuple
from elitescript.untrusted.plain_text import EncodingError, plain_text

_OPEN_FLAGS: Final = (
    os.O_RDONLY | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0)
)
"""Without blocking: a pipe that has taken the place of a file since it was looked at is refused, not waited for."""

_PIECE: Final = 1 << 20


class Kind(NamedTuple):
    """Files of one kind.

    Attributes:
        noun: in messages, as `world file`.
        bytes_max: that are read of one.
    """

    noun: str
    bytes_max: int


PROGRAM: Final = Kind("program", 16_000_000)
WORLD: Final = Kind("world file", 4_000_000)
ARM: Final = Kind("arm file", 1_000_000)
CASE: Final = Kind("case", 4_000_000)
BASELINE: Final = Kind("baseline", 16_000_000)
PROJECT: Final = Kind("project file", 1_000_000)
PROFILE: Final = Kind("profile", 1_000_000)
PYTHON: Final = Kind("Python file", 10_000_000)
POINTS: Final = Kind("file of points", 50_000_000)
TRACE: Final = Kind("trace", 500_000_000)
MESH: Final = Kind("mesh", 32 << 20)
TASK_FILE: Final = Kind("file of the task folder", 16_000_000)
ADDRESS: Final = Kind("address file", 10_000)
PASSWORD: Final = Kind("password file", 2_000)


class UnreadableError(UsageError):
    """A file cannot be read.

    Args:
        text: the message, with the path.
        why: without the path, as `it is a named pipe, not a file`.
        is_missing: whether there is no such file.
    """

    def __init__(self, text: str, why: str, *, is_missing: bool = False) -> None:
        super().__init__(text)
        self.why = why
        self.is_missing = is_missing


def opened(path: str | os.PathLike[str], *, is_stream_allowed: bool = False) -> BinaryIO:
    """Return a file, opened to be read in pieces.

    Args:
        path: of an ordinary file; links are followed.
        is_stream_allowed: accept standard input and other streams of the shell.

    Raises:
        UnreadableError: there is none, it may not be read, or something else stands there.
    """
    name = os.fspath(path)
    is_stream = is_stream_allowed and name.startswith(STREAMS)
    # Before it is opened: opening alone has effects on some devices.
    if why := why_no_file(name, is_stream_allowed=is_stream_allowed):
        raise _unreadable(name, f"it {why}")
    try:
        handle = os.open(name, os.O_RDONLY if is_stream else _OPEN_FLAGS)
    except FileNotFoundError as error:
        raise _unreadable(name, error.strerror or str(error), is_missing=True) from None
    except OSError as error:
        raise _unreadable(name, error.strerror or str(error)) from None
    except ValueError as error:  # a NUL in the name
        raise _unreadable(name, str(error)) from None
    file = open(handle, "rb")  # noqa: PTH123, SIM115
    mode = os.fstat(handle).st_mode
    if not is_stream and not stat.S_ISREG(mode):
        file.close()
        raise _unreadable(name, f"it is {kind_of(mode)}, not a file")
    return file


def read_bytes(path: str | os.PathLike[str], kind: Kind, *, is_stream_allowed: bool = False) -> bytes:
    """Return the content of a file.

    Args:
        path: of an ordinary file; links are followed.
        kind: what it is, and how much of it is read.
        is_stream_allowed: accept standard input and other streams of the shell.

    Raises:
        UnreadableError: there is none, it may not be read, something else stands there, or it is larger than its kind.
    """
    name = os.fspath(path)
    with opened(name, is_stream_allowed=is_stream_allowed) as file:
        try:
            size = os.fstat(file.fileno()).st_size
            if size > kind.bytes_max:
                raise _unreadable(name, too_large(kind, size))
            return _up_to(file, name, kind)
        except OSError as error:
            raise _unreadable(name, error.strerror or str(error)) from None


def read_text(path: str | os.PathLike[str], kind: Kind, *, is_stream_allowed: bool = False) -> str:
    """Return the content of a file as text, without a byte order mark.

    Args:
        path: see `read_bytes`; so are the next two.
        kind: see there.
        is_stream_allowed: see there.

    Raises:
        UnreadableError: see there; or it is not UTF-8, and the text names the line.
    """
    return text_of(read_bytes(path, kind, is_stream_allowed=is_stream_allowed), os.fspath(path), kind.noun)


def read_standard_input(kind: Kind) -> bytes:
    """Return all that comes in on standard input.

    Raises:
        UnreadableError: more than its kind has.
    """
    return _up_to(sys.stdin.buffer, "<stdin>", kind)


def text_of(data: bytes, name: str, noun: str) -> str:
    """Return the text of the content of a file, without a byte order mark.

    Args:
        data: the content.
        name: of the file, for messages.
        noun: what it is, for messages.

    Raises:
        UnreadableError: it is not UTF-8; the text names the line.
    """
    try:
        return plain_text(data)
    except EncodingError as error:
        why = f"it is not UTF-8: {error.why}"
        raise UnreadableError(f"{name}:{error.line}: the {noun} is not UTF-8: {error.why}", why) from None


def lines_of(file: BinaryIO, name: str, bytes_max: int) -> Iterator[bytes]:
    """Yield the lines of a file with their ends, the last one perhaps without.

    Args:
        file: read from where it stands.
        name: of the file, for messages.
        bytes_max: of a line.

    Raises:
        UnreadableError: a line is longer.
    """
    number = 0
    while line := file.readline(bytes_max + 1):
        number += 1
        if len(line) > bytes_max:
            raise _unreadable(name, f"line {number} has more than {bytes_max} bytes, which is the limit")
        yield line


def too_large(kind: Kind, size: int | None = None) -> str:
    """Return why a file is not read: its size and the limit.

    Args:
        kind: of the file.
        size: in bytes; None if it was not read to its end.
    """
    found = "more" if size is None else f"{size} bytes"
    return f"it has {found}; at most {kind.bytes_max} bytes are read ({kind.noun})"


def _up_to(file: BinaryIO, name: str, kind: Kind) -> bytes:
    """Return what a file holds; in pieces, since a read of a size takes the memory for it first."""
    pieces: list[bytes] = []
    left = kind.bytes_max + 1
    while left and (piece := file.read(min(_PIECE, left))):
        pieces.append(piece)
        left -= len(piece)
    if not left:
        raise _unreadable(name, too_large(kind))
    return b"".join(pieces)


def _unreadable(name: str, why: str, *, is_missing: bool = False) -> UnreadableError:
    return UnreadableError(f"cannot read {name}: {why}", why, is_missing=is_missing)
