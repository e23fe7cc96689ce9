"""Ctrl-C while a program runs in this process."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread


@contextmanager
def interrupts_passed_to(interrupt: Callable[[], None]) -> Iterator[None]:
    """Let Ctrl-C end the run at its next checkpoint and then raise KeyboardInterrupt; a second one raises it at once.

    Only where Python's own handler would have had it: a caller with a handler of its own keeps it.
    """
    if current_thread() is not main_thread() or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    happened = False

    def handle(_number: int, _frame: object) -> None:
        nonlocal happened
        happened = True
        signal.signal(signal.SIGINT, signal.default_int_handler)
        interrupt()

    signal.signal(signal.SIGINT, handle)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if happened:
        raise KeyboardInterrupt
