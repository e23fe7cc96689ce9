"""Texts that were never saved, and settings, are found again; only the user can read them."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

import pytest

from elitescript.studio import memory as module
from elitescript.studio.memory import Memory, new_owner, state_folder

PROGRAM = Path("/somewhere/cell.script")


@pytest.fixture
def memory(tmp_path: Path) -> Memory:
    return Memory(tmp_path / "state")


def texts(memory: Memory) -> list[str]:
    return [draft.text for draft in memory.drafts(PROGRAM)]


class TestDrafts:
    def test_the_newest_comes_first(self, memory: Memory, monkeypatch) -> None:
        memory.keep(PROGRAM, "one", "digest", "a")
        monkeypatch.setattr(module, "_now", lambda: "2999-01-01T00:00:00.000+00:00")
        memory.keep(PROGRAM, "two \ud83d\n", "", "b")
        memory.keep(Path("/somewhere/else.script"), "three", "", "a")
        assert texts(memory) == ["two \ud83d\n", "one"]
        assert memory.drafts(PROGRAM)[0][:] == ("two \ud83d\n", "", "2999-01-01T00:00:00.000+00:00", "b")
        assert memory.drafts(PROGRAM)[1].seen == "digest"

    def test_a_conversation_has_one(self, memory: Memory) -> None:
        memory.keep(PROGRAM, "one", "", "a")
        memory.keep(PROGRAM, "two", "", "a")
        assert texts(memory) == ["two"]
        memory.drop(PROGRAM, "a", "unknown")
        assert texts(memory) == []

    def test_the_oldest_go(self, memory: Memory, monkeypatch) -> None:
        for number in range(module.DRAFTS_MAX + 3):
            monkeypatch.setattr(module, "_now", lambda number=number: f"2000-01-01T00:00:{number:02}")
            memory.keep(PROGRAM, f"text {number}", "", new_owner())
        assert texts(memory) == [f"text {number}" for number in range(module.DRAFTS_MAX + 2, 2, -1)]

    def test_a_draft_that_makes_no_sense_is_none(self, memory: Memory, tmp_path: Path) -> None:
        memory.keep(PROGRAM, "good", "", "a")
        (path,) = (tmp_path / "state" / "drafts").iterdir()
        for data in (b"", b"[]", b'{"text": 1}', b"\xff", b"[" * 100_000, b'{"text": "x", "seen": "", "at": ""}'):
            path.with_name(path.name.replace("-a.", "-b.")).write_bytes(data)
            assert texts(memory) == ["good"]

    def test_what_cannot_be_written_leaves_the_one_before(self, memory: Memory, monkeypatch, tmp_path: Path) -> None:
        memory.keep(PROGRAM, "before", "", "a")

        def full(*_: object) -> None:
            raise OSError("full")

        with monkeypatch.context() as patched:
            patched.setattr(Path, "replace", full)
            with pytest.raises(OSError, match="full"):
                memory.keep(PROGRAM, "after", "", "a")
        assert texts(memory) == ["before"]
        assert len(list((tmp_path / "state" / "drafts").iterdir())) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
def test_only_the_user_can_read_them(memory: Memory, tmp_path: Path) -> None:
    memory.keep(PROGRAM, "text", "", "a")
    memory.keep_settings({"theme": "dark"})
    for path in (tmp_path / "state").rglob("*"):
        assert stat.S_IMODE(path.stat().st_mode) == (0o700 if path.is_dir() else 0o600)


class TestSettings:
    def test_they_are_as_they_were(self, memory: Memory) -> None:
        assert memory.settings() == {}
        memory.keep_settings({"theme": "dark", "sizes": [1, 2.5], "名": None})
        memory.keep_settings({"theme": "light", "sizes": [1, 2.5], "名": None})
        assert memory.settings() == {"theme": "light", "sizes": [1, 2.5], "名": None}

    def test_they_may_not_grow_for_ever(self, memory: Memory) -> None:
        memory.keep_settings({"theme": "dark"})
        with pytest.raises(ValueError, match="at most 65536 are kept"):
            memory.keep_settings({"text": "x" * module.SETTINGS_BYTES_MAX})
        assert memory.settings() == {"theme": "dark"}


class TestFolder:
    def test_it_is_where_the_system_keeps_the_state_of_programs(self, monkeypatch, tmp_path: Path) -> None:
        monkeypatch.setattr(sys, "platform", "linux")
        monkeypatch.setattr(Path, "home", lambda: Path("/home/ann"))
        monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
        assert state_folder() == tmp_path / "elitescript" / "studio"
        monkeypatch.setenv("XDG_STATE_HOME", "relative")
        assert state_folder() == Path("/home/ann/.local/state/elitescript/studio")
        monkeypatch.setattr(sys, "platform", "darwin")
        assert state_folder() == Path("/home/ann/Library/Application Support/elitescript/studio")
        monkeypatch.setattr(sys, "platform", "win32")
        monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
        assert state_folder() == tmp_path / "elitescript" / "studio"


def test_what_a_killed_process_has_left_goes(tmp_path):
    memory = Memory(tmp_path)
    program = tmp_path / "a.script"
    memory.keep(program, "text", "", "one")
    (draft,) = (tmp_path / "drafts").iterdir()
    old, new = (draft.with_name(f".{name}.json.elitescript") for name in ("0000", "1111"))
    for path in (old, new):
        path.write_text("{")
    os.utime(old, (1, 1))
    memory.keep(program, "text 2", "", "one")
    assert sorted((tmp_path / "drafts").iterdir()) == [new, draft]
