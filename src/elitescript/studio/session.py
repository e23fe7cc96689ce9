"""The conversation with one page: its file, its texts, and what answers it.

A source runs the texts, or shows a controller; files, drafts and editor services are the same whichever it is. What
takes long goes on beside the next messages: a check must not wait for a disk.
"""

from __future__ import annotations

import asyncio
import traceback
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any, Final, Protocol

from elitescript.conversation.describe import notice, refused
from elitescript.conversation.fields import MessageError
from elitescript.conversation.messages import Open, Program, Save, Service, Settings, ToSource, ask_of, read_message
from elitescript.conversation.trees import with_task
from elitescript.errors import UsageError
from elitescript.models.datafile import check_name
from elitescript.models.model import is_model_file, model_names
from elitescript.paths import PROGRAM_SUFFIX
from elitescript.records import NamedTuple, replace
from elitescript.studio.files import Programs
from elitescript.studio.last_runs import LastRuns
from elitescript.studio.memory import Memory
from elitescript.studio.meshes import Meshes
from elitescript.studio.opened import OpenFile
from elitescript.studio.services import PROGRAM_NAME, EditorServices, Place
from elitescript.world_file import names_arm

WAITING_MAX: Final = 64
"""Requests to editor services that wait for an answer; further ones are refused."""

Send = Callable[[Mapping[str, Any] | bytes], None]


class Source(Protocol):
    """What runs the texts of a page, or shows it a controller."""

    async def start(self, send: Send) -> None:
        """Send `hello`, `scene` and what is known, then every change; `send` does not block."""

    async def take(self, message: ToSource) -> None:
        """Do what a page asks for.

        Raises:
            UsageError: it cannot be done.
        """

    async def close(self) -> None:
        """End everything that was begun for this page."""


class Workplace(NamedTuple):
    """What all pages share.

    Attributes:
        programs: that may be opened; None if there is nothing to write.
        memory: of drafts and settings.
        given: options of the robot on the command line.
        world: path of the world file of the command line; None without one.
        meshes: of the arm; None without a URDF.
    """

    programs: Programs | None
    memory: Memory
    given: Mapping[str, Any]
    world: Path | None = None
    meshes: Meshes | None = None


