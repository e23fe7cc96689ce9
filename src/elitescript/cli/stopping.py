"""Ends a command that waits, by Ctrl-C or SIGTERM."""

from __future__ import annotations

import asyncio
import signal


def stop_by_signals() -> asyncio.Event:
    """Return an event of the running loop that SIGINT and SIGTERM set, in place of what they do otherwise."""
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        try:
            loop.add_signal_handler(number, stop.set)
        except NotImplementedError:
            # The loop of Windows has none.
            signal.signal(number, lambda *_: loop.call_soon_threadsafe(stop.set))
    return stop
