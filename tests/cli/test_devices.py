"""`elitescript devices` as a process, and what its options refuse."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from elitescript.cli.main import main

SOURCE = Path(__file__).resolve().parent.parent.parent / "src"

WORLD = """
[[tcp]]
name = "camera"
port = 5000
replies = [{ to = "where?", send = "(1, 2)" }]
"""


@pytest.fixture
def world(tmp_path):
    path = tmp_path / "cell.toml"
    path.write_text(WORLD)
    return path


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_device_answers_until_the_signal(world):
    environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
    process = subprocess.Popen(
        [sys.executable, "-m", "elitescript", "devices", str(world), "--port", "5000=0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    assert process.stdout is not None
    ready = process.stdout.readline()
    found = re.fullmatch(r"ready on 127\.0\.0\.1: camera (\d+)\n", ready)
    assert found is not None, ready
    with socket.create_connection(("127.0.0.1", int(found.group(1))), 5) as peer:
        peer.sendall(b"where?\nwhat?\n")
        assert peer.makefile().readline() == "(1, 2)\n"
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 0
    assert "camera: has no reply to 'what?'" in err


@pytest.mark.parametrize(
    "options, words",
    [
        (["--port", "5001=0"], "no device of .* has the port 5001"),
        (["--port", "x"], "--port x: write PORT=NUMBER"),
        (["--port", "5000=99999"], "write PORT=NUMBER"),
        (["--serial", "x=/dev/null"], "no serial port 'x'"),
    ],
)
def test_an_option_that_makes_no_sense_is_refused(world, capsys, options, words):
    assert main(["devices", str(world), *options]) == 2
    assert re.search(words, capsys.readouterr().err)


def test_a_file_without_devices_is_refused(tmp_path, capsys):
    path = tmp_path / "cell.toml"
    path.write_text("[[wire]]\nwhen = 'flag[0]'\nthen = 'flag[1]'\n")
    assert main(["devices", str(path)]) == 2
    assert "declares nothing to connect to" in capsys.readouterr().err


def test_a_serial_port_that_is_not_there_is_no_place_to_be_ready_at(tmp_path, capsys):
    path = tmp_path / "cell.toml"
    path.write_text("[[serial]]\nline = 'tool'\n")
    missing = tmp_path / "ttyUSB9"
    assert main(["devices", str(path), "--serial", f"tool={missing}"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert f"--serial tool={missing}: " in err


def test_a_port_in_use_is_told_of_in_few_words(world, capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert main(["devices", str(world), "--port", f"5000={port}"]) == 2
    assert (
        f"port {port} at 127.0.0.1: Address already in use; another one: --port 5000=NUMBER" in capsys.readouterr().err
    )
