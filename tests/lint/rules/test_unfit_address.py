from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2:5000", 5000)',),
        ('socket_open("192.168.1.300", 5000)',),
        ('socket_open("192.168.1", 5000)',),
        ('socket_open("http://10.0.0.2/", 5000)',),
        ('socket_open("10,0,0,2", 5000)',),
        ('socket_open(" 10.0.0.2", 5000)',),
        ('modbus_add_signal("10.0.0.5:502", 255, 0, 2, "s")',),
        ('modbus_add_signal("10.0.0.5", 255, 40001, 3, "s")',),
        ('ip = "10.0.0.256"', 'modbus_add_signal(ip, 255, 0, 3, "s")'),
        ('modbus_add_signal("10.0.0.5", 255, 30010, 2, "s")',),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W252"]


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2", 5000)',),
        ('socket_open("plc.local", 5000)',),
        ('socket_open("localhost", 5000)',),
        ('modbus_add_signal("10.0.0.5", 255, 400, 3, "s")',),
        ('modbus_add_signal("10.0.0.5", 255, 40001, 2, "s")',),
        ('socket_open("fe80::1", 5000)',),
        ("ip = get_task_path()", "socket_open(ip, 5000)"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W252" not in [problem.split()[0] for problem in body(*lines)]
