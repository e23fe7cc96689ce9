"""The file system of SSH clients, in memory."""

from __future__ import annotations

import errno

import pytest

from elitescript.services.ssh import files as ssh_files
from elitescript.services.ssh.files import RobotFiles, Status, absolute

LOG = "/opt/elite/data/log/log_history.csv"


@pytest.fixture
def files() -> RobotFiles:
    return RobotFiles({LOG: lambda: b"time,text\n"}, lambda: 1000.5)


def put(files: RobotFiles, path: str, data: bytes) -> None:
    file = files.open(path, writes=True, creates=True, truncates=True)
    try:
        file.write(0, data)
    finally:
        file.close()


def get(files: RobotFiles, path: str) -> bytes:
    file = files.open(path)
    data = file.read(0, 1 << 30)
    file.close()
    return data


def number_of(call) -> int:
    with pytest.raises(OSError) as caught:
        call()
    return caught.value.errno


@pytest.mark.parametrize(
    ("path", "place"),
    [
        ("", "/"),
        (".", "/"),
        ("tmp/a", "/tmp/a"),
        ("//tmp//a/", "/tmp/a"),
        ("/tmp/../../../etc/passwd", "/etc/passwd"),
        ("../../..", "/"),
        ("/tmp/./b", "/tmp/b"),
    ],
)
def test_a_path_never_leaves_the_root(path: str, place: str) -> None:
    assert absolute(path) == place


@pytest.mark.parametrize("path", ["a\0b", "x" * 2000, "/tmp/" + "n" * 256, "/d" * 40])
def test_a_path_that_is_none_is_refused(path: str) -> None:
    assert number_of(lambda: absolute(path)) in (errno.EINVAL, errno.ENAMETOOLONG)


def test_folders_are_there_at_the_start(files: RobotFiles) -> None:
    assert files.names("/") == ["opt", "tmp"]
    assert files.names("/opt/elite/data") == ["log"]
    assert files.names("/opt/elite/data/log") == ["log_history.csv"]
    assert files.names("/tmp") == []


def test_files_of_this_computer_are_not_there(files: RobotFiles) -> None:
    for path in ("/etc/passwd", "/tmp/../etc/passwd", __file__, "/proc/self/environ", "/dev/null"):
        assert number_of(lambda path=path: files.open(path)) == errno.ENOENT
        assert number_of(lambda path=path: files.status(path)) == errno.ENOENT


def test_what_is_written_is_read_back(files: RobotFiles) -> None:
    put(files, "/tmp/a", b"abcd")
    assert get(files, "/tmp/a") == b"abcd"
    assert files.status("/tmp/a") == Status(False, 4, 0o644, 1000)
    put(files, "/tmp/a", b"x")
    assert get(files, "/tmp/a") == b"x"


def test_writing_behind_the_end_fills_with_zeros_and_appending_does_not_look_at_the_offset(files: RobotFiles) -> None:
    file = files.open("/tmp/a", writes=True, creates=True)
    file.write(3, b"z")
    assert file.read(0, 9) == b"\0\0\0z"
    file.close()
    file = files.open("/tmp/a", writes=True, appends=True)
    file.write(0, b"!")
    assert file.read(2, 9) == b"\0z!"
    file.truncate(1)
    assert file.status.size == 1
    file.close()


def test_the_robots_own_files_are_read_only(files: RobotFiles) -> None:
    assert get(files, LOG) == b"time,text\n"
    assert files.status(LOG).size == 10
    for call in (
        lambda: files.open(LOG, writes=True),
        lambda: files.remove(LOG),
        lambda: files.rename(LOG, "/tmp/log", replaces=True),
        lambda: files.open("/opt/x", writes=True, creates=True),
        lambda: files.open("/tmp/../x", writes=True, creates=True),
        lambda: files.make_folder("/etc"),
        lambda: files.remove_folder("/tmp"),
    ):
        assert number_of(call) == errno.EACCES
    file = files.open(LOG)
    assert number_of(lambda: file.write(0, b"x")) == errno.EBADF
    file.close()


