"""`--serial` of `run` and `serve`: programs on real pseudo-terminals and bridges."""

from __future__ import annotations

import json
import os
import socket
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from threading import Thread

import pytest

from elitescript.cli.main import main
from elitescript.cli.serve import line_bindings
from elitescript.errors import UsageError
from tests.cli.test_serve import line_with, ports_in, start, stop
from tests.environment.terminal import Terminal

pytest.importorskip("serial")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")

PROGRAM = """def main():
  textmsg("opened ", tool_serial_config(True, 115200, 0, 1))
  textmsg("sent ", tool_serial_write("question"))
  textmsg("read ", tool_serial_read(6, False, 10))
  tool_serial_config(False, 115200, 0, 1)
end
"""


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    terminal = Terminal()
    yield terminal
    terminal.close()


@pytest.fixture
def place() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        yield Path(folder)


def said(capsys: pytest.CaptureFixture[str]) -> list[str]:
    records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    return [record["text"] for record in records if record["type"] in ("log", "warning")]


def test_a_program_speaks_to_a_device(terminal: Terminal, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "job.script"
    file.write_text(PROGRAM)
    heard: list[bytes] = []

    def device() -> None:
        heard.append(terminal.read(8))
        terminal.write(b"answer")

    player = Thread(target=device, daemon=True)
    player.start()
    assert main(["run", str(file), "--json", "--serial", f"tool={terminal.name}"]) == 0
    player.join(10)
    assert said(capsys) == ["opened True", "sent 8", "read b'answer'"]
    assert heard == [b"question"]


def test_without_a_binding_the_port_is_silent(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "job.script"
    file.write_text(PROGRAM)
    assert main(["run", str(file), "--json"]) == 0
    assert said(capsys) == [
        "nothing is connected to the serial port of the tool: it is open, and silent",
        "opened True",
        "sent 8",
        "read b''",
    ]


def test_a_device_that_is_not_there_is_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "job.script"
    file.write_text(PROGRAM)
    assert main(["run", str(file), "--json", "--serial", "tool=/dev/there-is-none"]) == 0
    texts = said(capsys)
    assert texts[0].startswith("the serial port of the tool cannot be opened: ")
    assert "No such file or directory" in texts[0]
    assert texts[1:] == ["opened False", "the serial port of the tool is not enabled", "sent 0", "read b''"]


def test_a_binding_that_makes_no_sense_ends_it_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "job.script"
    file.write_text(PROGRAM)
    assert main(["run", str(file), "--serial", "arm=/dev/ttyUSB0"]) == 2
    assert "no serial port 'arm'" in capsys.readouterr().err


def test_robots_do_not_share_a_port() -> None:
    assert line_bindings([], 2) == {}
    assert line_bindings(["tool=socket://h:1"], 1) == {"tool": "socket://h:1"}
    with pytest.raises(UsageError, match="--serial tool=socket://h:1: 2 robots cannot share"):
        line_bindings(["tool=socket://h:1"], 2)


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("options", [("--in-process",), ()], ids=["in process", "in a child"])
def test_a_served_robot_speaks_to_a_device(terminal: Terminal, place: Path, options: tuple[str, ...]) -> None:
    process = start(place, "--power-on", "--serial", f"tool={terminal.name}", *options)
    ports = ports_in(line_with(process, "ready"))
    with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
        peer.sendall(PROGRAM.encode())
        line_with(process, "sent 8")
        assert terminal.read(8) == b"question"
        terminal.write(b"answer")
        assert "read b'answer'" in line_with(process, "read ")
    assert stop(process)[0] == 0
