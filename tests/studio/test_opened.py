"""What a page learns of its file, and what becomes of its texts, without a socket."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest

from elitescript.conversation.messages import Save
from elitescript.errors import UsageError
from elitescript.studio import opened
from elitescript.studio.files import Programs
from elitescript.studio.memory import Memory
from elitescript.studio.opened import OpenFile


def digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()


class Desk:
    """A folder, the state of a user, and pages."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "cell"
        self.folder.mkdir()
        self.memory = Memory(folder / "state")
        self.path = self.folder / "a.script"
        self.path.write_text("old\n")

    def page(self) -> tuple[OpenFile, list[dict[str, Any]]]:
        said: list[dict[str, Any]] = []
        return OpenFile(Programs(self.folder), self.memory, lambda message: said.append(dict(message))), said

    def drafts(self) -> list[str]:
        return [draft.text for draft in self.memory.drafts(self.path)]


@pytest.fixture
def desk(tmp_path: Path, monkeypatch) -> Desk:
    monkeypatch.setattr(opened, "DRAFT_S", 0.0)
    return Desk(tmp_path)


def run(steps: Callable[[], Awaitable[None]]) -> None:
    asyncio.run(steps())  # type: ignore[arg-type]


async def settled() -> None:
    """Let what was begun come to its end."""
    others = asyncio.all_tasks() - {asyncio.current_task()}
    await asyncio.gather(*others)


class TestOpen:
    def test_the_first_program_that_can_be_read_is_sent(self, desk: Desk) -> None:
        (desk.folder / "0.script").write_bytes(b"\xff")

        async def steps() -> None:
            file, said = desk.page()
            await file.open_first()
            assert [message["type"] for message in said] == ["notice", "file"]
            assert "0.script: byte 0xFF is not UTF-8" in said[0]["text"]
            assert said[1] == {"type": "file", "name": "a.script", "text": "old\n", "digest": digest("old\n")}

        run(steps)

    def test_a_new_one_says_so(self, desk: Desk) -> None:
        async def steps() -> None:
            file, said = desk.page()
            await file.open("new.script")
            assert said == [{"type": "file", "name": "new.script", "text": "", "digest": "", "is_new": True}]

        run(steps)

    def test_what_cannot_be_opened_leaves_the_one_before(self, desk: Desk) -> None:
        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            with pytest.raises(UsageError):
                await file.open("../outside.script")
            await file.save(Save(ask=1, text="new\n", seen=digest("old\n")))
            assert said[-1]["type"] == "saved"
            assert desk.path.read_text() == "new\n"

        run(steps)


class TestSave:
    def test_a_conflict_has_both_texts_and_force_ends_it(self, desk: Desk) -> None:
        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            desk.path.write_text("theirs\n")
            await file.save(Save(ask=1, text="mine\n", seen=digest("old\n")))
            assert said[-1] == {
                "type": "refused",
                "ask": 1,
                "text": "the file has changed on disk since it was read",
                "conflict": {"text": "theirs\n", "digest": digest("theirs\n")},
            }
            assert desk.path.read_text() == "theirs\n"
            await file.save(Save(ask=2, text="mine\n", seen=digest("old\n"), force=True))
            assert said[-1] == {"type": "saved", "ask": 2, "digest": digest("mine\n")}
            assert desk.path.read_text() == "mine\n"

        run(steps)

    def test_a_disk_that_is_full_is_said_and_the_draft_stays(self, desk: Desk, monkeypatch) -> None:
        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            file.edited("mine\n")
            await settled()

            def full(*_: object, **__: object) -> str:
                raise UsageError("cannot write a.script: No space left on device")

            monkeypatch.setattr(opened, "save", full)
            await file.save(Save(ask=1, text="mine\n", seen=digest("old\n")))
            assert said[-1] == {"type": "refused", "ask": 1, "text": "cannot write a.script: No space left on device"}

        run(steps)
        assert desk.drafts() == ["mine\n"]
        assert desk.path.read_text() == "old\n"

    def test_nothing_is_open_yet(self, desk: Desk) -> None:
        async def steps() -> None:
            file, said = desk.page()
            await file.save(Save(ask=1, text="mine\n", seen=""))
            assert said == [{"type": "refused", "ask": 1, "text": "no program is open"}]

        run(steps)


