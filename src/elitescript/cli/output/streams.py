"""Standard output and standard error of this process: closed, without a reader, or on a disk that is full.

A reader that closes (`| head`) does not change the verdict of a command that ends, and ends one that may go on for
ever; the streams behave by the kind of the command.
"""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress
from io import BufferedWriter, FileIO, TextIOWrapper

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Final, Literal

    from _typeshed import ReadableBuffer

    WithoutReader = Literal["goes on", "ends", "stops"]

GOES_ON: Final = "goes on"
"""The command does the rest of its work without output, and gives its exit code."""
ENDS: Final = "ends"
"""It is left by `Stopped`, and ends as by SIGPIPE."""
STOPS: Final = "stops"
"""The same, but while it handles SIGTERM: it gets one, closes what it has open, and ends as by SIGPIPE."""

WITHOUT_READER: Final[dict[str, WithoutReader]] = {
    "run": ENDS,
    "sweep": ENDS,
    "serve": STOPS,
    "devices": STOPS,
    "record": STOPS,
    "shadow": STOPS,
    "studio": STOPS,
}
"""What commands that may go on for ever do when nobody reads their output any more; all others go on to their end."""

ENDED_WITH_READER: Final = 128 + 13
"""Exit code of a process that SIGPIPE has ended, as shells count it."""

OUTPUT: Final = "standard output"
ERROR: Final = "standard error"
_NAMES: Final = {1: OUTPUT, 2: ERROR}

_GONE: Final = frozenset(
    (errno.EPIPE, errno.ECONNRESET, errno.ESHUTDOWN, *((errno.EINVAL,) if os.name == "nt" else ()))
)
"""Errors of a stream without a reader; Windows has the last one."""


class StandardStream(FileIO):
    """Writes the bytes of a standard stream.

    After a failure, what is written is dropped: it would fail again, also when Python ends.

    Args:
        descriptor: 1 or 2.
        without_reader: what the command does when the reader has gone.

    Attributes:
        failure: why something is not written that is to be read, with the name of the stream; None if all is well.
        has_no_reader: whether the reader has gone.
    """

    def __init__(self, descriptor: int, without_reader: WithoutReader) -> None:
        super().__init__(descriptor, "w", closefd=False)
        self.failure: OSError | None = None
        self.has_no_reader = False
        self._is_dropping = False
        self._without_reader = without_reader

    def write(self, data: ReadableBuffer, /) -> int:
        """Write all bytes.

        Raises:
            OSError: standard output has failed; it is the file name.
            Stopped: the reader has gone, and the command ends with it.
        """
        left = memoryview(data).cast("B")
        size = left.nbytes
        try:
            while left and not self._is_dropping:
                written = super().write(left)
                if written is None:
                    _wait_for_room(self)
                else:
                    left = left[written:]
        except OSError as error:
            self._is_dropping = True
            self._failed(error)
        return size

    def _failed(self, error: OSError) -> None:
        if error.errno in _GONE:
            self.has_no_reader = True
            self._lose_reader()
        elif error.errno != errno.EIO or not _is_device(self):
            # Else the terminal has gone, and the process was to outlive it (`nohup`, `disown`).
            self.failure = OSError(error.errno, error.strerror, _NAMES[self.fileno()])
            if self.fileno() == 1:
                # What a command does is worth more than what it says of it on standard error.
                raise self.failure from None

    def _lose_reader(self) -> None:
        if self._without_reader == GOES_ON:
            return
        import signal

        from elitescript.environment.stop_signals import SIGPIPE, Stopped

        if self._without_reader == ENDS or not callable(signal.getsignal(signal.SIGTERM)):
            raise Stopped(SIGPIPE)
        signal.raise_signal(signal.SIGTERM)


def open_streams(command: str) -> None:
    """Put a `StandardStream` below `sys.stdout` and `sys.stderr`; consoles of Windows stay as they are."""
    without_reader = WITHOUT_READER.get(command, GOES_ON)
    for name, descriptor in (("stdout", 1), ("stderr", 2)):
        old = getattr(sys, name)
        buffer = getattr(old, "buffer", None)
        if type(getattr(buffer, "raw", buffer)) is not FileIO or old.fileno() != descriptor:
            continue
        old.flush()
        raw = StandardStream(descriptor, without_reader)
        new = TextIOWrapper(
            # With `python -u` there is no buffer.
            raw if buffer is not None and type(buffer) is FileIO else BufferedWriter(raw),
            encoding=old.encoding,
            errors=old.errors,
            line_buffering=old.line_buffering,
            write_through=old.write_through,
        )
        setattr(sys, name, new)


def open_closed_streams() -> None:
    """Open the null device in the place of standard streams that the caller has closed (`>&-`).

    The next file that is opened would get their number, and what is printed would go there.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is not None:
            continue
        null = os.open(os.devnull, os.O_RDWR)
        if null != number and not _is_open(number):
            os.dup2(null, number)
            os.close(null)
            null = number
        os.set_inheritable(null, True)
        setattr(sys, name, os.fdopen(null, "w" if number else "r", closefd=False))


def failure_of_streams() -> OSError | None:
    """Return the first failure of the two streams, after all has been written; None if there was none."""
    for stream in (sys.stdout, sys.stderr):
        raw = _raw_of(stream)
        if raw is not None:
            # A failure is kept; a reader that has gone is asked about.
            with suppress(OSError, KeyboardInterrupt):
                stream.flush()
            if raw.failure is not None:
                return raw.failure
    return None


def is_ended_with_reader(command: str) -> bool:
    """Return whether the reader of one of the streams has gone, which ends the command as by SIGPIPE."""
    if WITHOUT_READER.get(command, GOES_ON) == GOES_ON:
        return False
    return any(raw is not None and raw.has_no_reader for raw in map(_raw_of, (sys.stdout, sys.stderr)))


def _raw_of(stream: object) -> StandardStream | None:
    buffer = getattr(stream, "buffer", None)
    raw = getattr(buffer, "raw", buffer)
    return raw if isinstance(raw, StandardStream) else None


def _wait_for_room(stream: FileIO) -> None:
    """Wait until a pipe takes bytes that another process, which shares it, has made one that does not block."""
    import select

    select.select([], [stream], [])


def _is_device(stream: FileIO) -> bool:
    import stat

    return stat.S_ISCHR(os.fstat(stream.fileno()).st_mode)


def _is_open(descriptor: int) -> bool:
    try:
        os.fstat(descriptor)
    except OSError:
        return False
    return True
