"""File objects for scripts.

A script holds a `ScriptFile`, which hides the real file: that would lead to buffers, descriptors and paths. When the
last reference to it goes, the file is closed, as in CPython.
"""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from errno import EFBIG
from io import BytesIO, TextIOWrapper
from typing import IO, Any, Final, NoReturn
from weakref import ref

from elitescript.errors import ArgumentTypeError, InvalidValueError, NotSimulatedError, ScriptError
from elitescript.runtime.environment import (
    READ_MAX,
    Files,
    ProgramEnvironment,
    bytes_without_addresses,
    relative_name,
    without_addresses,
)
from elitescript.said import said
from elitescript.sealed import Sealed, hidden_slot, no_copy

OPEN_FILES_MAX: Final = 256
"""Files that one program may have open at a time (*assumed*; what a Linux controller allows by default is 1024)."""

_MODE_LETTERS: Final = frozenset("rwxabt+")

_PIECE: Final = 1 << 17
"""Characters or bytes that a call reads or writes before it looks again whether its tick is over."""
_LINES_PIECE: Final = 1000
"""Lines, likewise."""

_NAMES_SHOWN: Final = 3
"""Most file names in the hint for a missing file."""


class OpenFiles:
    """The files that one program has open.

    Args:
        world: has the task folder.
        note_call: called before each use of a file.
    """

    __slots__ = ("_files", "_note_call", "_world")

    def __init__(self, world: ProgramEnvironment, note_call: Callable[[], None] = lambda: None) -> None:
        self._world = world
        self._note_call = note_call
        self._files: list[ref[IO[Any]]] = []

    def open(
        self, path: Any, mode: Any = "r", encoding: Any = None, newline: Any = None, errors: Any = None
    ) -> ScriptFile:
        """Open a file for a script; the same bytes are written on every system.

        Text files are UTF-8 unless the script says otherwise, and a line feed is written as one unless `newline`
        says otherwise.

        Raises:
            OSError: as Python's `open`; `PermissionError` for what lies outside the task folder.
            LookupError: unknown encoding or error handler.
            ScriptError: invalid arguments.
        """
        name = relative_name(path)
        _check_mode(mode)
        is_binary = "b" in mode
        if not is_binary:
            encoding = "utf-8" if encoding is None or encoding == "locale" else encoding
            _check_text(encoding, newline, errors)
        elif any(option is not None for option in (encoding, newline, errors)):
            raise InvalidValueError("a binary file has neither encoding, errors nor newline")
        self._files = [known for known in self._files if (open_file := known()) is not None and not open_file.closed]
        if len(self._files) >= OPEN_FILES_MAX:
            raise OSError(24, f"more than {OPEN_FILES_MAX} files are open", name)
        file = self._world.files.open(name, mode if is_binary else mode.replace("t", "") + "b", None, None)
        if not is_binary:
            file = _text(file, mode, encoding, newline, errors)
        self._files.append(ref(file))
        line_is_cut = is_binary or newline in (None, "\n")
        return file_over(file, mode, name, self._note_call, line_is_cut=line_is_cut)

    def close(self) -> None:
        """Close the files that the program has left open.

        Raises:
            OSError: of the first file that could not be written; the others are closed all the same.
        """
        files, self._files = self._files, []
        errors = []
        for known in files:
            file = known()
            if file is not None and not file.closed:
                try:
                    file.close()
                except OSError as error:
                    errors.append(error)
        if errors:
            raise errors[0]


def _check_mode(mode: Any) -> None:
    if type(mode) is not str:
        raise ArgumentTypeError(
            said("the mode of open() must be a str, not {name}", name=type(mode).__name__), value=mode
        )
    letters = set(mode)
    if (
        not letters <= _MODE_LETTERS
        or len(letters) != len(mode)
        or len(letters & set("rwxa")) != 1
        or letters >= {"b", "t"}
    ):
        raise InvalidValueError(
            said("open() does not know the mode {mode!r}", mode=mode),
            value=mode,
            limit="one of r, w, x, a, with b, t or +",
        )


