"""`elitescript fmt`."""

from __future__ import annotations

import io
import os
import subprocess
from types import SimpleNamespace

import pytest

from elitescript.cli.main import main

BAD = "def a():\n    sleep( 1 )\nend\n"
GOOD = "def a():\n  sleep(1)\nend\n"
BROKEN = "def a():\n    sleep((1)\nend\n"
MARKED = 'def a():\n    $ LINE: (1, "x")\nend\n'


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def stdin(monkeypatch):
    def feed(data):
        monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=io.BytesIO(data)))

    return feed


def write(path, text):
    path.write_bytes(text.encode())
    return path.name


def test_a_file_is_written_anew_once(folder, capsys):
    name = write(folder / "a.script", BAD)
    assert main(["fmt", name]) == 0
    assert (folder / "a.script").read_text() == GOOD
    before = (folder / "a.script").stat()
    assert main(["fmt", name]) == 0
    assert (folder / "a.script").stat().st_mtime_ns == before.st_mtime_ns
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == "1 file formatted, 0 unchanged\n0 files formatted, 1 unchanged\n"


def test_folders_and_permissions(folder):
    write(folder / "a.script", BAD)
    (folder / "sub").mkdir()
    write(folder / "sub" / "b.script", BAD)
    write(folder / "sub" / "b.txt", BAD)
    if os.name == "posix":
        (folder / "a.script").chmod(0o640)
    assert main(["fmt", "."]) == 0
    assert (folder / "a.script").read_text() == (folder / "sub" / "b.script").read_text() == GOOD
    assert (folder / "sub" / "b.txt").read_text() == BAD
    if os.name == "posix":
        assert (folder / "a.script").stat().st_mode & 0o777 == 0o640


def test_check_changes_nothing_and_says_what_would_change(folder, capsys):
    write(folder / "a.script", BAD)
    write(folder / "b.script", GOOD)
    assert main(["fmt", "--check", "a.script", "b.script"]) == 1
    assert (folder / "a.script").read_text() == BAD
    assert capsys.readouterr().err == "a.script: not formatted\n1 file would be formatted, 1 unchanged\n"
    assert main(["fmt", "--check", "b.script"]) == 0


def test_diff_changes_nothing_and_can_be_applied(folder, capfdbinary):
    write(folder / "a.script", BAD)
    write(folder / "b.script", "\ufeffdef b():\r\n    sleep(1)\r\nend")
    assert main(["fmt", "--diff", "a.script", "b.script"]) == 0
    assert main(["fmt", "--diff", "--check", "a.script"]) == 1
    assert (folder / "a.script").read_text() == BAD
    diff = capfdbinary.readouterr().out
    assert diff.startswith(
        b"--- a.script\n+++ a.script\n@@ -1,3 +1,3 @@\n def a():\n-    sleep( 1 )\n+  sleep(1)\n end\n"
    )
    assert b"-end\n\\ No newline at end of file\n+  sleep(1)\r\n+end\r\n" in diff


def test_the_diff_is_one_for_git(folder, capfdbinary):
    write(folder / "b.script", "\ufeffdef b():\r\n    sleep(1)\r\nend")
    main(["fmt", "--diff", "b.script"])
    diff = capfdbinary.readouterr().out
    try:
        subprocess.run(["git", "apply", "-p0", "-"], input=diff, check=True, capture_output=True)
    except FileNotFoundError:
        pytest.skip("there is no git")
    assert (folder / "b.script").read_bytes() == "\ufeffdef b():\r\n  sleep(1)\r\nend\r\n".encode()


def test_standard_input_goes_to_standard_output(stdin, capfdbinary):
    stdin(BAD.encode())
    assert main(["fmt", "-"]) == 0
    assert capfdbinary.readouterr().out == GOOD.encode()
    stdin(BAD.encode())
    assert main(["fmt", "--check", "-"]) == 1
    assert capfdbinary.readouterr().out == b""


def test_a_filter_gives_back_what_it_cannot_read(stdin, capfdbinary):
    for data in (BROKEN.encode(), b"def a():\n  x = '\xff'\nend\n"):
        stdin(data)
        assert main(["fmt", "-"]) == 3
        assert capfdbinary.readouterr().out == data


def test_a_program_with_syntax_errors_is_left(folder, capsys):
    write(folder / "a.script", BROKEN)
    write(folder / "b.script", BAD)
    assert main(["fmt", "."]) == 3
    assert (folder / "a.script").read_text() == BROKEN
    assert (folder / "b.script").read_text() == GOOD
    error = capsys.readouterr().err
    assert "a.script:2:10: error E001: this '(' is never closed\n" in error
    assert error.endswith("1 file formatted, 0 unchanged, 1 file cannot be read\n")


def test_a_file_of_the_pendant_is_left_unless_asked(folder, capsys):
    name = write(folder / "a.script", MARKED)
    assert main(["fmt", "--check", name]) == 0
    assert main(["fmt", name]) == 0
    assert (folder / "a.script").read_text() == MARKED
    assert "1 file of the pendant left as it is (see --pendant)" in capsys.readouterr().err
    assert main(["fmt", "--pendant", name]) == 0
    assert (folder / "a.script").read_text() == MARKED.replace("    $", "  $")


def test_usage(folder, capsys):
    assert main(["fmt"]) == 2
    assert main(["fmt", "missing.script"]) == 2
    assert main(["fmt", "."]) == 2
    error = capsys.readouterr().err
    assert "cannot read missing.script: No such file" in error
    assert "elitescript fmt: .: no *.script file in this folder" in error
