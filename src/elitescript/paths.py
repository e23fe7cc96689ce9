"""What stands at a path of this computer, before something is read that never comes or never ends."""

from __future__ import annotations

import os
import stat
from typing import Final

_STREAMS: Final = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")
"""Names of what a shell has opened for us: `elitescript run /dev/stdin`, `elitescript run <(generate)`."""

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
        is_stream_allowed: accept standard input and what the shell has opened.
    """
    name = os.fspath(path)
    if is_stream_allowed and name.startswith(_STREAMS):
        return ""
    try:
        mode = os.stat(name).st_mode  # noqa: PTH116
    except (OSError, ValueError):
        return ""
    return next((f"is {kind}, not a file" for test, kind in _KINDS if test(mode)), "")
