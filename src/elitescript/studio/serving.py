"""Serves the studio from its start until a signal ends it."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import threading
import webbrowser
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import Any, Final

from elitescript.environment.collecting import Collector
from elitescript.errors import UsageError
from elitescript.kernel.options import robot_options
from elitescript.studio.connected.controller import ConnectedController
from elitescript.studio.connected.source import ConnectedSource
from elitescript.studio.connected.target import Target
from elitescript.studio.files import Programs, read
from elitescript.studio.live_source import LiveSource
from elitescript.studio.memory import Memory, state_folder
from elitescript.studio.meshes import Meshes
from elitescript.studio.outbox import Outbox
from elitescript.studio.server import Door
from elitescript.studio.session import Session, Source, Workplace
from elitescript.world_file import load_world_file

SWITCH_S: Final = 0.0005
"""Time for which a thread holds the interpreter while another one waits for it, s."""


def workplace(path: Path, given: Mapping[str, Any], world: str | None, urdf: str | None) -> Workplace:
    """Return what the command line names, looked at.

    Args:
        path: of a program or a folder.
        given: options of the robot.
        world: path of the world file; None without one.
        urdf: path of a description of the arm; None without one.

    Raises:
        UsageError: something of it makes no sense.
    """
    programs = Programs(path)
    if programs.only is not None:
        read(programs.path(programs.only))
    robot_options(given, {} if world is None else load_world_file(world).options)
    return Workplace(
        programs,
        Memory(state_folder()),
        given,
        None if world is None else Path(world).resolve(),
        None if urdf is None else Meshes(Path(urdf)),
    )


def serve_studio(place: Workplace, port: int, target: Target | None = None, *, opens_browser: bool) -> int:
    """Serve until SIGINT or SIGTERM; return the exit code.

    Args:
        place: what all pages share.
        port: of this computer; 0 is any free one.
        target: the controller that is shown; None for live runs.
        opens_browser: whether the page is opened.

    Raises:
        UsageError: the port cannot be had.
    """
    # The threads of editor services give way to the next message soon.
    sys.setswitchinterval(SWITCH_S)
    asyncio.run(_serve(place, port, target, opens_browser=opens_browser))
    return 0


async def _serve(place: Workplace, port: int, target: Target | None, *, opens_browser: bool) -> None:
    controller = None if target is None else ConnectedController(target)

    async def begin(outbox: Outbox) -> Session:
        session = Session(place, source(), outbox.put)
        await session.begin()
        return session

    def source() -> Source:
        if controller is not None:
            return ConnectedSource(controller)
        return LiveSource(place.programs.title, place.given, "" if place.meshes is None else place.meshes.name)

    door = Door(begin, Collector().message_came)
    stop = asyncio.Event()
    _on_signals(stop)
    try:
        await door.open(port)
    except OSError as error:
        raise UsageError(f"--port {port}: {error.strerror or error}") from None
    try:
        if controller is not None:
            await controller.open()
        print(f"ready {door.address}", flush=True)
        if opens_browser:
            _open_browser(door.ticket_address())
        await stop.wait()
    finally:
        await door.close()
        if controller is not None:
            await controller.close()


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
