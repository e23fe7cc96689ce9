"""Seeded random programs that talk, devices that answer in any way, and faults at any time."""

from __future__ import annotations

from random import Random
from typing import Any

from elitescript.testing.world import (
    Device,
    Fault,
    ModbusDevice,
    RpcFault,
    SerialDevice,
    TcpServer,
    World,
    XmlRpcServer,
)

RPC_S = 1.5
"""How long a call of a procedure waits for its answer."""
NEVER = float("inf")

PLACES: tuple[int | str, ...] = (5000, 5001, 8000, 502, "tool", "/dev/ttymxc0")
SETUP = """serial_config(True, 115200, 0, 1, 8, True)
tool_serial_config(True, 38400, 0, 1)
modbus_add_signal("h", 255, 0, 3, "r")
modbus_add_signal("h", 255, 0, 1, "c", True, 2)
modbus_set_signal_watchdog("r", 0.2)
server = rpc_factory("xmlrpc", "h:8000")
socket_open("h", 5000, "a")
socket_open("h", 5001, "b")"""
SIGNALS = ("r", "c", "new")
CLEANUP = """serial_config(False, 115200, 0, 1)
tool_serial_config(False, 38400, 0, 1)
for name in ["r", "c", "new"]:
  try:
    modbus_delete_signal(name)
  except Exception:
    pass
  end
end"""


class Chatterbox(TcpServer):
    """Answers with anything, at any time; sometimes hangs up."""

    port = 5000

    def opened(self, connection):
        if self.random.random() < 0.2:
            connection.after(self.random.uniform(0.0, 0.5), connection.close)
        return b"hello\n" if self.random.random() < 0.3 else None

    def received(self, connection, data):
        chance = self.random
        answers = [b"", data, b"x 42\n", b"x\n", b"(1.5, 2)", b"(1,", bytes(12), b"no\n", b"\xff" * 5]
        for _ in range(chance.randrange(3)):
            connection.after(chance.choice((0.0, 0.02, 0.4)), connection.send, chance.choice(answers))
        if chance.random() < 0.05:
            connection.send(bytes(chance.randrange(200_000)))
        if chance.random() < 0.1:
            connection.after(chance.uniform(0.0, 0.3), connection.close)


class Echo(TcpServer):
    port = 5001
    latency_s = 0.03
    jitter_s = 0.02

    def received(self, connection, data):
        return data


class Procedures(XmlRpcServer):
    port = 8000

    def part(self, number):
        return [number, "red"]

    def slow(self, number):
        return self.delayed(self.random.choice((0.1, 1.0, 3.0)), number)

    def broken(self):
        raise RpcFault(3, "no part")


class Scale(SerialDevice):
    line = "tool"
    baud = 38400

    def opened(self):
        self.every(0.15, lambda: self.send("12.5"))

    def line_received(self, line):
        return "ok " + line


def random_world(chance: Random, seed: int) -> World:
    """Devices, and what goes wrong with them."""
    devices = random_devices(chance)
    return World(devices=devices, faults=random_faults(chance), seed=seed)


def random_faults(chance: Random) -> list[Fault]:
    """What goes wrong."""
    return [random_fault(chance) for _ in range(chance.randrange(9))]


def random_devices(chance: Random) -> list[Device]:
    """One of each kind."""
    tables: dict[str, Any] = {"holding_registers": [1, 2, 3, 4], "coils": [1, 0, 1, 0]}
    return [
        Chatterbox(chunk=chance.choice((0, 0, 1, 7))),
        Echo(),
        Procedures(duration_s=chance.choice((0.0, 0.1)), chunk=chance.choice((0, 0, 11))),
        ModbusDevice(port=502, latency_s=chance.choice((0.0, 0.05, 0.9)), **tables),
        Scale(),
        ModbusDevice(line="/dev/ttymxc0", unit=1, latency_s=chance.choice((0.0, 0.03)), **tables),
    ]


