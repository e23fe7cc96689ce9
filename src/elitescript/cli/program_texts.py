"""Programs that a command line names: files, folders, standard input; and writing them anew."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.paths import PROGRAM_SUFFIX, is_program_name, is_task_name
from elitescript.records import NamedTuple
from elitescript.shown import shown, shown_word
from elitescript.untrusted.files import PROGRAM, UnreadableError, read_bytes, read_standard_input

STANDARD_INPUT: Final = "-"


class ProgramText(NamedTuple):
    """A text that a command line names.

    Attributes:
        name: in reports.
        path: the file; None for standard input.
        data: its bytes; None if it cannot be read.
        why_not: why it cannot be read.
        is_named: whether it is on the command line itself.
    """

    name: str
    path: Path | None
    data: bytes | None
    why_not: str
    is_named: bool


def program_texts(names: Iterable[str], command: str) -> Iterator[ProgramText]:
    """Yield the texts of a command line, each once, and those of its folders, by name.

    Args:
        names: files, folders, `-`.
        command: that reads them, for messages about folders that cannot be read.
    """

    def refuse(error: OSError) -> None:
        name, why = shown_word(str(error.filename)), error.strerror or shown(str(error))
        print(f"elitescript {command}: {name}: {why}; it is left out", file=sys.stderr)

    seen: set[str] = set()
    for name in names:
        if name == STANDARD_INPUT:
            try:
                yield ProgramText("<stdin>", None, read_standard_input(PROGRAM), "", True)
            except UnreadableError as error:
                yield ProgramText("<stdin>", None, None, str(error), True)
            continue
        path = Path(name)
        if not path.is_dir():
            yield from _read(path, seen, is_named=True)
            continue
        found = False
        for program in program_paths(path, command, refuse):
            found = True
            yield from _read(program, seen, is_named=False)
        if not found:
            yield ProgramText(name, path, None, f"no *{PROGRAM_SUFFIX} file in this folder", True)


def program_paths(folder: Path, command: str, on_error: Callable[[OSError], None] | None = None) -> Iterator[Path]:
    """Yield what a command reads in a folder and in those within it, by name.

    Args:
        folder: of the command line.
        command: `check` reads task files too.
        on_error: gets a folder that cannot be read.
    """
    for home, folders, files in os.walk(folder, onerror=on_error):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for file in sorted(files):
            if is_program_name(file) or (command == "check" and is_task_name(file)):
                yield Path(home, file)


def _read(path: Path, seen: set[str], *, is_named: bool) -> Iterator[ProgramText]:
    real = os.path.realpath(path)
    if real in seen:
        return
    seen.add(real)
    try:
        data = read_bytes(path, PROGRAM, is_stream_allowed=True)
    except UnreadableError as error:
        yield ProgramText(str(path), path, None, str(error), is_named)
    else:
        yield ProgramText(str(path), path, data, "", is_named)


def write_out(data: bytes) -> None:
    """Write bytes to standard output."""
    sys.stdout.flush()
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()


def rewrite(path: Path, data: bytes) -> None:
    """Replace the contents of a file; see `outputs.writing`.

    Raises:
        UsageError: it cannot be written.
    """
    from elitescript.outputs.writing import write_file

    try:
        write_file(path, data)
    except OSError as error:
        raise UsageError(f"cannot write {path}: {error.strerror or error}") from error
