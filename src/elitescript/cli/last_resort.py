"""Ends a process that does not react to Ctrl-C.

A call into Python's own functions, such as `sum(range(10**12))`, keeps every line of Python in its process from
running, also the handlers of signals and all threads. What the interpreter's C code still does is to write the number
of a signal to a pipe, and to write down where the process is (`faulthandler`). At the other end of the pipe is a small
process that reads: told twice to stop without an answer, it says where the program is, and kills.
"""

from __future__ import annotations

import faulthandler
import os
import select
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Final

from elitescript.cli.watched import place_in_trace

STOPS: Final = (signal.SIGINT, signal.SIGTERM)
HEARD: Final = b"\0"
"""What the process itself writes when one of its handlers runs: it reacts."""
PATIENCE_S: Final = 1.0
"""What the process has to react to the first signal. After that, people are told why it has not ended, and a second
signal kills; one that comes sooner counts only if the process has not reacted by then: it may be a key pressed too
long."""
TRACE_S: Final = 0.3
"""How long the process has to say where it is."""


@contextmanager
def last_resort(name: str) -> Iterator[Callable[[Callable[[], None]], None]]:
    """Watch over this process while the body runs; to be entered before any thread is started.

    Args:
        name: of the command, for what is said to people.

    Yields:
        A function that has another one called at the first signal to stop; in the main thread, anywhere.
    """
    if not hasattr(os, "fork"):
        # There is no such pipe; a process that hangs has to be ended by other means.
        yield lambda stop: _on_signals(lambda number, frame: stop())
        return
    told, tell = os.pipe()
    traced, trace = os.pipe()
    process = os.getpid()
    watcher = os.fork()
    if not watcher:
        os.close(tell)
        os.close(trace)
        with suppress(BaseException):
            _watch(process, told, traced, name)
        os._exit(0)
    os.close(told)
    os.close(traced)
    os.set_blocking(tell, False)
    faulthandler.register(signal.SIGUSR1, file=trace, all_threads=False)

    def listen(stop: Callable[[], None]) -> None:
        def heard(_number: int, _frame: FrameType | None) -> None:
            with suppress(OSError):
                os.write(tell, HEARD)
            stop()

        _on_signals(heard)
        signal.set_wakeup_fd(tell, warn_on_full_buffer=False)

    try:
        yield listen
    finally:
        signal.set_wakeup_fd(-1)
        faulthandler.unregister(signal.SIGUSR1)
        os.close(tell)
        os.close(trace)
        with suppress(ChildProcessError):
            os.waitpid(watcher, 0)


def _on_signals(handler: Callable[[int, FrameType | None], None]) -> None:
    for number in STOPS:
        signal.signal(number, handler)


def _watch(process: int, told: int, traced: int, name: str) -> None:
    """The other process: read signals until the first one is gone or has to be killed."""
    for number in (*STOPS, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(number, signal.SIG_IGN)
    until_s: float | None = None
    is_heard = is_urged = has_waited = False
    while True:
        left_s = None if until_s is None or has_waited else max(until_s - time.monotonic(), 0.0)
        if not select.select([told], [], [], left_s)[0]:
            has_waited = True
            if not is_urged or is_heard:
                is_urged = False
                _say(name, f"still busy: {_where(process, traced)}; once more (Ctrl-C) ends it at once")
        elif not (data := os.read(told, 64)):
            return
        else:
            is_heard = is_heard or HEARD in data
            for _ in range(sum(data.count(number) for number in STOPS)):
                is_urged = until_s is not None
                until_s = until_s or time.monotonic() + PATIENCE_S
        if has_waited and is_urged:
            _say(name, f"ended at once by a second signal: {_where(process, traced)}")
            os.kill(process, signal.SIGKILL)
            return


def _where(process: int, traced: int) -> str:
    """Return what the process is doing, in words."""
    os.kill(process, signal.SIGUSR1)
    trace, until_s = b"", time.monotonic() + TRACE_S
    while (left_s := until_s - time.monotonic()) > 0 and select.select([traced], [], [], left_s)[0]:
        piece = os.read(traced, 1 << 16)
        trace += piece
        if not piece:
            break
        # A trace comes in many small pieces; it is over when nothing comes for a while.
        until_s = min(until_s, time.monotonic() + TRACE_S / 6)
    place = place_in_trace(trace)
    if place is None:
        return "it does not come to an end"
    return f"a call in line {place[1]} of the program {place[0]} does not come back"


def _say(name: str, text: str) -> None:
    with suppress(OSError):
        os.write(sys.stderr.fileno(), f"{name}: {text}\n".encode())
