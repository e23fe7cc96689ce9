"""The source of a page that writes programs: every text is checked, and run in virtual time."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from elitescript import __version__
from elitescript.conversation.describe import LIVE_ABILITIES, Message, hello
from elitescript.conversation.messages import Detail, GoOn, Program, Record, Seek, Step, Stop, ToSource
from elitescript.errors import UsageError
from elitescript.records import NamedTuple
from elitescript.studio.live.engine import LiveEngine, Setting
from elitescript.studio.opened import OpenFile

Send = Callable[[Mapping[str, Any] | bytes], None]


class _Page(NamedTuple):
    """What texts are run for.

    Attributes:
        file: that the page has open.
        room: returns when the page has read enough for more.
    """

    file: OpenFile
    room: Callable[[], Awaitable[None]]


class LiveSource:
    """The live runs of one page.

    Args:
        title: of the page.
        setting: what the command line says of the robot.
        urdf: name of the user's own description of the arm; empty without one.
    """

    __slots__ = ("_engine", "_page", "_send", "_starting", "_title", "_urdf")

    def __init__(self, title: str, setting: Setting, urdf: str = "") -> None:
        self._title = title
        self._urdf = urdf
        self._engine = LiveEngine(self._pass_on, self._pass_on, setting)
        self._starting: asyncio.Task[None] | None = None
        self._page: _Page | None = None
        self._send: Send | None = None

    def prepare(self) -> None:
        """Begin to start processes, which takes longer than a page takes to its first text."""
        if self._starting is None:
            self._starting = asyncio.create_task(self._engine.start())

    def belong_to(self, file: OpenFile, room: Callable[[], Awaitable[None]]) -> None:
        """Take the page for which texts are run.

        Args:
            file: that it has open.
            room: returns when the page has read enough for more; a run waits for that.
        """
        self._page = _Page(file, room)

    async def start(self, send: Send) -> None:
        """Send `hello`; what a text is and does comes with the first one."""
        self._send = send
        self.prepare()
        send(hello("live", f"elitescript {__version__}", LIVE_ABILITIES, self._title))

    async def take(self, message: ToSource) -> None:
        """Do what the page asks for.

        Raises:
            UsageError: it is for a controller.
        """
        engine = self._engine
        match message:
            case Program():
                if self._page is not None:
                    file = self._page.file
                    engine.name, engine.folder, engine.task = file.name, file.folder, file.task
                await engine.program(message)
            case GoOn():
                await engine.go_on(message)
            case Stop():
                await engine.stop()
            case Detail():
                await engine.detail(message)
            case Seek():
                await engine.seek(message)
            case Step():
                await engine.step(message)
            case Record():
                await engine.record(message)
            case _:
                raise UsageError("a live run has no controller: start the studio with --connect")

    async def close(self) -> None:
        """End all processes."""
        if self._starting is not None:
            await asyncio.gather(self._starting, return_exceptions=True)
        await self._engine.close()

    async def _pass_on(self, message: Message | bytes) -> None:
        if self._page is not None:
            await self._page.room()
        if self._send is None:
            return
        if self._urdf and isinstance(message, dict) and message["type"] == "scene":
            message = {**message, "urdf": self._urdf}
        self._send(message)
