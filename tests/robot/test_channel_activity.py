"""What a run records of its connections, by kind: who has sent what, when, on which line."""

import pytest

from elitescript import VirtualRobot
from elitescript.messages.events import ChannelActivity
from elitescript.runtime.connections import traffic
from elitescript.runtime.connections.traffic import cut, shown
from elitescript.testing.world import Fault, ModbusDevice, RpcFault, SerialDevice, TcpServer, XmlRpcServer
from tests.devices.programs import run as run_beside


def activity(run, *fields):
    """The chosen fields of all of it; channel, kind, what, data and line if none is."""
    fields = fields or ("channel", "kind", "what", "data", "line")
    return [
        tuple(getattr(event, field) for field in fields) for event in run.events if isinstance(event, ChannelActivity)
    ]


def passed(run):
    return activity(run, "what", "data", "line")


class Camera(TcpServer):
    port = 5000

    def line_received(self, connection, line):
        return {"where": "12.5"}.get(line)


# ---------------------------------------------------------------------------------------------------------- sockets


def test_a_socket_from_its_opening_to_its_end():
    run = run_beside(
        """
socket_open("10.0.0.2", 5000, "camera")
socket_send_string("where\\n", "camera")
socket_read_string("camera", suffix="\\n")
socket_close("camera")
sleep(0.1)
""",
        Camera(),
    )
    assert activity(run) == [
        ("camera", "socket", "open", "10.0.0.2:5000", 2),
        ("camera", "socket", "sent", "where\n", 3),
        ("camera", "socket", "received", "12.5\n", 4),
        ("camera", "socket", "closed", "", 5),
    ]
    assert activity(run, "tick", "thread") == [(1, "main"), (1, "main"), (3, "main"), (3, "main")]


def test_a_reading_that_waits_in_vain():
    run = run_beside(
        """
socket_open("10.0.0.2", 5000, "camera")
socket_read_string("camera", timeout=0.5)
""",
        Camera(),
    )
    assert passed(run)[1:] == [("timeout", "0.5 s for data on socket 'camera'", 3), ("closed", "", 0)]


def test_what_arrives_in_the_last_moment_is_no_timeout():
    class Late(TcpServer):
        port = 5000

        def opened(self, connection):
            self.after(0.5, connection.send, "now\n")

    body = """
socket_open("10.0.0.2", 5000, "late")
socket_read_string("late", suffix="\\n", timeout={})
"""
    in_time = [run_beside(body.format(limit), Late()) for limit in (0.504, 0.508, 0.512)]
    whats = [[what for what, _, line in passed(run) if line == 3] for run in in_time]
    assert ["received"] in whats
    assert all("timeout" not in what or "received" not in what for what in whats), whats


def test_a_connection_that_is_refused_or_not_answered():
    refused = run_beside('socket_open("10.0.0.2", 5999, "nobody")', Camera(address="10.0.0.2"))
    assert activity(refused) == [("nobody", "socket", "refused", "10.0.0.2:5999: connection refused", 2)]
    silent = run_beside(
        'socket_open("10.0.0.2", 5000, "camera")', Camera(), faults=[Fault("silence", on=5000, direction="both")]
    )
    assert passed(silent) == [("timeout", "no answer within 2 s", 2)]


def test_an_address_that_is_not_let_through_is_refused_and_silent():
    run = VirtualRobot("CS66").run('def main():\n  socket_open("h", 1, "x")\nend\n')
    assert [event[:3] for event in activity(run)] == [("x", "socket", "refused"), ("x", "socket", "timeout")]


def test_a_server_that_closes():
    class Rude(TcpServer):
        port = 5000

        def opened(self, connection):
            connection.close()

    run = run_beside('socket_open("10.0.0.2", 5000, "camera")\nsleep(0.1)', Rude())
    assert passed(run) == [("open", "10.0.0.2:5000", 2), ("closed", "by the other side", 0)]


def test_what_nobody_waits_for_has_no_line():
    class Eager(TcpServer):
        port = 5000

        def opened(self, connection):
            self.after(0.1, connection.send, "hello\n")

    run = run_beside('socket_open("10.0.0.2", 5000, "camera")\nsleep(0.5)', Eager())
    assert ("received", "hello\n", 0) in passed(run)


# -------------------------------------------------------------------------------------------------------------- rpc


