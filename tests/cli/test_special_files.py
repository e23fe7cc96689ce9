"""Pipes, devices and folders where a file is meant are refused before anything waits for them."""

import os

import pytest

from elitescript.cli.main import main
from elitescript.paths import why_no_file

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.script").write_text("def p():\n  textmsg('ran')\nend\n")
    for name in (
        "pipe",
        "pipe.script",
        "pipe.toml",
        "pipe.csv",
        "pipe.jsonl",
        "pipe.html",
        "kept.json.lock",
    ):
        os.mkfifo(name)
    os.mkfifo("pipe.case.toml")
    (tmp_path / "folder").mkdir()
    for name in ("loop.script", "loop.json", "loop.toml"):
        (tmp_path / name).symlink_to(name)
    with (tmp_path / "large.toml").open("wb") as file:
        file.truncate(20_000_000)
    (tmp_path / "parts.toml").write_text(f"[{'.'.join('a' * 5000)}]\n")
    return tmp_path


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (["run", "pipe.script"], "cannot read pipe.script: it is a named pipe, not a file"),
        (["run", "folder"], "cannot read folder: it is a folder, not a file"),
        (["run", "/dev/zero"], "cannot read /dev/zero: it is a device, not a file"),
        (["check", "pipe.script"], "cannot read pipe.script: it is a named pipe, not a file"),
        (["plot", "pipe.script"], "cannot read pipe.script: it is a named pipe, not a file"),
        (["plot", "pipe.csv"], "cannot read pipe.csv: it is a named pipe, not a file"),
        (["run", "good.script", "--world", "pipe.toml"], "cannot read pipe.toml: it is a named pipe, not a file"),
        (["run", "good.script", "--robot", "pipe.toml"], "cannot read pipe.toml: it is a named pipe, not a file"),
        (["plot", "good.script", "-o", "folder"], "-o folder: it is a folder, not a file"),
        (
            ["sweep", "good.script", "--runs", "1", "--out", "pipe.csv"],
            "--out pipe.csv: it is a named pipe, not a file",
        ),
        (["run", "good.script", "--state", "pipe"], "--state pipe: it is a named pipe, not a file"),
        (["run", "good.script", "--state", "kept.json"], "kept.json.lock is a named pipe, not a file"),
        (["run", "good.script", "--state", "folder"], "--state folder: it is a folder, not a file"),
        (["run", "good.script", "--state", "/dev/null"], "--state /dev/null: it is a device, not a file"),
        (["run", "loop.script"], "cannot read loop.script: Too many levels of symbolic links"),
        (["run", "good.script", "--state", "loop.json"], "Too many levels of symbolic links"),
        (["run", "good.script", "--world", "loop.toml"], "cannot read loop.toml: Too many levels of symbolic links"),
        (["run", "good.script", "--world", "large.toml"], "it has 20000000 bytes; at most 4000000 bytes are read"),
        (["run", "good.script", "--robot", "large.toml"], "it has 20000000 bytes; at most 1000000 bytes are read"),
        (["run", "good.script", "--world", "parts.toml"], "parts.toml:1: a name of 5000 parts with dots between"),
        (["run", "good.script", "--robot", "parts.toml"], "parts.toml:1: a name of 5000 parts with dots between"),
        (["run", "--case", "parts.toml"], "parts.toml:1: a name of 5000 parts with dots between"),
        (["run", "--case", "pipe.case.toml"], "cannot read pipe.case.toml: it is a named pipe, not a file"),
        (["sweep", "good.script", "--chaos", "pipe.toml"], "cannot read pipe.toml: it is a named pipe, not a file"),
        (["sweep", "good.script", "--chaos", "parts.toml"], "parts.toml:1: a name of 5000 parts with dots between"),
        (["replay", "pipe"], "cannot read pipe: it is a named pipe, not a file"),
        (["audit", "pipe"], "cannot read pipe: it is a named pipe, not a file"),
        (["fit", "good.script", "--pairs", "pipe.csv"], "cannot read pipe.csv: it is a named pipe, not a file"),
        (["serve", "--in-process", "--port", "all=0", "--world", "parts.toml"], "parts.toml:1: a name of 5000 parts"),
        (["serve", "--port", "all=0", "--state", "pipe"], "--state pipe: it is a named pipe, not a file"),
        (["serve", "--port", "all=0", "--world", "pipe.toml"], "cannot read pipe.toml: it is a named pipe, not a file"),
    ],
)
def test_a_call_is_refused(folder, capsys, call, words):
    assert main(call) == 2
    out, err = capsys.readouterr()
    assert words in err
    assert "ran" not in out


def test_what_the_shell_has_opened_may_be_a_pipe(folder):
    reading, writing = os.pipe()
    try:
        assert why_no_file(f"/dev/fd/{reading}", is_stream_allowed=True) == ""
        assert why_no_file(f"/dev/fd/{reading}") == "is a named pipe, not a file"
    finally:
        os.close(reading)
        os.close(writing)


@pytest.mark.parametrize("name", ["good.script", "missing", "a\0b"])
def test_files_and_what_is_missing_are_left_to_who_opens_them(folder, name):
    assert why_no_file(name) == ""
