"""One task folder is like another: the same tests over a real folder and one in memory."""

from __future__ import annotations

import os
import tracemalloc

import pytest

from elitescript.devices.memory import MemoryEnvironment, MemoryFiles
from elitescript.environment.allowance import ENTRIES_MAX, Allowance, shown_size
from elitescript.environment.local import LocalEnvironment, LocalFiles
from elitescript.errors import ScriptPermissionError, UsageError

CONTENTS = {"points.csv": b"1,2\r\n3,4\n", "sub/deep.txt": "坐标\n".encode()}


def memory(tmp_path):
    return MemoryEnvironment(CONTENTS)


def real(tmp_path):
    for name, data in CONTENTS.items():
        path = tmp_path / "task" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return LocalEnvironment(tmp_path / "task")


@pytest.fixture(params=[memory, real])
def files(request, tmp_path):
    return request.param(tmp_path).files


def content(files, name):
    with files.open(name, "rb", None, None) as file:
        return file.read()


def written(files, name, mode, data):
    encoding = None if "b" in mode else "utf-8"
    with files.open(name, mode, encoding, None) as file:
        file.write(data)
    return content(files, name)


class TestReading:
    def test_text_is_decoded_and_its_line_ends_are_line_feeds(self, files):
        with files.open("points.csv", "r", "utf-8", None) as file:
            assert file.read() == "1,2\n3,4\n"
        with files.open("sub/deep.txt", "rt", "utf-8", None) as file:
            assert file.read() == "坐标\n"

    def test_newline_is_python_s(self, files):
        with files.open("points.csv", "r", "utf-8", "") as file:
            assert file.readlines() == ["1,2\r\n", "3,4\n"]

    def test_binary_is_as_it_is(self, files):
        assert content(files, "points.csv") == b"1,2\r\n3,4\n"

    def test_a_place_in_the_file(self, files):
        with files.open("points.csv", "rb", None, None) as file:
            file.seek(5)
            assert (file.tell(), file.read(1), file.readline()) == (5, b"3", b",4\n")

    def test_a_file_for_reading_is_not_written(self, files):
        with files.open("points.csv", "rb", None, None) as file, pytest.raises(OSError):
            file.write(b"x")
        assert content(files, "points.csv") == CONTENTS["points.csv"]


class TestWriting:
    def test_w_begins_anew(self, files):
        assert written(files, "points.csv", "w", "x") == b"x"
        assert written(files, "new.txt", "w", "y") == b"y"

    def test_a_goes_on_at_the_end(self, files):
        assert written(files, "points.csv", "ab", b"5\n") == CONTENTS["points.csv"] + b"5\n"
        assert written(files, "new.txt", "a", "y") == b"y"

    def test_a_goes_on_at_the_end_wherever_one_went_before(self, files):
        with files.open("points.csv", "ab", None, None) as file:
            file.seek(0)
            file.write(b"!")
        assert content(files, "points.csv").endswith(b"\n!")

    def test_x_makes_a_new_file(self, files):
        assert written(files, "new.txt", "x", "y") == b"y"
        with pytest.raises(FileExistsError) as error:
            files.open("points.csv", "x", "utf-8", None)
        assert error.value.filename == "points.csv"

    def test_r_plus_changes_in_place(self, files):
        with files.open("points.csv", "r+b", None, None) as file:
            file.write(b"9")
            file.seek(0)
            assert file.read(3) == b"9,2"
        assert content(files, "points.csv").startswith(b"9,2")

    def test_w_plus_can_be_read_back(self, files):
        with files.open("new.txt", "w+", "utf-8", None) as file:
            file.write("abc")
            file.seek(1)
            assert file.read() == "bc"

    def test_a_file_for_writing_is_not_read(self, files):
        with files.open("new.txt", "wb", None, None) as file, pytest.raises(OSError):
            file.read()

    def test_what_is_flushed_is_seen(self, files):
        with files.open("new.txt", "w", "utf-8", None) as file:
            file.write("seen")
            file.flush()
            assert content(files, "new.txt") == b"seen"

    def test_a_file_that_nothing_was_written_to_undoes_nothing(self, files):
        with files.open("points.csv", "r+b", None, None):
            assert written(files, "points.csv", "w", "new") == b"new"
        assert content(files, "points.csv") == b"new"

    def test_it_can_be_cut_off(self, files):
        with files.open("points.csv", "r+b", None, None) as file:
            file.truncate(3)
        assert content(files, "points.csv") == b"1,2"