class Planner(XmlRpcServer):
    port = 8000

    def next_pose(self, n):
        if n > 2:
            raise RpcFault(7, "no part is left")
        return [0.5, n]


def test_calls_and_their_answers():
    run = run_beside(
        """
planner = rpc_factory("xmlrpc", "http://10.0.0.2:8000/RPC2")
planner.next_pose(1)
try:
  planner.next_pose(3)
except:
  pass
""",
        Planner(),
    )
    assert activity(run)[:5] == [
        ("http://10.0.0.2:8000/RPC2", "rpc", "open", "10.0.0.2:8000", 3),
        ("http://10.0.0.2:8000/RPC2", "rpc", "sent", "next_pose(1)", 3),
        ("http://10.0.0.2:8000/RPC2", "rpc", "received", "[0.5, 1]", 3),
        ("http://10.0.0.2:8000/RPC2", "rpc", "sent", "next_pose(3)", 5),
        ("http://10.0.0.2:8000/RPC2", "rpc", "received", "fault 7: no part is left", 5),
    ]


def test_calls_that_are_not_answered():
    body = 'rpc_factory("xmlrpc", "http://10.0.0.2:8000/RPC2").next_pose(1)'
    refused = run_beside(body.replace("8000", "8001"), Planner(address="10.0.0.2"))
    assert activity(refused) == [
        ("http://10.0.0.2:8001/RPC2", "rpc", "refused", "10.0.0.2:8001: connection refused", 2)
    ]
    mute = run_beside(body, Planner(), faults=[Fault("silence", on=8000, direction="to_robot")])
    assert [event[0] for event in passed(mute)] == ["open", "sent", "timeout", "closed"]


# ----------------------------------------------------------------------------------------------------- MODBUS TCP


def test_signals_of_modbus_are_recorded_when_they_change_and_not_when_they_are_asked():
    class Mover(ModbusDevice):
        port = 502

        def started(self):
            self.after(1.0, self.move)

        def move(self):
            self.holding_registers[0] = 11

    run = run_beside(
        """
modbus_add_signal("10.0.0.2", 1, 0, 3, "speed")
sleep(2)
modbus_set_output_register("speed", 99)
sleep(1)
""",
        Mover(holding_registers=[10, 20, 30]),
    )
    assert activity(run) == [
        ("10.0.0.2:502", "modbus", "open", "", 0),
        ("speed", "modbus", "received", "10", 0),
        ("speed", "modbus", "received", "11", 0),
        ("speed", "modbus", "sent", "99", 4),
    ]


def test_errors_of_modbus_are_recorded_once_and_the_value_afterwards():
    run = run_beside(
        """
modbus_add_signal("10.0.0.2", 1, 7, 0, "door")
sleep(6)
""",
        ModbusDevice(port=502, discrete_inputs=10),
        faults=[Fault("silence", on=502, direction="to_robot", at_s=1.0, for_s=1.5)],
    )
    assert [event for event in activity(run) if event[0] == "door"] == [
        ("door", "modbus", "received", "False", 0),
        ("door", "modbus", "timeout", "no answer within 1 s", 0),
        ("door", "modbus", "received", "False", 0),
    ]


def test_a_device_that_refuses_an_address():
    run = run_beside(
        'modbus_add_signal("10.0.0.2", 1, 70, 3, "speed")\nsleep(1)', ModbusDevice(port=502, holding_registers=2)
    )
    found = [event[2:4] for event in activity(run) if event[0] == "speed"]
    assert [what for what, _ in found] == ["refused"]


def test_custom_commands_are_recorded_each():
    run = run_beside(
        """
modbus_send_custom_command("10.0.0.2", 1, 6, [0, 1, 0, 99])
sleep(0.5)
modbus_send_custom_command("10.0.0.2", 1, 6, [0, 1, 0, 99])
sleep(0.5)
""",
        ModbusDevice(port=502, holding_registers=3),
    )
    of_commands = [event for event in passed(run) if event[0] in ("sent", "received")]
    assert of_commands == [
        ("sent", "slave 1: 06 00 01 00 63", 2),
        ("received", "slave 1: 06 00 01 00 63", 0),
        ("sent", "slave 1: 06 00 01 00 63", 4),
        ("received", "slave 1: 06 00 01 00 63", 0),
    ]


