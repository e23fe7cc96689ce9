"""The signals that ask a process to end: Ctrl-C, the end of a service, the end of a terminal.

They reach every process of a terminal, of `timeout` or of a service at once. A process that helps another one leaves
them to it: it ends with the other, and is not to be taken for one that has crashed.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

STOP_SIGNALS: Final = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Those that this system has."""


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