class TestErrors:
    @pytest.mark.parametrize("mode", ["r", "r+", "rb"])
    def test_a_missing_file(self, files, mode):
        with pytest.raises(FileNotFoundError) as error:
            files.open("none.txt", mode, None if "b" in mode else "utf-8", None)
        assert error.value.filename == "none.txt"

    def test_a_missing_folder(self, files):
        with pytest.raises(FileNotFoundError) as error:
            files.open("none/new.txt", "w", "utf-8", None)
        assert error.value.filename == "none/new.txt"

    @pytest.mark.parametrize("mode", ["r", "w"])
    def test_a_folder_is_no_file(self, files, mode):
        with pytest.raises(IsADirectoryError) as error:
            files.open("sub", mode, "utf-8", None)
        assert error.value.filename == "sub"

    @pytest.mark.parametrize("call", ["size", "names", "remove"])
    def test_of_other_calls(self, files, call):
        with pytest.raises(FileNotFoundError) as error:
            getattr(files, call)("none")
        assert error.value.filename == "none"
        assert os.sep + "task" not in str(error.value)


class TestFolder:
    def test_what_is_there(self, files):
        assert [files.kind(name) for name in ("", "sub", "points.csv", "none", "sub/deep.txt")] == [
            "folder", "folder", "file", "", "file"
        ]  # fmt: skip
        assert files.names("") == ["points.csv", "sub"]
        assert files.names("sub") == ["deep.txt"]
        assert files.size("points.csv") == 9

    def test_folders_can_be_made_and_files_removed(self, files):
        files.make_folder("new")
        assert written(files, "new/a.txt", "w", "x") == b"x"
        assert files.names("new") == ["a.txt"]
        files.remove("new/a.txt")
        assert files.names("new") == []
        with pytest.raises(FileExistsError):
            files.make_folder("new")
        with pytest.raises(FileNotFoundError):
            files.make_folder("none/new")


class TestMemory:
    def test_two_worlds_do_not_see_each_other(self):
        one, two = MemoryEnvironment(CONTENTS), MemoryEnvironment(CONTENTS)
        written(one.files, "points.csv", "w", "x")
        assert two.files.contents == CONTENTS

    def test_a_file_that_was_removed_meanwhile_does_not_come_back(self):
        files = MemoryEnvironment(CONTENTS).files
        file = files.open("points.csv", "ab", None, None)
        files.remove("points.csv")
        file.write(b"x")
        file.close()
        assert files.kind("points.csv") == ""


class TestHandles:
    """Several handles of one file, as on a disk."""

    def test_see_what_another_has_flushed(self, files):
        with files.open("new.txt", "w+b", None, None) as one, files.open("new.txt", "rb", None, None) as two:
            one.write(b"abc")
            one.flush()
            assert two.read() == b"abc"
            one.write(b"def")
            one.flush()
            assert two.read() == b"def"

    def test_do_not_write_over_each_other_with_what_they_have_not_changed(self, files):
        with files.open("points.csv", "r+b", None, None) as one, files.open("points.csv", "r+b", None, None) as two:
            one.write(b"9")
            two.seek(2)
            two.write(b"8")
        assert content(files, "points.csv") == b"9,8\r\n3,4\n"

    def test_append_one_after_the_other(self, files):
        with files.open("log", "ab", None, None) as one, files.open("log", "ab", None, None) as two:
            for number in range(3):
                one.write(b"a%d " % number)
                one.flush()
                two.write(b"b%d " % number)
                two.flush()
        assert content(files, "log") == b"a0 b0 a1 b1 a2 b2 "

    def test_see_that_it_was_emptied(self, files):
        with files.open("points.csv", "rb", None, None) as reader:
            files.open("points.csv", "wb", None, None).close()
            assert reader.read() == b""

    def test_keep_a_removed_file_that_has_a_namesake_now(self, files):
        with files.open("points.csv", "rb", None, None) as old:
            files.remove("points.csv")
            assert written(files, "points.csv", "wb", b"new") == b"new"
            assert old.read() == CONTENTS["points.csv"]

    def test_put_zeros_between_the_end_and_what_is_written_behind_it(self, files):
        with files.open("points.csv", "r+b", None, None) as file:
            file.seek(12)
            file.write(b"x")
            file.truncate(14)
        assert content(files, "points.csv") == b"1,2\r\n3,4\n\0\0\0x\0"


