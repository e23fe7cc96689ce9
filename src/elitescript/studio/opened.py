"""The program that a page has open: read, watched, written, and its unsaved text kept.

Nothing here decides for people: a change on disk is reported, a save over it is refused with both texts, and a draft is
offered beside the file.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from elitescript.assist.generated import refusal
from elitescript.conversation.describe import notice, refused
from elitescript.conversation.messages import Save
from elitescript.conversation.trees import tree
from elitescript.environment.task_files import OpenedTask
from elitescript.errors import UsageError
from elitescript.studio.files import NONE, Conflict, Found, Programs, read_any, save, stamp
from elitescript.studio.memory import Memory, new_owner

LOOK_EVERY_S: Final = 0.5
"""Time between two looks whether the file has changed on disk, s."""

DRAFT_S: Final = 0.3
"""Time after which a text that was not saved is kept, s; from its first change on, so that typing does not delay it."""


class OpenFile:
    """The file of one page.

    Args:
        programs: that may be opened.
        memory: for drafts.
        send: sends the page a message.
    """

    __slots__ = (
        *("_drafted", "_has_warned", "_keeping", "_lock", "_memory", "_offered", "_on_disk", "_owner", "_path"),
        *("_programs", "_seen", "_send", "_stamp", "_text", "name"),
    )

    def __init__(self, programs: Programs, memory: Memory, send: Callable[[Mapping[str, Any]], None]) -> None:
        self._programs = programs
        self._memory = memory
        self._send = send
        self._owner = new_owner()
        self._lock = asyncio.Lock()
        """Held while the file or the draft is read or written: `open` changes which file it is."""
        self.name = ""
        self._path: Path | None = None
        self._on_disk: Found = NONE
        """The file as the page has last been sent it."""
        self._stamp: tuple[object, ...] = ()
        """What differs after every change of the file and of those beside it."""
        self._seen = ""
        """Digest of the file that the text was made of."""
        self._text: str | None = None
        """The newest text of the page; None before the first one."""
        self._drafted: str | None = None
        """The text that is kept as a draft of this conversation."""
        self._offered = ""
        """Conversation of the draft that the page was offered."""
        self._keeping: asyncio.Task[None] | None = None
        self._has_warned = False

    @property
    def folder(self) -> Path:
        """The folder of the file, which its program reads and writes files in."""
        return self._programs.folder if self._path is None else self._path.parent

    @property
    def task(self) -> OpenedTask | None:
        """The graphical program, if it is one."""
        return self._on_disk.task

    def _read(self, path: Path) -> tuple[Found, tuple[object, ...]]:
        """Return a file, and the stamps of what it is made of as they were before it was read."""
        known = self._on_disk.paths
        before = _stamps(path, known)
        found = read_any(path, self._programs.folder)
        # What is beside a task is known once it has been read.
        return found, before if found.paths == known else (before[0], *_stamps(path, found.paths)[1:])

    async def open_first(self) -> None:
        """Open the first program that can be read; a new one if there is none."""
        for name in await asyncio.to_thread(self._programs.first_names):
            try:
                await self.open(name)
            except UsageError as error:
                self._send(notice("warning", str(error)))
            else:
                return

    async def open(self, name: str) -> None:
        """Open a program, and send it to the page.

        Raises:
            UsageError: it cannot be opened; the one before stays open.
        """
        async with self._lock:
            path = self._programs.path(name)
            found, seen = await asyncio.to_thread(self._read, path)
            drafts = () if found.task else await asyncio.to_thread(self._memory.drafts, path)
            await self._keep()
            self.name, self._path, self._stamp = name, path, seen
            self._on_disk, self._seen = found, found.digest
            self._text = self._drafted = None
            self._offered = ""
            message: dict[str, Any] = {"type": "file", "name": name, **_shown(found)}
            if not found.digest:
                message["is_new"] = True
            if draft := next((draft for draft in drafts if draft.text != found.text), None):
                self._offered = draft.owner
                message["draft"] = {"text": draft.text, "seen": draft.seen, "at": draft.at}
            self._send(message)

    def edited(self, text: str) -> None:
        """Take a text of the page; it is kept soon if it differs from the file."""
        if self.task is not None:
            return
        self._text = text
        if self._keeping is None or self._keeping.done():
            self._keeping = asyncio.create_task(self._keep_soon())

    async def save(self, asked: Save) -> None:
        """Write the file and answer the page."""
        async with self._lock:
            path = self._path
            if path is None:
                self._send(refused("no program is open", asked.ask))
                return
            if self.task is not None:
                self._send(refused(refusal(self.task.source.name), asked.ask))
                return
            try:
                digest = await asyncio.to_thread(save, path, asked.text, asked.seen, force=asked.force)
            except Conflict as error:
                found = error.found
                self._send(refused(str(error), asked.ask, {"text": found.text, "digest": found.digest}))
                return
            except UsageError as error:
                self._send(refused(str(error), asked.ask))
                return
            self._stamp = await asyncio.to_thread(_stamps, path)
            self._on_disk, self._seen = Found(_with_lf(asked.text), digest), digest
            self._send({"type": "saved", "ask": asked.ask, "digest": digest})
            await self._drop_drafts(path)

    async def watch(self) -> None:
        """Report changes on disk until this is cancelled."""
        while True:
            await asyncio.sleep(LOOK_EVERY_S)
            await self.look()

    async def look(self) -> None:
        """Report a change on disk, if there is one."""
        async with self._lock:
            path = self._path
            beside = self._on_disk.paths
            if path is None or (now := await asyncio.to_thread(_stamps, path, beside)) == self._stamp:
                return
            try:
                found, self._stamp = await asyncio.to_thread(self._read, path)
            except UsageError as error:
                self._stamp = now
                self._send(notice("warning", f"{self.name} has changed on disk: {error}"))
                return
            if found.digest == self._on_disk.digest:
                return
            if not found.digest:
                # What it was stays known: a tool that saves may remove it for a moment.
                self._send({"type": "file_changed", "name": self.name, "digest": ""})
                self._on_disk = found._replace(task=self.task)
                return
            self._on_disk = found
            self._send({"type": "file_changed", "name": self.name, **_shown(found)})

    async def close(self) -> None:
        """Keep the unsaved text."""
        if self._keeping is not None:
            self._keeping.cancel()
            with suppress(asyncio.CancelledError):
                await self._keeping
        await self._keep()

    # ---------------------------------------------------------------- drafts

    async def _keep_soon(self) -> None:
        text: str | None = None
        while text != self._text:
            await asyncio.sleep(DRAFT_S)
            async with self._lock:
                text = self._text
                await self._keep()

    async def _keep(self) -> None:
        """Keep the newest text if it differs from the file; remove the draft if it does no more."""
        path, text = self._path, self._text
        if path is None or text is None or text == self._drafted:
            return
        try:
            if text == self._on_disk.text:
                self._seen = self._on_disk.digest
                if self._drafted is not None:
                    await asyncio.to_thread(self._memory.drop, path, self._owner)
                    self._drafted = None
            else:
                await asyncio.to_thread(self._memory.keep, path, text, self._seen, self._owner)
                self._drafted = text
        except OSError as error:
            if not self._has_warned:
                self._has_warned = True
                self._send(notice("warning", f"unsaved text cannot be kept: {error.strerror or error}"))

    async def _drop_drafts(self, path: Path) -> None:
        """Remove the drafts that the file has made worthless: of this conversation, the offered one, and same texts."""
        owners = {self._owner, self._offered} - {""}
        try:
            same = await asyncio.to_thread(self._memory.drafts, path)
            owners |= {draft.owner for draft in same if draft.text == self._on_disk.text}
            await asyncio.to_thread(self._memory.drop, path, *owners)
        except OSError as error:
            self._send(notice("warning", f"an old draft stays: {error.strerror or error}"))
        self._drafted, self._offered = None, ""


def _stamps(path: Path, beside: tuple[Path, ...] = ()) -> tuple[object, ...]:
    return tuple(stamp(each) for each in beside or (path,))


def _shown(found: Found) -> dict[str, Any]:
    """Return a file as messages have it."""
    message: dict[str, Any] = {"text": found.text, "digest": found.digest}
    if (task := found.task) is not None:
        script = None if task.program is None else task.program.script
        message["tree"] = tree(script)
    return message


def _with_lf(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")
