"""Folders that are copied into memory."""

from __future__ import annotations

from elitescript.environment import memory
from elitescript.environment.memory import folder_contents


def test_hidden_files_and_links_are_left_out(tmp_path):
    (tmp_path / "a.txt").write_bytes(b"1")
    (tmp_path / ".secret").write_bytes(b"2")
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "b.txt").write_bytes(b"3")
    (tmp_path / ".git").mkdir()
    (tmp_path / ".git" / "c").write_bytes(b"4")
    (tmp_path / "link").symlink_to(tmp_path / "a.txt")
    assert folder_contents(tmp_path) == {"a.txt": b"1", "inner/b.txt": b"3"}


def test_there_are_limits(tmp_path, monkeypatch):
    for number in range(5):
        (tmp_path / f"{number}.txt").write_bytes(b"x" * 10)
    assert folder_contents(tmp_path).left_out == ""
    monkeypatch.setattr(memory, "FILES_MAX", 3)
    assert f"a copy of the folder {tmp_path.name} that ends before 3.txt" in folder_contents(tmp_path).left_out
    assert list(folder_contents(tmp_path)) == ["0.txt", "1.txt", "2.txt"]
    monkeypatch.setattr(memory, "FILES_BYTES_MAX", 25)
    assert list(folder_contents(tmp_path)) == ["0.txt", "1.txt"]
