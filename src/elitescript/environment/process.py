"""Limits of a process that runs programs, and the place of a program in the trace of its crash."""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Final

MEMORY_DEFAULT: Final = "4GiB"
"""Limit of the memory of a run, *assumed*: more than a controller has, less than most computers."""
MEMORY_MIN: Final = 512 << 20
"""Least limit of the address space, for Python, this package and its model."""

_ENTRANCES: Final = (f"elitescript{os.sep}cli{os.sep}main.py", f"elitescript{os.sep}dap{os.sep}worker.py")


def place_in_trace(trace: bytes) -> tuple[str, int] | None:
    """Return the name and line of the program text that a trace of `faulthandler` was in; None if it was in none."""
    for row in trace.decode("utf-8", "replace").splitlines():
        file, quote, rest = row.strip().removeprefix('File "').partition('", line ')
        if file.endswith(_ENTRANCES):
            # What called it is the command itself, which need not end in .py.
            return None
        # Only texts of programs are no files of Python.
        if quote and not file.endswith(".py") and not file.startswith("<frozen"):
            return file, int(rest.split()[0])
    return None


def limit_memory(size: int) -> None:
    """Limit the memory of this process, in bytes, where the system can."""
    try:
        import resource
    except ImportError:
        return
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    soft = size if hard == resource.RLIM_INFINITY else min(size, hard)
    resource.setrlimit(resource.RLIMIT_AS, (max(soft, MEMORY_MIN), hard))