def _check_text(encoding: Any, newline: Any, errors: Any) -> None:
    """Check the options of a text file before it is opened, which may truncate it."""
    for option, value in (("encoding", encoding), ("newline", newline), ("errors", errors)):
        if value is not None and type(value) is not str:
            raise ArgumentTypeError(
                said("{option} must be a str or None, not {name}", option=option, name=type(value).__name__),
                value=value,
            )
    if newline not in (None, "", "\n", "\r", "\r\n"):
        raise InvalidValueError(
            said("open() does not know the newline {newline!r}", newline=newline),
            value=newline,
            limit=r"None, '', '\n', '\r' or '\r\n'",
        )
    TextIOWrapper(BytesIO(), encoding)
    codecs.lookup_error(errors or "strict")


class _ChangedText(TextIOWrapper):
    r"""Text of a file that is both read and written: reads any line end as `\n`, and writes `\n` as it is.

    To be made with `newline=""`. Python's own text files that read so write the line end of the system.
    """

    def read(self, size: int | None = -1, /) -> str:
        if size is None or size < 0:
            return _with_line_feeds(super().read())
        parts = []
        left = size
        while left > 0:
            text = self._completed(super().read(left))
            if not text:
                break
            parts.append(text)
            left -= len(text)
        return "".join(parts)

    def readline(self, size: int = -1, /) -> str:  # type: ignore[override]
        line = super().readline(size)
        return _with_line_feeds(line) if size < 0 else self._completed(line)

    def _completed(self, text: str) -> str:
        r"""Return the text with line feeds; a `\n` that follows a `\r` at its end is read too."""
        if text.endswith("\r"):
            place = self.tell()
            if super().read(1) != "\n":
                self.seek(place)
        return _with_line_feeds(text)


