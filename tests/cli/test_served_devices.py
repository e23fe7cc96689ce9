"""`serve --world` as a process, its robot in a child: devices beside it, and connections that fail."""

from __future__ import annotations

import os
import signal
import socket
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.cli.test_serve import ctl, line_with, ports_in, start

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")

WORLD = """
[[tcp]]
class = "cell.py:Camera"
name = "camera"
port = 5000

[[modbus]]
line = "tool"
unit = 1
holding_registers = [42]

[[wire]]
when = "standard_digital_out[0]"
then = "standard_digital_in[1]"
after_s = 0.1
"""

CLASSES = """
from elitescript.testing.world import TcpServer


class Camera(TcpServer):
    def line_received(self, connection, line):
        if line == "break":
            raise ValueError("lens")
        self.log(f"asked {line}")
        return "(7)"
"""

ASK = """def ask():
  if socket_open("h", 5000):
    socket_send_line("{}")
    textmsg("found ", socket_read_ascii_float(1, "socket_0", 0.5))
  else:
    textmsg("no camera")
  end
end
"""

OTHERS = """def others():
  tool_serial_config(True, 115200, 0, 1, 8, True)
  textmsg("register ", tool_modbus_read_registers(1, 0, 1))
  set_standard_digital_out(0, True)
  while not get_standard_digital_in(1):
    sync()
  end
  textmsg("wired")
end
"""


@pytest.fixture
def place() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        yield Path(folder)


def test_programs_of_a_served_robot_meet_devices(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cell.py").write_text(CLASSES)
    (tmp_path / "cell.toml").write_text(WORLD)
    process = start(place, "--power-on", "--world", str(tmp_path / "cell.toml"))

    def run(text: str) -> None:
        with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
            peer.sendall(text.encode())

    def order(*words: str) -> tuple[int, str]:
        return ctl(place, monkeypatch, capsys, *words)

    try:
        ports: Any = ports_in(line_with(process, "ready"))
        run(ASK.format("where?"))
        assert "camera: asked where?" in line_with(process, "asked")
        assert "found [1, 7.0]" in line_with(process, "found")
        assert order("disturb", "refuse", "on=5000") == (0, "refuse on port 5000\n")
        run(ASK.format("where?"))
        line_with(process, "no camera")
        assert order("disturb", "end")[0] == 0
        assert order("disturb", "refuse", "on=tool")[0] == 1
        run(OTHERS)
        assert "register [42]" in line_with(process, "register")
        line_with(process, "wired")
        run(ASK.format("break"))
        assert "found [0, nan]" in line_with(process, "found")
    finally:
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20)
    assert f"{tmp_path / 'cell.py'}:8: device camera (Camera): ValueError: lens; the device is disconnected" in err
