"""Defines the environment of programs: files of the task folder, TCP connections and serial lines.

An environment is local (this computer), in memory (tests) or remote (the scripts run in a child process); programs see
no difference. Names of files are virtual: scripts see the task folder as `/task/`; an environment gets a name relative
to that folder, with `/` between its parts and without `..`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from errno import EFBIG
from io import BufferedRandom, BufferedReader, BufferedWriter, RawIOBase, TextIOWrapper
from typing import IO, TYPE_CHECKING, Any, Final, NoReturn, Protocol, cast

from elitescript.errors import ArgumentTypeError, ScriptPermissionError
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.messages.inputs import ChannelEvent
    from elitescript.messages.line import LineSettings

TASK_PATH: Final = "/task/"
"""The task folder as scripts see it; ends in `/` because programs append names to it (*assumed*)."""
READ_AHEAD: Final = 8192
"""Bytes that Python reads at once."""


class Files(Protocol):
    """The task folder.

    Errors are `OSError` or `ScriptPermissionError`; their text and file name show names relative to the folder,
    never where the folder is.
    """

    def open(self, name: str, mode: str, encoding: str | None, newline: str | None) -> IO[Any]:
        """Open a file; flushed data is visible to all that have it open.

        Args:
            name: relative to the task folder.
            mode: as Python's `open`, checked already.
            encoding: of a text file; None for a binary one.
            newline: as Python's `open`.

        Raises:
            OSError: the file is missing, exists already, is a folder, ...
            ScriptPermissionError: the name leads out of the folder, through a link for instance.
        """

    def kind(self, name: str) -> str:
        """Return `file`, `folder`, or an empty text if the name does not exist."""

    def size(self, name: str) -> int:
        """Return the size of a file in bytes."""

    def names(self, name: str) -> list[str]:
        """Return the sorted names in a folder."""

    def remove(self, name: str) -> None:
        """Delete a file."""

    def make_folder(self, name: str) -> None:
        """Make a folder in an existing one."""


READ_MAX: Final = 24 << 20
"""Bytes that `read()` without a size takes, and that a program of a served robot reads in one tick (*assumed*)."""
_PIECE: Final = 1 << 18


class WholeReads(RawIOBase):
    """Reads the rest of a file in pieces, up to `READ_MAX`; base of the files of all environments."""

    def readall(self) -> bytes:
        """Read up to the end.

        Raises:
            OSError: that is too much.
        """
        pieces: list[bytes] = []
        size = 0
        while piece := self.read(_PIECE):
            pieces.append(piece)
            size += len(piece)
            if size > READ_MAX:
                text = said(
                    "read() of more than {read_max} bytes at once; read the file line by line or in pieces",
                    read_max=READ_MAX,
                )
                raise OSError(EFBIG, text)
        return b"".join(pieces)


def opened(
    raw: RawIOBase, mode: str, encoding: str | None, newline: str | None, *, read_ahead: int = READ_AHEAD
) -> IO[Any]:
    """Put Python's buffers over a file, so that files of all environments are buffered alike.

    Args:
        raw: the file.
        mode: see `Files.open`.
        encoding: see `Files.open`.
        newline: see `Files.open`.
        read_ahead: buffer size of a file for reading.
    """
    file: BufferedRandom | BufferedReader | BufferedWriter
    if "+" in mode:
        file = BufferedRandom(raw)
    elif "r" in mode:
        file = BufferedReader(raw, read_ahead)
    else:
        file = BufferedWriter(raw)
    if encoding is None:
        return cast("IO[bytes]", file)
    # Text is written through, so that a flush writes all of it.
    return TextIOWrapper(cast("IO[bytes]", file), encoding=encoding, newline=newline, write_through=True)


class Channels(Protocol):
    """Connections to TCP servers, and serial lines, by number.

    No method waits: the result of a request arrives as an event at a later tick. At most `CHANNEL_WINDOW` bytes are
    on their way in each direction; see `messages.outputs`.
    """

    @property
    def is_real(self) -> bool:
        """Whether one leads to a peer in wall-clock time."""

    def open(self, address: str, port: int, timeout_s: float) -> int:
        """Begin to connect; return the channel, or 0 without a network. Ends in `ChannelOpened`."""

    def open_line(self, device: str, settings: LineSettings) -> int:
        """Open a serial line; return the channel, or 0 if there are no lines. Ends in `ChannelOpened`.

        Args:
            device: `tool`, or the device of the control box, such as `/dev/ttymxc0`.
            settings: of the line.
        """

    def send(self, channel: int, data: bytes) -> None:
        """Send bytes; `ChannelCredit` arrives when they have left."""

    def credit(self, channel: int, size: int) -> None:
        """Let the peer send `size` more bytes: as many have been read."""

    def close(self, channel: int) -> None:
        """Close after all bytes have been sent; no event of that channel arrives any more."""

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        """Return the events that have arrived, before each tick that is run."""

    def pending(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        """Return a text for each channel with sent bytes, or a close, that have not arrived.

        Args:
            ignoring: open channels that do not count.
        """

    def give_up(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        """Drop pending bytes; return them as `pending`, with those lost on closed channels since the last call."""

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick at which an event may arrive."""


