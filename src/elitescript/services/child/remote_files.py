"""The task folder of a robot whose process opens no files: questions to the process that does.

A question is `[verb, argument, ...]`, its answer `["ok", value]` or `["error", kind, number, text, name]`. Files are
read and written in pieces, where the script's own file object asks for them, so that what is seen, and when, is the
same as with files of one's own. No question is trusted.
"""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Callable
from contextlib import suppress
from errno import EFBIG
from io import BufferedRandom, BufferedReader, BufferedWriter
from typing import IO, Any, Final

from elitescript.codec.values import CodecError, is_large
from elitescript.errors import ScriptPermissionError
from elitescript.runtime.environment import READ_MAX, Files, WholeReads, opened

OPEN_MAX: Final = 300
PIECE_MAX: Final = 1 << 18
"""Bytes that are read or written at once."""
FILE_MAX: Final = 1 << 28
"""Bytes of a file that scripts write to."""
NAME_MAX: Final = 4096

Question = list[Any]
Answer = list[Any]
Ask = Callable[[Question], Answer]


class FileDesk:
    """Answers questions with the files of a world.

    Args:
        files: the task folder.
    """

    __slots__ = ("_files", "_next", "_open", "_read_left")

    def __init__(self, files: Files) -> None:
        self._files = files
        self._open: dict[int, IO[Any]] = {}
        self._next = 1
        self._read_left = READ_MAX

    def new_tick(self) -> None:
        """Let as much be read as one tick may read: a journal keeps the answers of a tick in one line."""
        self._read_left = READ_MAX

    def answer(self, question: Any) -> Answer:
        """Return the answer to a question.

        Raises:
            CodecError: that is no question.
        """
        if type(question) is not list or not question or type(question[0]) is not str or question[0] not in _VERBS:
            raise CodecError("a question about files is expected")
        kinds, act = _VERBS[question[0]]
        arguments = question[1:]
        if [type(argument) for argument in arguments] != list(kinds):
            raise CodecError(f"{question[0]}: wrong arguments")
        if any(len(argument) > 2 * PIECE_MAX for argument in arguments if type(argument) is str):
            raise CodecError(f"{question[0]}: an argument is too long")
        if any(map(is_large, arguments)):
            raise CodecError(f"{question[0]}: a number is too large")
        try:
            return ["ok", act(self, *arguments)]
        except ScriptPermissionError as error:
            return ["error", "permission", 0, str(error), ""]
        except OSError as error:
            name = error.filename if isinstance(error.filename, str) else ""
            return ["error", "os", error.errno or 0, error.strerror or str(error), name]
        except ValueError as error:
            return ["error", "os", 22, str(error), ""]

    def close(self) -> None:
        """Close what is open: the process that asked is gone."""
        for file in self._open.values():
            with suppress(OSError):
                file.close()
        self._open.clear()

    # ---------------------------------------------------------------- verbs

    def _open_file(self, name: str, mode: str) -> int:
        if len(self._open) >= OPEN_MAX:
            raise OSError(24, "Too many open files", name)
        if not set(mode) <= set("rwxab+") or len(mode) > 3 or "b" not in mode:
            raise CodecError(f"no mode of a file: {mode[:10]!r}")
        file: Any = self._files.open(name[:NAME_MAX], mode, None, None)
        # The asking side has a buffer; one more here would hide what other handles write.
        is_buffered = isinstance(file, BufferedRandom | BufferedReader | BufferedWriter)
        self._open[self._next] = file.detach() if is_buffered else file
        self._next += 1
        return self._next - 1

    def _file(self, handle: int) -> IO[Any]:
        file = self._open.get(handle)
        if file is None:
            raise OSError(9, "Bad file descriptor")
        return file

    def _read(self, handle: int, position: int, count: int) -> str:
        file = self._file(handle)
        if self._read_left < 0:
            text = f"more than {READ_MAX} bytes of files in one control period; put a sync() or sleep() into the loop"
            raise OSError(EFBIG, text)
        file.seek(position)
        data = file.read(min(max(count, 0), PIECE_MAX))
        self._read_left -= len(data)
        return b64encode(data).decode()

    def _write(self, handle: int, position: int, text: str) -> list[int]:
        data = b64decode(text, validate=True)
        if not 0 <= position <= FILE_MAX - len(data):
            raise OSError(27, f"files of a program may have {FILE_MAX} bytes")
        file = self._file(handle)
        file.seek(position)
        written = file.write(data)
        file.flush()
        return [written, file.tell()]

    def _truncate(self, handle: int, size: int) -> int:
        if not 0 <= size <= FILE_MAX:
            raise OSError(27, f"files of a program may have {FILE_MAX} bytes")
        file = self._file(handle)
        file.truncate(size)
        file.flush()
        return size

    def _end(self, handle: int) -> int:
        return self._file(handle).seek(0, 2)

    def _close_file(self, handle: int) -> None:
        self._file(handle).close()
        del self._open[handle]

    def _kind(self, name: str) -> str:
        return self._files.kind(name[:NAME_MAX])

    def _size(self, name: str) -> int:
        return self._files.size(name[:NAME_MAX])

    def _names(self, name: str) -> list[str]:
        return self._files.names(name[:NAME_MAX])

    def _remove(self, name: str) -> None:
        self._files.remove(name[:NAME_MAX])

    def _make_folder(self, name: str) -> None:
        self._files.make_folder(name[:NAME_MAX])


