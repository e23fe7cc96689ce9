"""`check --reach`, and what `run` and `plot` say of what they do not reach."""

import json
import socket
from pathlib import Path

import pytest

from elitescript.cli.main import main

PROGRAM = """import os
from os import remove as gone
def cell(host):
  address = "192.168.1.5"
  socket_open(address, 502, "a")
  socket_open("localhost", 5020)
  socket_open("10.0.0.7", 5000, "camera")
  socket_open(host, 502, "a")
  rpc_factory("xmlrpc", "http://camera.local:8080/RPC2")
  modbus_add_signal("10.0.0.1", 255, 1, 1, "s", port=1502)
  tool_serial_config(True, 115200, 0, 1)
  serial_config(True, 115200, 0, 1)
  f = open("/task/points.csv")
  os.path.exists("../../etc/passwd")
  gone(host)
  g = socket_open
end
"""

BY_HAND = [
    (5, "socket", "socket_open", "192.168.1.5:502", False),
    (6, "socket", "socket_open", "localhost:5020", True),
    (7, "socket", "socket_open", "10.0.0.7:5000", True),
    (8, "socket", "socket_open", "host, 502", None),
    (9, "rpc", "rpc_factory", "camera.local:8080", True),
    (10, "modbus", "modbus_add_signal", "10.0.0.1:1502", False),
    (11, "serial", "tool_serial_config", "tool", False),
    (12, "serial", "serial_config", "/dev/ttymxc0", True),
    (13, "file", "open", "/task/points.csv", True),
    (14, "file", "os.path.exists", "../../etc/passwd", False),
    (15, "file", "os.remove", "host", None),
    (16, "socket", "socket_open", "socket_open", None),
]


@pytest.fixture
def cell(tmp_path):
    (tmp_path / "cell.script").write_text(PROGRAM)
    (tmp_path / "cell.toml").write_text("[[tcp]]\nport = 5000\n[robot]\nnetwork = 'camera.local'\n")
    return tmp_path


def test_every_address_port_line_and_file_is_listed(cell, capsys):
    command = ["check", "--reach", str(cell / "cell.script"), "--world", str(cell / "cell.toml")]
    command += ["--serial", "box=socket://10.0.0.3:7000"]
    assert main([*command, "--json"]) == 0
    out, err = capsys.readouterr()
    rows = [json.loads(line) for line in out.splitlines()]
    assert [(row["line"], row["kind"], row["by"], row["target"], row["reached"]) for row in rows] == BY_HAND
    assert {(row["type"], row["file"]) for row in rows} == {("reach", str(cell / "cell.script"))}
    assert (rows[0]["address"], rows[0]["port"], rows[0]["column"]) == ("192.168.1.5", 502, 3)
    assert "`--network camera.local,192.168.1.5:502` allows it" in rows[0]["why"]
    assert err == "12 places, 4 not let through by --network camera.local, 3 not known before the run\n"
    assert main(command) == 0
    assert f"{cell / 'cell.script'}:6:3: socket localhost:5020: yes: let through" in capsys.readouterr().out


def test_the_option_of_the_command_line_counts_more_than_the_world(cell, capsys):
    main(
        [
            "check",
            "--reach",
            "--json",
            str(cell / "cell.script"),
            "--world",
            str(cell / "cell.toml"),
            "--network",
            "none",
        ]
    )
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["line"] for row in rows if row["reached"]] == [7, 13]


@pytest.mark.parametrize("more", [["--fix"], ["--format", "sarif"]])
def test_it_goes_with_no_other_report(cell, more):
    assert main(["check", "--reach", str(cell / "cell.script"), *more]) == 2


def test_a_file_that_is_no_program_is_named(tmp_path, capsys):
    (tmp_path / "bad.script").write_bytes(b"\xff\xfe\x00")
    assert main(["check", "--reach", str(tmp_path / "bad.script")]) == 3
    assert main(["check", "--reach", str(tmp_path / "none.script")]) == 2
    assert "the text is UTF-16, not UTF-8" in capsys.readouterr().err


