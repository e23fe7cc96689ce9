"""`elitescript record` against a small controller: exit codes, Ctrl-C, a kill, and what is refused."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from elitescript.cli.main import main
from elitescript.environment.process import module_command, module_environment
from elitescript.recorder.mcap_file import read_recording
from elitescript.recorder.storing import McapSink
from tests.recorder.controller import HOST, FakeController, closed_port, served, ticks


@contextmanager
def controller(count: int, then: Callable[[], None] | None = None) -> Iterator[list[str]]:
    """A controller in a thread; the words of a call that name its ports. `then` is called when it is connected to."""
    words: list[str] = []
    ready = threading.Event()
    done: list[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = []

    async def serve() -> None:
        fake = FakeController(ticks(1.0, count))
        async with served(fake) as target:
            end = asyncio.Event()
            done.append((asyncio.get_running_loop(), end))
            words.extend([HOST, *(f"--port={name}={number}" for name, number in target.ports.items())])
            ready.set()
            while then is not None and not fake.opened["rtsi"]:
                await asyncio.sleep(0.01)
            if then is not None:
                then()
            await end.wait()

    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    thread.start()
    assert ready.wait(10.0)
    try:
        yield words
    finally:
        loop, end = done[0]
        loop.call_soon_threadsafe(end.set)
        thread.join()


def test_it_records_for_a_time(tmp_path, capsys):
    program = tmp_path / "cell.script"
    program.write_text("x = 1\n")
    out = tmp_path / "run.mcap"
    with controller(300) as words:
        assert main(["record", *words, "--out", str(out), "--for", "0.5", "--program", str(program)]) == 0
    found = read_recording(out)
    # A busy computer may not read all of them in this time.
    count = len(found.t)
    assert count > 0
    assert list(found.t) == ticks(1.0, count)
    assert capsys.readouterr().out.startswith(f"{out}: {count} rows at 250 Hz, no gaps; ")
    assert (found.facts["host"], found.facts["program"]) == (HOST, "cell.script")
    assert found.attachments == {"cell.script": b"x = 1\n"}


@pytest.mark.skipif(os.name != "posix", reason="open files cannot be removed")
def test_a_recording_that_has_lost_a_file_is_not_said_to_have_no_gaps(tmp_path, capsys, monkeypatch):
    out = tmp_path / "run.mcap"
    first = McapSink.close

    def close(self):
        out.unlink(missing_ok=True)
        return first(self)

    monkeypatch.setattr(McapSink, "close", close)
    with controller(300) as words:
        assert main(["record", *words, "--out", str(out), "--for", "0.5"]) == 1
    said = capsys.readouterr().out
    assert f"{out} was removed: its " in said
    assert "no gaps" not in said


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_ends_it_in_order(tmp_path):
    out = tmp_path / "run.mcap"
    with controller(300, lambda: os.kill(os.getpid(), signal.SIGINT)) as words:
        assert main(["record", *words, "--out", str(out)]) == 0
    found = read_recording(out).t
    assert list(found) == ticks(1.0, len(found))


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_killed_recorder_leaves_what_is_older_than_a_second(tmp_path):
    out = tmp_path / "run.mcap"
    with controller(300) as words:
        child = subprocess.Popen(
            module_command("elitescript", ["record", *words, "--out", out]),
            env=module_environment(),
            stderr=subprocess.DEVNULL,
        )
        _wait_for_rows(out)
        child.kill()
        child.wait()
    assert list(read_recording(out).t) == ticks(1.0, 300)


def _wait_for_rows(path) -> None:
    """Return when rows can be read, while the recorder goes on."""
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        time.sleep(0.1)
        if path.exists() and path.stat().st_size and read_recording(path).t:
            return


def test_nobody_is_an_error_of_the_call(tmp_path, capsys):
    ports = [f"--port={name}={closed_port()}" for name in ("rtsi", "primary", "dashboard")]
    assert main(["record", HOST, *ports, "--out", str(tmp_path / "run.mcap")]) == 2
    assert capsys.readouterr().err.startswith(f"elitescript record: nothing answers at {HOST}: ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--out", "there.mcap"], "there.mcap exists already; a recording is never written over"),
        (["--out", "away/run.mcap"], "away/run.mcap: there is no folder away"),
        (["--for", "0"], "--for 0: a number above 0 is needed"),
        (["--for", "nan"], "--for nan: a number above 0 is needed"),
        (["--rate", "500"], "--rate 500: a controller sends from 1 to 250 Hz"),
        (["--rotate", "soon"], "--rotate soon: write a size, such as 500MB, or a time, such as 3600s"),
        (["--rotate", "0MB"], "--rotate 0MB: write a size"),
        (["--port", "modbus=502"], "--port modbus=502: record reads the ports rtsi, primary, dashboard"),
        (["--port", "rtsi"], "--port rtsi: write NAME=NUMBER"),
        (["--instance", "900"], "an instance is a number from 0 to 200, not 900"),
        (["--fetch-program", "/a.script"], "--fetch-program PATH and --ssh-password TEXT|@FILE go together"),
        (["--fetch-program", "/a", "--program", "b", "--ssh-password", "x"], "are two programs; write one of them"),
        (["--fetch-program", "/a.script", "--ssh-password", "x", "--port", "ssh=1"], "the program cannot be fetched"),
        (["--program", "none.script"], "cannot read none.script: No such file"),
        (["--world", "."], "cannot read .: it is a folder, not a file"),
        (["--world", "there.mcap", "--program", "there.mcap"], "another file of the recording has the name there.mcap"),
    ],
)
def test_what_is_refused_before_anything_is_connected(tmp_path, monkeypatch, capsys, words, text):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.mcap").write_bytes(b"mine")
    assert main(["record", HOST, *words]) == 2
    assert text in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["there.mcap"]


@pytest.mark.parametrize("host", ["", "two words", "http://robot"])
def test_hosts(host, capsys):
    assert main(["record", host]) == 2
    assert "a name or an address is needed" in capsys.readouterr().err


def test_a_missing_extra_is_said_with_the_line_that_installs_it(monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(sys.modules, "mcap", None)
    for name in [name for name in sys.modules if name.startswith("mcap.")]:
        monkeypatch.delitem(sys.modules, name)
    assert main(["record", HOST, "--out", str(tmp_path / "run.mcap")]) == 2
    assert "not installed: pip install 'elitescript[mcap]'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--out", "."], "--out .: it is a folder, not a file"),
        (["--rotate", "9" * 400 + "kB"], "write a size"),
    ],
)
def test_words_that_are_none_are_refused(words, text, capsys):
    assert main(["record", HOST, *words]) == 2
    assert text in capsys.readouterr().err