_VERBS: Final[dict[Any, tuple[tuple[type, ...], Callable[..., Any]]]] = {
    "open": ((str, str), FileDesk._open_file),
    "read": ((int, int, int), FileDesk._read),
    "write": ((int, int, str), FileDesk._write),
    "truncate": ((int, int), FileDesk._truncate),
    "end": ((int,), FileDesk._end),
    "close": ((int,), FileDesk._close_file),
    "kind": ((str,), FileDesk._kind),
    "size": ((str,), FileDesk._size),
    "names": ((str,), FileDesk._names),
    "remove": ((str,), FileDesk._remove),
    "make_folder": ((str,), FileDesk._make_folder),
}


class RemoteFiles:
    """The task folder as the robot's process sees it; see `runtime.environment.Files`.

    Args:
        ask: gets a question answered.
    """

    __slots__ = ("_ask",)

    def __init__(self, ask: Ask) -> None:
        self._ask = ask

    def open(self, name: str, mode: str, encoding: str | None, newline: str | None) -> IO[Any]:
        letters = mode.replace("t", "").replace("b", "") + "b"
        raw = _RemoteFile(self._ask, _value(self._ask(["open", name, letters])), mode)
        return opened(raw, mode, None if "b" in mode else encoding, newline, read_ahead=PIECE_MAX)

    def kind(self, name: str) -> str:
        return str(_value(self._ask(["kind", name])))

    def size(self, name: str) -> int:
        return int(_value(self._ask(["size", name])))

    def names(self, name: str) -> list[str]:
        return list(_value(self._ask(["names", name])))

    def remove(self, name: str) -> None:
        _value(self._ask(["remove", name]))

    def make_folder(self, name: str) -> None:
        _value(self._ask(["make_folder", name]))


def _value(answer: Answer) -> Any:
    if answer[0] == "ok":
        return answer[1]
    _, kind, number, text, name = answer
    if kind == "permission":
        raise ScriptPermissionError(text)
    if name:
        raise OSError(number, text, name)
    raise OSError(number, text) if number else OSError(text)


class _RemoteFile(WholeReads):
    """An open file; knows its own position."""

    def __init__(self, ask: Ask, handle: int, mode: str) -> None:
        super().__init__()
        self._ask = ask
        self._handle = handle
        self._can_read = "r" in mode or "+" in mode
        self._can_write = mode.strip("bt") != "r"
        self._position = int(_value(ask(["end", handle]))) if "a" in mode else 0

    def readable(self) -> bool:
        return self._can_read

    def writable(self) -> bool:
        return self._can_write

    def seekable(self) -> bool:
        return True

    def readinto(self, buffer: Any, /) -> int:
        with memoryview(buffer).cast("B") as view:
            data = b64decode(_value(self._ask(["read", self._handle, self._position, min(len(view), PIECE_MAX)])))
            view[: len(data)] = data
        self._position += len(data)
        return len(data)

    def write(self, data: Any, /) -> int:
        with memoryview(data).cast("B") as view:
            piece = bytes(view[:PIECE_MAX])
        question = ["write", self._handle, self._position, b64encode(piece).decode()]
        written, self._position = _value(self._ask(question))
        return int(written)

    def seek(self, offset: int, whence: int = 0, /) -> int:
        start = (0, self._position, 0)[whence] if whence != 2 else int(_value(self._ask(["end", self._handle])))
        if start + offset < 0:
            raise OSError(22, "Invalid argument")
        self._position = start + offset
        return self._position

    def tell(self) -> int:
        return self._position

    def truncate(self, size: int | None = None, /) -> int:
        return int(_value(self._ask(["truncate", self._handle, self._position if size is None else size])))

    def close(self) -> None:
        if not self.closed:
            super().close()
            _value(self._ask(["close", self._handle]))
