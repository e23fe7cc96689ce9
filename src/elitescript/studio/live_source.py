"""The source of a page that writes programs: every text is checked, and run in virtual time."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from elitescript import __version__
from elitescript.conversation.describe import LIVE_ABILITIES, Message, hello
from elitescript.conversation.messages import Detail, GoOn, Program, Seek, Step, Stop, ToSource
from elitescript.errors import UsageError
from elitescript.studio.live.engine import LiveEngine, Setting
from elitescript.studio.opened import OpenFile

Send = Callable[[Mapping[str, Any] | bytes], None]


class LiveSource:
    """The live runs of one page.

    Args:
        title: of the page.
        setting: what the command line says of the robot.
        file: of the page.
        room: returns when the page has read enough for more; a run waits for that.
        urdf: name of the user's own description of the arm; empty without one.
    """

    def __init__(
        self, title: str, setting: Setting, file: OpenFile, room: Callable[[], Awaitable[None]], urdf: str = ""
    ) -> None:
        self._title = title
        self._file = file
        self._room = room
        self._urdf = urdf
        self._engine = LiveEngine(self._pass_on, self._pass_on, setting)
        self._send: Send | None = None

    async def start(self, send: Send) -> None:
        """Send `hello`, and begin to start processes; what a text is and does comes with the first one."""
        self._send = send
        send(hello("live", f"elitescript {__version__}", LIVE_ABILITIES, self._title))
        await self._engine.start()

    async def take(self, message: ToSource) -> None:
        """Do what the page asks for.

        Raises:
            UsageError: it is for a controller.
        """
        engine = self._engine
        match message:
            case Program():
                engine.name, engine.folder = self._file.name, self._file.folder
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
            case _:
                raise UsageError("a live run has no controller: start the studio with --connect")

    async def close(self) -> None:
        """End all processes."""
        await self._engine.close()

    async def _pass_on(self, message: Message | bytes) -> None:
        assert self._send is not None
        await self._room()
        is_scene = isinstance(message, dict) and message["type"] == "scene"
        self._send({**message, "urdf": self._urdf} if is_scene and self._urdf else message)  # type: ignore[dict-item]
