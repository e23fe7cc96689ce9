"""The programs that pages may open and save: one file, or those in one folder, and nothing else of this computer."""

from __future__ import annotations

import os
import re
from collections import Counter
from hashlib import sha256
from itertools import chain, count, takewhile
from pathlib import Path
from typing import Final

from elitescript.conversation.messages import TEXT_MAX
from elitescript.environment.task_files import TASK, OpenedTask, opened_task
from elitescript.errors import ProgramError, UsageError
from elitescript.language.text.source import BOM, SourceFile
from elitescript.outputs.writing import write_file
from elitescript.paths import PROGRAM_SUFFIX, TASK_SUFFIX, is_program_name, is_task_name
from elitescript.records import NamedTuple
from elitescript.untrusted.files import PROGRAM, UnreadableError, read_bytes

FILE_BYTES_MAX: Final = TEXT_MAX
"""Largest program that is opened; a message of a page has room for its text."""

_OPENED: Final = PROGRAM._replace(bytes_max=FILE_BYTES_MAX)

PROGRAMS_MAX: Final = 1000
"""Programs of a folder that are listed."""

_LOOKED_AT_MAX: Final = 20_000
"""Entries of a folder that are looked at to find them: it may be somebody's whole home."""

_FIRST_MAX: Final = 20
"""Programs of a folder of which one must be readable for a page to begin with it."""

NEW_NAME: Final = f"program{PROGRAM_SUFFIX}"
"""Name of the new program that a folder without programs begins with."""

_LINE_END: Final = re.compile(r"\r\n|\r|\n")


class Found(NamedTuple):
    """A file as it is on disk.

    Attributes:
        text: with LF as line ends and without a byte order mark; empty if there is no file.
        digest: of its bytes, SHA-256 as hexadecimal; empty if there is no file.
        task: of a graphical program; `text` is its script, or the file as it is if it is no task.
    """

    text: str
    digest: str
    task: OpenedTask | None = None

    @property
    def paths(self) -> tuple[Path, ...]:
        """The files beside it that it is made of, too."""
        return () if self.task is None else self.task.paths


class Conflict(Exception):
    """A file has changed since it was read; nothing was written.

    Attributes:
        found: what is on disk.
    """

    def __init__(self, found: Found) -> None:
        super().__init__("the file has changed on disk since it was read")
        self.found = found


class Programs:
    """The file or the folder that the studio was started for.

    Args:
        path: of a program, which need not exist yet, or of a folder.

    Raises:
        UsageError: there can be no program at this path.
    """

    __slots__ = ("folder", "only")

    def __init__(self, path: Path) -> None:
        try:
            real = path.resolve()
            is_folder = real.is_dir()
        except (OSError, ValueError, RuntimeError) as error:
            raise UsageError(f"{path}: {error}") from None
        self.only: str | None = None if is_folder else real.name
        self.folder = real if is_folder else real.parent
        if not self.folder.is_dir():
            raise UsageError(f"{path}: there is no folder {self.folder}")

    @property
    def title(self) -> str:
        """Name of the file or of the folder."""
        return self.only or self.folder.name or str(self.folder)

    def names(self) -> list[str]:
        """Return the programs, relative to the folder with `/`, in alphabetical order; hidden folders are left out."""
        if self.only is not None:
            return [self.only]
        found: list[str] = []
        looked_at = 0
        for home, folders, files in os.walk(self.folder):
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            programs = [Path(home, name) for name in files if _can_be_opened(name) and not name.startswith(".")]
            found += [path.relative_to(self.folder).as_posix() for path in programs]
            looked_at += len(folders) + len(files)
            if len(found) >= PROGRAMS_MAX or looked_at >= _LOOKED_AT_MAX:
                break
        return sorted(found)[:PROGRAMS_MAX]

    def first_names(self) -> list[str]:
        """Return the programs that a page may begin with, the first choice first."""
        return [*self.names()[:_FIRST_MAX], *([] if self.only else [self._new_name()])]

    def _new_name(self) -> str:
        """Return the name of a program that the folder does not have."""
        numbered = (f"program_{number}{PROGRAM_SUFFIX}" for number in count(2))
        return next(name for name in chain((NEW_NAME,), numbered) if not (self.folder / name).exists())

    def path(self, name: str) -> Path:
        """Return the path of a program, without links.

        Args:
            name: relative to the folder.

        Raises:
            UsageError: it is none of the programs that may be opened.
        """
        if self.only is not None:
            if name != self.only:
                raise UsageError(
                    f"{name!r:.200}: only {self.only} is open; start the studio with its folder for others"
                )
            return self.folder / name
        given = Path(name)
        if given.is_absolute() or given.drive or not _can_be_opened(given.name):
            raise UsageError(f"{name!r:.200}: the relative path of a {PROGRAM_SUFFIX} or {TASK_SUFFIX} file is needed")
        try:
            found = (self.folder / given).resolve()
        except (OSError, ValueError, RuntimeError) as error:
            raise UsageError(f"{name!r:.200} is no path: {error}") from None
        if not found.is_relative_to(self.folder) or not _can_be_opened(found.name):
            raise UsageError(f"{name!r:.200} is outside {self.folder}: only programs in this folder can be opened")
        return found