def _with_line_feeds(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _text(file: IO[bytes], mode: str, encoding: str, newline: str | None, errors: str | None) -> IO[str]:
    """Return the text layer of an open file; text is written through, so that a flush writes all of it."""
    kind: type[TextIOWrapper] = TextIOWrapper
    if newline is None and "+" in mode:
        kind, newline = _ChangedText, ""
    elif newline is None and "r" not in mode:
        newline = "\n"
    return kind(file, encoding=encoding, errors=errors, newline=newline, write_through=True)


class ScriptFile(metaclass=Sealed):
    """An open file of the task folder; the usual methods of Python's files."""

    __slots__ = ("_inner", "_line_is_cut", "_note_call", "mode", "name")
    __module__ = "io"
    __reduce_ex__ = no_copy

    def __init__(self, mode: str, name: str) -> None:
        self.mode = mode
        self.name = name

    def read(self, size: Any = -1) -> Any:
        """Read the rest, or up to `size` characters or bytes; at most `READ_MAX` bytes."""
        inner = _used(self)
        if size is None:
            size = -1
        if type(size) is int and not 0 <= size <= _PIECE:
            return _long_read(self, inner, size)
        return inner.read(size)

    def readline(self, size: Any = -1) -> Any:
        """Read one line with its line end; empty at the end of the file."""
        inner = _used(self)
        if size is None:
            size = -1
        if type(size) is int and not 0 <= size <= _PIECE and _line_is_cut_of(self):
            return _long_line(self, inner, size)
        return inner.readline(size)

    def readlines(self, hint: Any = -1) -> list[Any]:
        """Read all lines, of at most `READ_MAX` bytes."""
        inner = _used(self)
        if hint is None:
            hint = -1
        if type(hint) is not int:
            return inner.readlines(hint)
        lines: list[Any] = []
        size = 0
        while line := self.readline() if len(lines) % _LINES_PIECE == 0 else inner.readline():
            lines.append(line)
            size += len(line)
            if size > READ_MAX:
                raise OSError(EFBIG, _TOO_MUCH.format(call="readlines()"))
            if 0 < hint < size:
                break
        return lines

    def write(self, data: Any) -> int:
        """Write text, or bytes to a binary file; return how many."""
        inner = _used(self)
        if isinstance(data, str):
            data = without_addresses(data)
        elif isinstance(data, bytes):
            data = bytes_without_addresses(data)
        if type(data) in (str, bytes, bytearray) and len(data) > _PIECE:
            return _long_write(self, inner, data)
        return inner.write(data)

    def writelines(self, lines: Iterable[Any]) -> None:
        """Write one after the other, adding no line ends."""
        for line in lines:
            self.write(line)

    def seek(self, offset: Any, whence: Any = 0) -> int:
        """Go to a place in the file."""
        return _used(self).seek(offset, whence)

    def tell(self) -> int:
        """Return the place in the file."""
        return _file(self).tell()

    def truncate(self, size: Any = None) -> int:
        """Cut the file off."""
        return _used(self).truncate(size)

    def flush(self) -> None:
        """Write out what is buffered."""
        _used(self).flush()

    def close(self) -> None:
        """Close the file."""
        _used(self).close()

    def readable(self) -> bool:
        """Return whether it was opened for reading."""
        return _file(self).readable()

    def writable(self) -> bool:
        """Return whether it was opened for writing."""
        return _file(self).writable()

    def seekable(self) -> bool:
        """Return whether `seek` works."""
        return _file(self).seekable()

    def fileno(self) -> NoReturn:
        """Refuse: there is no descriptor."""
        raise NotSimulatedError("files of the task folder have no descriptor")

    def isatty(self) -> bool:
        """It is no terminal."""
        return False

    @property
    def closed(self) -> bool:
        """Whether it is closed."""
        return bool(_file(self).closed)

    @property
    def encoding(self) -> str | None:
        """Encoding of a text file; None for a binary one."""
        return getattr(_file(self), "encoding", None)

    def __enter__(self) -> ScriptFile:
        if self.closed:
            raise ValueError("I/O operation on closed file.")
        return self

    def __exit__(self, *details: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Any]:
        return self

    def __next__(self) -> Any:
        line = _used(self).readline()
        if not line:
            raise StopIteration
        return line

    def __del__(self) -> None:
        # No code could catch an error here; a program that has to know of one closes the file itself.
        with suppress(Exception):
            _file(self).close()

    def __repr__(self) -> str:
        return f"<file name={self.name!r} mode={self.mode!r}>"


_inner = hidden_slot(ScriptFile, "_inner")
_file: Callable[[ScriptFile], IO[Any]] = _inner.__get__
_note_call = hidden_slot(ScriptFile, "_note_call")
_note_call_of: Callable[[ScriptFile], Callable[[], None]] = _note_call.__get__
_line_is_cut = hidden_slot(ScriptFile, "_line_is_cut")
_line_is_cut_of: Callable[[ScriptFile], bool] = _line_is_cut.__get__

_TOO_MUCH: Final = f"{{call}} of more than {READ_MAX} bytes at once; read the file line by line or in pieces"


def _used(file: ScriptFile) -> IO[Any]:
    """Return the file behind it, for a call that may take long."""
    _note_call_of(file)()
    return _file(file)


def _long_read(file: ScriptFile, inner: IO[Any], size: int) -> Any:
    """Read up to `size`, or the rest if that is negative, in pieces between which the tick may end."""
    return _in_pieces(file, inner, size, inner.read, "read()", lambda piece: False)


def _long_line(file: ScriptFile, inner: IO[Any], size: int) -> Any:
    """Read a line of up to `size`, or a whole one if that is negative, likewise."""
    end = b"\n" if "b" in file.mode else "\n"
    return _in_pieces(
        file, inner, size, inner.readline, "readline()", lambda piece: len(piece) < _PIECE or piece.endswith(end)
    )


def _in_pieces(
    file: ScriptFile,
    inner: IO[Any],
    size: int,
    read: Callable[[int], Any],
    call: str,
    is_last: Callable[[Any], bool],
) -> Any:
    """Read by `read` until `size` is there, nothing comes or `is_last` is true of a piece.

    Raises:
        OSError: more than `READ_MAX` bytes; `call` names what the program has called.
    """
    pieces: list[Any] = []
    left = size if size >= 0 else READ_MAX + 1
    taken = 0
    while left and (piece := read(min(left, _PIECE))):
        pieces.append(piece)
        taken += _bytes_in(piece)
        left -= len(piece)
        if taken > READ_MAX:
            raise OSError(EFBIG, _TOO_MUCH.format(call=call))
        if is_last(piece):
            break
        _note_call_of(file)()
    return pieces[0][:0].join(pieces) if pieces else inner.read(0)


def _bytes_in(piece: str | bytes) -> int:
    """Return how many bytes that is, as UTF-8."""
    return len(piece) if isinstance(piece, bytes) or piece.isascii() else len(piece.encode("utf-8", "surrogatepass"))


def _long_write(file: ScriptFile, inner: IO[Any], data: Any) -> int:
    """Write in pieces between which the tick may end; nothing of a text that cannot be encoded."""
    places = range(0, len(data), _PIECE)
    if isinstance(data, str) and "b" not in file.mode and not data.isascii():
        text: Any = inner
        for at in places:
            data[at : at + _PIECE].encode(text.encoding, text.errors)
            _note_call_of(file)()
    written = 0
    for at in places:
        written += inner.write(data[at : at + _PIECE])
        _note_call_of(file)()
    return written


def file_over(
    inner: IO[Any], mode: str, name: str, note_call: Callable[[], None] = lambda: None, *, line_is_cut: bool = True
) -> ScriptFile:
    """Return what a script holds of an open file.

    Args:
        inner: the file.
        mode: as the script wrote it.
        name: likewise.
        note_call: called before each use of the file, and between the pieces of a long one.
        line_is_cut: whether a long line may be read in pieces: not where a `\\r` may end it.
    """
    file = ScriptFile(mode, name)
    _inner.__set__(file, inner)
    _note_call.__set__(file, note_call)
    _line_is_cut.__set__(file, line_is_cut)
    return file


class ScriptStream(metaclass=Sealed):
    """`sys.stdout` for scripts: what is written there is printed."""

    __slots__ = ("_write", "name")
    __module__ = "io"
    __reduce_ex__ = no_copy

    def __init__(self, name: str, write: Callable[[str], None]) -> None:
        self.name = name
        _write.__set__(self, write)

    def write(self, text: Any) -> int:
        """Print a text."""
        if not isinstance(text, str):
            raise ArgumentTypeError(
                said("write() argument must be str, not {name}", name=type(text).__name__), value=text
            )
        _write.__get__(self)(str(text))
        return len(text)

    def flush(self) -> None:
        """Nothing is buffered here."""

    def isatty(self) -> bool:
        """It is no terminal."""
        return False

    def __repr__(self) -> str:
        return f"<stream {self.name!r}>"


_write = hidden_slot(ScriptStream, "_write")


def content_of(files: Files, path: str, size_max: int) -> bytes:
    """Read a whole file of the task folder.

    Args:
        files: the task folder.
        path: of the file, as scripts write it.
        size_max: the largest size, in bytes.

    Raises:
        InvalidValueError: there is no such file, it cannot be read or has more bytes than that.
        ScriptPermissionError: the path leads out of the task folder.
    """
    name = relative_name(path)
    try:
        kind = files.kind(name)
        if kind != "file":
            what = "is a folder" if kind else "does not exist"
            near = [other for other in files.names("") if other.startswith(name.rpartition(".")[0] or name)]
            hint = (
                said("the task folder holds {near}", near=", ".join(near[:_NAMES_SHOWN])) if near and not kind else None
            )
            raise InvalidValueError(
                said("the file {name!r} {what}", name=name, what=what), argument="file_name", value=path, hint=hint
            )
        size = files.size(name)
        if size <= size_max:
            with files.open(name, "rb", None, None) as file:
                return bytes(file.read(size_max))
    except OSError as error:
        if isinstance(error, ScriptError):
            raise
        text = said("the file {name!r} cannot be read: {strerror}", name=name, strerror=error.strerror or error)
        raise InvalidValueError(text, argument="file_name", value=path) from None
    raise InvalidValueError(
        said(
            "the file {name!r} has {size} bytes; at most {size_max} are allowed",
            name=name,
            size=size,
            size_max=size_max,
        ),
        argument="file_name",
        value=size,
        limit=f"<= {size_max}",
        unit="bytes",
    )
