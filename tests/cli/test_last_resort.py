"""A `serve` whose process hears no signal, because a program is in a call that does not come back."""

from __future__ import annotations

import os
import select
import signal
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.test_serve import line_with, ports_in, start, stop

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")

HANGS = b'def hang():\n  textmsg("now")\n  sleep(0.3)\n  x = sum(range(10**12))\nend\n'


@pytest.fixture
def process(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[subprocess.Popen[str]]:
    """A server with the options of the test."""
    process = start(tmp_path, "--power-on", *request.param)
    yield process
    process.kill()
    process.wait()


def hang(process: subprocess.Popen[str]) -> None:
    """Have it hear no signal."""
    ports = ports_in(line_with(process, "ready"))
    with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
        peer.sendall(HANGS)
        line_with(process, "now")
        peer.settimeout(0.7)
        with pytest.raises(TimeoutError):
            # The state comes ten times a second.
            while peer.recv(4096):
                pass


def said(process: subprocess.Popen[str], words: str) -> bool:
    """Whether it says these words on its standard error within some seconds."""
    assert process.stderr is not None
    while select.select([process.stderr], [], [], 20)[0]:
        line = process.stderr.readline()
        if words in line or not line:
            return words in line
    return False


IN_PROCESS = pytest.mark.parametrize("process", [("--in-process",)], indirect=True)


@pytest.mark.parametrize("process", [("--in-process",), ("--lockstep", "rtsi")], indirect=True)
def test_a_second_signal_ends_it_at_once_and_says_why(process: subprocess.Popen[str]) -> None:
    hang(process)
    process.send_signal(signal.SIGINT)
    assert said(process, "elitescript serve: still busy: a call in line 4 of the program <primary#1> does not come")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert "ended at once by a second signal: a call in line 4 of the program <primary#1>" in err
    assert process.returncode == -signal.SIGKILL


@IN_PROCESS
def test_a_second_signal_that_comes_soon_is_not_forgotten(process: subprocess.Popen[str]) -> None:
    hang(process)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=20)
    assert "ended at once by a second signal" in err


@IN_PROCESS
@pytest.mark.parametrize("presses", [1, 2])
def test_a_process_that_hears_ends_by_itself_also_if_a_key_is_pressed_too_long(
    process: subprocess.Popen[str], presses: int
) -> None:
    line_with(process, "ready")
    for _ in range(presses - 1):
        process.send_signal(signal.SIGINT)
    code, out = stop(process)
    assert code == 0
    assert out.endswith("stopped\n")
