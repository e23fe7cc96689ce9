"""One rule for what programs reach outside their world, whatever they speak and however they are run."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.environment import tcp_channel
from elitescript.errors import UsageError
from elitescript.messages.events import BARRED, ChannelActivity, Warned
from elitescript.pytest_plugin.marker import robot_arguments, serve_arguments
from elitescript.services.channels.connect_policy import ConnectPolicy, policy_values
from elitescript.testing.world import ModbusDevice, TcpServer, Wire, World
from elitescript.world_file import closed_world

WIRE = "[[wire]]\nwhen = 'standard_digital_out[0]'\nthen = 'standard_digital_in[1]'\n"

SOCKET = """
def plc():
  ok = socket_open("192.168.1.5", 502, "plc")
  textmsg(ok)
end
"""
MODBUS = """
def plc():
  modbus_add_signal("192.168.1.5", 255, 0, 1, "coil", False)
  modbus_set_output_signal("coil", True)
  sleep(3)
  textmsg(modbus_get_error("coil")[0] != 0)
end
"""
RPC = """
def plc():
  camera = rpc_factory("xmlrpc", "http://192.168.1.5:502/RPC2")
  try:
    camera.look()
  except Exception as error:
    textmsg("no connection within 2 s" in str(error))
  end
end
"""


class Camera(TcpServer):
    port = 5000
    address = "10.0.0.7"

    def line_received(self, connection, line):
        return "seen"


@pytest.fixture(autouse=True)
def no_contact(monkeypatch):
    """Fail on every packet and every query."""

    class Never(socket.socket):
        def connect_ex(self, address):
            raise AssertionError(f"connected to {address}")

        connect = connect_ex

    inner = socket.getaddrinfo

    def getaddrinfo(host, port, *args, flags=0, **more):
        assert flags & socket.AI_NUMERICHOST, f"{host!r} is looked up"
        return inner(host, port, *args, flags=flags, **more)

    monkeypatch.setattr(tcp_channel.socket, "socket", Never)
    monkeypatch.setattr(socket, "getaddrinfo", getaddrinfo)


def worlds(tmp_path: Path) -> dict[str, object]:
    (tmp_path / "wires.toml").write_text(WIRE)
    (tmp_path / "devices.toml").write_text("[[tcp]]\nport = 5000\naddress = '10.0.0.7'\n")
    (tmp_path / "real.toml").write_text(f"[world]\nnetwork = 'real'\n{WIRE}")
    (tmp_path / "robot.toml").write_text("[robot]\nnetwork = 'local'\n")
    return {
        "no world": None,
        "wires in Python": World(wires=[Wire(when="standard_digital_out[0]", then="standard_digital_in[1]")]),
        "wires in a file": tmp_path / "wires.toml",
        "devices in Python": World(devices=[Camera()]),
        "devices in a file": tmp_path / "devices.toml",
        "a file that leads outside": tmp_path / "real.toml",
        "a file about the robot": tmp_path / "robot.toml",
        "a closed world": World(network="virtual"),
        "closed by its door": closed_world(None),
    }


NAMES = [
    "no world",
    "wires in Python",
    "wires in a file",
    "devices in Python",
    "devices in a file",
    "a file that leads outside",
    "a file about the robot",
    "a closed world",
    "closed by its door",
]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("program", "log", "line"), [(SOCKET, "False", 3), (MODBUS, "True", 3), (RPC, "True", 5)])
def test_a_real_address_is_as_one_without_a_host(tmp_path, name, program, log, line):
    robot = VirtualRobot(world=worlds(tmp_path)[name])
    run = robot.run(program, until_s=30)
    assert (run.state, run.log, run.is_paced) == ("finished", [log], False)
    assert run.time_s == pytest.approx(3.0 if program is MODBUS else 2.0, abs=0.02)
    warned = [event for event in run.events if isinstance(event, Warned) and event.code == BARRED]
    assert (warned[0].line, warned[0].thread) == (line, "main")
    assert warned[0].text.startswith("not connected to 192.168.1.5:502: it is n")
    assert ('`network="192.168.1.5:502"` allows it' in warned[0].text) is ("closed" not in name)
    assert ("this run is closed" in warned[0].text) is ("closed" in name)
    refused = [event for event in run.events if isinstance(event, ChannelActivity) and event.what == "refused"]
    assert refused[0].line == line and refused[0].data == warned[0].text
    assert "has refused" in warned[-1].text and "192.168.1.5:502" in warned[-1].text
    assert not run.alarms


def test_the_same_wire_means_the_same_in_python_and_in_a_file(tmp_path):
    found = worlds(tmp_path)
    records = []
    for name in ("wires in Python", "wires in a file"):
        run = VirtualRobot(world=found[name]).run(SOCKET)
        records.append((run.time_s, run.log, run.warnings, list(run.events)))
    assert records[0] == records[1]


def test_each_statement_that_is_refused_is_named_once():
    run = VirtualRobot().run(
        """
def plc():
  for i in range(3):
    socket_open("10.0.0.1", 80, "a")
  end
  socket_open("10.0.0.1", 80, "a")
  socket_open("camera.local", 80, "b")
end
"""
    )
    lines = [event.line for event in run.events if isinstance(event, Warned) and event.code == BARRED]
    assert lines == [4, 6, 7, 0]
    assert run.warnings[-1] == (
        'network="local" has refused 5 connections: 10.0.0.1:80 (4 times), camera.local:80; '
        '`network="10.0.0.1:80,camera.local:80"` allows them'
    )


def test_a_device_is_reached_whatever_the_option_is_and_has_no_other_ports():
    text = """
