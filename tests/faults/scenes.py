"""What stands around the program of a cell of the table, and what the program does before and after the call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from elitescript.testing.world import Device, ModbusDevice, SerialDevice, TcpServer, XmlRpcServer
from tests.faults.table import Row

ANSWER_S = 0.1
"""After the call, or after 1.0 s."""


class Talker(TcpServer):
    """Answers questions, and sends its text 0.1 s after the call, for which it was asked before."""

    port = 5000

    def __init__(self, text: str) -> None:
        super().__init__()
        self.text = text.encode("latin-1")
        self.heard = b""
        self.asked = b""

    def received(self, connection, data):
        if data == b"go":
            connection.after(0.3, connection.send, self.text)
            return
        self.heard += data
        self.asked = (self.asked + data)[-6:]
        if self.asked == b"GET x\n":
            connection.after(ANSWER_S, connection.send, b"x 42\n")


class Procedures(XmlRpcServer):
    port = 8000

    def part(self, number):
        return self.delayed(ANSWER_S, [number, "red"])


class Beacon(SerialDevice):
    """Sends its text 0.3 s after it is asked to."""

    line_end = ""

    def __init__(self, line: str, text: str) -> None:
        super().__init__(line=line)
        self.text = text
        self.heard = b""

    def received(self, data):
        if data == b"go":
            self.after(0.3, self.send, self.text.encode("latin-1"))
        else:
            self.heard += data


@dataclass(frozen=True)
class Scene:
    """Where a command is called.

    Attributes:
        on: the channel on which something goes wrong.
        device: what is there.
        before: lines that run at 0.8 s, before anything goes wrong.
        again: lines that run when nothing goes wrong any more, before the call is made once more.
        after: lines at the end, also after an alarm: what programs leave behind on purpose.
        call_s: when the call is made.
    """

    on: int | str
    device: Callable[[Row], Device]
    before: str = ""
    again: str = ""
    after: str = ""
    call_s: float = 1.0


def _rtu(line: str) -> Callable[[Row], Device]:
    def device(row: Row) -> Device:
        return ModbusDevice(line=line, unit=1, latency_s=ANSWER_S, **slave_values())

    return device


def slave_values() -> dict[str, Any]:
    """What the slaves hold."""
    return {
        "holding_registers": {2: 7, 3: 0, 4: 65535, 10: 0, 11: 0},
        "input_registers": {2: 9},
        "coils": {2: 1, 3: 0, 4: 1, 5: 0, 10: 0, 11: 0, 12: 0},
        "discrete_inputs": {0: 0, 1: 1, 2: 1},
    }


def _modbus(row: Row) -> Device:
    return ModbusDevice(port=502, latency_s=ANSWER_S, **slave_values())


SIGNALS = """
modbus_add_signal("h", 255, 2, 3, "s")
modbus_add_signal("h", 255, 2, 1, "c")
modbus_set_signal_watchdog("s", 0.5)
modbus_set_signal_watchdog("c", 0.5)
"""
NO_SIGNALS = """
for name in ["s", "c"]:
  try:
    modbus_delete_signal(name)
  except Exception:
    pass
  end
end
"""
RECOVERY = "sleep(6)"
"""The controller tries to connect every 4 s in the end."""

OPEN = 'socket_open("h", 5000, "a")'
TOOL = "tool_serial_config({}, 115200, 0, 1, 8, {})"
BOX = "serial_config({}, 115200, 0, 1, 8, {})"

SCENES = {
    "nothing open": Scene(5000, lambda row: Talker(""), again='socket_close("a")'),
    "socket": Scene(
        5000,
        lambda row: Talker(row.sends),
        f'{OPEN}\nsocket_send_string("go", "a")',
        f'socket_close("a")\n{OPEN}\nsocket_send_string("go", "a")\nsleep(0.2)',
    ),
    "rpc": Scene(8000, lambda row: Procedures(), 'handle = rpc_factory("xmlrpc", "h:8000")'),
    "tool": Scene(
        "tool",
        lambda row: Beacon("tool", row.sends),
        TOOL.format(True, False) + '\ntool_serial_write("go")',
        TOOL.format(False, False) + "\n" + TOOL.format(True, False) + '\ntool_serial_write("go")\nsleep(0.2)',
        TOOL.format(False, False),
    ),
    "box": Scene(
        "/dev/ttymxc0",
        lambda row: Beacon("/dev/ttymxc0", row.sends),
        BOX.format(True, False) + '\nserial_write("go")',
        BOX.format(False, False) + "\n" + BOX.format(True, False) + '\nserial_write("go")\nsleep(0.2)',
        BOX.format(False, False),
    ),
    "tool rtu": Scene("tool", _rtu("tool"), TOOL.format(True, True), "", TOOL.format(False, True)),
    "box rtu": Scene("/dev/ttymxc0", _rtu("/dev/ttymxc0"), BOX.format(True, True), "", BOX.format(False, True)),
    "modbus": Scene(502, _modbus, SIGNALS, RECOVERY, NO_SIGNALS, call_s=3.0),
    "modbus, added again": Scene(502, _modbus, SIGNALS, SIGNALS + RECOVERY, NO_SIGNALS, call_s=3.0),
}
"""By name."""
