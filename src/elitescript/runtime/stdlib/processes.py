"""`os`, `signal` and `subprocess` for scripts: names of files, and a table of processes that do not exist.

Real programs look for stale `socat` processes, end them and start their own, to reach the serial line of the tool
over the network. They find an empty table and get a process that runs until they end it. Any other process is
refused; no process is ever started.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, Final, Protocol

from elitescript.errors import ScriptPermissionError
from elitescript.runtime.sealed import Sealed, hidden_slot, no_copy
from elitescript.runtime.stdlib.loader import forwarded, real
from elitescript.runtime.world import TASK_PATH, Files, relative_name

PROCESSES_MAX: Final = 32
"""Processes that a program may have running."""

_FIRST_PID: Final = 1000
_TERMINATED: Final = -15
_KILLED: Final = -9


class ProcessTable:
    """The processes of one program, none of which exists."""

    __slots__ = ("_next_pid", "running")

    def __init__(self) -> None:
        self.running: dict[int, Process] = {}
        self._next_pid = _FIRST_PID

    def start(self, args: list[str]) -> Process:
        """Add a process.

        Raises:
            OSError: too many.
        """
        if len(self.running) >= PROCESSES_MAX:
            raise OSError(11, f"more than {PROCESSES_MAX} processes")
        process = Process(args)
        self._next_pid += 1
        state = _state_of(process)
        state.table = self
        state.pid = self._next_pid
        self.running[self._next_pid] = process
        return process

    def end(self, pid: int, status: int) -> None:
        """Take a process out.

        Raises:
            ProcessLookupError: there is none of that number.
        """
        process = self.running.pop(pid, None)
        if process is None:
            raise ProcessLookupError(3, "No such process")
        _state_of(process).status = status


class _ProcessState:
    __slots__ = ("pid", "status", "table")

    def __init__(self) -> None:
        self.pid = 0
        self.status: int | None = None
        self.table: ProcessTable | None = None


class Process(metaclass=Sealed):
    """What `subprocess.Popen` returns."""

    __slots__ = ("_state", "args", "stderr", "stdin", "stdout")
    __module__ = "subprocess"
    __qualname__ = "Popen"
    __reduce_ex__ = no_copy

    def __init__(self, args: list[str]) -> None:
        self.args = args
        self.stdin = self.stdout = self.stderr = None
        _state.__set__(self, _ProcessState())

    @property
    def pid(self) -> int:
        """Number of the process."""
        return int(_state_of(self).pid)

    @property
    def returncode(self) -> int | None:
        """How it ended; None while it runs."""
        status: int | None = _state_of(self).status
        return status

    def poll(self) -> int | None:
        """How it ended; None while it runs."""
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """How it ended.

        Raises:
            PermissionError: it runs, and will until the program ends it.
        """
        status = self.returncode
        if status is None:
            raise ScriptPermissionError(
                "the process exists in name only and ends when the program ends it",
                hint="call terminate() or kill() before wait()",
            )
        return status

    def communicate(self, input: object = None, timeout: float | None = None) -> tuple[str, str]:
        """Its outputs, which are empty."""
        self.wait()
        return "", ""

    def terminate(self) -> None:
        """End it."""
        _end(self, _TERMINATED)

    def kill(self) -> None:
        """End it."""
        _end(self, _KILLED)

    def send_signal(self, number: int) -> None:
        """End it, whatever the signal; 0 does nothing."""
        if number:
            _end(self, -int(number))

    def __repr__(self) -> str:
        return f"<Popen: returncode: {self.returncode} args: {self.args!r}>"


_state = hidden_slot(Process, "_state")
_state_of: Callable[[Process], _ProcessState] = _state.__get__


def _end(process: Process, status: int) -> None:
    state = _state_of(process)
    if state.status is None and state.table is not None:
        state.table.end(state.pid, status)


# ---------------------------------------------------------------- subprocess


class CompletedProcess(metaclass=Sealed):
    """What `subprocess.run` returns."""

    __slots__ = ("args", "returncode", "stderr", "stdout")
    __module__ = "subprocess"

    def __init__(self, args: Any, stdout: Any) -> None:
        self.args = args
        self.returncode = 0
        self.stdout = stdout
        self.stderr: Any = None if stdout is None else type(stdout)()

    def check_returncode(self) -> None:
        """Do nothing: it ended well."""


def subprocess_names(table: ProcessTable) -> dict[str, Any]:
    """Public names of `subprocess` for one program."""

    def listing(args: list[str]) -> str:
        kind = _kind_of(args)
        if kind == "ps":
            rows = [f"{process.pid:>5} root      0:00 {' '.join(process.args)}" for process in table.running.values()]
            return "\n".join(["  PID USER     TIME  COMMAND", *rows]) + "\n"
        if kind == "pgrep":
            words = [word for word in args[1:] if not word.startswith("-")]
            found = [p.pid for p in table.running.values() if all(word in " ".join(p.args) for word in words)]
            return "".join(f"{pid}\n" for pid in found)
        raise _refusal(args)

    def run(args: Any, **options: Any) -> CompletedProcess:
        """Run `ps` or `pgrep` in the table of processes, or refuse.

        Raises:
            PermissionError: any other command.
        """
        words = _words(args)
        text = listing(words)
        is_text = any(options.get(name) for name in ("text", "universal_newlines", "encoding"))
        is_captured = options.get("capture_output") or options.get("stdout") == -1
        return CompletedProcess(args, (text if is_text else text.encode()) if is_captured else None)

    def check_output(args: Any, **options: Any) -> Any:
        """What `run` writes to its output."""
        return run(args, **{**options, "stdout": -1}).stdout

    def call(args: Any, **options: Any) -> int:
        """The status with which `run` ends, which is 0."""
        return run(args, **options).returncode

    def start(args: Any, *positional: Any, **options: Any) -> Process:
        """Start a `socat` that exists in name only, or refuse.

        Raises:
            PermissionError: any other command.
        """
        words = _words(args)
        if _kind_of(words) != "socat":
            raise _refusal(words)
        return table.start(words)

    class SubprocessError(Exception):
        """Base of the errors of this module."""

    class CalledProcessError(SubprocessError):
        """Never raised here."""

    class TimeoutExpired(SubprocessError):
        """Never raised here."""

    for error in (SubprocessError, CalledProcessError, TimeoutExpired):
        error.__module__ = "subprocess"
        error.__qualname__ = error.__name__
    return {
        "CalledProcessError": CalledProcessError,
        "CompletedProcess": CompletedProcess,
        "DEVNULL": -3,
        "PIPE": -1,
        "Popen": start,
        "STDOUT": -2,
        "SubprocessError": SubprocessError,
        "TimeoutExpired": TimeoutExpired,
        "call": call,
        "check_call": call,
        "check_output": check_output,
        "run": run,
    }


def _words(args: Any) -> list[str]:
    words = args.split() if isinstance(args, str) else list(args)
    if not words or not all(type(word) is str for word in words):
        raise TypeError("a command is a text or a list of texts")
    if any(letter in word for word in words for letter in "|&;<>`$\n"):
        raise _refusal(words)
    return words


def _kind_of(words: list[str]) -> str:
    name = words[0].rpartition("/")[2]
    return name if name in ("ps", "pgrep", "socat") else ""


def _refusal(words: list[str]) -> ScriptPermissionError:
    return ScriptPermissionError(
        f"the command {' '.join(words)!r} is not run: programs cannot start processes",
        hint="only ps, pgrep and socat are known, and they exist in name only",
    )


# ---------------------------------------------------------------- os and signal


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
        """End a process of the table; signal 0 only looks for it."""
        if number == 0 and pid in table.running:
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
        "getpid": lambda: _FIRST_PID,
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


NO_PROCESSES: Final = SimpleNamespace()
"""`os` for copies, which only ask it what it lacks."""
