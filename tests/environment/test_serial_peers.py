"""Serial ports against other people's programs: pymodbus as a slave, socat as cable and as TCP bridge."""

from __future__ import annotations

import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from elitescript.robot import VirtualRobot
from tests.runtime.line_bench import program

pytestmark = pytest.mark.peers

SLAVE = """
import asyncio, sys, warnings
warnings.simplefilter("ignore")
from pymodbus import FramerType
from pymodbus.datastore import ModbusDeviceContext, ModbusSequentialDataBlock, ModbusServerContext
from pymodbus.server import ModbusSerialServer

def block(values):
    # Its blocks count from 1.
    return ModbusSequentialDataBlock(1, values)

async def main(port):
    device = ModbusDeviceContext(
        co=block([0] * 300), di=block([n % 3 == 0 for n in range(300)]),
        hr=block([0] * 300), ir=block([n * 200 for n in range(300)]))
    server = ModbusSerialServer(ModbusServerContext(devices={17: device}, single=False), framer=FramerType.RTU,
                                port=port, baudrate=115200)
    await server.serve_forever(background=True)
    print("ready", flush=True)
    await asyncio.Event().wait()

asyncio.run(main(sys.argv[1]))
"""

PROGRAM = """
tool_serial_config(True, 115200, 0, 1, 8, True)
textmsg(tool_modbus_write_registers(17, 0, [1, 2, 65535]), tool_modbus_write_single_register(17, 3, 300))
textmsg(tool_modbus_read_registers(17, 0, 5))
textmsg(tool_modbus_write_bits(17, 0, [1, 0, 1, 1, 0, 0, 0, 0, 1]), tool_modbus_write_single_bit(17, 1, 1))
textmsg(tool_modbus_read_bits(17, 0, 10))
textmsg(tool_modbus_read_input_registers(17, 10, 3), tool_modbus_read_input_bits(17, 0, 7))
textmsg(tool_modbus_read_registers(17, 299, 2), tool_modbus_write_single_register(17, 300, 1))
textmsg(tool_modbus_read_registers(17, 0, 125)[:4])
tool_serial_config(False, 115200, 0, 1)
"""
SAID = [
    "True1",
    "[1, 2, 65535, 300, 0]",
    "True1",
    "[1, 1, 1, 1, 0, 0, 0, 0, 1, 0]",
    "[2000, 2200, 2400][1, 0, 0, 1, 0, 0, 1]",
    "[]0",
    "[1, 2, 65535, 300]",
]


@contextmanager
def started(*command: str, until: str) -> Iterator[None]:
    """A program of somebody else, once it has said a word on one of its outputs."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        assert process.stdout is not None
        said = []
        for line in process.stdout:
            said.append(line)
            if until in line:
                break
        else:
            raise AssertionError("".join(said))
        yield
    finally:
        process.kill()
        process.communicate()


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[tuple[str, str]]:
    """Two ends of a line."""
    socat = shutil.which("socat") or pytest.skip("socat is not installed")
    near, far = str(tmp_path / "near"), str(tmp_path / "far")
    with started(socat, "-d", "-d", f"pty,raw,echo=0,link={near}", f"pty,raw,echo=0,link={far}", until="starting"):
        yield near, far


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


def slave(port: str):
    pytest.importorskip("pymodbus")
    pytest.importorskip("serial")
    return started(sys.executable, "-c", SLAVE, port, until="ready")


def test_a_slave_of_somebody_else_understands_every_function(cable: tuple[str, str]) -> None:
    near, far = cable
    with slave(far):
        run = VirtualRobot(lines={"tool": near}).run(program(PROGRAM), until_s=30)
    assert run.log == SAID
    assert run.warnings == ["slave 17 on the serial port of the tool: it refuses: exception 2: illegal data address"]


def test_so_it_does_at_the_other_end_of_a_bridge(cable: tuple[str, str]) -> None:
    near, far = cable
    port = free_port()
    listener = f"tcp-listen:{port},bind=127.0.0.1,reuseaddr,nodelay"
    bridge = started(shutil.which("socat") or "", "-d", "-d", listener, f"{near},raw,echo=0", until="listening")
    with slave(far), bridge:
        robot = VirtualRobot(lines={"box": f"socket://127.0.0.1:{port}"})
        body = PROGRAM.replace("tool_modbus", "serial_modbus").replace("tool_serial", "serial")
        run = robot.run(program(body), until_s=30)
    assert run.log == [said.replace("True1", {0: "31", 2: "91"}.get(index, "")) for index, said in enumerate(SAID)]


def test_plain_bytes_over_a_cable(cable: tuple[str, str]) -> None:
    pytest.importorskip("serial")
    near, far = cable
    body = """
    tool_serial_config(True, 115200, 0, 1)
    serial_config(True, 115200, 0, 1)
    textmsg(tool_serial_write([0, 255, 10, 13, 17, 19, 3]))
    textmsg(serial_read(7, True, 5))
    textmsg(serial_write(b"back"))
    textmsg(tool_serial_read(4, False, 5))
    tool_serial_config(False, 115200, 0, 1)
    serial_config(False, 115200, 0, 1)
    """
    run = VirtualRobot(lines={"tool": near, "box": far}).run(program(body), until_s=30)
    assert run.log == ["7", "[0, 255, 10, 13, 17, 19, 3]", "True", "b'back'"]
