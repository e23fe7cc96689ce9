"""Files that are written: whole or as they were, with their owner, mode and links."""

from __future__ import annotations

import errno
import os
import resource
import signal
import stat
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from elitescript.outputs import writing
from elitescript.outputs.writing import Output, WriteError, opened_new, write_file

pytestmark = pytest.mark.skipif(os.name != "posix", reason="owners, links and pipes of POSIX")
OLD, NEW = b"old content", b"new content, which is longer"
is_root = os.geteuid() == 0 if hasattr(os, "geteuid") else False


@pytest.fixture
def old(tmp_path: Path) -> Path:
    path = tmp_path / "out.html"
    path.write_bytes(OLD)
    return path


@pytest.fixture
def umask() -> Iterator[Callable[[int], None]]:
    before = os.umask(0)
    os.umask(before)
    yield lambda mask: (os.umask(mask), None)[1]
    os.umask(before)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


# ---------------------------------------------------------------- what takes the place


@pytest.mark.parametrize(("mask", "mode"), [(0o022, 0o644), (0o077, 0o600), (0o002, 0o664), (0o000, 0o666)])
def test_a_new_file_follows_the_umask(mask: int, mode: int, tmp_path: Path, umask: Callable[[int], None]) -> None:
    umask(mask)
    write_file(tmp_path / "out", NEW)
    assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == mode
    os.close(opened_new(tmp_path / "new"))
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == mode
    write_file(tmp_path / "secret", NEW, mode=0o600)
    assert stat.S_IMODE((tmp_path / "secret").stat().st_mode) == 0o600 & ~mask


@pytest.mark.parametrize("mode", [0o600, 0o644, 0o664, 0o640, 0o755, 0o2664, 0o2775, 0o4755])
def test_an_old_file_keeps_its_mode_and_becomes_another_one(mode: int, old: Path) -> None:
    old.chmod(mode)
    before = old.stat()
    write_file(old, NEW)
    found = old.stat()
    assert old.read_bytes() == NEW
    assert stat.S_IMODE(found.st_mode) == mode
    assert found.st_ino != before.st_ino
    assert names(old.parent) == ["out.html"]


@pytest.mark.skipif(not is_root, reason="needs root to give files away")
@pytest.mark.parametrize("mode", [0o644, 0o2664, 0o6755])
def test_owner_and_group_stay(mode: int, old: Path) -> None:
    os.chown(old, 1000, 1234)
    old.chmod(mode)
    write_file(old, NEW)
    found = old.stat()
    assert (found.st_uid, found.st_gid, stat.S_IMODE(found.st_mode)) == (1000, 1234, mode)
    assert old.read_bytes() == NEW


def test_a_file_whose_owner_cannot_be_kept_is_overwritten(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = old.stat()

    def refused(*_: object) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "fchmod", refused)
    write_file(old, NEW)
    assert old.read_bytes() == NEW
    assert old.stat().st_ino == before.st_ino
    write_file(old, b"x")
    assert old.read_bytes() == b"x"
    assert names(old.parent) == ["out.html"]


@pytest.mark.parametrize("content", [b"", b"short", NEW])
def test_hard_links_stay_together(content: bytes, old: Path) -> None:
    other = old.with_name("other")
    os.link(old, other)
    write_file(old, content)
    assert other.read_bytes() == content
    assert old.stat().st_ino == other.stat().st_ino
    assert names(old.parent) == ["other", "out.html"]


def test_links_lead_to_the_new_content(old: Path, tmp_path: Path) -> None:
    link = tmp_path / "folder" / "link"
    link.parent.mkdir()
    link.symlink_to("../out.html")
    write_file(link, NEW)
    assert link.is_symlink()
    assert old.read_bytes() == NEW
    (tmp_path / "dangling").symlink_to("folder/made")
    write_file(tmp_path / "dangling", NEW)
    assert (tmp_path / "dangling").is_symlink()
    assert (tmp_path / "folder" / "made").read_bytes() == NEW
    assert names(tmp_path / "folder") == ["link", "made"]


def test_attributes_stay(old: Path) -> None:
    try:
        os.setxattr(old, "user.note", b"mine")
    except (OSError, AttributeError):
        pytest.skip("the file system has none")
    write_file(old, NEW)
    assert os.getxattr(old, "user.note") == b"mine"


