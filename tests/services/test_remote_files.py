"""Files through questions: the same as files of one's own, and safe against whoever asks."""

import json
import tracemalloc
from random import Random

import pytest

from elitescript.devices.memory import MemoryFiles
from elitescript.environment.allowance import Allowance
from elitescript.environment.local import LocalFiles
from elitescript.errors import ScriptPermissionError
from elitescript.messages.shapes import CodecError
from elitescript.services.child.remote_files import OPEN_MAX, PIECE_MAX, FileDesk, RemoteFiles


def remote(files):
    """Files behind a desk; questions and answers go through JSON, as they do between processes."""
    desk = FileDesk(files)
    return RemoteFiles(lambda question: json.loads(json.dumps(desk.answer(json.loads(json.dumps(question))))))


@pytest.fixture(params=["memory", "real"])
def files(request, tmp_path):
    (tmp_path / "old.txt").write_bytes(b"one\ntwo\n")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "inner.bin").write_bytes(bytes(range(256)))
    if request.param == "real":
        return remote(LocalFiles(tmp_path))
    return remote(MemoryFiles({"old.txt": b"one\ntwo\n", "folder/inner.bin": bytes(range(256))}))


class TestRemoteFiles:
    def test_reads(self, files):
        with files.open("old.txt", "rb", None, None) as file:
            assert file.readline() == b"one\n"
            assert file.read() == b"two\n"
            assert file.read() == b""

    def test_reads_more_than_a_piece(self, files):
        data = Random(1).randbytes(2 * PIECE_MAX + 17)
        with files.open("big", "wb", None, None) as file:
            file.write(data)
        assert files.size("big") == len(data)
        with files.open("big", "rb", None, None) as file:
            assert file.read() == data

    def test_what_is_flushed_is_there_for_others(self, files):
        with files.open("new.txt", "wb", None, None) as file:
            file.write(b"abc")
            file.flush()
            with files.open("new.txt", "rb", None, None) as other:
                assert other.read() == b"abc"

    def test_appends_at_the_end(self, files):
        with files.open("old.txt", "ab", None, None) as file:
            assert file.tell() == 8
            file.write(b"three\n")
        with files.open("old.txt", "rb", None, None) as file:
            assert file.read() == b"one\ntwo\nthree\n"

    def test_reads_and_writes_one_file(self, files):
        with files.open("old.txt", "r+b", None, None) as file:
            file.seek(4)
            file.write(b"TWO")
            file.seek(0)
            assert file.read() == b"one\nTWO\n"
            file.truncate(3)
        assert files.size("old.txt") == 3

    def test_text(self, files):
        with files.open("text", "w", "utf-8", "") as file:
            file.write("grün\n")
        with files.open("text", "r", "utf-8", "") as file:
            assert file.read() == "grün\n"

    def test_folders(self, files):
        assert files.names("") == ["folder", "old.txt"]
        assert [files.kind(name) for name in ("folder", "old.txt", "none")] == ["folder", "file", ""]
        files.make_folder("more")
        files.remove("old.txt")
        assert files.names("") == ["folder", "more"]

    @pytest.mark.parametrize(("mode", "error"), [("rb", FileNotFoundError), ("xb", FileExistsError)])
    def test_errors_keep_their_class_and_name(self, files, mode, error):
        name = "none" if mode == "rb" else "old.txt"
        with pytest.raises(error) as caught:
            files.open(name, mode, None, None)
        assert caught.value.filename == name
        assert caught.value.strerror

    def test_a_file_opened_for_reading_cannot_be_written(self, files):
        with files.open("old.txt", "rb", None, None) as file, pytest.raises(OSError, match="write"):
            file.write(b"x")

    def test_same_as_files_of_ones_own_for_random_work(self, tmp_path):
        random = Random(3)
        own, far = MemoryFiles({"f": b""}), remote(MemoryFiles({"f": b""}))
        with own.open("f", "r+b", None, None) as ours, far.open("f", "r+b", None, None) as theirs:
            for _ in range(300):
                act, number = random.choice(["read", "write", "seek", "tell", "truncate"]), random.randrange(40)
                argument = random.randbytes(number) if act == "write" else number
                results = [
                    getattr(file, act)() if act in ("tell", "truncate") else getattr(file, act)(argument)
                    for file in (ours, theirs)
                ]
                assert results[0] == results[1], act
            ours.seek(0)
            theirs.seek(0)
            assert ours.read() == theirs.read()