class Session:
    """One page.

    Args:
        place: that it shares with other pages.
        source: of this page.
        file: that it has open; None if there is nothing to write.
        send: sends it a message.
    """

    def __init__(self, place: Workplace, source: Source, file: OpenFile | None, send: Send) -> None:
        self._place = place
        self._source = source
        self._send = send
        self._services = EditorServices(place.given, place.world, place.meshes)
        self._last_runs = LastRuns(self._services.ran)
        self._file = file
        self._names: list[str] = []
        """Programs that can be opened."""
        self._is_checked_here = False
        """Whether the source does not check texts."""
        self._beside: set[asyncio.Task[None]] = set()
        """What goes on beside the next messages."""
        self._saving: asyncio.Task[None] | None = None
        """The last save."""
        self._asked = 0

    async def begin(self) -> None:
        """Send what a page begins with."""
        if self._place.programs is not None:
            self._names = await asyncio.to_thread(self._place.programs.names)
        await self._source.start(self._from_source)
        if self._file is not None:
            await self._file.open_first()
            self._let(None, self._file.watch)

    async def take(self, text: str | bytes) -> None:
        """Take a message of the page; what is wrong with it is answered."""
        try:
            message = read_message(text)
        except MessageError as error:
            self._send(refused(str(error), ask_of(text)))
            return
        ask: int | None = getattr(message, "ask", None)
        await self._do(ask, self._dispatch, message)

    async def close(self) -> None:
        """End everything that goes on for the page; its unsaved text is kept."""
        await self._saved()
        for task in self._beside:
            task.cancel()
        await asyncio.gather(*self._beside, return_exceptions=True)
        self._services.close()
        try:
            if self._file is not None:
                await self._file.close()
        finally:
            await self._source.close()

    @property
    def _opened(self) -> OpenFile:
        """The file of the page.

        Raises:
            UsageError: there is nothing to write.
        """
        if self._file is None:
            raise UsageError("no program is open: start the studio with a file or a folder")
        return self._file

    # ---------------------------------------------------------------- messages of the page

    async def _dispatch(self, message: ToSource) -> None:
        match message:
            case Program():
                await self._program(message)
            case Service():
                if self._asked >= WAITING_MAX:
                    raise UsageError(f"{WAITING_MAX} requests wait for an answer")
                self._asked += 1
                self._let(message.ask, self._answer, message)
            case Save():
                self._saving = self._let(message.ask, self._opened.save, message)
            case Open():
                await self._saved()
                # Texts that come next are of this file.
                await self._opened.open(message.name)
                self._send({"type": "done", "ask": message.ask})
            case Settings():
                self._let(None, self._keep_settings, message.values)
            case _:
                await self._source.take(message)

    async def _saved(self) -> None:
        """Wait until every text that is to be saved has been: it is of the file that is open now."""
        if self._saving is not None:
            await asyncio.wait({self._saving})

    async def _program(self, message: Program) -> None:
        given = message.options
        world = self._inside(given.world) if given.world else None
        # An arm of the command line may be anywhere; it is used if the page leaves it out.
        robot = None if given.robot == self._place.given.get("model") else given.robot
        if robot is not None:
            check_name(robot)
        if robot is not None and is_model_file(robot):
            robot = str(self._inside(robot))
        file = self._opened
        if robot is None:
            robot = self._arm_of(file, world)
        file.edited(message.text)
        self._last_runs.program(message.version, message.text)
        options = {"model": robot, "firmware": given.firmware}
        chosen = {name: value for name, value in options.items() if value is not None}
        name = PROGRAM_NAME if file.task is None else f"{file.name}{PROGRAM_SUFFIX}"
        self._services.put(message.version, message.text, chosen, world, name)
        if self._is_checked_here:
            self._let(None, self._check, message.version)
        else:
            located = replace(given, robot=robot, world=given.world if world is None else str(world))
            await self._source.take(replace(message, options=located))

    def _arm_of(self, file: OpenFile, world: Path | None) -> str | None:
        """Return the arm for which a graphical program was made, if nothing names another one."""
        task = file.task
        if task is None or task.program is None or "model" in self._place.given:
            return None
        beside = world or self._place.world
        if task.program.arm not in model_names() or (beside is not None and names_arm(beside)):
            return None
        return task.program.arm

    async def _check(self, version: int) -> None:
        for are_all in (False, True):
            if (found := await self._services.problems(version, are_all=are_all)) is not None:
                self._send(with_task(found, self._opened.task))

    async def _answer(self, asked: Service) -> None:
        try:
            place = Place(asked.line, asked.column, asked.arguments)
            result = await self._services.answer(asked.service, asked.version, place)
        finally:
            self._asked -= 1
        self._send({"type": "answer", "ask": asked.ask, "result": result})

    async def _keep_settings(self, values: Mapping[str, Any]) -> None:
        try:
            await asyncio.to_thread(self._place.memory.keep_settings, values)
        except (OSError, ValueError) as error:
            raise UsageError(f"the settings of the page are not kept: {error}") from None

    def _inside(self, name: str) -> Path:
        """Return the path of a file that the page names: what is read here must be the user's choice.

        Raises:
            UsageError: it is neither in the folder of the program nor the world file of the command line.
        """
        folder = self._opened.folder
        try:
            path = (folder / name).resolve()
        except (OSError, ValueError, RuntimeError) as error:
            raise UsageError(f"{name!r:.200} is no path: {error}") from None
        if path != self._place.world and not path.is_relative_to(folder):
            raise UsageError(f"{name!r:.200} is outside {folder}; name it on the command line")
        return path

    # ---------------------------------------------------------------- messages of the source

    def _from_source(self, message: Mapping[str, Any] | bytes) -> None:
        if isinstance(message, bytes):
            self._send(message)
        elif message["type"] == "hello":
            self._send(self._hello(message))
        else:
            self._last_runs.take(message)
            self._send(message)

    def _hello(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Return the greeting of the source with what is beside it."""
        abilities = [*message["abilities"], "services"]
        given: dict[str, Any] = {"settings": self._place.memory.settings()}
        if self._place.programs is not None:
            self._is_checked_here = "edit" not in abilities
            abilities += ["edit", "save"]
            given["programs"] = message.get("programs") or self._names
        return {**message, **given, "abilities": list(dict.fromkeys(abilities))}

    # ---------------------------------------------------------------- failures

    def _let(self, ask: int | None, work: Callable[..., Awaitable[None]], *given: Any) -> asyncio.Task[None]:
        """Let something go on beside the next messages; return its task."""
        task = asyncio.create_task(self._do(ask, work, *given))
        self._beside.add(task)
        task.add_done_callback(self._beside.discard)
        return task

    async def _do(self, ask: int | None, work: Callable[..., Awaitable[None]], *given: Any) -> None:
        """Do something; the page reads what is wrong, and an error of ours is printed with its place."""
        try:
            await work(*given)
        except UsageError as error:
            self._send(notice("warning", str(error)) if ask is None else refused(str(error), ask))
        except Exception as error:
            traceback.print_exc()
            self._send(refused(f"internal error: {type(error).__name__}: {error}", ask))
