"""Serves the studio from its start until a signal ends it."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import threading
import webbrowser
from contextlib import suppress
from pathlib import Path
from types import FrameType

from elitescript.errors import UsageError
from elitescript.studio.files import Programs
from elitescript.studio.outbox import Outbox
from elitescript.studio.server import Door
from elitescript.studio.session import Session


def serve_studio(path: Path, port: int, *, opens_browser: bool) -> int:
    """Serve until SIGINT or SIGTERM; return the exit code.

    Raises:
        UsageError: nothing can be served; nothing has been started then.
    """
    programs = Programs(path)

    async def begin(outbox: Outbox) -> Session:
        session = Session(programs, outbox)
        await session.begin()
        return session

    asyncio.run(_serve(Door(begin), port, opens_browser=opens_browser))
    return 0


async def _serve(door: Door, port: int, *, opens_browser: bool) -> None:
    stop = asyncio.Event()
    _on_signals(stop)
    try:
        await door.open(port)
    except OSError as error:
        raise UsageError(f"--port {port}: {error.strerror or error}") from None
    try:
        print(f"ready {door.address}", flush=True)
        if opens_browser:
            _open_browser(door.ticket_address())
        await stop.wait()
    finally:
        await door.close()


def _open_browser(address: str) -> None:
    if sys.platform == "linux" and not {"DISPLAY", "WAYLAND_DISPLAY", "BROWSER"} & os.environ.keys():
        # What is there without a screen are browsers that take the terminal.
        return
    # Some browsers are waited for, and one that hangs must not keep the studio from ending.
    threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()


def _on_signals(stop: asyncio.Event) -> None:
    loop = asyncio.get_running_loop()

    def react(_number: int, _frame: FrameType | None) -> None:
        with suppress(RuntimeError):
            # The loop is closed: it has stopped already.
            loop.call_soon_threadsafe(stop.set)

    for number in (signal.SIGINT, signal.SIGTERM):
        try:
            loop.add_signal_handler(number, stop.set)
        except NotImplementedError:
            signal.signal(number, react)
