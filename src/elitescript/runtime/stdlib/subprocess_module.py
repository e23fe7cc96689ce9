"""`subprocess` for scripts: a table of simulated processes.

Real programs look for stale `socat` processes, end them and start their own, to reach the serial line of the tool over
the network. Here the table is empty at first, and a simulated `socat` runs until the program ends it. Any other process
is refused; no process is ever started.
"""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO, StringIO
from typing import Any, Final

from elitescript.errors import ScriptPermissionError, ScriptStateError
from elitescript.messages.timing import ticks_for
from elitescript.runtime.files import ScriptFile, file_over
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.said import said
from elitescript.sealed import Sealed, hidden_slot, no_copy

PROCESSES_MAX: Final = 32
"""Processes that a program may have running."""

FIRST_PID: Final = 1000
"""Number of the program's own process; those that it starts count on."""

HARMLESS: Final = frozenset((0, 17, 18, 19))
"""Signals that end no process: none at all, SIGCHLD, SIGCONT, SIGSTOP."""

_TERMINATED: Final = -15
_KILLED: Final = -9


class ProcessTable:
    """The simulated processes of one program."""

    __slots__ = ("_next_pid", "running")

    def __init__(self) -> None:
        self.running: dict[int, Process] = {}
        self._next_pid = FIRST_PID

    def start(self, args: list[str]) -> Process:
        """Add a process.

        Raises:
            OSError: too many.
        """
        if len(self.running) >= PROCESSES_MAX:
            raise OSError(11, f"more than {PROCESSES_MAX} processes")
        process = self.ended(args)
        state = _state_of(process)
        state.table = self
        state.status = None
        self.running[state.pid] = process
        return process

    def ended(self, args: list[str]) -> Process:
        """Return a process that has ended with status 0."""
        process = Process(args)
        self._next_pid += 1
        state = _state_of(process)
        state.pid = self._next_pid
        state.status = 0
        return process

    def end(self, pid: int, status: int) -> None:
        """End a process.

        Raises:
            ProcessLookupError: there is none of that number.
        """
        process = self.running.pop(pid, None)
        if process is None:
            raise ProcessLookupError(3, "No such process")
        state = _state_of(process)
        state.status = status
        for wake in state.at_end:
            wake()


class _ProcessState:
    __slots__ = ("at_end", "await_end", "pid", "status", "table")

    def __init__(self) -> None:
        self.pid = 0
        self.status: int | None = None
        self.table: ProcessTable | None = None
        self.await_end: Callable[[Process, Any], None] | None = None
        self.at_end: list[Callable[[], None]] = []


class Process(metaclass=Sealed):
    """The result of `subprocess.Popen`."""

    __slots__ = ("_state", "args", "stderr", "stdin", "stdout")
    __module__ = "subprocess"
    __qualname__ = "Popen"
    __reduce_ex__ = no_copy

    def __init__(self, args: list[str]) -> None:
        self.args = args
        self.stdin = None
        self.stdout: ScriptFile | None = None
        self.stderr: ScriptFile | None = None
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
        """Return how it ended; None while it runs."""
        return self.returncode

    def wait(self, timeout: Any = None) -> int:
        """Return how it ended.

        Args:
            timeout: so many seconds another thread of the program has to end it, s.

        Raises:
            TimeoutExpired: it still runs.
            PermissionError: it runs, and no time-out says how long to wait.
        """
        state = _state_of(self)
        if state.status is None and timeout is not None and state.await_end is not None:
            state.await_end(self, timeout)
        status = self.returncode
        if status is None:
            raise ScriptPermissionError(
                "the process exists in name only and ends when the program ends it",
                hint="call terminate() or kill() before wait()",
            )
        return status

    def communicate(self, input: object = None, timeout: Any = None) -> tuple[Any, Any]:
        """Return its outputs, as far as they are pipes; waits like `wait`."""
        self.wait(timeout)
        output, errors = (None if stream is None else stream.read() for stream in (self.stdout, self.stderr))
        self._close()
        return output, errors

    def _close(self) -> None:
        for stream in (self.stdout, self.stderr):
            if stream is not None:
                stream.close()

    def __enter__(self) -> Process:
        return self

    def __exit__(self, kind: object, *details: object) -> None:
        self._close()
        if kind is None:
            self.wait()

    def terminate(self) -> None:
        """End it."""
        _end(self, _TERMINATED)

    def kill(self) -> None:
        """End it."""
        _end(self, _KILLED)

    def send_signal(self, number: int) -> None:
        """End it, unless the signal is one of those that end nothing."""
        if number not in HARMLESS:
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
    """The result of `subprocess.run`."""

    __slots__ = ("args", "returncode", "stderr", "stdout")
    __module__ = "subprocess"

    def __init__(self, args: Any, stdout: Any) -> None:
        self.args = args
        self.returncode = 0
        self.stdout = stdout
        self.stderr: Any = None if stdout is None else type(stdout)()

    def check_returncode(self) -> None:
        """Do nothing: the status is 0."""