@pytest.fixture(params=["memory", "real"])
def limited(request, tmp_path):
    """A folder that holds nine bytes, where programs may write a hundred."""
    if request.param == "memory":
        return MemoryFiles({"points.csv": CONTENTS["points.csv"]}, Allowance(100))
    (tmp_path / "points.csv").write_bytes(CONTENTS["points.csv"])
    return LocalFiles(tmp_path, Allowance(100))


class TestAllowance:
    """What programs may write."""

    def test_covers_all_files_together(self, limited):
        assert len(written(limited, "a", "wb", b"x" * 60)) == 60
        assert len(written(limited, "b", "wb", b"x" * 40)) == 40
        with pytest.raises(OSError) as error:
            written(limited, "c", "wb", b"x")
        assert error.value.errno == 28
        assert error.value.filename == "c"
        assert error.value.strerror == (
            "No space left in the task folder: programs have written 100 bytes, and 1 bytes more would exceed the "
            "limit of 100 bytes (--task-dir-limit sets it)"
        )

    def test_counts_what_a_file_grows_by(self, limited):
        for _ in range(50):
            with limited.open("a", "r+b" if limited.kind("a") else "wb", None, None) as file:
                file.write(b"x" * 80)
        assert len(written(limited, "points.csv", "ab", b"x" * 20)) == 29

    @pytest.mark.parametrize("way", ["empty", "remove", "truncate"])
    def test_gives_back_what_is_deleted(self, limited, way):
        written(limited, "a", "wb", b"x" * 100)
        if way == "empty":
            written(limited, "a", "wb", b"")
        elif way == "remove":
            limited.remove("a")
        else:
            with limited.open("a", "r+b", None, None) as file:
                file.truncate(0)
        assert len(written(limited, "b", "wb", b"y" * 100)) == 100

    def test_gives_nothing_for_what_was_there_before_but_its_place(self, limited):
        limited.remove("points.csv")
        with pytest.raises(OSError, match="No space left"):
            written(limited, "b", "wb", b"y" * 101)

    @pytest.mark.parametrize("way", ["seek", "truncate"])
    def test_counts_holes(self, limited, way):
        with pytest.raises(OSError, match="No space left"), limited.open("a", "wb", None, None) as file:
            if way == "seek":
                file.seek(10**12)
                file.write(b"x")
            else:
                file.truncate(10**12)
        assert limited.size("a") == 0

    def test_two_handles_do_not_count_twice(self, limited):
        with limited.open("a", "wb", None, None) as one, limited.open("a", "r+b", None, None) as two:
            for file in (one, two):
                file.write(b"x" * 90)
                file.flush()
        assert len(written(limited, "b", "wb", b"x" * 10)) == 10

    def test_bounds_files_and_folders(self, limited, monkeypatch):
        monkeypatch.setattr("elitescript.environment.allowance.ENTRIES_MAX", 3)
        written(limited, "a", "wb", b"")
        written(limited, "a", "wb", b"")
        limited.make_folder("f")
        limited.make_folder("g")
        with pytest.raises(OSError, match="programs have made 3 files and folders, which is the limit"):
            limited.make_folder("h")
        with pytest.raises(OSError, match="which is the limit"):
            limited.open("b", "wb", None, None)
        assert limited.names("") == ["a", "f", "g", "points.csv"]
        limited.remove("a")
        limited.make_folder("h")
        assert ENTRIES_MAX == 10_000

    def test_a_removed_file_counts_until_it_is_closed(self):
        files = MemoryFiles({}, Allowance(100))
        file = files.open("a", "wb", None, None)
        file.write(b"x" * 100)
        file.flush()
        files.remove("a")
        with pytest.raises(OSError, match="No space left"):
            written(files, "b", "wb", b"y")
        file.close()
        files.remove("b")
        assert len(written(files, "b", "wb", b"y" * 100)) == 100

    @pytest.mark.parametrize(
        ("size", "text"),
        [(0, "0 bytes"), (999, "999 bytes"), (1000, "1 kB"), (99_990_000, "99.99 MB"), (2_500_000_000, "2.5 GB")],
    )
    def test_shows_sizes(self, size, text):
        assert shown_size(size) == text


