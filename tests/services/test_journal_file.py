"""The file of a journal: what becomes of it when the disk does not do what it should."""

from __future__ import annotations

import os
import threading

import pytest

from elitescript.errors import UsageError
from elitescript.services.journal import file as journal_file
from elitescript.services.journal.file import JournalFile

LIMIT_S = 10.0


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.journal"


def ended(file: JournalFile) -> str:
    """Wait until nothing more is written; return why."""
    file._thread.join(LIMIT_S)
    return file.failure


def test_lines_are_written_in_their_order(path):
    file = JournalFile(path)
    lines = [f"{number}\n".encode() for number in range(1000)]
    for line in lines:
        file.put(line)
    file.close()
    assert path.read_bytes() == b"".join(lines)
    assert file.failure == ""


def test_a_disk_that_fills_up_leaves_whole_lines(path, monkeypatch):
    """As a real one does, it takes half of the line that does not fit."""

    def write(descriptor, data):
        if b"b" in data:
            os.write(descriptor, data[: data.index(b"b") + 1])
            raise OSError(28, "No space left on device")
        os.write(descriptor, data)

    monkeypatch.setattr(journal_file, "write", write)
    monkeypatch.setattr(journal_file, "LAG_S", 0.0)
    file = JournalFile(path)
    file.put(b"a\n")
    while path.read_bytes() != b"a\n":
        """The thread is about to."""
    file.put(b"xbx\n")
    assert ended(file) == "No space left on device"
    file.put(b"c\n")
    file.close()
    assert path.read_bytes() == b"a\n"


def test_a_disk_that_hangs_holds_nobody_up(path, monkeypatch):
    go_on = threading.Event()
    monkeypatch.setattr(journal_file, "write", lambda descriptor, data: go_on.wait(LIMIT_S))
    monkeypatch.setattr(journal_file, "WAITING_MAX", 1000)
    monkeypatch.setattr(journal_file, "CLOSE_S", 0.01)
    file = JournalFile(path)
    for _ in range(200):
        file.put(b"0123456\n")
    assert "the disk is too slow" in file.failure
    file.close()
    go_on.set()
    file._thread.join(LIMIT_S)


def test_a_file_that_is_removed_ends_the_journal(path, monkeypatch):
    monkeypatch.setattr(journal_file, "CHECK_S", 0.0)
    file = JournalFile(path)
    path.unlink()
    file.put(b"a\n")
    assert ended(file) == "the file was removed"


def test_a_file_that_is_cut_ends_the_journal_and_is_left_as_it_is(path, monkeypatch):
    monkeypatch.setattr(journal_file, "CHECK_S", 0.0)
    monkeypatch.setattr(journal_file, "LAG_S", 0.0)
    has_written = threading.Event()
    monkeypatch.setattr(journal_file.time, "sleep", lambda _: has_written.set())
    file = JournalFile(path)
    file.put(b"abc\n")
    assert has_written.wait(LIMIT_S)
    assert path.read_bytes() == b"abc\n"
    path.write_bytes(b"")
    file.put(b"def\n")
    assert ended(file) == "the file was truncated, or another process has written to it"
    assert path.read_bytes() == b""


def test_a_file_that_is_renamed_goes_on(path, monkeypatch):
    monkeypatch.setattr(journal_file, "CHECK_S", 0.0)
    file = JournalFile(path)
    file.put(b"a\n")
    path.rename(path.with_name("b.journal"))
    file.put(b"b\n")
    file.close()
    assert path.with_name("b.journal").read_bytes() == b"a\nb\n"
    assert file.failure == ""


@pytest.mark.parametrize(
    "make",
    [
        lambda path: path.write_text("precious"),
        lambda path: path.mkdir(),
        *([os.mkfifo] if hasattr(os, "mkfifo") else []),
    ],
)
def test_what_is_there_is_not_touched(path, make):
    make(path)
    with pytest.raises(UsageError, match="name another one"):
        JournalFile(path)


def test_a_folder_that_is_not_there_is_told(tmp_path):
    with pytest.raises(UsageError, match="No such file"):
        JournalFile(tmp_path / "none" / "a.journal")
