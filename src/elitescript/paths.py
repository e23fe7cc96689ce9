"""Paths that users give: what kind of file is there, before a read that would block or never end; where links lead."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Final

STREAMS: Final = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")
"""Names of streams that a shell has opened: `elitescript run /dev/stdin`, `elitescript run <(generate)`."""

_KINDS: Final = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


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


def kind_of(mode: int) -> str:
    """Return what a mode of `os.stat` is that is no ordinary file, as `a device`; empty for an ordinary file."""
    return next((kind for test, kind in _KINDS if test(mode)), "")


def real_path(path: str | Path) -> Path:
    """Return an absolute path without links.

    Of links that go round in circles the path stays as it is, and whatever opens it says so; `Path.resolve` of
    Python 3.11 and 3.12 raises an error that no caller expects.
    """
    return Path(os.path.realpath(path))
