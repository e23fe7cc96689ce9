"""`run --watch` and `check --watch`: what is refused, what is watched, and a session in a pipe."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from elitescript.cli.call_paths import files_read
from elitescript.cli.main import _parsed, main

SOUND = "def f():\n  sleep(0.1)\nend\n"
ENDLESS = "def f():\n  textmsg('begun')\n  while True:\n    sleep(0.1)\n  end\nend\n"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["run", "--watch", "missing.script"], "missing.script: no such file"),
        (["run", "--watch"], "goes with the name of a program"),
        (["check", "--watch", "-"], "- is no file, so it never changes"),
        (["check", "--watch", "/dev/stdin"], "/dev/stdin is no file"),
        (["check", "--watch"], "goes with the name of a program"),
    ],
)
def test_what_cannot_be_watched_is_refused(words, text, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    assert text in capsys.readouterr().err


def test_an_option_that_makes_no_sense_ends_it_before_the_first_round(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["run", "--watch", "--untill", "3", "a.script"])
    assert ended.value.code == 2


def test_what_a_call_reads_and_what_it_may_write_itself(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cell = 'def f():\n  a = open("points.csv")\n  sleep(1)\nend\n'
    for name, text in (
        ("cell.script", cell),
        ("cell.toml", '[[device]]\nclass = "button.py:Button"\n'),
        ("button.py", ""),
        ("arm.toml", 'base = "CS66"\n'),
    ):
        Path(name).write_text(text)
    found = files_read(_parsed(["run", "cell.script", "--world", "cell.toml", "--robot", "arm.toml", "--watch"]))
    assert {path.name: is_written for path, is_written in found.items()} == {
        "cell.script": False,
        "cell.toml": False,
        "button.py": False,
        "arm.toml": False,
        "points.csv": True,
    }


def test_programs_of_folders_and_those_that_fix_rewrites(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a/one.script", "a/b/two.script", "a/note.md"):
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(SOUND)
    assert sorted(files_read(_parsed(["check", "a", "--watch"])).values()) == [False, False]
    assert sorted(files_read(_parsed(["check", "a", "--watch", "--fix"])).values()) == [True, True]


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_session_in_a_pipe(tmp_path):
    path, new = tmp_path / "cell.script", tmp_path / "cell.script~"
    path.write_text(SOUND)
    command = [sys.executable, "-m", "elitescript", "run", str(path), "--watch"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        assert process.stdout is not None

        def until(words: str) -> str:
            assert process.stderr is not None
            return next(line for line in process.stderr if words in line)

        assert "exit code 0" in until("Ctrl-C ends it")
        new.write_text("def f(:\n")
        new.replace(path)
        assert "E001" in until("error E001")
        assert "exit code 3" in until("Ctrl-C ends it")
        path.write_text(ENDLESS)
        until("cell.script changed")
        # Ended by the next change, since it runs.
        first = next(line for line in process.stdout if "begun" in line)
        path.write_text(SOUND)
        until("cell.script changed")
        assert "exit code 0" in until("Ctrl-C ends it")
        process.send_signal(signal.SIGINT)
        out = first + process.stdout.read()
        assert process.wait(20) == 130
    assert "\x1b" not in out
    ends = [line[14:].partition(" (")[0] for line in out.splitlines()]
    # A program that is ended at its start has no last line.
    assert [end for end in ends if end != "interrupted"] == ["begun", "finished"]
