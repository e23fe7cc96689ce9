"""The signals that ask a process to end: Ctrl-C, the end of a service, the end of a terminal.

They reach every process of a terminal, of `timeout` or of a service at once. A process that helps another one leaves
them to it: it ends with the other, and is not to be taken for one that has crashed.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final, Never

STOP_SIGNALS: Final = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Those that this system has."""

SIGPIPE: Final = 13
"""Number of the signal that ends a process whose reader has gone; Windows has no name for it."""


class Stopped(KeyboardInterrupt):
    """A process is to end as by a signal, from wherever it is.

    Args:
        number: of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def cause_of(stop: KeyboardInterrupt) -> str:
    """Return what has ended a process, for messages."""
    number = getattr(stop, "number", signal.SIGINT)
    if number == signal.SIGINT:
        return "Ctrl-C"
    return "the end of its reader" if number == SIGPIPE else signal.Signals(number).name


def exit_code_of(stop: KeyboardInterrupt) -> int:
    """Return the exit code of a process that a signal has ended, as shells count it."""
    return 128 + int(getattr(stop, "number", signal.SIGINT))


def leave(number: int, frame: FrameType | None = None) -> Never:
    """Leave what the main thread does, as the handler of a signal.

    Raises:
        KeyboardInterrupt: at Ctrl-C.
        Stopped: at the others.
    """
    if number == signal.SIGINT:
        signal.default_int_handler(number, frame)
    raise Stopped(number)


def leave_by_signals() -> None:
    """Let the signals to stop raise `Stopped` in the main thread, and Ctrl-C KeyboardInterrupt as always."""
    for number in handled_signals():
        signal.signal(number, leave)


def handled_signals() -> tuple[signal.Signals, ...]:
    """Return those that this process is to handle: all, but for the end of a terminal if it was started by `nohup`.

    Shells have what they start in the background ignore Ctrl-C, too; that is no wish of a user.
    """
    hung_up = getattr(signal, "SIGHUP", None)
    return tuple(
        number for number in STOP_SIGNALS if number != hung_up or signal.getsignal(number) is not signal.SIG_IGN
    )


@contextmanager
def held_back() -> Iterator[None]:
    """Keep the signals from this thread, and from a process that is started meanwhile until it calls `ignore`."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOP_SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore() -> None:
    """Leave the signals to the process that has started this one, from its start on if it has used `held_back`."""
    for number in STOP_SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)
