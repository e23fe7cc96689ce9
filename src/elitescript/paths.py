"""Paths that users give: names of programs, what is there before a read that might never end, where links lead."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Final

STREAMS: Final = ("/dev/stdin", "/dev/stdout", "/dev/stderr", "/dev/fd/", "/proc/self/fd/")
"""Names of streams that a shell has opened: `elitescript run /dev/stdin`, `elitescript run <(generate)`."""

_STANDARD: Final = ("stdin", "stdout", "stderr")
_LINKS_MAX: Final = 40

_KINDS: Final = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


PROGRAM_SUFFIX: Final = ".script"


TASK_SUFFIX: Final = ".task"


def is_task_name(name: str) -> bool:
    """Return whether a file is a graphical program, by its name."""
    return name.lower().endswith(TASK_SUFFIX)


def is_program_name(name: str) -> bool:
    """Return whether a file is a program, by its name. Windows and pendants may write `CELL.SCRIPT`."""
    return name.lower().endswith(PROGRAM_SUFFIX)


REMOVED: Final = "was removed"
CHANGED: Final = "was truncated, or another process has written to it"
MOVED: Final = "was moved"


def what_became_of(path: str | os.PathLike[str], descriptor: int, size: int) -> str:
    """Return what became of a file that this process writes: `REMOVED`, `CHANGED`, `MOVED`; empty if all is well.

    Args:
        path: under which it was made.
        descriptor: of the open file, which appends: so what is written behind a cut shows in the size.
        size: bytes that were written to it.
    """
    ours = os.fstat(descriptor)
    if not stat.S_ISREG(ours.st_mode):
        return ""
    if ours.st_nlink == 0:
        return REMOVED
    if ours.st_size != size:
        return CHANGED
    try:
        there = os.stat(path)  # noqa: PTH116
    except OSError:
        return MOVED
    return "" if (there.st_dev, there.st_ino) == (ours.st_dev, ours.st_ino) else MOVED


def why_no_file(path: str | os.PathLike[str], *, is_stream_allowed: bool = False) -> str:
    """Return why a path is no ordinary file, as `is a named pipe, not a file`; empty if it is one, or nothing is there.

    Args:
        path: of this computer; links are followed.
        is_stream_allowed: accept standard input and other streams of the shell.
    """
    name = os.fspath(path)
    if is_stream_allowed and name.startswith(STREAMS):
        return ""
    try:
        kind = kind_of(os.stat(name).st_mode)  # noqa: PTH116
    except (OSError, ValueError):
        return ""
    return f"is {kind}, not a file" if kind else ""


def stream_of(path: str | os.PathLike[str]) -> int | None:
    """Return the descriptor of the stream of the shell to which a path leads, also through links; None if it does not.

    It is to be duplicated, not opened: a second opening would write over what is written through the first.
    """
    name = os.fspath(path)
    for _ in range(_LINKS_MAX):
        folder, last = os.path.split(name)
        folder = os.path.realpath(folder)
        if folder == "/dev" and last in _STANDARD:
            return _STANDARD.index(last)
        if folder in ("/dev/fd", f"/proc/{os.getpid()}/fd") and last.isascii() and last.isdigit():
            return int(last)
        try:
            name = os.path.join(folder, os.readlink(os.path.join(folder, last)))  # noqa: PTH115, PTH118
        except (OSError, ValueError):
            return None
    return None


def kind_of(mode: int) -> str:
    """Return what a mode of `os.stat` is that is no ordinary file, as `a device`; empty for an ordinary file."""
    return next((kind for test, kind in _KINDS if test(mode)), "")


def real_path(path: str | Path) -> Path:
    """Return an absolute path without links.

    Of links that go round in circles the path stays as it is, and whatever opens it says so; `Path.resolve` of
    Python 3.11 and 3.12 raises an error that no caller expects.
    """
    return Path(os.path.realpath(path))


def file_above(folder: str, name: str) -> str | None:
    """Return the file of a name that is nearest above a folder, or in it; None if there is none."""
    folder = os.path.abspath(folder)  # noqa: PTH100 - every call of ours looks, and pathlib takes longer
    while not os.path.isfile(path := os.path.join(folder, name)):  # noqa: PTH113, PTH118
        above = os.path.dirname(folder)  # noqa: PTH120
        if above == folder:
            return None
        folder = above
    return path
