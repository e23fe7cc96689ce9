"""`os`, `os.path` and `signal` for scripts: the task folder, and signals to simulated processes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from elitescript.errors import NotSimulatedError, ScriptPermissionError
from elitescript.runtime.environment import TASK_PATH, Files, relative_name
from elitescript.runtime.stdlib.loader import forwarded, real
from elitescript.runtime.stdlib.subprocess_module import FIRST_PID, HARMLESS, ProcessTable
from elitescript.said import said


def os_names(files: Files, table: ProcessTable, facade: Callable[[str, dict[str, Any]], Any]) -> dict[str, Any]:
    """Return the public names of `os` for one program.

    Args:
        files: the task folder.
        table: the processes of the program.
        facade: makes a module of names, for `os.path`.
    """

    def kill(pid: int, number: int) -> None:
        """End a process of the table, unless the signal is harmless."""
        if number in HARMLESS and pid in table.running:
            return
        table.end(pid, -int(number))

    def listdir(path: str = TASK_PATH) -> list[str]:
        """Return sorted names in a folder of the task folder."""
        return files.names(relative_name(path))

    def remove(path: str) -> None:
        """Delete a file of the task folder."""
        files.remove(relative_name(path))

    def mkdir(path: str, mode: int = 0o777) -> None:
        """Make a folder in the task folder."""
        files.make_folder(relative_name(path))

    def makedirs(path: str, mode: int = 0o777, exist_ok: bool = False) -> None:
        """Make a folder and those above it."""
        name = relative_name(path)
        parts = name.split("/")
        for end in range(1, len(parts)):
            if not files.kind("/".join(parts[:end])):
                files.make_folder("/".join(parts[:end]))
        if not (exist_ok and files.kind(name) == "folder"):
            files.make_folder(name)

    return {
        **_NAMES_OF_FOLDERS,
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
        "path": facade("os.path", _path_names(files)),
        "pathsep": ":",
        "remove": remove,
        "unlink": remove,
    }


_PATH_FUNCTIONS: Final = "basename commonprefix dirname isabs join normcase normpath split splitdrive splitext"
_NAMES_OF_FOLDERS: Final = {"curdir": ".", "extsep": ".", "pardir": "..", "sep": "/"}


def _path_names(files: Files) -> dict[str, Any]:
    posixpath = real("posixpath")

    def kind(path: str) -> str:
        try:
            return files.kind(relative_name(path))
        except ScriptPermissionError:
            return ""

    def abspath(path: str) -> str:
        """Return a path from the root on, without `.` and `..`."""
        return str(posixpath.normpath(posixpath.join(TASK_PATH, path)))

    def realpath(path: str, *, strict: bool = False) -> str:
        """Return the absolute path: programs see no links."""
        if strict and not kind(path):
            raise FileNotFoundError(2, "No such file or directory", path)
        return abspath(path)

    def relpath(path: str, start: str = TASK_PATH) -> str:
        """Return a path from a folder on, the task folder by default."""
        return str(posixpath.relpath(abspath(path), abspath(start)))

    def expanduser(path: str) -> str:
        """Return the path as it is: there are no home folders on the robot (*assumed*)."""
        return str(posixpath.join(path))

    def getmtime(path: str) -> float:
        """Refuse: the task folder keeps no times.

        Raises:
            NotSimulatedError: always, for a file that is there.
        """
        name = relative_name(path)
        if not files.kind(name):
            raise FileNotFoundError(2, "No such file or directory", path)
        raise NotSimulatedError(
            said("the task folder keeps no times: when {path!r} was changed is not known", path=path), value=path
        )

    return {
        **{name: forwarded(getattr(posixpath, name)) for name in _PATH_FUNCTIONS.split()},
        **_NAMES_OF_FOLDERS,
        "abspath": abspath,
        "exists": lambda path: kind(path) != "",
        "expanduser": expanduser,
        "getmtime": getmtime,
        "getsize": lambda path: files.size(relative_name(path)),
        "isdir": lambda path: kind(path) == "folder",
        "isfile": lambda path: kind(path) == "file",
        "realpath": realpath,
        "relpath": relpath,
    }


_SIGNALS: Final = {
    "SIGHUP": 1,
    "SIGINT": 2,
    "SIGABRT": 6,
    "SIGKILL": 9,
    "SIGUSR1": 10,
    "SIGUSR2": 12,
    "SIGPIPE": 13,
    "SIGALRM": 14,
    "SIGTERM": 15,
    "SIGCHLD": 17,
    "SIGCONT": 18,
    "SIGSTOP": 19,
}
_UNHANDLED: Final = frozenset((9, 19))
_SIGNAL_MAX: Final = 64


def signal_names() -> dict[str, Any]:
    """Return the public names of `signal` for one program. Handlers are kept and never called: no signal arrives."""
    handlers: dict[int, Any] = {}

    def signal(number: int, handler: Any) -> Any:
        """Keep a handler; return the one before."""
        if number not in _SIGNALS.values():
            raise ValueError("signal number out of range")
        if number in _UNHANDLED:
            raise OSError(22, "Invalid argument")
        if not callable(handler) and handler not in (0, 1):
            raise TypeError("signal handler must be signal.SIG_IGN, signal.SIG_DFL, or a callable object")
        before = handlers.get(number, 0)
        handlers[number] = handler
        return before

    def getsignal(number: int) -> Any:
        """Return the handler that was kept."""
        if not 1 <= number <= _SIGNAL_MAX:
            raise ValueError("signal number out of range")
        return handlers.get(number, 0)

    return {**_SIGNALS, "SIG_DFL": 0, "SIG_IGN": 1, "getsignal": getsignal, "signal": signal}
