"""Program texts: from a file, or as they are."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.language.advice.unknown_names import nearest
from elitescript.language.text.source import SourceFile
from elitescript.paths import PROGRAM_SUFFIX, is_program_name, is_task_name
from elitescript.said import said
from elitescript.untrusted.files import PROGRAM, UnreadableError, read_bytes

_MOST_NEIGHBOURS: Final = 1000
"""Files of a folder that are looked at to find the one that was meant."""


def source_of(program: str | Path, task_dir: str | Path | None = None, *, is_generated: bool = False) -> SourceFile:
    """Return the source of a program: a path, or a text.

    A str is a path if it is a single line that ends in `.script` or otherwise looks like a path: a word with a suffix,
    with slashes, or alone. Everything else is program text.

    Args:
        program: the path or the text.
        task_dir: the task folder, where a graphical program finds its configuration; None: the folder of its file.
        is_generated: of a graphical program, take the script that the pendant has written beside it.

    Raises:
        UsageError: the file cannot be read.
        ProgramError: the file is not UTF-8.
    """
    if isinstance(program, str) and not _is_path(program):
        return SourceFile("<program>", program)
    path = Path(program)
    if is_task_name(path.name) and path.exists():
        # Imported late: few programs are graphical.
        from elitescript.environment.task_files import pendant_source, source_of_task

        return pendant_source(path, task_dir) if is_generated else source_of_task(path, task_dir)
    if is_generated:
        raise UsageError(said("--generated: {program} is no graphical program (.task)", program=path))
    try:
        data = read_bytes(path, PROGRAM, is_stream_allowed=True)
    except UnreadableError as error:
        near = neighbours(path)
        raise UsageError(f"{error}{f'; {near}' if near else ''}") from None
    return SourceFile.from_bytes(str(path), data)


def refused_source(path: Path) -> SourceFile:
    """Return the source of a file that `source_of` has refused, to show its lines; see `SourceFile.to_show`.

    Raises:
        UsageError: the file cannot be read any more.
    """
    if is_task_name(path.name):
        from elitescript.environment.task_files import refused_task

        return refused_task(path)
    data = read_bytes(path, PROGRAM, is_stream_allowed=True)
    return SourceFile.to_show(str(path), data)


def neighbours(path: Path) -> str:
    """Return the file nearby that was meant, as a question; empty if none is named alike."""
    try:
        if path.exists():
            return ""
        names = []
        for entry in path.parent.iterdir():
            names.append(entry.name)
            if len(names) >= _MOST_NEIGHBOURS:
                break
    except (OSError, ValueError):
        return ""
    if not path.suffix and f"{path.name}{PROGRAM_SUFFIX}" in names:
        found = f"{path.name}{PROGRAM_SUFFIX}"
    else:
        programs = [name for name in names if is_program_name(name)]
        named = f"{path.stem}{PROGRAM_SUFFIX}"
        found = nearest(path.name, programs) or nearest(named, programs) or nearest(path.name, names)
    return f"is {path.parent / found} meant?" if found and found != path.name else ""


def _is_path(text: str) -> bool:
    """Return whether a str names a file. No statement is a single word, nor looks like `cell.scrpt` or `jobs/cell`."""
    line = text.strip()
    if not line or "\n" in text or "\r" in text:
        return False
    if is_program_name(line) or is_task_name(line):
        return True
    if line in _STATEMENTS:
        return False
    if re.fullmatch(r"[\w.~ -]*[/\\][^()=\[\]{}#'\"]*", line):
        return True
    return re.fullmatch(r"[^\s()=\[\]{}#'\",:;+*%&|^<>@!]+", line) is not None and not _is_number(line)


_STATEMENTS: Final = ("pass", "end", "return", "break", "continue", "raise", "...")
"""Words that are statements by themselves."""


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