class ProgramEnvironment(Protocol):
    """Everything that a program can reach outside."""

    @property
    def files(self) -> Files:
        """The task folder."""

    @property
    def channels(self) -> Channels:
        """Connections to TCP servers, and serial lines."""


class FilesRefused:
    """Refuse every file: there is no task folder."""

    __slots__ = ()

    def kind(self, name: str) -> str:
        return "folder" if name == "" else ""

    def names(self, name: str) -> list[str]:
        return []

    def _refuse(self, name: str, *_details: object, **_options: object) -> NoReturn:
        raise ScriptPermissionError(said("cannot open {name!r}: this run has no task folder", name=name))

    open = size = remove = make_folder = _refuse


class NoChannels:
    """Open no channel: there is no network and no serial line."""

    __slots__ = ()

    is_real: Final = False

    def open(self, address: str, port: int, timeout_s: float) -> int:
        return 0

    def open_line(self, device: str, settings: LineSettings) -> int:
        return 0

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        return ()

    def pending(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        return ()

    give_up = pending

    def _ignore(self, *_: Any, **_options: Any) -> None:
        pass

    send = credit = close = next_tick = _ignore


class EmptyEnvironment:
    """An environment without files and connections."""

    __slots__ = ("channels", "files")

    def __init__(self) -> None:
        self.files: Files = FilesRefused()
        self.channels: Channels = NoChannels()


def relative_name(path: object) -> str:
    """Return the name in the task folder for a path of a script; empty for the folder itself.

    A relative path counts from the task folder (*assumed*). `//` and `.` are dropped, `..` goes up.

    Raises:
        ArgumentTypeError: not a str.
        ScriptPermissionError: the path leads out of the task folder.
    """
    if type(path) is not str:
        raise ArgumentTypeError(
            said("a path must be a str, not {name}", name=type(path).__name__), value=path, limit="a str"
        )
    if "\0" in path:
        raise ScriptPermissionError("a path cannot hold a null character", value=path)
    text = path.replace("\\", "/")
    root = TASK_PATH.rstrip("/")
    if text.startswith("/"):
        text = "/" + text.lstrip("/")
        if text != root and not text.startswith(TASK_PATH):
            raise _outside(path)
        text = text[len(root) :]
    elif len(text) > 1 and text[1] == ":":
        raise _outside(path)
    parts: list[str] = []
    for part in text.split("/"):
        if part == "..":
            if not parts:
                raise _outside(path)
            parts.pop()
        elif part not in ("", "."):
            parts.append(part)
    return "/".join(parts)


def _outside(path: str) -> ScriptPermissionError:
    return ScriptPermissionError(
        said(
            "cannot open {path!r}: programs reach only the files of the task folder, get_task_path() = {task_path!r}",
            path=path,
            task_path=TASK_PATH,
        ),
        value=path,
        limit=TASK_PATH,
    )


def without_addresses(text: str) -> str:
    """Return a text without the addresses of objects, which differ from run to run; see `runtime.addresses`."""
    if " at 0x" not in text:
        return text
    from elitescript.runtime import addresses

    return addresses.without_addresses(text)


def bytes_without_addresses(data: bytes) -> bytes:
    """Return an encoded text likewise."""
    return without_addresses(data.decode("latin-1")).encode("latin-1") if b" at 0x" in data else data
