"""A `serve` whose process hears no signal, because a program is in a call that does not come back."""

from __future__ import annotations

import os
import select
import signal
import socket
import subprocess
from pathlib import Path

import pytest

from tests.cli.test_serve import line_with, ports_in, start, stop

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")

HANGS = b'def hang():\n  textmsg("now")\n  sleep(0.3)\n  x = sum(range(10**12))\nend\n'


def hung(place: Path, *options: str) -> subprocess.Popen[str]:
    """A server in that state."""
    process = start(place, "--power-on", *options)
    ports = ports_in(line_with(process, "ready"))
    with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
        peer.sendall(HANGS)
        line_with(process, "now")
        peer.settimeout(0.7)
        with pytest.raises(TimeoutError):
            # The state comes ten times a second.
            while peer.recv(4096):
                pass
    return process


def said(process: subprocess.Popen[str], words: str) -> bool:
    """Whether it says these words on its standard error within some seconds."""
    assert process.stderr is not None
    while select.select([process.stderr], [], [], 20)[0]:
        line = process.stderr.readline()
        if words in line or not line:
            return words in line
    return False


@pytest.mark.parametrize("options", [("--in-process",), ("--lockstep", "rtsi")])
def test_a_second_signal_ends_it_at_once_and_says_why(tmp_path: Path, options: tuple[str, ...]) -> None:
    process = hung(tmp_path, *options)
    try:
        process.send_signal(signal.SIGINT)
        assert said(process, "elitescript serve: still busy: a call in line 4 of the program <primary#1> does not come")
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20)
        assert "ended at once by a second signal: a call in line 4 of the program <primary#1>" in err
        assert process.returncode == -signal.SIGKILL
    finally:
        process.kill()


def test_a_second_signal_that_comes_soon_is_not_forgotten(tmp_path: Path) -> None:
    process = hung(tmp_path, "--in-process")
    try:
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=20)
        assert "ended at once by a second signal" in err
    finally:
        process.kill()


def test_one_signal_is_enough_where_the_process_hears_it(tmp_path: Path) -> None:
    process = start(tmp_path, "--in-process")
    line_with(process, "ready")
    code, out = stop(process, signal.SIGTERM)
    assert code == 0
    assert out.endswith("stopped\n")


def test_a_key_pressed_too_long_does_not_kill(tmp_path: Path) -> None:
    process = start(tmp_path, "--in-process")
    line_with(process, "ready")
    process.send_signal(signal.SIGINT)
    code, out = stop(process)
    assert code == 0
    assert out.endswith("stopped\n")