def test_folders_and_names(files: RobotFiles) -> None:
    files.make_folder("/tmp/d")
    put(files, "/tmp/d/a", b"1")
    put(files, "/tmp/b", b"2")
    assert files.names("/tmp") == ["b", "d"]
    assert number_of(lambda: files.remove_folder("/tmp/d")) == errno.ENOTEMPTY
    assert number_of(lambda: files.rename("/tmp/d/a", "/tmp/b", replaces=False)) == errno.EEXIST
    files.rename("/tmp/d/a", "/tmp/b", replaces=True)
    assert get(files, "/tmp/b") == b"1"
    files.remove_folder("/tmp/d")
    files.remove("/tmp/b")
    assert files.names("/tmp") == []


@pytest.mark.parametrize(
    ("act", "number"),
    [
        (lambda files: files.open("/tmp"), errno.EISDIR),
        (lambda files: files.remove("/tmp"), errno.EISDIR),
        (lambda files: files.remove("/tmp/none"), errno.ENOENT),
        (lambda files: files.open("/tmp/none/a", writes=True, creates=True), errno.ENOENT),
        (lambda files: files.open("/tmp/f/a", writes=True, creates=True), errno.ENOTDIR),
        (lambda files: files.open("/tmp/f", writes=True, creates=True, is_new=True), errno.EEXIST),
        (lambda files: files.names("/tmp/f"), errno.ENOTDIR),
        (lambda files: files.names("/none"), errno.ENOENT),
        (lambda files: files.make_folder("/tmp/f"), errno.EEXIST),
        (lambda files: files.rename("/tmp/f", "/tmp/none/f", replaces=True), errno.ENOENT),
        (lambda files: files.rename("/tmp", "/tmp/x", replaces=True), errno.EISDIR),
    ],
)
def test_what_cannot_be_is_refused(files: RobotFiles, act, number: int) -> None:
    put(files, "/tmp/f", b"1")
    assert number_of(lambda: act(files)) == number
    assert get(files, "/tmp/f") == b"1"


class TestBounds:
    def test_bytes(self, files: RobotFiles, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(ssh_files, "BYTES_MAX", 100)
        put(files, "/tmp/a", bytes(60))
        assert number_of(lambda: put(files, "/tmp/b", bytes(41))) == errno.ENOSPC
        put(files, "/tmp/b", bytes(40))
        files.remove("/tmp/a")
        put(files, "/tmp/c", bytes(60))

    def test_a_write_far_behind_the_end_takes_no_memory(self, files: RobotFiles) -> None:
        file = files.open("/tmp/a", writes=True, creates=True)
        assert number_of(lambda: file.write(1 << 50, b"x")) == errno.ENOSPC
        assert number_of(lambda: file.truncate(1 << 50)) == errno.ENOSPC
        assert file.status.size == 0
        file.close()

    def test_bytes_of_a_removed_file_count_until_it_is_closed(
        self, files: RobotFiles, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(ssh_files, "BYTES_MAX", 100)
        file = files.open("/tmp/a", writes=True, creates=True)
        file.write(0, bytes(100))
        files.remove("/tmp/a")
        assert number_of(lambda: put(files, "/tmp/b", b"1")) == errno.ENOSPC
        file.close()
        file.close()
        put(files, "/tmp/b", b"1")
        assert files.free == 99

    def test_entries(self, files: RobotFiles) -> None:
        for number in range(ssh_files.ENTRIES_MAX // 2):
            put(files, f"/tmp/f{number}", b"")
            files.make_folder(f"/tmp/d{number}")
        assert number_of(lambda: put(files, "/tmp/more", b"")) == errno.ENOSPC
        assert number_of(lambda: files.make_folder("/tmp/more")) == errno.ENOSPC

    def test_open_files(self, files: RobotFiles) -> None:
        put(files, "/tmp/a", b"")
        opened = [files.open("/tmp/a") for _ in range(ssh_files.OPEN_MAX)]
        assert number_of(lambda: files.open("/tmp/a")) == errno.EMFILE
        opened.pop().close()
        files.open("/tmp/a").close()