def test_a_file_in_a_folder_that_takes_no_more_is_overwritten(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened = os.open

    def refusing(path: Any, flags: int, *rest: Any, **more: Any) -> int:
        if flags & os.O_CREAT and os.fspath(path).endswith(".elitescript"):
            raise PermissionError(errno.EACCES, "Permission denied")
        return opened(path, flags, *rest, **more)

    monkeypatch.setattr(os, "open", refusing)
    write_file(old, NEW)
    assert old.read_bytes() == NEW
    with pytest.raises(WriteError, match="Permission denied"):
        write_file(old.with_name("new"), NEW)


def test_a_file_that_cannot_be_moved_over_is_overwritten(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise OSError(errno.EBUSY, "Device or resource busy")

    monkeypatch.setattr(Path, "replace", refused)
    write_file(old, NEW)
    assert old.read_bytes() == NEW
    assert names(old.parent) == ["out.html"]


def test_a_name_may_be_as_long_as_the_system_lets_it(tmp_path: Path) -> None:
    for letter in ("x", "é"):
        path = tmp_path / (letter * (255 // len(letter.encode())))
        write_file(path, OLD)
        write_file(path, NEW)
        assert path.read_bytes() == NEW


def test_half_a_character_is_escaped(tmp_path: Path) -> None:
    write_file(tmp_path / "out", "a\ud83d\n")
    assert (tmp_path / "out").read_bytes() == b"a\\ud83d\n"


# ---------------------------------------------------------------- what goes wrong


class Crash(BaseException):
    """The process is ended."""


def test_an_error_of_the_caller_leaves_the_old_file(old: Path) -> None:
    for error in (Crash, KeyboardInterrupt, ValueError):
        with pytest.raises(error), Output(old) as file:
            file.write(NEW)
            raise error
        assert old.read_bytes() == OLD
        assert names(old.parent) == ["out.html"]


def test_a_read_only_file_is_refused(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(WriteError, match="it is read-only"):
        write_file(old, NEW)
    assert old.read_bytes() == OLD


@pytest.mark.parametrize(
    ("name", "why"), [("none/out", "there is no folder"), (".", "it is a folder, not a file"), ("a\0b", "null")]
)
def test_what_cannot_be_written_is_named(name: str, why: str, tmp_path: Path) -> None:
    with pytest.raises((WriteError, ValueError), match=why):
        write_file(tmp_path / name, NEW, "--page it")


@pytest.mark.parametrize("size", [0, 5, len(OLD), len(OLD) + 3])
@pytest.mark.parametrize("links", [1, 2])
def test_a_full_disk_leaves_the_old_file(size: int, links: int, old: Path) -> None:
    """In another process: what the limit does to a process cannot be taken back."""
    if links == 2:
        os.link(old, old.with_name("other"))
    child = os.fork()
    if not child:
        try:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
            write_file(old, NEW, "--page out.html")
        except WriteError as error:
            os._exit(7 if str(error) == "--page out.html: File too large" else 8)
        finally:
            os._exit(9)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 7
    assert old.read_bytes() == OLD
    assert names(old.parent) == ["out.html"] if links == 1 else ["other", "out.html"]


def test_a_disk_that_is_full_while_an_old_file_is_overwritten_leaves_it(
    old: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    os.link(old, old.with_name("other"))
    written = os.write

    def full(descriptor: int, data: Any) -> int:
        written(descriptor, bytes(data)[:3])
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "write", full)
    with pytest.raises(WriteError, match="No space left on device"):
        write_file(old, NEW)
    assert old.read_bytes() == OLD
    assert names(old.parent) == ["other", "out.html"]


@pytest.mark.parametrize("step", ["fsync", "fchmod", "replace"])
def test_a_process_that_is_killed_leaves_the_old_file_or_the_new_one(step: str, old: Path) -> None:
    child = os.fork()
    if not child:

        def die(*_: object) -> None:
            os.kill(os.getpid(), signal.SIGKILL)

        setattr(Path if step == "replace" else os, step, die)
        write_file(old, NEW, is_synced=True)
        os._exit(0)
    os.waitpid(child, 0)
    assert old.read_bytes() == OLD
    # What was left over is taken away by whoever comes next.
    assert names(old.parent) == [".out.html.elitescript", "out.html"]
    write_file(old, NEW)
    assert old.read_bytes() == NEW
    assert names(old.parent) == ["out.html"]


def test_the_disk_has_the_content_before_the_name_and_then_the_name(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[str] = []
    fsync, replace = os.fsync, Path.replace

    def synced(descriptor: int) -> None:
        mode = os.fstat(descriptor).st_mode
        steps.append("folder" if stat.S_ISDIR(mode) else "content")
        fsync(descriptor)

    def replaced(path: Path, target: Path) -> Path:
        steps.append("name")
        return replace(path, target)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(Path, "replace", replaced)
    write_file(old, NEW, is_synced=True)
    assert steps == ["content", "name", "folder"]


# ---------------------------------------------------------------- two at the same time


def test_two_outputs_of_one_name_exclude_each_other(old: Path) -> None:
    link = old.with_name("link")
    link.symlink_to(old)
    first = Output(old)
    for path in (old, link):
        with pytest.raises(WriteError, match="another process writes it"):
            Output(path)
    first.finish(NEW)
    Output(link).finish(b"second")
    assert old.read_bytes() == b"second"
    dropped = Output(old)
    dropped.drop()
    Output(old).finish(NEW)
    assert names(old.parent) == ["link", "out.html"]


def test_a_short_write_waits_for_another_one(old: Path) -> None:
    first = Output(old)
    thread = threading.Thread(target=write_file, args=(old, b"second"))
    thread.start()
    first.finish(b"first")
    thread.join()
    assert old.read_bytes() == b"second"


def test_many_writers_leave_one_whole_content(old: Path) -> None:
    contents = [bytes([65 + number]) * 200_000 for number in range(6)]
    threads = [
        threading.Thread(target=write_file, args=(old, content), kwargs={"waits_s": 60.0}) for content in contents
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert old.read_bytes() in contents
    assert names(old.parent) == ["out.html"]


def test_what_another_process_has_taken_for_left_over_is_made_again(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real, calls = writing.lock, []

    def late(descriptor: int) -> None:
        calls.append(descriptor)
        if len(calls) == 1:
            raise BlockingIOError(errno.EAGAIN, "another process looks at it")
        real(descriptor)

    monkeypatch.setattr(writing, "lock", late)
    first = Output(old)
    with pytest.raises(WriteError, match="another process writes it"):
        Output(old)
    first.finish(b"first")
    assert old.read_bytes() == b"first"


def test_without_locks_files_are_written_too(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(writing, "lock", none)
    first = Output(old)
    Output(old).finish(b"second")
    with pytest.raises(WriteError, match="another process writes it"):
        first.finish(b"first")
    assert old.read_bytes() == b"second"
    assert names(old.parent) == ["out.html"]


def test_a_new_file_takes_no_place_of_another_one(old: Path) -> None:
    first = Output(old.with_name("case"), is_new=True)
    first.file.write(NEW)
    old.with_name("case").write_bytes(OLD)
    for output in (first, Output(old, is_new=True)):
        with pytest.raises(WriteError) as caught:
            output.finish()
        assert caught.value.errno == errno.EEXIST
    assert old.with_name("case").read_bytes() == OLD
    write_file(old.with_name("free"), NEW, is_new=True)
    assert names(old.parent) == ["case", "free", "out.html"]


# ---------------------------------------------------------------- what is no ordinary file


def test_a_pipe_is_written_straight(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    output = Output(path)  # which waits for nobody
    assert not output.is_file
    read: list[bytes] = []
    thread = threading.Thread(target=lambda: read.append(path.read_bytes()))
    thread.start()
    output.finish(NEW)
    thread.join()
    assert read == [NEW]
    assert stat.S_ISFIFO(path.stat().st_mode)


def test_a_device_is_written_straight() -> None:
    write_file("/dev/null", NEW)
    assert Path("/dev/null").is_char_device()
    with pytest.raises(WriteError, match="No space left on device"):
        write_file("/dev/full", NEW, "--page /dev/full")


@pytest.mark.parametrize("way", ["/dev/fd/{}", "/proc/self/fd/{}", "link"])
def test_a_stream_of_the_shell_is_written_where_it_stands(way: str, tmp_path: Path) -> None:
    with (tmp_path / "log").open("wb") as log:
        log.write(b"before ")
        log.flush()
        path = Path(way.format(log.fileno()))
        if way == "link":
            path = tmp_path / "link"
            path.symlink_to(f"/dev/fd/{log.fileno()}")
        write_file(path, NEW)
        log.write(b" behind")
    assert (tmp_path / "log").read_bytes() == b"before " + NEW + b" behind"
    assert "log" in names(tmp_path)


def test_a_recording_is_never_written_over(old: Path) -> None:
    with pytest.raises(FileExistsError):
        opened_new(old)
    os.close(opened_new("/dev/null"))
