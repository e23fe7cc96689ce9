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
from elitescript.models.model import load_model
from elitescript.paths import PROGRAM_SUFFIX, is_program_name, real_path
from elitescript.studio.connected.controller import ConnectedController
from elitescript.studio.connected.source import ConnectedSource
from elitescript.studio.connected.target import Target
from elitescript.studio.files import Programs, read_any
from elitescript.studio.live.engine import Setting
from elitescript.studio.live_source import LiveSource
from elitescript.studio.memory import Memory, state_folder
from elitescript.studio.meshes import Meshes
from elitescript.studio.opened import OpenFile
from elitescript.studio.outbox import Outbox
from elitescript.studio.server import Door
from elitescript.studio.session import Session, Source, Workplace
from elitescript.world_file import load_world_file

SWITCH_S: Final = 0.0005
"""Time for which a thread holds the interpreter while another one waits for it, s."""


def workplace(path: str | None, given: Mapping[str, Any], world: str | None, urdf: str | None) -> Workplace:
    """Return what the command line names, looked at.

    Args:
        path: of a program or a folder; None if there is nothing to write.
        given: options of the robot.
        world: path of the world file; None without one.
        urdf: path of a description of the arm; None without one.

    Raises:
        UsageError: something of it makes no sense.
    """
    programs = None if path is None else Programs(Path(path))
    if programs is not None and programs.only is not None:
        found = read_any(programs.path(programs.only), programs.folder)
        if not found.digest and not is_program_name(programs.only):
            raise UsageError(f"{path}: there is no such file or folder; a new program is a {PROGRAM_SUFFIX} file")
    load_model(robot_options(given, {} if world is None else load_world_file(world).options).model)
    return Workplace(
        programs,
        Memory(state_folder()),
        given,
        None if world is None else real_path(world),
        None if urdf is None else Meshes(Path(urdf)),
    )


def serve_studio(
    place: Workplace,
    port: int,
    target: Target | None = None,
    *,
    opens_browser: bool,
    ends_with_input: bool = False,
) -> int:
    """Serve until SIGINT, SIGTERM or SIGHUP; return the exit code.

    Args:
        place: what all pages share.
        port: of this computer; 0 is any free one.
        target: the controller that is shown; None for live runs.
        opens_browser: whether the page is opened.
        ends_with_input: whether the end of standard input ends it too.

    Raises:
        UsageError: the port cannot be had.
    """

    asyncio.run(_serve(place, port, target, opens_browser=opens_browser, ends_with_input=ends_with_input))
    return 0


async def _serve(
    place: Workplace, port: int, target: Target | None, *, opens_browser: bool, ends_with_input: bool
) -> None:
    controller = None if target is None else ConnectedController(target)
    ready: list[LiveSource] = []
    """A source whose processes are started before there is a page."""

    async def begin(outbox: Outbox) -> Session:
        file = None if place.programs is None else OpenFile(place.programs, place.memory, outbox.put)
        session = Session(place, source(outbox, file), file, outbox.put)
        await session.begin()
        return session

    def source(outbox: Outbox, file: OpenFile | None) -> Source:
        if controller is not None:
            return ConnectedSource(controller)
        live = ready.pop() if ready else _live_source(place)
        if file is not None:
            live.belong_to(file, outbox.room)
        return live

    door = Door(begin)
    stop = asyncio.Event()
    _on_signals(stop)
    if ends_with_input:
        loop = asyncio.get_running_loop()
        threading.Thread(target=_wait_for_end, args=(loop, stop), daemon=True).start()
    try:
        await door.open(port)
    except OSError as error:
        raise UsageError(f"--port {port}: {error.strerror or error}") from None
    door.heard = Collector().message_came
    # The threads of editor services give way to the next message soon.
    sys.setswitchinterval(SWITCH_S)
    try:
        if controller is not None:
            await controller.open()
        else:
            ready.append(_live_source(place))
            ready[0].prepare()
        print(f"ready {door.address}", flush=True)
        if opens_browser:
            _open_browser(door.ticket_address())
        await stop.wait()
    finally:
        await door.close()
        for unused in ready:
            await unused.close()
        if controller is not None:
            await controller.close()


def _live_source(place: Workplace) -> LiveSource:
    title = "" if place.programs is None else place.programs.title
    return LiveSource(title, Setting(place.given, place.world), "" if place.meshes is None else place.meshes.name)


def _open_browser(address: str) -> threading.Thread | None:
    """Open a page in the user's browser; None if there is no screen for one."""
    if sys.platform == "linux" and not {"DISPLAY", "WAYLAND_DISPLAY", "BROWSER"} & os.environ.keys():
        # What is there without a screen are browsers that take the terminal.
        return None
    # Some browsers are waited for, and one that hangs must not keep the studio from ending.
    opening = threading.Thread(target=webbrowser.open, args=(address,), daemon=True)
    opening.start()
    return opening


def _wait_for_end(loop: asyncio.AbstractEventLoop, stop: asyncio.Event) -> None:
    """Read standard input to its end, then set the event of a loop."""
    while os.read(sys.stdin.fileno(), 4096):
        pass
    with suppress(RuntimeError):
        # The loop is closed: it has stopped already.
        loop.call_soon_threadsafe(stop.set)


def _on_signals(stop: asyncio.Event) -> None:
    loop = asyncio.get_running_loop()

    def react(_number: int, _frame: FrameType | None) -> None:
        with suppress(RuntimeError):
            # The loop is closed: it has stopped already.
            loop.call_soon_threadsafe(stop.set)

    numbers = [signal.SIGINT, signal.SIGTERM]
    if sys.platform != "win32" and signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        # The terminal is closed; with `nohup` that is ignored.
        numbers.append(signal.SIGHUP)
    for number in numbers:
        try:
            loop.add_signal_handler(number, stop.set)
        except NotImplementedError:
            signal.signal(number, react)
