"""Programs are read and written as they are, only where they may be, and never over a change that nobody has seen."""

from __future__ import annotations

import errno
import json
import os
import stat
import sys
from hashlib import sha256
from pathlib import Path

import pytest

from elitescript.conversation.messages import read_message
from elitescript.errors import UsageError
from elitescript.outputs import writing
from elitescript.studio import files
from elitescript.studio.files import FILE_BYTES_MAX, NONE, Conflict, Programs, read, save

TEXT = "def p():\n  sleep(1)\nend\n"


def digest(data: bytes) -> str:
    return sha256(data).hexdigest()


def leftovers(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.name.startswith("."))


class TestSave:
    def test_a_new_file_is_written_as_it_is(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        assert save(path, TEXT, "") == digest(TEXT.encode())
        assert path.read_bytes() == TEXT.encode()
        mask = os.umask(0)
        os.umask(mask)
        assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~mask
        assert leftovers(tmp_path) == []

    def test_a_name_may_be_as_long_as_the_system_lets_it(self, tmp_path: Path) -> None:
        path = tmp_path / ("a" * 248 + ".script")
        path.write_text("old")
        save(path, "new", read(path).digest)
        assert path.read_text() == "new"

    def test_what_can_be_opened_can_be_saved(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        path.write_text("\n" * FILE_BYTES_MAX)
        message = {"type": "save", "ask": 1, "text": read(path).text, "seen": ""}
        assert len(read_message(json.dumps(message)).text) == FILE_BYTES_MAX

    @pytest.mark.parametrize(
        ("before", "text", "after"),
        [
            (b"a\r\nb\r\n", "a\nx\nb\n", b"a\r\nx\r\nb\r\n"),
            (b"a\rb\r", "a\nb\nc", b"a\rb\rc"),
            (b"a\nb\n", "a\r\nx\r\n", b"a\nx\n"),
            (b"\xef\xbb\xbfa\r\n", "a\nb\n", b"\xef\xbb\xbfa\r\nb\r\n"),
            (b"a", "a\nb", b"a\nb"),
            # Of several kinds, lines that did not change keep theirs.
            (b"a\nb\r\nc\nd\n", "a\nb\nx\nd\n", b"a\nb\r\nx\nd\n"),
            (b"a\nb\r\nc\r\nd\n\r\n", "a\nx\ny\nc\nd\n\n", b"a\nx\r\ny\r\nc\r\nd\n\r\n"),
            (b"a\r\nb\n", "b\n", b"b\n"),
            (b"a\r\nb\n", "", b""),
            ("Größe 位置 🤖\r\n".encode(), "Größe 位置 🤖\nx\n", "Größe 位置 🤖\r\nx\r\n".encode()),
        ],
    )
    def test_line_ends_and_the_mark_stay(self, tmp_path: Path, before: bytes, text: str, after: bytes) -> None:
        path = tmp_path / "a.script"
        path.write_bytes(before)
        assert save(path, text, digest(before)) == digest(after)
        assert path.read_bytes() == after

    def test_what_is_read_and_saved_is_the_same_bytes(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        for data in (b"", b"\n", b"a\r\n\nb\r\rc\n", b"\xef\xbb\xbf", b"a\x00b\r\n", "\u2028a\x0bb\n".encode()):
            path.write_bytes(data)
            found = read(path)
            assert save(path, found.text, found.digest) == digest(data)
            assert path.read_bytes() == data

    def test_permissions_and_links_stay(self, tmp_path: Path) -> None:
        path, link = tmp_path / "a.script", tmp_path / "link.script"
        path.write_text("old")
        path.chmod(0o640)
        link.symlink_to(path)
        programs = Programs(link)
        save(programs.path(programs.only or ""), TEXT, digest(b"old"))
        assert link.is_symlink()
        assert path.read_text() == TEXT
        assert stat.S_IMODE(path.stat().st_mode) == 0o640

    def test_a_change_on_disk_is_a_conflict(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        path.write_bytes(b"theirs\r\n")
        with pytest.raises(Conflict) as refused:
            save(path, "mine\n", digest(b"before"))
        assert refused.value.found == ("theirs\n", digest(b"theirs\r\n"), None)
        assert path.read_bytes() == b"theirs\r\n"
        assert save(path, "mine\n", digest(b"before"), force=True) == digest(b"mine\r\n")

    def test_a_file_that_has_come_or_gone_is_a_conflict(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        with pytest.raises(Conflict) as refused:
            save(path, "mine", digest(b"gone"))
        assert refused.value.found == NONE
        assert not path.exists()
        path.write_bytes(b"theirs")
        with pytest.raises(Conflict):
            save(path, "mine", "")

    def test_the_same_text_is_no_conflict(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        path.write_bytes(b"same")
        assert save(path, "same", "another digest") == digest(b"same")

    @pytest.mark.parametrize("call", ["write", "fsync", "replace"])
    def test_a_full_disk_leaves_the_file_and_nothing_else(self, tmp_path: Path, monkeypatch, call: str) -> None:
        path = tmp_path / "a.script"
        path.write_bytes(b"old")

        def full(*_: object) -> None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        if call == "write":
            monkeypatch.setattr(writing._Raw, "write", full)
        elif call == "fsync":
            monkeypatch.setattr(os, "fsync", full)
        else:
            monkeypatch.setattr(Path, "replace", full)
        with pytest.raises(UsageError, match=r"cannot write .*a\.script: No space left on device"):
            save(path, "new", digest(b"old"))
        monkeypatch.undo()
        assert path.read_bytes() == b"old"
        assert leftovers(tmp_path) == []

    def test_a_read_only_file_stays_although_its_folder_could_be_written(self, tmp_path: Path, monkeypatch) -> None:
        path = tmp_path / "a.script"
        path.write_bytes(b"old")
        monkeypatch.setattr(os, "access", lambda *_: False)
        with pytest.raises(UsageError, match="it is read-only"):
            save(path, "new", digest(b"old"))
        assert path.read_bytes() == b"old"

    def test_half_a_character_is_refused(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        with pytest.raises(UsageError, match=r"U\+D83D alone is half a character"):
            save(path, "a\ud83db", "")
        assert not path.exists()


class TestRead:
    def test_the_text_has_lf_and_no_mark(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        path.write_bytes(b"\xef\xbb\xbfa\r\nb\rc\n")
        assert read(path) == ("a\nb\nc\n", digest(b"\xef\xbb\xbfa\r\nb\rc\n"), None)

    def test_no_file_is_a_new_one(self, tmp_path: Path) -> None:
        assert read(tmp_path / "a.script") == NONE

    def test_another_encoding_is_refused_with_its_place(self, tmp_path: Path) -> None:
        path = tmp_path / "a.script"
        path.write_bytes(b"a\nGr\xfc\xdfe")
        with pytest.raises(
            UsageError, match=r"cannot open .*a\.script: byte 0xFC is not UTF-8 text; it stays as it is"
        ):
            read(path)
        with pytest.raises(UsageError, match="not UTF-8"):
            save(path, "new", "")
        assert path.read_bytes() == b"a\nGr\xfc\xdfe"

    def test_what_is_no_file_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(UsageError, match="is a folder, not a file"):
            read(tmp_path)
        if sys.platform != "win32":
            os.mkfifo(tmp_path / "pipe.script")
            with pytest.raises(UsageError, match="is a named pipe, not a file"):
                read(tmp_path / "pipe.script")

    def test_what_the_system_refuses_is_said(self, tmp_path: Path) -> None:
        with pytest.raises(UsageError, match="File name too long"):
            read(Programs(tmp_path).path("x" * 5000 + ".script"))

    def test_a_large_file_is_refused(self, tmp_path: Path, monkeypatch) -> None:
        monkeypatch.setattr(files, "_OPENED", files._OPENED._replace(bytes_max=10))
        (tmp_path / "a.script").write_bytes(b"x" * 11)
        with pytest.raises(UsageError, match="has 11 bytes; at most 10 bytes are read"):
            read(tmp_path / "a.script")


class TestPrograms:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        home = tmp_path / "cell"
        for name in (
            "b.script",
            "a.script",
            "jobs/c.script",
            "jobs/D.SCRIPT",
            ".hidden/d.script",
            ".e.script",
            "notes.txt",
        ):
            (home / name).parent.mkdir(parents=True, exist_ok=True)
            (home / name).write_text(name)
        (tmp_path / "outside.script").write_text("secret")
        return home

    def test_a_folder_lists_its_programs(self, folder: Path) -> None:
        programs = Programs(folder)
        assert programs.names() == ["a.script", "b.script", "jobs/D.SCRIPT", "jobs/c.script"]
        assert programs.first_names() == ["a.script", "b.script", "jobs/D.SCRIPT", "jobs/c.script", "program.script"]
        assert programs.title == "cell"
        assert programs.path("jobs/c.script").read_text() == "jobs/c.script"
        assert programs.path("jobs/D.SCRIPT").read_text() == "jobs/D.SCRIPT"
        assert programs.path("jobs/new.script") == folder / "jobs" / "new.script"

    def test_an_empty_folder_begins_with_a_new_program(self, tmp_path: Path) -> None:
        assert Programs(tmp_path).first_names() == ["program.script"]

    def test_the_new_program_is_none_that_cannot_be_read(self, tmp_path: Path) -> None:
        (tmp_path / "program.script").write_bytes(b"\xff")
        assert Programs(tmp_path).first_names() == ["program.script", "program_2.script"]

    @pytest.mark.parametrize(
        "name",
        [
            "../outside.script",
            "jobs/../../outside.script",
            "/etc/passwd",
            "link.script",
            "far/outside.script",
            "notes.txt",
            "plain.script",
            "",
            ".",
            "a.script\0.txt",
            "a\0.script",
        ],
    )
    def test_nothing_else_is_opened(self, folder: Path, name: str) -> None:
        (folder / "link.script").symlink_to(folder.parent / "outside.script")
        (folder / "far").symlink_to(folder.parent)
        (folder / "plain.script").symlink_to(folder / "notes.txt")
        with pytest.raises(UsageError):
            Programs(folder).path(name)

    def test_one_file_is_the_only_one(self, folder: Path) -> None:
        programs = Programs(folder / "a.script")
        assert (programs.names(), programs.first_names(), programs.title) == (["a.script"], ["a.script"], "a.script")
        assert programs.path("a.script") == folder / "a.script"
        with pytest.raises(UsageError, match=r"only a\.script is open"):
            programs.path("b.script")

    def test_graphical_programs_are_opened_too(self, folder: Path) -> None:
        (folder / "cell.task").write_bytes(b"<EliTask/>")
        assert "cell.task" in Programs(folder).names()
        assert Programs(folder).path("cell.task") == folder / "cell.task"
        assert Programs(folder / "cell.task").names() == ["cell.task"]
        with pytest.raises(UsageError, match=r"the relative path of a \.script or \.task file is needed"):
            Programs(folder).path("cell.configuration")

    def test_a_file_that_does_not_exist_yet_needs_its_folder(self, tmp_path: Path) -> None:
        assert Programs(tmp_path / "new.script").names() == ["new.script"]
        with pytest.raises(UsageError, match="there is no folder"):
            Programs(tmp_path / "no" / "new.script")