def random_fault(chance: Random, after_s: float = 0.0) -> Fault:
    """Something that goes wrong somewhere for a while."""
    on = chance.choice(PLACES)
    is_line = isinstance(on, str)
    kinds = ["silence", "drop", "delay", "duplicate", "corrupt", "trickle", "wrong_reply", "disconnect"]
    kind = chance.choice(kinds if is_line else [*kinds, "refuse"])
    settings: dict[str, Any] = {"at_s": after_s + round(chance.uniform(0.0, 4.0), 3)}
    if chance.random() < 0.8:
        settings["for_s"] = round(chance.uniform(0.01, 2.0), 3)
    if kind not in ("refuse", "disconnect"):
        settings["share"] = chance.choice((1.0, 0.5, 0.1))
        settings["nth"] = chance.choice((1, 1, 2))
        settings["direction"] = chance.choice(("both", "to_robot", "to_device"))
    if kind == "delay":
        settings["delay_s"] = chance.choice((0.01, 0.3, 2.5))
    elif kind == "trickle":
        settings["chunk"] = chance.choice((1, 3))
    elif kind == "wrong_reply":
        settings["direction"] = "both"
        settings |= _wrong_reply(chance, on)
    return Fault(kind, on, **settings)


def _wrong_reply(chance: Random, on: int | str) -> dict[str, Any]:
    forms: list[dict[str, Any]] = [{"form": "text", "reply": chance.randbytes(chance.randrange(1, 30))}]
    if on in (502, "/dev/ttymxc0"):
        forms += [{"form": "exception", "code": chance.randint(1, 11)}, {"form": "unit"}]
        forms += [{"form": "transaction"}] if on == 502 else [{"form": "checksum"}]
    if on == 8000:
        forms += [{"form": "fault", "code": 3, "reply": "no"}, {"form": "http", "code": 503}]
    return chance.choice(forms)


