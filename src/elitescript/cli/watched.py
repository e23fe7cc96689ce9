"""Runs a program in a child process that its parent watches.

A single call into C, such as `sum(range(10**12))`, reaches no checkpoint and lets no other thread of its process run;
one that recurses too deep, such as the end of a `map` of `map` of `map`, crashes the process. So programs run in a
child, and the parent only waits for it: it ends a child that takes too long, and reports the place of a crash.

The child writes a trace to a pipe when it crashes (`faulthandler`). It ends with its parent, and signals that only the
parent gets are passed on.
"""

from __future__ import annotations

import os
import sys
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, Final

MARK: Final = "ELITESCRIPT_WATCHED"
"""Set in the environment of a watched child: the descriptor for the trace of a crash, 0 for none."""

GRACE_S: Final = 2.0
"""Time of a child beyond its limit: to start, and to end by itself at its next checkpoint."""

ALARM: Final = 1
TIME_LIMIT: Final = 4
"""Exit codes of a run that ends so by itself."""

STACK_BYTES: Final = 1 << 30
"""Stack of a child, for recursion of C code; the usual 8 MB hold 100,000 nested `map`. It takes memory only as it is
used."""

STACK_MARGIN: Final = 16 << 20
"""Least distance between a full stack and other memory; the system itself wants 1 MB."""

TRACE_MAX: Final = 1 << 16

HINT: Final = "do not nest iterators (map, filter, zip, itertools) or objects hundreds of thousands deep"


def can_watch() -> bool:
    """Return whether this system can watch a process without a time limit."""
    return sys.platform == "linux"


def run_watched(
    command: list[str],
    environment: dict[str, str],
    max_wall_s: float | None,
    *,
    is_json: bool,
    run_here: Callable[[], int] | None = None,
) -> int:
    """Run `elitescript` in a watched child; return its exit code, in the child too.

    Args:
        command: program and arguments; the word behind `elitescript` names the command for messages.
        environment: of the child.
        max_wall_s: limit of its wall time; None for no limit.
        is_json: whether an end that the child cannot report itself is reported as JSON.
        run_here: what the child does if it need not start Python once more.
    """
    name = f"elitescript {command[command.index('elitescript') + 1]}"
    if can_watch():
        child = _started(command, environment, can_run_here=run_here is not None)
        if child is None:
            assert run_here is not None
            return run_here()
        status, trace = _watch(child, max_wall_s)
    else:
        assert max_wall_s is not None
        status, trace = _wait(command, environment, max_wall_s), b""
    if status is None:
        text = f"no checkpoint within --max-wall {max_wall_s:g} s: a single call does not come back; process ended"
        print(f"{_erased()}{name}: {text}", file=sys.stderr)
        if is_json:
            _print_records({"type": "end", "state": "time_limit", "t": None, "killed": True, "text": text})
        return TIME_LIMIT
    if status >= 0:
        return status
    import signal

    if -status in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGPIPE):
        # It was ended from outside: this process ends by the same signal, so that its parent sees it.
        signal.signal(-status, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {-status})
        os.kill(os.getpid(), -status)
        return 128 - status
    from elitescript.environment.process import place_in_trace

    _report_crash(name, signal.Signals(-status).name, place_in_trace(trace), is_json=is_json)
    return ALARM


def watch_for_crashes() -> bool:
    """Let a watched child write its trace when it crashes; return whether this is such a child."""
    mark = os.environ.get(MARK, "")
    if not mark.isdigit():
        return False
    if int(mark):
        import _thread
        import faulthandler

        faulthandler.enable(file=int(mark), all_threads=False)
        # The contents of a buffer are lost in a crash.
        if (reconfigure := getattr(sys.stdout, "reconfigure", None)) is not None:
            reconfigure(line_buffering=True)
        # By default threads would get the same stack as this process.
        _thread.stack_size(8 << 20)
    return True


class _Child:
    __slots__ = ("process", "trace")

    def __init__(self, process: int, trace: int) -> None:
        self.process = process
        self.trace = trace
        """Descriptor of the pipe for its trace."""


def _started(command: list[str], environment: dict[str, str], *, can_run_here: bool) -> _Child | None:
    """Start a child; return None in a child that goes on here, as a copy of this process, which takes least time."""
    import fcntl
    import resource

    trace, crash = os.pipe()
    parted, parent = os.pipe()
    sys.stdout.flush()
    child = os.fork()
    if not child:
        try:
            # The end of the parent closes its pipe, which ends this process with SIGIO.
            os.close(parent)
            fcntl.fcntl(parted, fcntl.F_SETOWN, os.getpid())
            fcntl.fcntl(parted, fcntl.F_SETFL, fcntl.fcntl(parted, fcntl.F_GETFL) | os.O_ASYNC)
            for descriptor in (parted, crash):
                os.set_inheritable(descriptor, True)
            hard = resource.getrlimit(resource.RLIMIT_STACK)[1]
            soft = STACK_BYTES if hard == resource.RLIM_INFINITY else min(STACK_BYTES, hard)
            resource.setrlimit(resource.RLIMIT_STACK, (soft, hard))
            environment[MARK] = str(crash)
            if not (can_run_here and _has_room(soft)):
                os.execve(command[0], command, environment)
        except BaseException:
            os._exit(127)
        os.environ[MARK] = str(crash)
        if not sys.flags.safe_path:
            # As with -P: a file called queue.py beside the program must not stand in for the standard library's.
            folder = sys.path.pop(0)
            if os.path.abspath(folder) in environment.get("PYTHONPATH", "").split(os.pathsep):  # noqa: PTH100
                # A working copy is found through this path alone, and so may be what it needs.
                sys.path.insert(0, folder)
        return None
    os.close(parted)
    os.close(crash)
    return _Child(child, trace)