def _can_be_opened(name: str) -> bool:
    return is_program_name(name) or is_task_name(name)


def stamp(path: Path) -> tuple[int, int, int] | None:
    """Return what differs after every change of a file, without reading it; None if there is none."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def read(path: Path) -> Found:
    """Return a program as it is on disk; `NONE` if there is no file.

    Raises:
        UsageError: it cannot be read, is no ordinary file, too large or not UTF-8.
    """
    data = _bytes(path)
    return NONE if data is None else Found(_text(path, data), digest_of(data))


def read_any(path: Path, task_dir: Path) -> Found:
    """Return a program or a graphical program as it is on disk; see `read`.

    Args:
        path: of it.
        task_dir: below which the configuration of a graphical program may be.
    """
    if not is_task_name(path.name):
        return read(path)
    try:
        data = read_bytes(path, TASK)
    except UnreadableError as error:
        if error.is_missing:
            return NONE
        raise
    task = opened_task(path, task_dir, data)
    text = task.source.text
    if task.program is None and len(text) > FILE_BYTES_MAX:
        (problem,) = task.errors
        raise UsageError(f"{path}:{problem.line}:{problem.column}: {problem.text}")
    if len(text) > FILE_BYTES_MAX:
        raise UsageError(f"{path}: its script has {len(text)} characters; the studio shows up to {FILE_BYTES_MAX}")
    return Found(text, digest_of(data + b"\0" + text.encode("utf-8", "surrogatepass")), task)


NONE: Final = Found("", "")


def digest_of(data: bytes) -> str:
    """Return the digest by which a page knows the contents of a file."""
    return sha256(data).hexdigest()


def save(path: Path, text: str, seen: str, *, force: bool = False) -> str:
    """Write a program as `outputs.writing` does; return the digest of the file.

    The file keeps its byte order mark, and its line ends: that of a line which has not changed, else
    the one that most lines have.

    Args:
        path: without links.
        text: of the editor, with any line ends.
        seen: digest of the file as the page knows it; empty if there was none.
        force: write although the file has changed since.

    Raises:
        Conflict: it has changed since.
        UsageError: it cannot be written; what is on disk stays as it was.
    """
    before = _bytes(path, must_fit=not force)
    data = _encoded(path, text, before)
    if data == before:
        return digest_of(data)
    if not force and ("" if before is None else digest_of(before)) != seen:
        raise Conflict(NONE if before is None else Found(_text(path, before), digest_of(before)))
    try:
        write_file(path, data, is_synced=True)
    except OSError as error:
        raise UsageError(f"cannot write {path}: {error.strerror or error}") from None
    return digest_of(data)


def _bytes(path: Path, *, must_fit: bool = True) -> bytes | None:
    """Return the contents of a file; None if there is none."""
    try:
        return read_bytes(path, _OPENED if must_fit else PROGRAM)
    except UnreadableError as error:
        if error.is_missing:
            return None
        raise


def _text(path: Path, data: bytes) -> str:
    try:
        return SourceFile.from_bytes(str(path), data).text
    except ProgramError as error:
        raise UsageError(f"cannot open {path}: {error.problems[0].text}; it stays as it is") from None


def _encoded(path: Path, text: str, before: bytes | None) -> bytes:
    """Return a text of the editor as bytes with the line ends of the file that it replaces."""
    rows = _LINE_END.split(text)
    ends = _LINE_END.findall(text)
    mark = ""
    if before is not None:
        # Bytes that are no UTF-8 have been refused, or are overwritten by force.
        old = before.decode("utf-8", "replace")
        mark = BOM if old.startswith(BOM) else ""
        old = old.removeprefix(BOM)
        ends = _line_ends(rows, _LINE_END.split(old), _LINE_END.findall(old))
    whole = mark + "".join(row + end for row, end in zip(rows, [*ends, ""], strict=True))
    try:
        return whole.encode()
    except UnicodeEncodeError as error:
        raise UsageError(f"cannot write {path}: U+{ord(whole[error.start]):04X} alone is half a character") from None


def _line_ends(rows: list[str], old_rows: list[str], old_ends: list[str]) -> list[str]:
    """Return the line ends of `rows`: those of the old lines before and behind what differs, in between the usual."""
    count = len(rows) - 1
    if not old_ends:
        return ["\n"] * count
    usual = Counter(old_ends).most_common(1)[0][0]
    if len(set(old_ends)) == 1:
        return [usual] * count
    room = min(count, len(old_ends))
    before = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(rows[:room], old_rows, strict=False)))
    pairs = zip(reversed(rows[before:]), reversed(old_rows[before:]), strict=False)
    # The last row has no line end.
    same = max(0, sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs)) - 1)
    behind = min(same, room - before)
    return old_ends[:before] + [usual] * (count - before - behind) + old_ends[len(old_ends) - behind :]