def random_call(chance: Random) -> tuple[str, float]:
    """A call, and how long it may take; not counting what other threads do in between."""
    wait_s = chance.choice((0.02, 0.02, 0.3, 1.0, 0.0 if chance.random() < 0.1 else 0.1))
    limit_s = wait_s or NEVER
    name = f'"{chance.choice("ab")}"'
    bit = chance.randrange(2)
    signal = f'"{chance.choice(SIGNALS)}"'
    calls: list[tuple[str, float]] = [
        (f'socket_open("h", {chance.choice((5000, 5000, 5001, 5001, 5002))}, {name})', 2.0),
        (f'socket_open("h", {chance.choice((5000, 5001))}, {name})', 2.0),
        (f"socket_close({name})", 0.0),
        (f"socket_is_connected({name})", 0.0),
        (f'socket_get_var("x", {name})', 2.0),
        (f"socket_read_ascii_float(2, {name}, {wait_s})", limit_s),
        (f"socket_read_binary_integer(2, {name}, {wait_s})", limit_s),
        (f"socket_read_byte_list({chance.choice((1, 5, 512))}, {name}, {wait_s})", limit_s),
        (f'socket_read_string({name}, "", "", {wait_s})', limit_s),
        (f'socket_read_string({name}, "h", "\\n", {wait_s})', limit_s),
        (f"socket_send_byte_list([1, 2, 3], {name})", 0.0),
        (f"socket_send_byte(65, {name})", 0.0),
        (f"socket_send_int(7, {name})", 0.0),
        (f'socket_send_line("where?", 0, {name})', 0.0),
        (f'socket_send_string("{"y" * chance.choice((1, 3000))}", {name})', 0.0),
        (f'socket_set_var("x", 3, {name})', 0.0),
        ("server.part(2)", 2.0 + RPC_S),
        ("server.slow(3)", 2.0 + RPC_S),
        ("server.broken()", 2.0 + RPC_S),
        (f"tool_serial_read({chance.choice((1, 8, 60))}, True, {wait_s})", limit_s),
        ('tool_serial_write("net?\\n")', 0.1),
        ("tool_serial_mode()", 0.0),
        (f"tool_serial_config({chance.random() < 0.8}, 38400, 0, 1)", 0.1),
        (f"serial_read(3, True, {wait_s})", limit_s),
        (f"serial_config(True, 115200, 0, 1, 8, {chance.random() < 0.9})", 0.1),
        ("serial_flush()", 0.0),
        (f"serial_modbus_read_registers({chance.choice((1, 1, 2))}, 0, 3, {wait_s})", limit_s),
        (f"serial_modbus_read_bits(1, {bit}, 2, {wait_s})", limit_s),
        (f"serial_modbus_write_registers(1, {bit}, [5, 6], {wait_s})", limit_s),
        (f"serial_modbus_write_single_bit(1, {bit}, 1, {wait_s})", limit_s),
        (f'modbus_add_signal("h", {chance.choice((0, 1, 255))}, {bit}, {chance.randrange(4)}, "new")', 0.0),
        (f"modbus_delete_signal({signal})", 0.0),
        (f"modbus_get_signal_status({signal})", 0.0),
        (f"modbus_get_signal_status({signal})", 0.0),
        (f"modbus_get_error({signal})", 0.0),
        (f"modbus_get_time_since_signal_invalid({signal})", 0.0),
        (f"modbus_set_output_register({signal}, 7)", 0.0),
        (f"modbus_set_output_signal({signal}, [True])", 0.0),
        (f"modbus_set_runstate_dependent_choice({signal}, {chance.randrange(4)})", 0.0),
        (f"modbus_set_signal_update_frequency({signal}, {chance.choice((0, 1, 50, 250))})", 0.0),
        (f"modbus_set_signal_watchdog({signal}, {wait_s})", 0.0),
        ('modbus_send_custom_command("h", 255, 6, [0, 0, 0, 9])', 0.0),
        (f'modbus_reset_connection("h", {chance.random() < 0.7})', 2.0),
        ("write_port_register(256, read_port_register(256) + 1)", 0.0),
        ("write_port_bit(60, not read_port_bit(60))", 0.0),
        ("sleep(0.05)", 0.05),
        ("sync()", 0.01),
    ]
    return chance.choice(calls)


def random_talk(chance: Random) -> tuple[str, dict[int, float]]:
    """A program of some threads that talk, and how long each of its numbered calls may take."""
    lines = ["def talk():", *(f"  {line}" for line in SETUP.split("\n"))]
    limits: dict[int, float] = {}
    threads = chance.randrange(0, 3)
    for number in range(threads):
        lines += [f"  def worker{number}():", *_calls(chance, limits, "    "), "  end"]
    lines += [f"  h{number} = start_thread(worker{number}, ())" for number in range(threads)]
    lines += _calls(chance, limits, "  ")
    lines += [f"  {chance.choice(('stop', 'join', 'join'))}_thread(h{number})" for number in range(threads)]
    lines += [f"  {line}" for line in CLEANUP.split("\n")] if chance.random() < 0.5 else []
    return "\n".join([*lines, "end"]) + "\n", limits


def _calls(chance: Random, limits: dict[int, float], indent: str) -> list[str]:
    lines = [f"for n in range({chance.randrange(1, 4)}):"]
    for _ in range(chance.randrange(5, 21)):
        call, limit_s = random_call(chance)
        number = len(limits)
        limits[number] = limit_s
        lines += [f'  textmsg("begin ", {number})', "  try:", f'    textmsg("is ", {call})']
        lines += ["  except Exception as problem:", '    textmsg("raised ", repr(problem))', "  end"]
        lines += [f'  textmsg("end ", {number})']
    return [indent + line for line in [*lines, "end"]]


def random_secondary(chance: Random) -> str:
    """A `sec` that talks: it does not wait."""
    calls = [random_call(chance)[0] for _ in range(chance.randrange(1, 4))]
    return "\n".join(["sec poll():", *(f'  textmsg("sec ", {call})' for call in calls), "end"]) + "\n"