def _has_room(stack: int) -> bool:
    """Return whether the stack of this process can grow to so many bytes, which is decided where it was started.

    From Python 3.14 on the interpreter itself measures its stack there.
    """
    if sys.version_info >= (3, 14):
        return False
    below = 0
    try:
        with open("/proc/self/maps", encoding="utf-8", errors="replace") as maps:  # noqa: PTH123
            for row in maps:
                _, end = (int(address, 16) for address in row.partition(" ")[0].split("-"))
                if row.endswith("[stack]\n"):
                    return end - below > stack + STACK_MARGIN
                below = end
    except OSError:
        pass
    return False


def _watch(child: _Child, max_wall_s: float | None) -> tuple[int | None, bytes]:
    """Return the exit code of a child, the negative signal that ended it, or None at the limit; and its trace."""
    code = _ended(child.process, max_wall_s)
    os.set_blocking(child.trace, False)
    try:
        return code, os.read(child.trace, TRACE_MAX)
    except BlockingIOError:
        return code, b""


def _ended(child: int, max_wall_s: float | None) -> int | None:
    """Wait for the end of a child, which is killed at the limit; see `_watch`."""
    end_s = None if max_wall_s is None else time.monotonic() + max_wall_s + GRACE_S
    # The child starts meanwhile.
    import signal

    passed_on = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    awaited = {signal.SIGCHLD, *passed_on}
    ended_by = 0
    signal.pthread_sigmask(signal.SIG_BLOCK, awaited)
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        # At most an hour at a time: a wait of years overflows a counter.
        left_s = 3600.0 if end_s is None else min(end_s - time.monotonic(), 3600.0)
        if left_s <= 0.0:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return -ended_by if ended_by else None
        received = signal.sigtimedwait(awaited, left_s)
        if received is None or received.si_signo not in passed_on:
            continue
        # A terminal sends to both processes, with the code of the kernel, which is positive.
        if received.si_code <= 0:
            os.kill(child, received.si_signo)
        if received.si_signo != signal.SIGINT:
            # A call that does not come back keeps the child from ending; a second Ctrl-C would kill it.
            ended_by = received.si_signo
            limit_s = time.monotonic() + GRACE_S
            end_s = limit_s if end_s is None else min(end_s, limit_s)


def _wait(command: list[str], environment: dict[str, str], max_wall_s: float) -> int | None:
    """Run a command where only its time can be watched; see `_watch`."""
    import signal
    import subprocess

    # In its own process group, the child gets Ctrl-C once: from this process.
    own_group: dict[str, Any] = {"process_group": 0, "close_fds": False} if os.name == "posix" else {}
    child = subprocess.Popen(command, env={**environment, MARK: "0"}, **own_group)

    def pass_on(number: int, _frame: object) -> None:
        try:
            child.send_signal(number)
        except (OSError, ValueError):
            return

    signal.signal(signal.SIGINT, pass_on if os.name == "posix" else signal.SIG_IGN)
    signal.signal(signal.SIGTERM, pass_on)
    try:
        return child.wait(timeout=max_wall_s + GRACE_S)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()
        return None


def _erased() -> str:
    """Return the escape code that erases a status line of the child; see `cli.output.screen`."""
    from elitescript.cli.output.screen import ERASE, understands_escapes

    return ERASE if sys.stderr.isatty() and understands_escapes(os.environ, os.name) else ""


def _report_crash(name: str, cause: str, place: tuple[str, int] | None, *, is_json: bool) -> None:
    from elitescript.errors import CODES
    from elitescript.shown import shown_word

    code = "R151"
    text = f"{CODES[code].title} ({cause})"
    hint = HINT
    if cause == "SIGKILL":
        text += ": the system had no more memory, or somebody has killed it"
        hint = "--memory-limit bounds what a run may have"
    file, line = place or ("", 0)
    where = f" in line {line} of {shown_word(file)}" if line else ""
    print(f"{_erased()}{name}: ALARM {code}{where}: {text}", file=sys.stderr)
    if source := _line_of(file, line):
        print(f"{line:>8} | {source}", file=sys.stderr)
    print(f"    hint: {hint}", file=sys.stderr)
    if is_json:
        details = {"class": "ProcessCrashed", "text": text, "line": line, "column": 0, "thread": "", "hint": hint}
        _print_records(
            {"type": "alarm", "t": None, "code": code, **details},
            {"type": "end", "state": "alarm", "t": None, "killed": True, "text": text},
        )


def _line_of(file: str, line: int) -> str:
    if not os.path.isfile(file):  # noqa: PTH113
        return ""
    from elitescript.shown import shown

    with open(file, encoding="utf-8", errors="replace") as text:  # noqa: PTH123
        return next((shown(row.rstrip()) for number, row in enumerate(text, 1) if number == line), "")


def _print_records(*records: dict[str, Any]) -> None:
    from elitescript.json_records import jsonlines

    for record in records:
        print(jsonlines.line(record), flush=True)