def ask():
  textmsg(socket_open("10.0.0.7", 5000, "camera"))
  socket_send_line("look", 0, "camera")
  textmsg(socket_read_string("camera"))
  textmsg(socket_open("10.0.0.7", 5001, "other"))
end
"""
    for network in ("none", "local", "all", "10.0.0.7:5001"):
        run = VirtualRobot(world=World(devices=[Camera()]), network=network).run(text)
        assert [entry.strip() for entry in run.log] == ["True", "seen", "False"]
        # There is a host at that address: it refuses at once.
        assert run.time_s < 0.5 and not any(event.code for event in run.events if isinstance(event, Warned))


def test_a_modbus_device_of_the_world_is_reached_by_a_name_that_is_not_looked_up():
    plc = ModbusDevice(port=502)
    run = VirtualRobot(world=World(devices=[plc]), network="none").run(
        """
def plc():
  modbus_add_signal("plc.factory", 255, 0, 1, "coil", False)
  modbus_set_output_signal("coil", True)
  sleep(1)
end
"""
    )
    assert plc.coils[0] is True or plc.coils[0] == 1
    assert not run.warnings


def test_a_serial_port_that_no_option_names_is_silent_and_the_option_is_named():
    run = VirtualRobot().run(
        """
def weigh():
  tool_serial_config(True, 115200, 0, 1)
  textmsg(tool_serial_write("x"))
end
"""
    )
    (warned,) = [event for event in run.events if isinstance(event, Warned)]
    assert (warned.code, warned.line, warned.hint) == (
        BARRED,
        3,
        '`--serial tool=DEVICE`, in Python `lines={"tool": DEVICE}`, binds it to a port of this computer',
    )
    assert run.state == "finished"


def test_a_line_that_stands_for_a_serial_port_is_reached_because_an_option_names_it(monkeypatch, capsys):
    met = []

    class Noted(socket.socket):
        def connect_ex(self, address):
            met.append(address)
            return 111

    monkeypatch.setattr(tcp_channel.socket, "socket", Noted)
    robot = VirtualRobot(lines={"tool": "socket://10.0.0.3:7000"}, network="none")
    run = robot.run("def weigh():\n  tool_serial_config(True, 115200, 0, 1)\n  socket_open('10.0.0.3', 7000)\nend")
    assert met == [("10.0.0.3", 7000)]
    assert "10.0.0.3:7000" in capsys.readouterr().err
    assert 'network="none" has refused 1 connection: 10.0.0.3:7000' in run.warnings[-1]


def test_the_option_is_one_of_the_robot(tmp_path):
    (tmp_path / "cell.toml").write_text("[robot]\nnetwork = 'none'\n")
    assert VirtualRobot().options.network == "local"
    assert VirtualRobot(world=tmp_path / "cell.toml").options.network == "none"
    assert VirtualRobot(world=tmp_path / "cell.toml", network="10.0.0.1").options.network == "10.0.0.1"
    assert VirtualRobot(**robot_arguments({"network": "all"}, tmp_path)).options.network == "all"
    (tmp_path / "cell.toml").write_text("[robot]\nnetwork = 'a b'\n")
    with pytest.raises(UsageError, match=r"cell.toml:2: \[robot\] network must be"):
        VirtualRobot(world=tmp_path / "cell.toml")


def test_a_served_robot_of_a_test_reaches_this_computer_unless_the_marker_says_more(tmp_path):
    (tmp_path / "cell.toml").write_text("[robot]\nnetwork = '10.0.0.2'\n")
    assert serve_arguments({}, tmp_path) == ["--allow-connect=local"]
    assert serve_arguments({"network": "none"}, tmp_path) == ["--allow-connect=none"]
    assert serve_arguments({"network": "10.0.0.1,plc"}, tmp_path) == [
        "--allow-connect=10.0.0.1,plc",
        "--allow-connect=local",
    ]
    # `serve` reads it there.
    assert serve_arguments({"world": "cell.toml"}, tmp_path) == ["--world", str(tmp_path / "cell.toml")]
    with pytest.raises(UsageError, match="network must be"):
        serve_arguments({"network": "a b"}, tmp_path)


@pytest.mark.parametrize(
    ("given", "network", "address", "is_allowed"),
    [
        ([], None, "8.8.8.8", True),
        ([], "local", "8.8.8.8", False),
        ([], "local", "127.0.0.1", True),
        ([], "none", "127.0.0.1", False),
        ([], "10.0.0.1", "10.0.0.1", True),
        ([], "10.0.0.1", "127.0.0.1", True),
        ([], "10.0.0.1", "10.0.0.2", False),
        ([], "all", "169.254.169.254", True),
        (["all"], "none", "169.254.169.254", True),
        (["10.0.0.2,10.0.0.3"], "none", "10.0.0.3", True),
    ],
)
def test_serve_keeps_its_own_rule_and_reads_that_of_the_world_without_one(given, network, address, is_allowed):
    policy = ConnectPolicy(policy_values(given, network))
    assert (not policy.refusal(address, address, 80)) is is_allowed


def test_serve_looks_up_no_name_that_could_not_be_allowed():
    for values, name, is_asked in [
        ([], "plc", True),
        (["none"], "plc", False),
        (["local"], "plc", False),
        (["local"], "localhost", True),
        (["localhost:80"], "plc", False),
        (["10.0.0.0/8"], "plc", True),
        (["plc:502"], "plc", False),
        (["plc:80"], "plc", True),
        (["all"], "plc", True),
    ]:
        assert ConnectPolicy(values).looks_up(name, 80) is is_asked, (values, name)