class TestAppending:
    def test_copies_no_file_for_a_line_that_is_put_behind_it(self):
        files = MemoryFiles({"log": bytes(10_000_000)})
        with files.open("log", "ab", None, None) as file:
            append_lines(file, 1)
            assert tracemalloc_peak(lambda: append_lines(file, 100)) < 1_000_000
        assert files.size("log") == 10_000_000 + 101 * 23

    def test_opening_a_file_copies_nothing(self):
        files = MemoryFiles({"log": bytes(10_000_000)})

        def reopen():
            for _ in range(10):
                files.open("log", "rb", None, None).close()

        assert tracemalloc_peak(reopen) < 1_000_000


def append_lines(file, count):
    for _ in range(count):
        file.write(b"a line of twenty-two b\n")
        file.flush()


def tracemalloc_peak(act):
    """The most memory that is taken besides what was there before."""
    tracemalloc.start()
    try:
        act()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


class TestReal:
    def test_a_folder_that_is_not_there(self, tmp_path):
        with pytest.raises(UsageError, match="does not exist"):
            LocalEnvironment(tmp_path / "none")

    @pytest.fixture
    def linked(self, tmp_path):
        world = real(tmp_path)
        (tmp_path / "secret.txt").write_text("secret")
        (tmp_path / "outside").mkdir()
        task = tmp_path / "task"
        (task / "to_file").symlink_to(tmp_path / "secret.txt")
        (task / "to_folder").symlink_to(tmp_path / "outside")
        (task / "to_nothing").symlink_to(tmp_path / "later.txt")
        (task / "inside").symlink_to(task / "points.csv")
        (task / "circle").symlink_to(task / "circle")
        return world.files

    @pytest.mark.parametrize("name", ["to_file", "to_folder/new.txt", "to_nothing", "to_folder", "../secret.txt"])
    @pytest.mark.parametrize("mode", ["r", "w", "x", "a"])
    def test_links_that_lead_out_are_refused(self, linked, tmp_path, name, mode):
        with pytest.raises(ScriptPermissionError) as error:
            linked.open(name, mode, "utf-8", None)
        assert str(tmp_path) not in str(error.value)
        assert not (tmp_path / "later.txt").exists() and not (tmp_path / "outside" / "new.txt").exists()

    def test_links_that_stay_inside_are_followed(self, linked):
        assert content(linked, "inside") == CONTENTS["points.csv"]

    def test_links_that_go_round_in_circles_are_no_way_out(self, linked):
        with pytest.raises(OSError) as error:
            linked.open("circle", "r", "utf-8", None)
        assert isinstance(error.value, ScriptPermissionError) or error.value.filename == "circle"

    @pytest.mark.parametrize("call", ["open", "size", "names", "remove", "make_folder", "kind"])
    def test_names_that_no_disk_takes_do_not_say_where_the_folder_is(self, tmp_path, call):
        name = "n" * 300
        with pytest.raises(OSError) as error:
            getattr(real(tmp_path).files, call)(name, *(("w", "utf-8", None) if call == "open" else ()))
        assert error.value.filename == name
        assert str(tmp_path) not in str(error.value)

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
    def test_a_pipe_is_refused(self, tmp_path):
        files = real(tmp_path).files
        os.mkfifo(tmp_path / "task" / "pipe")
        with pytest.raises(ScriptPermissionError, match="neither a file nor a folder"):
            files.open("pipe", "r", "utf-8", None)

    def test_errors_do_not_say_where_the_folder_is(self, tmp_path):
        files = real(tmp_path).files
        with pytest.raises(OSError) as error:
            files.open("sub", "r", "utf-8", None)
        assert str(tmp_path) not in str(error.value)
