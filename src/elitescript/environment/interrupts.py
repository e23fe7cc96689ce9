"""Ctrl-C while a program runs in this process."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_passed_to(interrupt: Callable[[], None]) -> Iterator[None]:
    """Let Ctrl-C end the run at its next checkpoint and then raise KeyboardInterrupt; a second one raises it at once.

    Only where Python's own handler would have had it: a caller with a handler of its own keeps it.
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler or not _is_in_main_thread():
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


def _is_in_main_thread() -> bool:
    # `elitescript run` has a handler of its own, and no need of this module.
    from threading import current_thread, main_thread

    return current_thread() is main_thread()
