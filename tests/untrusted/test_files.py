"""Files that others wrote: what stands at a path, and how much of it is read."""

from __future__ import annotations

import os
import socket
import sys
from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.untrusted.files import Kind, UnreadableError, opened, read_bytes, read_text

SMALL = Kind("world file", 10)
ROOT = hasattr(os, "geteuid") and os.geteuid() == 0


def refusal(path: object, kind: Kind = SMALL) -> str:
    with pytest.raises(UsageError) as found:
        read_text(str(path), kind)
    return str(found.value)


def test_a_file_within_its_limit_is_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"0123456789")
    assert read_bytes(path, SMALL) == b"0123456789"
    assert read_text(path, SMALL) == "0123456789"


def test_one_byte_more_is_refused_with_size_and_limit(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"0123456789a")
    assert refusal(path) == f"cannot read {path}: it has 11 bytes; at most 10 bytes are read (world file)"


def test_a_file_that_grows_while_it_is_read_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"01234")
    before = path.stat()
    path.write_bytes(b"x" * 1000)
    monkeypatch.setattr(os, "fstat", lambda _handle: before)
    assert refusal(path) == f"cannot read {path}: it has more; at most 10 bytes are read (world file)"


@pytest.mark.skipif(sys.platform != "linux", reason="/proc")
def test_a_file_whose_size_is_not_known_is_read_up_to_its_limit() -> None:
    assert "it has more; at most 10 bytes are read (world file)" in refusal("/proc/self/status")


def test_a_sparse_file_of_a_terabyte_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    assert "it has 1099511627776 bytes" in refusal(path)


@pytest.mark.skipif(os.name == "nt", reason="POSIX files")
def test_what_is_no_file_is_refused_unopened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "to_pipe").symlink_to("pipe")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "nowhere").symlink_to("missing")
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(tmp_path / "s"))
    found = {name: refusal(tmp_path / name).partition(": ")[2] for name in ("pipe", "to_pipe", "s", "loop", "nowhere")}
    assert found == {
        "pipe": "it is a named pipe, not a file",
        "to_pipe": "it is a named pipe, not a file",
        "s": "it is a socket, not a file",
        "loop": "Too many levels of symbolic links",
        "nowhere": "No such file or directory",
    }
    assert refusal(tmp_path) == f"cannot read {tmp_path}: it is a folder, not a file"
    assert refusal("/dev/zero") == "cannot read /dev/zero: it is a device, not a file"


@pytest.mark.skipif(os.name == "nt", reason="POSIX files")
def test_a_pipe_that_takes_the_place_of_a_file_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setattr("elitescript.untrusted.files.why_no_file", lambda *_, **__: "")
    assert refusal(tmp_path / "pipe") == f"cannot read {tmp_path / 'pipe'}: it is a named pipe, not a file"


@pytest.mark.skipif(ROOT or os.name == "nt", reason="root may read all")
def test_a_file_without_permission_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"x")
    path.chmod(0)
    assert "Permission denied" in refusal(path)


def test_names_that_no_file_has_are_refused(tmp_path: Path) -> None:
    assert "null" in refusal(f"{tmp_path}/a\0b")
    assert "too long" in refusal(tmp_path / ("x" * 300))


def test_a_missing_file_can_be_told_from_others(tmp_path: Path) -> None:
    with pytest.raises(UnreadableError) as found:
        opened(tmp_path / "none")
    assert found.value.is_missing
    assert found.value.why == "No such file or directory"


def test_a_byte_order_mark_is_no_part_of_a_text(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 1\r\n")
    assert read_text(path, SMALL) == "a = 1\r\n"


def test_what_is_not_utf_8_is_refused_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbfa\nb\n\xff")
    assert refusal(path) == f"{path}:3: the world file is not UTF-8: invalid start byte at byte 7"
    path.write_bytes("a = 1".encode("utf-16")[:10])
    assert refusal(path) == f"{path}:1: the world file is not UTF-8: it is UTF-16; save it as UTF-8"
