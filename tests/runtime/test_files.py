from io import BytesIO, TextIOWrapper
from random import Random

import pytest

from elitescript.environment.memory import MemoryEnvironment
from elitescript.errors import ScriptError
from elitescript.runtime.files import OPEN_FILES_MAX, OpenFiles, ScriptFile, ScriptStream
from tests.runtime.machine import Bench, run


@pytest.fixture
def world():
    return MemoryEnvironment({"points.csv": b"1,2\n3,4\n", "data.bin": bytes(range(4))})


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

        def full(self, data):
            closings.append(self)
            raise OSError(28, "No space left on device")

        unraised = []
        monkeypatch.setattr("sys.unraisablehook", unraised.append)
        monkeypatch.setattr("elitescript.environment.memory._MemoryFile.write", full)
        file = files.open("new.txt", "w")
        file.write("x")
        del file
        assert closings and not unraised and not recwarn.list

    def test_a_file_that_could_not_be_opened_is_let_go_in_silence(self, monkeypatch):
        unraised = []
        monkeypatch.setattr("sys.unraisablehook", unraised.append)
        ScriptFile("r", "never opened")
        assert not unraised

    def test_one_that_cannot_be_closed_does_not_keep_the_others_open(self, files, monkeypatch):
        def full(self, data):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr("elitescript.environment.memory._MemoryFile.write", full)
        kept = [files.open(name, "w") for name in ("a", "b")]
        for file in kept:
            file.write("x")
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


class TestText:
    @pytest.fixture
    def world(self):
        return MemoryEnvironment({"crlf.txt": b"a\r\nb\rc\n", "broken.txt": b"a\xffb"})

    @pytest.mark.parametrize(
        ("errors", "text"), [("ignore", "ab"), ("replace", "a\ufffdb"), ("backslashreplace", "a\\xffb")]
    )
    def test_errors_says_what_becomes_of_bytes_that_are_no_text(self, files, errors, text):
        with files.open("broken.txt", errors=errors) as file:
            assert file.read() == text

    def test_errors_says_what_becomes_of_letters_that_have_no_bytes(self, files, world):
        with files.open("new.txt", "w", "ascii", errors="replace") as file:
            file.write("5 \u03a9")
        assert world.files.contents["new.txt"] == b"5 ?"

    @pytest.mark.parametrize("errors", [None, "strict"])
    def test_by_default_they_are_errors(self, files, errors):
        with files.open("broken.txt", errors=errors) as file, pytest.raises(UnicodeDecodeError):
            file.read()
        with files.open("new.txt", "w", "ascii", errors=errors) as file, pytest.raises(UnicodeEncodeError):
            file.write("\u03a9")

    @pytest.mark.parametrize(
        ("options", "error"),
        [
            ({"errors": "nothing_like_it"}, LookupError),
            ({"errors": 3}, TypeError),
            ({"encoding": "nothing_like_it"}, LookupError),
            ({"encoding": "hex"}, LookupError),
            ({"encoding": 3}, TypeError),
            ({"newline": "x"}, ValueError),
            ({"newline": ["\n"]}, TypeError),
        ],
    )
    def test_options_that_make_no_sense_destroy_nothing(self, files, world, options, error):
        with pytest.raises(error):
            files.open("crlf.txt", "w", **options)
        assert world.files.contents["crlf.txt"] == b"a\r\nb\rc\n"

    @pytest.mark.parametrize("option", ["encoding", "errors", "newline"])
    def test_a_binary_file_has_none_of_them(self, files, option):
        with pytest.raises(ScriptError, match="binary"):
            files.open("crlf.txt", "rb", **{option: "strict"})

    def test_the_encoding_of_the_place_is_the_robot_s(self, files):
        assert files.open("crlf.txt", encoding="locale").encoding == "utf-8"

    @pytest.mark.parametrize("mode", ["w", "x", "a", "w+", "a+"])
    @pytest.mark.parametrize(
        ("newline", "data"), [(None, b"1\n2\r\n"), ("", b"1\n2\r\n"), ("\n", b"1\n2\r\n"), ("\r\n", b"1\r\n2\r\r\n")]
    )
    def test_line_ends_are_written_as_they_are_unless_asked(self, files, world, mode, newline, data):
        with files.open("new.txt", mode, newline=newline) as file:
            file.write("1\n2\r\n")
        assert world.files.contents["new.txt"] == data

    @pytest.mark.parametrize("mode", ["w", "x", "a", "r+", "w+", "a+"])
    def test_the_computer_s_line_end_plays_no_part(self, files, monkeypatch, mode):
        """None lets Python write the line end of the system that it runs on."""
        made = []
        init = TextIOWrapper.__init__

        class Spy(TextIOWrapper):
            def __init__(self, buffer, *encoding, **options):
                made.extend([options["newline"]] if options else [])
                init(self, buffer, *encoding, **options)

        monkeypatch.setattr("elitescript.runtime.files.TextIOWrapper", Spy)
        monkeypatch.setattr("elitescript.runtime.files._ChangedText", Spy)
        files.open("crlf.txt" if mode == "r+" else "new.txt", mode)
        assert len(made) == 1 and made[0] in ("", "\n")

    @pytest.mark.parametrize("mode", ["r", "r+"])
    def test_every_line_end_is_read_as_a_line_feed(self, files, mode):
        with files.open("crlf.txt", mode) as file:
            assert file.readlines() == ["a\n", "b\n", "c\n"]
            file.seek(0)
            assert [file.readline(), *file] == ["a\n", "b\n", "c\n"]
            file.seek(0)
            assert [file.read(2), file.read(3), file.read(5), file.read(1)] == ["a\n", "b\nc", "\n", ""]
            file.seek(0)
            assert [file.readline(2), file.readline(1), file.readline(2)] == ["a\n", "b", "\n"]
            file.seek(0)
            assert file.read() == "a\nb\nc\n"

    @pytest.mark.parametrize("seed", range(20))
    def test_a_file_that_is_read_and_written_reads_like_python_s(self, seed):
        random = Random(seed)
        data = "".join(random.choice("a\u03a9\r\n") for _ in range(random.randrange(40))).encode()
        file = OpenFiles(MemoryEnvironment({"x": data})).open("x", "r+")
        expected = TextIOWrapper(BytesIO(data), "utf-8", newline=None)
        for _ in range(12):
            name = random.choice(("read", "readline"))
            size = random.randrange(-1, 6)
            assert getattr(file, name)(size) == getattr(expected, name)(size), (data, name, size)


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
