"""The conversation with one page, over a source that only takes down what it is asked."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from elitescript.conversation.messages import Program, Seek, ToSource
from elitescript.errors import UsageError
from elitescript.studio import session as module
from elitescript.studio.files import Programs
from elitescript.studio.memory import Memory
from elitescript.studio.opened import OpenFile
from elitescript.studio.session import Session, Workplace

TEXT = "def p():\n  movej([0, -1.57, -1.57, -1.57, 1.57, 0])\nend\n"


class Source:
    """Says hello, refuses `seek`, fails at `stop`."""

    def __init__(self, *abilities: str) -> None:
        self.abilities = abilities
        self.taken: list[ToSource] = []
        self.is_closed = False
        self.send: Callable[[Mapping[str, Any] | bytes], None] = print

    async def start(self, send: Callable[[Mapping[str, Any] | bytes], None]) -> None:
        self.send = send
        send({"type": "hello", "abilities": list(self.abilities), "title": "p"})

    async def take(self, message: ToSource) -> None:
        self.taken.append(message)
        if isinstance(message, Seek):
            raise UsageError("there is no such run")
        if type(message).__name__ == "Stop":
            raise ZeroDivisionError("a mistake of ours")

    async def close(self) -> None:
        self.is_closed = True


class Page:
    """A session and what it has said."""

    def __init__(
        self,
        folder: Path,
        world: Path | None = None,
        source: Source | None = None,
        *,
        has_programs: bool = True,
        model: str | None = None,
    ) -> None:
        self.said: list[Any] = []
        self.source = source or Source("edit")
        self.memory = Memory(folder / "state")
        cell = folder / "cell"
        cell.mkdir(exist_ok=True)
        (cell / "a.script").write_text(TEXT)
        (cell / "b.script").write_text("b")
        programs = Programs(cell) if has_programs else None
        place = Workplace(programs, self.memory, {} if model is None else {"model": model}, world)
        file = None if programs is None else OpenFile(programs, self.memory, self.said.append)
        self.session = Session(place, self.source, file, self.said.append)

    async def take(self, type_: str, **fields: Any) -> None:
        await self.session.take(json.dumps({"type": type_, **fields}))

    async def answer(self, type_: str, **fields: Any) -> dict[str, Any]:
        await self.take(type_, ask=7, **fields)
        while not (found := [message for message in self.said if dict(message).get("ask") == 7]):
            await asyncio.sleep(0.001)
        self.said.remove(found[0])
        return dict(found[0])


def run(folder: Path, steps: Callable[[Page], Awaitable[None]], *given: Any, **more: Any) -> Page:
    async def go() -> Page:
        page = Page(folder, *given, **more)
        await page.session.begin()
        try:
            await steps(page)
        finally:
            await page.session.close()
        return page

    page = asyncio.run(go())
    assert page.source.is_closed
    return page


async def nothing(_: Page) -> None:
    pass


def test_a_page_begins_with_hello_and_its_file(tmp_path: Path) -> None:
    Memory(tmp_path / "state").keep_settings({"theme": "dark"})
    hello, file = run(tmp_path, nothing).said
    assert hello == {
        "type": "hello",
        "abilities": ["edit", "services", "save"],
        "title": "p",
        "programs": ["a.script", "b.script"],
        "settings": {"theme": "dark"},
    }
    assert (file["type"], file["name"], file["text"]) == ("file", "a.script", TEXT)


def test_texts_go_to_the_source_the_editor_and_the_drafts(tmp_path: Path) -> None:
    async def steps(page: Page) -> None:
        await page.take("program", version=3, text=TEXT + "# new\n", options={"robot": "CS63"})
        answer = await page.answer("service", service="hover", version=3, line=2, column=4)
        assert "movej(" in answer["result"]["markdown"]

    page = run(tmp_path, steps)
    (program,) = page.source.taken
    assert isinstance(program, Program)
    assert (program.version, program.text, program.options.robot) == (3, TEXT + "# new\n", "CS63")
    (draft,) = page.memory.drafts(tmp_path / "cell" / "a.script")
    assert draft.text == TEXT + "# new\n"


def test_files_are_saved_and_opened(tmp_path: Path) -> None:
    async def steps(page: Page) -> None:
        seen = page.said[1]["digest"]
        assert (await page.answer("save", text="new", seen=seen))["type"] == "saved"
        refused = await page.answer("save", text="newer", seen=seen)
        assert refused["conflict"]["text"] == "new"
        assert await page.answer("open", name="b.script") == {"type": "done", "ask": 7}
        assert (page.said[-1]["type"], page.said[-1]["name"]) == ("file", "b.script")
        refused = await page.answer("open", name="../../secret.script")
        assert (refused["type"], "outside" in refused["text"]) == ("refused", True)

    run(tmp_path, steps)
    assert (tmp_path / "cell" / "a.script").read_text() == "new"


def test_a_text_is_saved_into_the_file_that_was_open(tmp_path: Path) -> None:
    """Also when the next file is opened, or the page is closed, before it is written."""

    async def steps(page: Page) -> None:
        await page.take("save", ask=1, text="new a", seen="", force=True)
        await page.take("open", ask=2, name="b.script")
        await page.take("save", ask=3, text="new b", seen="", force=True)

    run(tmp_path, steps)
    assert (tmp_path / "cell" / "a.script").read_text() == "new a"
    assert (tmp_path / "cell" / "b.script").read_text() == "new b"


def test_settings_are_kept(tmp_path: Path) -> None:
    async def steps(page: Page) -> None:
        await page.take("settings", values={"sizes": [1, 2]})
        await page.take("settings", values={"x": "y" * 100_000})
        while not any(message["type"] == "notice" for message in page.said):
            await asyncio.sleep(0.001)

    page = run(tmp_path, steps)
    assert page.memory.settings() == {"sizes": [1, 2]}
    assert "at most 65536 are kept" in page.said[-1]["text"]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x",
        "[]",
        "null",
        "{}",
        '{"type": 3}',
        '{"type": "nothing"}',
        '{"type": "program"}',
        '{"type": "program", "version": -1, "text": ""}',
        '{"type": "program", "version": 1, "text": 3}',
        '{"type": "service", "ask": 1, "service": "__class__", "version": 0}',
        '{"type": "save", "ask": 1, "text": "x", "seen": null}',
        '{"type": "open", "ask": 1, "name": ["a"]}',
        "[" * 100_000,
        b"\x00\xff",
    ],
)
def test_what_is_no_message_is_refused(tmp_path: Path, text: str | bytes) -> None:
    async def steps(page: Page) -> None:
        await page.session.take(text)
        assert page.said[-1]["type"] == "refused"

    page = run(tmp_path, steps)
    assert page.source.taken == []


def test_refusals_and_mistakes_of_ours_are_answered_and_the_next_message_is_taken(tmp_path: Path, capsys) -> None:
    async def steps(page: Page) -> None:
        assert await page.answer("seek", run=1, t=0.0) == {"type": "refused", "ask": 7, "text": "there is no such run"}
        await page.take("stop")
        assert page.said[-1] == {"type": "refused", "text": "internal error: ZeroDivisionError: a mistake of ours"}
        assert (await page.answer("service", service="signals", version=0))["type"] == "answer"

    run(tmp_path, steps)
    assert "ZeroDivisionError: a mistake of ours" in capsys.readouterr().err


def test_requests_to_the_editor_may_not_pile_up(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(module, "WAITING_MAX", 2)

    async def steps(page: Page) -> None:
        for ask in range(5):
            await page.take("service", ask=ask, service="signals", version=0)
        refused = [message for message in page.said if message["type"] == "refused"]
        assert [message["ask"] for message in refused] == [2, 3, 4]
        assert refused[0]["text"] == "2 requests wait for an answer"
        while sum(message["type"] == "answer" for message in page.said) < 2:
            await asyncio.sleep(0.001)
        assert (await page.answer("service", service="signals", version=0))["type"] == "answer"

    run(tmp_path, steps)


class TestWorld:
    def world_of(self, tmp_path: Path, name: str, given: Path | None = None) -> Any:
        async def steps(page: Page) -> None:
            await page.take("program", version=1, text=TEXT, options={"world": name})

        page = run(tmp_path, steps, given)
        return page.source.taken[0].options.world if page.source.taken else page.said[-1]["text"]  # type: ignore[union-attr]

    def test_it_is_in_the_folder_or_that_of_the_command_line(self, tmp_path: Path) -> None:
        cell = (tmp_path / "cell").resolve()
        assert self.world_of(tmp_path, "world.toml") == str(cell / "world.toml")
        assert self.world_of(tmp_path, "") == ""
        given = tmp_path.resolve() / "given.toml"
        assert self.world_of(tmp_path, str(given), given) == str(given)

    def test_an_arm_of_ones_own_too(self, tmp_path: Path) -> None:
        async def steps(page: Page) -> None:
            for robot in ("CS63", "arm.toml", "/far/arm.toml", "../arm.toml", "/etc/arm.toml"):
                await page.take("program", version=1, text=TEXT, options={"robot": robot})

        page = run(tmp_path, steps, model="/far/arm.toml")
        taken = [message.options.robot for message in page.source.taken]  # type: ignore[union-attr]
        assert taken == ["CS63", str((tmp_path / "cell").resolve() / "arm.toml"), None]
        assert [message["type"] for message in page.said[2:]] == ["notice", "notice"]

    @pytest.mark.parametrize("name", ["../world.toml", "/etc/passwd", "a\0b"])
    def test_no_other_is_read(self, tmp_path: Path, name: str) -> None:
        assert isinstance(found := self.world_of(tmp_path, name), str)
        assert "is outside" in found or "is no path" in found


def test_messages_of_the_source_go_to_the_page_as_they_are(tmp_path: Path) -> None:
    hostile = {
        "type": "events",
        "run": 1,
        "list": [{"type": "log", "text": "</script><img src=x onerror=alert(1)>\u2028"}],
    }

    async def steps(page: Page) -> None:
        page.source.send(b"rows")
        page.source.send(hostile)
        assert page.said[-2:] == [b"rows", hostile]

    run(tmp_path, steps)


class TestBesideAController:
    """The source checks no texts: the page may write all the same."""

    def test_texts_are_checked_here(self, tmp_path: Path) -> None:
        async def steps(page: Page) -> None:
            await page.take("program", version=1, text="def p():\n  movej(\nend\n")
            await page.take("program", version=2, text="def p():\n  movek(1)\nend\n")
            while not any(message["type"] == "problems" and message["version"] == 2 for message in page.said):
                await asyncio.sleep(0.001)
            (problem,) = page.said[-1]["list"]
            assert (problem["code"], problem["line"], page.said[-1]["compiles"]) == ("E301", 2, True)

        page = run(tmp_path, steps, None, Source("live", "control"))
        assert page.source.taken == []
        assert page.said[0]["abilities"] == ["live", "control", "services", "edit", "save"]

    def test_without_a_file_there_is_nothing_to_write(self, tmp_path: Path) -> None:
        async def steps(page: Page) -> None:
            refused = await page.answer("save", text="x", seen="")
            assert refused["text"] == "no program is open: start the studio with a file or a folder"
            assert (await page.answer("open", name="a.script"))["type"] == "refused"
            assert (await page.answer("service", service="signals", version=0))["type"] == "answer"

        page = run(tmp_path, steps, None, Source("live"), has_programs=False)
        assert page.said[0] == {"type": "hello", "abilities": ["live", "services"], "title": "p", "settings": {}}
        assert len(page.said) == 1