class TestHandles:
    def test_see_what_another_has_flushed(self, files):
        with files.open("old.txt", "r+b", None, None) as one, files.open("old.txt", "rb", None, None) as two:
            assert two.read() == b"one\ntwo\n"
            one.seek(0, 2)
            one.write(b"three\n")
            one.flush()
            assert two.read() == b"three\n"

    def test_the_limit_of_the_folder_is_named(self, tmp_path):
        files = remote(LocalFiles(tmp_path, Allowance(10)))
        file = files.open("f", "wb", None, None)
        file.write(b"x" * 11)
        with pytest.raises(OSError, match=r"limit of 10 bytes \(--task-dir-limit sets it\)") as caught:
            file.close()
        assert (caught.value.errno, caught.value.filename) == (28, "f")

    def test_a_line_that_is_appended_copies_no_file(self):
        far = remote(MemoryFiles({"log": bytes(10_000_000)}))
        with far.open("log", "ab", None, None) as file:
            file.write(b"first\n")
            file.flush()
            tracemalloc.start()
            try:
                for _ in range(20):
                    file.write(b"a line\n")
                    file.flush()
                assert tracemalloc.get_traced_memory()[1] < 1_000_000
            finally:
                tracemalloc.stop()


class TestFileDesk:
    """Against whoever asks."""

    def test_leads_nobody_out_of_the_folder(self, tmp_path):
        inside = tmp_path / "task"
        inside.mkdir()
        (tmp_path / "secret").write_text("x")
        (inside / "link").symlink_to(tmp_path / "secret")
        desk = FileDesk(LocalFiles(inside))
        for name in ("../secret", str(tmp_path / "secret"), "link", "a/../../secret", "/etc/passwd"):
            assert desk.answer(["open", name, "rb"])[:2] == ["error", "permission"]
        with pytest.raises(ScriptPermissionError):
            remote(LocalFiles(inside)).kind("../secret")

    @pytest.mark.parametrize(
        "question",
        [
            None,
            [],
            ["shutdown"],
            ["open", "f"],
            ["open", "f", 3],
            ["open", "f", "rb", "more"],
            ["open", "f", "rw!"],
            ["open", "f", "r"],
            ["read", 1, 2, "x"],
            ["read", True, 0, 1],
            ["write", 1, 0, None],
            [["open"]],
            {"open": 1},
            ["kind", "x" * (3 * PIECE_MAX)],
        ],
    )
    def test_refuses_what_is_no_question(self, question):
        with pytest.raises(CodecError):
            FileDesk(MemoryFiles({})).answer(question)

    @pytest.mark.parametrize(
        "question",
        [
            ["read", 7, 0, 10],
            ["write", 1, -1, ""],
            ["write", 1, 2**60, "eA=="],
            ["write", 1, 0, "no base64!"],
            ["truncate", 1, 2**60],
            ["read", 1, -5, 10],
            ["kind", "a\0b"],
            ["close", 9],
        ],
    )
    def test_answers_nonsense_with_an_error(self, question, tmp_path):
        desk = FileDesk(LocalFiles(tmp_path))
        assert desk.answer(["open", "f", "w+b"]) == ["ok", 1]
        answer = desk.answer(question)
        assert answer[0] == "error" or answer == ["ok", ""]
        desk.close()

    def test_gives_no_more_than_a_piece(self):
        desk = FileDesk(MemoryFiles({"f": b"x" * (3 * PIECE_MAX)}))
        desk.answer(["open", "f", "rb"])
        assert len(desk.answer(["read", 1, 0, 2**62])[1]) < 2 * PIECE_MAX

    def test_opens_no_more_files_than_it_may(self):
        desk = FileDesk(MemoryFiles({"f": b""}))
        answers = [desk.answer(["open", "f", "rb"]) for _ in range(OPEN_MAX + 1)]
        assert [answer[0] for answer in answers] == ["ok"] * OPEN_MAX + ["error"]
        desk.close()
        assert desk.answer(["open", "f", "rb"])[0] == "ok"
