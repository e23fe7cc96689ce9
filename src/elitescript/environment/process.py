"""Processes that run programs: their start, their limits, their end with their parent, and the place in a trace."""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any, Final

MEMORY_DEFAULT: Final = "4GiB"
"""Limit of the memory of a run, *assumed*: more than a controller has, less than most computers."""
MEMORY_MIN: Final = 512 << 20
"""Least limit of the address space, for Python, this package and its model."""

HASH_SEED: Final = "0"
"""The order of a set of strings depends on it; every process that runs programs has the same."""

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


def cores() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def limit_memory(size: int) -> None:
    """Limit the memory of this process, in bytes, where the system can."""
    try:
        import resource
    except ImportError:
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    # What the shell has allowed counts too (`ulimit -v`, whose hard limit no process may raise).
    allowed = [limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_AS, (min([max(size, MEMORY_MIN), *allowed]), hard))


def module_command(module: str, arguments: Iterable[object] = ()) -> list[str]:
    """Return the command line of a process that runs a module of this package.

    With -P a file called queue.py in the working folder does not stand in for the standard library's.
    """
    return [sys.executable, "-P", "-m", module, *map(str, arguments)]


def module_environment() -> dict[str, str]:
    """Return the variables of such a process: it finds the same modules as this one, and has the same hashes."""
    paths = os.pathsep.join(filter(None, sys.path))
    return {**os.environ, "PYTHONHASHSEED": HASH_SEED, "PYTHONUTF8": "1", "PYTHONPATH": paths}


class Life:
    """A pipe whose end in this process ends another one, whatever that does; see `end_with_parent`.

    Attributes:
        descriptor: for the other process; -1 where there is no such thing.
    """

    __slots__ = ("_own", "descriptor")

    def __init__(self) -> None:
        self.descriptor, self._own = os.pipe() if os.name == "posix" else (-1, -1)

    @property
    def options(self) -> dict[str, Any]:
        """Keyword arguments for the start of the other process."""
        return {"start_new_session": True, "pass_fds": [self.descriptor]} if self._own >= 0 else {}

    def started(self) -> None:
        """Close the end of the other process here, once that has it."""
        if self.descriptor >= 0:
            os.close(self.descriptor)
            self.descriptor = -1

    def close(self) -> None:
        """Close both ends."""
        self.started()
        if self._own >= 0:
            os.close(self._own)
            self._own = -1


def end_with_parent(descriptor: int) -> None:
    """Let the system end this process and its copies when the parent's end of a pipe closes, where it can.

    Args:
        descriptor: of `Life`; below 0 for none.
    """
    if descriptor < 0:
        return
    import fcntl
    import signal

    signal.signal(signal.SIGIO, signal.SIG_DFL)
    fcntl.fcntl(descriptor, fcntl.F_SETOWN, -os.getpgrp())
    fcntl.fcntl(descriptor, fcntl.F_SETFL, fcntl.fcntl(descriptor, fcntl.F_GETFL) | os.O_ASYNC)
    if _is_closed(descriptor):
        # The parent had gone before.
        os._exit(1)


def _is_closed(descriptor: int) -> bool:
    import select

    return bool(select.select([descriptor], [], [], 0)[0])
