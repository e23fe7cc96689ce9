"""Ends a command that waits, by Ctrl-C or another signal that asks for its end."""

from __future__ import annotations

import asyncio
import signal

from elitescript.environment.stop_signals import handled_signals


def stop_by_signals() -> asyncio.Event:
    """Return an event of the running loop that the signals to stop set, in place of what they do otherwise."""
    stop = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in handled_signals():
        try:
            loop.add_signal_handler(number, stop.set)
        except NotImplementedError:
            # The loop of Windows has none.
            signal.signal(number, lambda *_: loop.call_soon_threadsafe(stop.set))
    return stop
