"""Ends a process that does not react to Ctrl-C.

A call into Python's own functions, such as `sum(range(10**12))`, keeps all Python code of its process from running,
also signal handlers and threads. The C code of the interpreter still writes the number of a signal to a pipe, and a
trace of the process (`faulthandler`). A small process reads the other end of the pipe: after two signals without a
reaction it reports the line of the program, and kills the process.
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

from elitescript.environment.process import place_in_trace
from elitescript.environment.stop_signals import STOP_SIGNALS, handled_signals
from elitescript.shown import shown

REACTED: Final = b"\0"
"""Written by the process itself when one of its handlers runs."""
REACTION_LIMIT_S: Final = 1.0
"""Time for a reaction to the first signal. After it a message is printed and a second signal kills; an earlier one
counts only if the process has not reacted by then, since it may be a key held down."""
TRACE_S: Final = 0.3
"""Timeout of the trace of the process."""


@contextmanager
def last_resort(name: str) -> Iterator[Callable[[Callable[[int], None]], None]]:
    """Watch this process while the body runs; to be entered before any thread is started.

    Args:
        name: of the command, for messages.

    Yields:
        A function that takes what handles a signal to stop, by its number; it is called in the main thread.
    """
    if not hasattr(os, "fork"):
        # Without a watching process, a process that hangs must be ended by other means.
        yield lambda stop: _on_signals(lambda number, _frame: stop(number))
        return
    signals, signalled = os.pipe()
    traced, trace = os.pipe()
    process = os.getpid()
    watcher = os.fork()
    if not watcher:
        os.close(signalled)
        os.close(trace)
        with suppress(BaseException):
            _watch(process, signals, traced, name)
        os._exit(0)
    os.close(signals)
    os.close(traced)
    os.set_blocking(signalled, False)
    faulthandler.register(signal.SIGUSR1, file=trace, all_threads=False)

    def listen(stop: Callable[[int], None]) -> None:
        def react(number: int, _frame: FrameType | None) -> None:
            with suppress(OSError):
                os.write(signalled, REACTED)
            stop(number)

        _on_signals(react)
        signal.set_wakeup_fd(signalled, warn_on_full_buffer=False)

    try:
        yield listen
    finally:
        signal.set_wakeup_fd(-1)
        faulthandler.unregister(signal.SIGUSR1)
        os.close(signalled)
        os.close(trace)
        with suppress(ChildProcessError):
            os.waitpid(watcher, 0)


def _on_signals(handler: Callable[[int, FrameType | None], None]) -> None:
    for number in handled_signals():
        signal.signal(number, handler)


def _watch(process: int, signals: int, traced: int, name: str) -> None:
    """Read signals in the watching process until the watched one has ended or must be killed."""
    for number in (*STOP_SIGNALS, signal.SIGQUIT):
        signal.signal(number, signal.SIG_IGN)
    until_s: float | None = None
    has_reacted = is_repeated = has_waited = False
    while True:
        left_s = None if until_s is None or has_waited else max(until_s - time.monotonic(), 0.0)
        if not select.select([signals], [], [], left_s)[0]:
            has_waited = True
            if not is_repeated or has_reacted:
                is_repeated = False
                _print(name, f"still busy: {_where(process, traced)}; once more (Ctrl-C) ends it at once")
        elif not (data := os.read(signals, 64)):
            return
        else:
            has_reacted = has_reacted or REACTED in data
            for _ in range(sum(data.count(number) for number in STOP_SIGNALS)):
                is_repeated = until_s is not None
                until_s = until_s or time.monotonic() + REACTION_LIMIT_S
        if has_waited and is_repeated:
            _print(name, f"ended at once by a second signal: {_where(process, traced)}")
            os.kill(process, signal.SIGKILL)
            return


def _where(process: int, traced: int) -> str:
    """Return the place of the process in its program, for messages."""
    os.kill(process, signal.SIGUSR1)
    trace, until_s = b"", time.monotonic() + TRACE_S
    while (left_s := until_s - time.monotonic()) > 0 and select.select([traced], [], [], left_s)[0]:
        piece = os.read(traced, 1 << 16)
        trace += piece
        if not piece:
            break
        # A trace comes in many small pieces, without an end mark.
        until_s = min(until_s, time.monotonic() + TRACE_S / 6)
    place = place_in_trace(trace)
    if place is None:
        return "it does not come to an end"
    return f"a call in line {place[1]} of the program {place[0]} does not come back"


def _print(name: str, text: str) -> None:
    with suppress(OSError):
        os.write(sys.stderr.fileno(), f"{name}: {shown(text)}\n".encode())