def test_outputs_that_are_tied_to_the_program():
    run = run_beside(
        """
modbus_add_signal("10.0.0.2", 1, 0, 1, "lamp")
modbus_set_runstate_dependent_choice("lamp", 3)
sleep(0.5)
""",
        ModbusDevice(port=502, coils=3),
    )
    assert [event[2:] for event in activity(run) if event[0] == "lamp" and event[2] == "sent"] == [
        ("sent", "True", 3),
        ("sent", "False", 0),
    ]


# ---------------------------------------------------------------------------------------------------- serial ports


class Scale(SerialDevice):
    line = "/dev/ttymxc0"

    def received(self, data):
        return b"1.25\x00" if data == b"W" else None


def test_plain_serial_ports():
    run = run_beside(
        """
serial_config(True, 115200, 0, 1, 8, False)
serial_write("W")
serial_read(5, False, 1.0)
serial_read(3, False, 0.2)
""",
        Scale(),
    )
    found = activity(run)
    assert found[0] == ("box", "serial", "open", "115200 8N1", 2)
    assert ("box", "serial", "sent", "W", 3) in found
    got = [event[3] for event in found if event[2] == "received"]
    assert "".join(got) == "1.25\\x00"
    assert found[-1] == (
        "box", "serial", "timeout", "3 of 3 bytes on the serial port /dev/ttymxc0 have not come in time", 5
    )  # fmt: skip


def test_a_port_to_which_nothing_is_connected():
    run = VirtualRobot("CS66").run(
        'def main():\n  tool_serial_config(True, 9600, 2, 1)\n  tool_serial_write("x")\nend\n'
    )
    assert activity(run) == [
        ("tool", "serial", "open", "nothing is connected", 2),
        ("tool", "serial", "sent", "x", 3),
    ]


def test_slaves_on_a_serial_port():
    run = run_beside(
        """
tool_serial_config(True, 115200, 0, 1, 8, True)
tool_modbus_write_single_register(9, 0, 42)
tool_modbus_read_registers(9, 0, 2)
tool_modbus_read_registers(9, 70, 1)
tool_modbus_read_registers(8, 0, 1, 0.5)
""",
        ModbusDevice(line="tool", unit=9, holding_registers=2),
    )
    assert activity(run)[1:] == [
        ("tool", "serial", "sent", "slave 9: write register 0 = 42", 3),
        ("tool", "serial", "received", "slave 9: done", 3),
        ("tool", "serial", "sent", "slave 9: read holding registers 0 to 1", 4),
        ("tool", "serial", "received", "slave 9: 42, 0", 4),
        ("tool", "serial", "sent", "slave 9: read holding registers 70", 5),
        ("tool", "serial", "refused", "slave 9: exception 2: illegal data address", 5),
        ("tool", "serial", "sent", "slave 8: read holding registers 0", 6),
        ("tool", "serial", "timeout", "slave 8: no answer in time", 6),
    ]


# --------------------------------------------------------------------------------------------------------- bounds


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"done\r\n", "done\r\n"),
        (b"\x00\x00\x01\x02", "\\x00\\x00\\x01\\x02"),
        ("20 °C".encode(), "20 °C"),
        (b"\xff\xfeA", "\\xff\\xfeA"),
        (b"\x1b[31m\x7f", "\\x1b[31m\\x7f"),
        ("\x9b".encode(), "\\x9b"),
        (b"x" * 200, "x" * 200),
        (b"x" * 201, "x" * 200 + "… (201 bytes)"),
    ],
)
def test_bytes_as_text(data, text):
    assert shown(data) == text


def test_texts_are_cut():
    assert cut("x" * 200) == "x" * 200
    assert cut("x" * 300) == "x" * 200 + "… (300 characters)"


def test_a_flood_is_recorded_up_to_a_bound_in_each_tick(monkeypatch):
    monkeypatch.setattr(traffic, "PER_TICK_MAX", 3)
    run = run_beside(
        """
socket_open("10.0.0.2", 5000, "camera")
for n in range(10):
  socket_send_string(str(n), "camera")
end
sleep(0.1)
socket_send_string("later", "camera")
""",
        Camera(),
    )
    assert [data for what, data, _ in passed(run) if what == "sent"] == ["0", "1", traffic.LEFT_OUT, "later"]


def test_the_name_of_a_channel_is_cut():
    run = VirtualRobot("CS66").run('def main():\n  socket_open("h", 1, "x" * 5000)\nend\n')
    assert len(activity(run, "channel")[0][0]) == 80
