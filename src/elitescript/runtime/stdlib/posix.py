"""`os`, `os.path` and `signal` for scripts: the task folder, and signals to processes that do not exist."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.errors import ScriptPermissionError
from elitescript.runtime.stdlib.loader import forwarded, real
from elitescript.runtime.stdlib.processes import FIRST_PID, HARMLESS, ProcessTable
from elitescript.runtime.world import TASK_PATH, Files, relative_name


class FilesPort(Protocol):
    """What `os` asks of the program that it belongs to."""

    @property
    def task_files(self) -> Files:
        """The task folder."""


def os_names(port: FilesPort, table: ProcessTable, facade: Callable[[str, dict[str, Any]], Any]) -> dict[str, Any]:
    """Public names of `os` for one program.

    Args:
        port: the program.
        table: its processes.
        facade: makes a module of names, for `os.path`.
    """

    def kill(pid: int, number: int) -> None:
        """End a process of the table, unless the signal is one of those that end nothing."""
        if number in HARMLESS and pid in table.running:
            return
        table.end(pid, -int(number))

    def listdir(path: str = TASK_PATH) -> list[str]:
        """Sorted names in a folder of the task folder."""
        return port.task_files.names(relative_name(path))

    def remove(path: str) -> None:
        """Delete a file of the task folder."""
        port.task_files.remove(relative_name(path))

    def mkdir(path: str, mode: int = 0o777) -> None:
        """Make a folder in the task folder."""
        port.task_files.make_folder(relative_name(path))

    def makedirs(path: str, mode: int = 0o777, exist_ok: bool = False) -> None:
        """Make a folder and those above it."""
        name = relative_name(path)
        files = port.task_files
        parts = name.split("/")
        for end in range(1, len(parts)):
            if not files.kind("/".join(parts[:end])):
                files.make_folder("/".join(parts[:end]))
        if not (exist_ok and files.kind(name) == "folder"):
            files.make_folder(name)

    return {
        "environ": {},
        "getcwd": lambda: TASK_PATH.rstrip("/"),
        "getenv": lambda key, default=None: default,
        "getpid": lambda: FIRST_PID,
        "getppid": lambda: 1,
        "kill": kill,
        "linesep": "\n",
        "listdir": listdir,
        "makedirs": makedirs,
        "mkdir": mkdir,
        "name": "posix",
        "path": facade("os.path", _path_names(port)),
        "pathsep": ":",
        "remove": remove,
        "sep": "/",
        "unlink": remove,
    }


_PATH_FUNCTIONS: Final = ("basename", "commonprefix", "dirname", "isabs", "join", "normpath", "split", "splitext")


def _path_names(port: FilesPort) -> dict[str, Any]:
    posixpath = real("posixpath")

    def kind(path: str) -> str:
        try:
            return port.task_files.kind(relative_name(path))
        except ScriptPermissionError:
            return ""

    return {
        **{name: forwarded(getattr(posixpath, name)) for name in _PATH_FUNCTIONS},
        "abspath": lambda path: posixpath.normpath(posixpath.join(TASK_PATH, path)),
        "exists": lambda path: kind(path) != "",
        "getsize": lambda path: port.task_files.size(relative_name(path)),
        "isdir": lambda path: kind(path) == "folder",
        "isfile": lambda path: kind(path) == "file",
        "sep": "/",
    }


_SIGNALS: Final = {"SIGHUP": 1, "SIGINT": 2, "SIGKILL": 9, "SIGUSR1": 10, "SIGUSR2": 12, "SIGTERM": 15}


def signal_names() -> dict[str, Any]:
    """Public names of `signal` for one program. Handlers are kept and never called: no signal ever arrives."""
    handlers: dict[int, Any] = {}

    def signal(number: int, handler: Any) -> Any:
        """Keep a handler; return the one before."""
        if number not in _SIGNALS.values():
            raise ValueError("signal number out of range")
        before = handlers.get(number, 0)
        handlers[number] = handler
        return before

    def getsignal(number: int) -> Any:
        """The handler that was kept."""
        return handlers.get(number, 0)

    return {**_SIGNALS, "SIG_DFL": 0, "SIG_IGN": 1, "getsignal": getsignal, "signal": signal}