_PIPE: Final = -1


def subprocess_names(table: ProcessTable, scheduler: Scheduler) -> dict[str, Any]:
    """Return the public names of `subprocess` for one program.

    Args:
        table: its processes.
        scheduler: runs its threads.
    """

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
        is_captured = options.get("capture_output") or options.get("stdout") == _PIPE
        return CompletedProcess(args, (text if _is_text(options) else text.encode()) if is_captured else None)

    def check_output(args: Any, **options: Any) -> Any:
        """Return what `run` writes to its output."""
        return run(args, **{**options, "stdout": _PIPE}).stdout

    def call(args: Any, **options: Any) -> int:
        """Return the status with which `run` ends, which is 0."""
        return run(args, **options).returncode

    def start(args: Any, *positional: Any, **options: Any) -> Process:
        """Start a `socat` that exists in name only, run `ps` or `pgrep` in the table of processes, or refuse.

        Raises:
            PermissionError: any other command.
        """
        words = _words(args)
        if _kind_of(words) == "socat":
            text = ""
            process = table.start(words)
            _state_of(process).await_end = await_end
        else:
            text = listing(words)
            process = table.ended(words)
        if options.get("stdout") == _PIPE:
            process.stdout = _stream("<stdout>", text, options)
        if options.get("stderr") == _PIPE:
            process.stderr = _stream("<stderr>", "", options)
        return process

    def await_end(process: Process, timeout: Any) -> None:
        """Let the calling thread wait until another one ends a process."""
        if not isinstance(timeout, (int, float)):
            raise TypeError(f"a timeout is a number of seconds, not a {type(timeout).__name__}")
        strand = scheduler.current
        ticks = ticks_for(timeout)
        if strand is not None and ticks > 0:
            if strand.is_secondary:
                raise ScriptStateError(
                    "Popen.wait waits, which a secondary program (sec) may not do", code="R120", command="Popen.wait"
                )
            ticket = strand.ticket + 1

            def wake() -> None:
                if strand.ticket == ticket:
                    scheduler.wake(strand)

            state = _state_of(process)
            state.at_end.append(wake)
            try:
                scheduler.wait("a process to end", scheduler.now + ticks)
            finally:
                state.at_end.remove(wake)
        if process.returncode is None:
            raise TimeoutExpired(process.args, timeout)

    class SubprocessError(Exception):
        """Base of the errors of this module."""

    class CalledProcessError(SubprocessError):
        """Never raised here."""

    class TimeoutExpired(SubprocessError):
        """A process still runs when the time is over."""

        def __init__(self, cmd: Any, timeout: Any, output: Any = None, stderr: Any = None) -> None:
            self.cmd = cmd
            self.timeout = timeout
            self.output = self.stdout = output
            self.stderr = stderr

        def __str__(self) -> str:
            return f"Command {self.cmd!r} timed out after {self.timeout} seconds"

    for error in (SubprocessError, CalledProcessError, TimeoutExpired):
        error.__module__ = "subprocess"
        error.__qualname__ = error.__name__
    return {
        "CalledProcessError": CalledProcessError,
        "CompletedProcess": CompletedProcess,
        "DEVNULL": -3,
        "PIPE": _PIPE,
        "Popen": start,
        "STDOUT": -2,
        "SubprocessError": SubprocessError,
        "TimeoutExpired": TimeoutExpired,
        "call": call,
        "check_call": call,
        "check_output": check_output,
        "run": run,
    }


def _is_text(options: dict[str, Any]) -> bool:
    return any(options.get(name) for name in ("text", "universal_newlines", "encoding", "errors"))


def _stream(name: str, text: str, options: dict[str, Any]) -> ScriptFile:
    """Return an output of a process with all of its text."""
    return file_over(StringIO(text), "r", name) if _is_text(options) else file_over(BytesIO(text.encode()), "rb", name)


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
        said("the command {command!r} is not run: programs cannot start processes", command=" ".join(words)),
        hint="only ps, pgrep and socat are known, and they exist in name only",
    )