REFUSED = "def p():\n  socket_open('10.0.0.1', 80)\n  socket_open('10.0.0.1', 80)\nend\n"


def test_a_run_names_the_line_and_at_its_end_the_number(tmp_path, capsys, monkeypatch):
    (tmp_path / "p.script").write_text(REFUSED)
    assert main(["run", str(tmp_path / "p.script")]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert [line.split("W274")[1].partition(";")[0] for line in lines] == [
        ": line 2: not connected to 10.0.0.1:80: it is neither beside the robot nor a loopback address",
        ": line 3: not connected to 10.0.0.1:80: it is neither beside the robot nor a loopback address",
        ": --network local has refused 2 connections: 10.0.0.1:80 (2 times)",
    ]
    assert main(["plot", str(tmp_path / "p.script"), "-o", str(tmp_path / "p.html")]) == 0
    assert "has refused 2 connections" in capsys.readouterr().err


def test_a_real_connection_is_named_on_the_error_output_and_not_in_the_records(tmp_path, capsys):
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        path = Path(tmp_path, "p.script")
        path.write_text(f"def p():\n  socket_open('127.0.0.1', {port})\nend\n")
        assert main(["run", str(path), "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == f"elitescript: the program connects to 127.0.0.1:{port} (--network local)\n"
    assert all(json.loads(line)["type"] for line in out.splitlines())


@pytest.mark.parametrize("value", ["", "none,all", "10.0.0.1:0", "a b"])
def test_a_value_without_sense_is_a_mistake_of_usage(tmp_path, value, capsys):
    (tmp_path / "p.script").write_text(REFUSED)
    assert main(["run", str(tmp_path / "p.script"), f"--network={value}"]) == 2
    assert "--network must be" in capsys.readouterr().err


def test_what_is_not_written_as_a_value_is_said_to_be_unknown(tmp_path, capsys):
    rows = [
        # line, what is shown, whether it is let through
        ('socket_open("192.168.1." + str(n), 1)', "192.168.1.7:1", False),
        ('socket_open(f"192.168.1.{n}", 2)', "192.168.1.7:2", False),
        ('socket_open(f"192.168.1.{n:d}", 3)', "f'192.168.1.{n:d}', 3", None),
        ('socket_open("192.168.1.{}".format(n), 4)', "'192.168.1.{}'.format(n), 4", None),
        ("socket_open(hosts[1], 5)", "192.168.1.11:5", False),
        ("socket_open(where(), 6)", "where(), 6", None),
        ("socket_open(changed, 7)", "changed, 7", None),
        ('socket_open(*["192.168.1.5", 8])', "*['192.168.1.5', 8]", None),
        ('socket_open("192.168.1.5", *[9])', "'192.168.1.5', *[9]", None),
        ('socket_open(**{"address": "a"})', "**{'address': 'a'}", None),
        ("for h in hosts: socket_open(h, 10)", "h, 10", None),
        ("serial_config(True, 115200, 0, 1, *spread)", "True, 115200, 0, 1, *spread", None),
        ("modbus_add_signal(*spread)", "*spread", None),
        ("rpc_factory(*spread)", "*spread", None),
        ('open(mode="r", file="a.txt")', "/task/a.txt", True),
        ("open(*spread)", "*spread", None),
        ("reader = open", "open", None),
        ('eval("socket_open(1, 2)")', "'socket_open(1, 2)'", None),
        ("runner = exec", "exec", None),
        ("start_thread(socket_open, (hosts[0], 11))", "socket_open", None),
    ]
    head = 'n = 7\nhosts = ["192.168.1.10", "192.168.1.11"]\nchanged = "a"\nchanged = "b"\nspread = [1]\n'
    head += 'def where():\n  return "c"\nend\n'
    (tmp_path / "cell.script").write_text(head + "".join(f"{line}\n" for line, _, _ in rows))
    assert main(["check", "--reach", "--json", str(tmp_path / "cell.script")]) == 0
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(row["line"] - 8, row["target"], row["reached"]) for row in found] == [
        (number, shown, reached) for number, (_, shown, reached) in enumerate(rows, 1)
    ]
