import pytest

from elitescript.errors import ScriptError
from elitescript.runtime.files import OPEN_FILES_MAX, OpenFiles, ScriptFile, ScriptStream
from elitescript.worlds.memory import MemoryWorld
from tests.runtime.machine import Bench, run


@pytest.fixture
def world():
    return MemoryWorld({"points.csv": b"1,2\n3,4\n", "data.bin": bytes(range(4))})


@pytest.fixture
def files(world):
    return OpenFiles(world)


class TestOpen:
    @pytest.mark.parametrize("mode", ["", "rw", "z", "r+w", "rbt", "bt", "rr", "+"])
    def test_modes_that_make_no_sense_are_refused(self, files, mode):
        with pytest.raises(ValueError, match="mode"):
            files.open("points.csv", mode)

    def test_a_mode_is_a_str(self, files):
        with pytest.raises(TypeError):
            files.open("points.csv", 3)

    def test_a_binary_file_has_no_encoding(self, files):
        with pytest.raises(ScriptError):
            files.open("data.bin", "rb", "utf-8")

    def test_so_many_at_a_time(self, files):
        kept = [files.open("points.csv") for _ in range(OPEN_FILES_MAX)]
        with pytest.raises(OSError, match="files are open"):
            files.open("points.csv")
        kept[0].close()
        files.open("points.csv")

    def test_a_file_is_closed_with_the_last_reference_to_it(self, files, world):
        write = files.open("new.txt", "w").write
        write("abc")
        del write
        assert world.files.contents["new.txt"] == b"abc"

    def test_files_that_are_let_go_do_not_count(self, files):
        for _ in range(2 * OPEN_FILES_MAX):
            files.open("points.csv")

    def test_what_goes_wrong_when_a_file_is_let_go_is_nobody_s_error(self, files, monkeypatch, recwarn):
        closings = []

        def full(self):
            closings.append(self)
            raise OSError(28, "No space left on device")

        unraised = []
        monkeypatch.setattr("sys.unraisablehook", unraised.append)
        monkeypatch.setattr("elitescript.worlds.memory._MemoryFile.flush", full)
        file = files.open("new.txt", "w")
        del file
        assert closings and not unraised and not recwarn.list

    def test_a_file_that_could_not_be_opened_is_let_go_in_silence(self, monkeypatch):
        unraised = []
        monkeypatch.setattr("sys.unraisablehook", unraised.append)
        ScriptFile("r", "never opened")
        assert not unraised

    def test_one_that_cannot_be_closed_does_not_keep_the_others_open(self, files, monkeypatch):
        def full(self):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr("elitescript.worlds.memory._MemoryFile.flush", full)
        kept = [files.open(name, "w") for name in ("a", "b")]
        with pytest.raises(OSError, match="No space"):
            files.close()
        assert [file.closed for file in kept] == [True, True]

    def test_all_are_closed_with_the_program(self, files, world):
        file = files.open("new.txt", "w")
        file.write("x")
        files.close()
        assert file.closed
        assert world.files.contents["new.txt"] == b"x"


class TestFile:
    def test_it_reads_like_a_file(self, files):
        with files.open("points.csv") as file:
            assert file.readline() == "1,2\n"
            assert list(file) == ["3,4\n"]
            file.seek(0)
            assert file.read(3) == "1,2"
            assert file.tell() == 3
            assert file.readlines() == ["\n", "3,4\n"]
            assert (file.name, file.mode, file.encoding, file.closed) == ("points.csv", "r", "utf-8", False)
            assert (file.readable(), file.writable(), file.seekable(), file.isatty()) == (True, False, True, False)
        assert file.closed
        with pytest.raises(ValueError, match="closed"):
            file.read()
        with pytest.raises(ValueError, match="closed"), file:
            pass

    def test_it_writes_like_a_file(self, files, world):
        with files.open("new.txt", "w") as file:
            assert file.write("a\n") == 2
            file.writelines(["b\n", "c\n"])
            file.truncate(4)
            file.flush()
        assert world.files.contents["new.txt"] == b"a\nb\n"

    def test_it_has_no_descriptor(self, files):
        with pytest.raises(ScriptError):
            files.open("points.csv").fileno()

    def test_what_stands_behind_it_has_no_name(self, files):
        file = files.open("points.csv")
        assert not [name for name in dir(file) if "inner" in name or "buffer" in name]
        assert repr(file) == "<file name='points.csv' mode='r'>"

    def test_it_cannot_be_copied(self, files):
        import copy

        with pytest.raises(TypeError, match="copy"):
            copy.copy(files.open("points.csv"))

    def test_its_class_cannot_be_patched(self):
        with pytest.raises(TypeError):
            ScriptFile.read = None


def test_a_stream_hands_on_what_is_written():
    seen = []
    stream = ScriptStream("<stdout>", seen.append)
    assert stream.write("abc") == 3
    stream.flush()
    assert (seen, stream.isatty()) == (["abc"], False)
    with pytest.raises(TypeError):
        stream.write(3)


class TestInPrograms:
    def test_a_path_may_have_one_slash_too_many(self, world):
        bench = run(
            """
            def a():
              with open(get_task_path() + "grid.csv", "w") as f:
                f.write("0.1,0.2\\n")
              with open(get_task_path() + "/grid.csv") as f:
                textmsg(f.read())
              for row in open("grid.csv"):
                textmsg(row.split(","))
            end
            """,
            world=world,
        )
        assert bench.log == ["0.1,0.2\n", "['0.1', '0.2\\n']"]

    def test_what_lies_elsewhere_is_refused(self, world):
        bench = run(
            """
            def a():
              for path in ["/etc/hostname", get_task_path() + "../../secret", "../x"]:
                try:
                  open(path, "w")
                except PermissionError as e:
                  textmsg("refused")
            end
            """,
            world=world,
        )
        assert bench.log == ["refused"] * 3

    def test_what_is_missing_is_missing(self, world):
        (alarm,) = run('open("none.txt")\n', world=world).alarms
        assert (alarm.class_name, alarm.line) == ("FileNotFoundError", 1)
        assert "none.txt" in alarm.text

    def test_a_file_left_open_is_written_at_the_end(self, world):
        run('def a():\n  f = open("out.txt", "w")\n  f.write("kept")\n  halt()\nend\n', world=world)
        assert world.files.contents["out.txt"] == b"kept"

    def test_a_file_that_is_not_closed_is_written_when_it_is_let_go(self, world):
        bench = run(
            """
            def a():
              open("q.txt", "w").write("abc")
              textmsg(open("q.txt").read())
              def write():
                f = open("q.txt", "a")
                f.write("def")
              write()
              for row in open("q.txt"):
                textmsg(row)
            end
            """,
            world=world,
        )
        assert bench.log == ["abc", "abcdef"]

    def test_without_a_world_there_are_none(self):
        (alarm,) = Bench().start('open("x")\n').run().alarms
        assert alarm.class_name == "PermissionError"