class TestWatch:
    def test_a_change_on_disk_is_reported_once(self, desk: Desk) -> None:
        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            await file.look()
            desk.path.write_text("theirs, longer\n")
            await file.look()
            await file.look()
            assert said[1:] == [
                {
                    "type": "file_changed",
                    "name": "a.script",
                    "text": "theirs, longer\n",
                    "digest": digest("theirs, longer\n"),
                }
            ]
            desk.path.unlink()
            await file.look()
            assert said[2:] == [{"type": "file_changed", "name": "a.script", "digest": ""}]
            desk.path.write_bytes(b"\xff")
            await file.look()
            assert (said[3]["type"], said[3]["severity"]) == ("notice", "warning")

        run(steps)

    def test_what_the_page_has_saved_is_no_change(self, desk: Desk) -> None:
        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            await file.save(Save(ask=1, text="new\n", seen=digest("old\n")))
            await file.look()
            assert [message["type"] for message in said] == ["file", "saved"]

        run(steps)

    def test_two_pages_on_one_file_see_each_other(self, desk: Desk) -> None:
        async def steps() -> None:
            (one, said_one), (two, said_two) = desk.page(), desk.page()
            await one.open("a.script")
            await two.open("a.script")
            one.edited("of one\n")
            two.edited("of two\n")
            await settled()
            assert sorted(desk.drafts()) == ["of one\n", "of two\n"]
            await one.save(Save(ask=1, text="of one\n", seen=said_one[0]["digest"]))
            await two.look()
            assert (said_two[-1]["type"], said_two[-1]["text"]) == ("file_changed", "of one\n")
            await two.save(Save(ask=1, text="of two\n", seen=said_two[0]["digest"]))
            assert said_two[-1]["conflict"]["text"] == "of one\n"
            assert desk.drafts() == ["of two\n"]

        run(steps)


class TestDrafts:
    def test_an_unsaved_text_is_kept_and_offered(self, desk: Desk) -> None:
        async def steps() -> None:
            file, _ = desk.page()
            await file.open("a.script")
            file.edited("mine \ud83d\n")
            await settled()
            # The process ends here without a goodbye.
            later, said = desk.page()
            await later.open("a.script")
            draft = said[0]["draft"]
            assert (draft["text"], draft["seen"]) == ("mine \ud83d\n", digest("old\n"))

        run(steps)

    def test_the_last_text_is_kept_when_the_page_goes(self, desk: Desk, monkeypatch) -> None:
        monkeypatch.setattr(opened, "DRAFT_S", 1000.0)

        async def steps() -> None:
            file, _ = desk.page()
            await file.open("a.script")
            file.edited("mine\n")
            await file.close()

        run(steps)
        assert desk.drafts() == ["mine\n"]

    def test_another_file_does_not_get_it(self, desk: Desk, monkeypatch) -> None:
        monkeypatch.setattr(opened, "DRAFT_S", 1000.0)

        async def steps() -> None:
            file, _ = desk.page()
            await file.open("a.script")
            file.edited("mine\n")
            await file.open("b.script")
            await file.close()

        run(steps)
        assert desk.drafts() == ["mine\n"]
        assert desk.memory.drafts(desk.folder / "b.script") == []

    def test_looking_at_a_file_leaves_the_draft_of_before(self, desk: Desk) -> None:
        desk.memory.keep(desk.path, "of before\n", "", "somebody")

        async def steps() -> None:
            file, _ = desk.page()
            await file.open("a.script")
            file.edited("old\n")
            await settled()
            file.edited("other\n")
            await settled()
            await file.close()

        run(steps)
        assert sorted(desk.drafts()) == ["of before\n", "other\n"]

    def test_a_text_that_comes_while_one_is_written_is_kept_too(self, desk: Desk, monkeypatch) -> None:
        keep = Memory.keep

        async def steps() -> None:
            file, _ = desk.page()
            await file.open("a.script")

            def typing(memory: Memory, program: Path, text: str, seen: str, owner: str) -> None:
                if text == "one\n":
                    file.edited("two\n")
                keep(memory, program, text, seen, owner)

            monkeypatch.setattr(Memory, "keep", typing)
            file.edited("one\n")
            await settled()

        run(steps)
        assert desk.drafts() == ["two\n"]

    def test_undoing_everything_removes_it(self, desk: Desk) -> None:
        async def steps() -> None:
            file, _ = desk.page()
            await file.open("a.script")
            for text in ("mine\n", "old\n"):
                file.edited(text)
                await settled()

        run(steps)
        assert desk.drafts() == []

    def test_a_save_removes_it_and_what_was_offered_but_no_other(self, desk: Desk) -> None:
        desk.memory.keep(desk.path, "offered\n", "", "before")

        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            assert said[0]["draft"]["text"] == "offered\n"
            desk.memory.keep(desk.path, "of another page\n", "", "another")
            file.edited("mine\n")
            await settled()
            await file.save(Save(ask=1, text="mine\n", seen=digest("old\n")))
            file.edited("mine\n")
            await settled()
            await file.close()

        run(steps)
        assert desk.drafts() == ["of another page\n"]

    def test_one_that_the_file_has_already_is_not_offered(self, desk: Desk) -> None:
        desk.memory.keep(desk.path, "old\n", "", "before")

        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            assert "draft" not in said[0]

        run(steps)

    def test_a_state_folder_that_cannot_be_written_is_said_once(self, desk: Desk, monkeypatch) -> None:
        def full(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(Memory, "keep", full)

        async def steps() -> None:
            file, said = desk.page()
            await file.open("a.script")
            for text in ("one", "two"):
                file.edited(text)
                await settled()
            assert [message["type"] for message in said] == ["file", "notice"]
            assert said[1]["text"] == "unsaved text cannot be kept: No space left on device"

        run(steps)
