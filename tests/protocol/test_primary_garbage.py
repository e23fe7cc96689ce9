"""Garbage on the ports that take programs: one warning for each burst, and no harm to what is script."""

from __future__ import annotations

import random

import pytest

from elitescript.messages.inputs import AddLog, Do, RunUnit
from elitescript.messages.machine import StopTask
from elitescript.protocol.primary.connection import PRIMARY, REALTIME, SECONDARY, SILENCE_TICKS
from tests.protocol.snapshots import output
from tests.protocol.test_primary import ME, connect


def burst(data, port=PRIMARY):
    """What the robot is given when these bytes come, then silence, and the client goes."""
    connection = connect(port)
    inputs = connection.receive(data, output(0))
    for tick in range(1, 2 * SILENCE_TICKS):
        connection.publish(output(tick))
        inputs += connection.due()
    return inputs + connection.closed()


class TestGarbage:
    @pytest.mark.parametrize("port", [PRIMARY, SECONDARY, REALTIME])
    @pytest.mark.parametrize(
        ("data", "told"),
        [
            (bytes(5000), r"5000 characters in 1 line that are no script, beginning with '\x00"),
            (bytes(5000) + b"\n", "5000 characters in 1 line "),
            (b"\0\n" * 40, "40 characters in 40 lines "),
            (b"\x16\x03\x01\x02" * 100, "400 characters in 1 line "),
            (b"\xff\xfe" * 100 + b"\n", "200 characters in 1 line "),
        ],
    )
    def test_a_burst_is_one_warning_with_a_count(self, port, data, told):
        inputs = burst(data, port)
        assert [(type(item), item.is_warning) for item in inputs] == [(AddLog, True)]
        assert told in inputs[0].text
        assert inputs[0].text.startswith(f"{ME} sent ")

    @pytest.mark.parametrize("seed", range(8))
    def test_random_bytes_are_one_warning(self, seed):
        assert len(burst(b"\x80" + random.Random(seed).randbytes(5000))) == 1

    @pytest.mark.parametrize(
        "data",
        [
            b"GET / HTTP/1.1\r\nHost: 127.0.0.1:30001\r\nUser-Agent: curl/8.5 (Linux)\r\nAccept: */*\r\n\r\n",
            b"SSH-2.0-OpenSSH_9.6\r\n",
            b"\x00\x05V\x00\x01\x00\x03v",
        ],
    )
    def test_other_protocols_are_one_warning(self, data):
        assert len(burst(data)) == 1

    def test_what_is_script_runs_between_it(self):
        first, second, third, log = burst(b"\0\0\nhalt()\n\x01\nstop task\nx\ny = 1\n")
        assert (first, second, third) == (
            RunUnit(ME, "line", "halt()"),
            Do(ME, StopTask()),
            RunUnit(ME, "line", "y = 1"),
        )
        assert "4 characters in 3 lines" in log.text

    def test_one_that_never_ends_is_told_every_second(self):
        connection = connect()
        inputs = []
        for tick in range(1000):
            inputs += connection.receive(b"\0\n", output(tick))
            connection.publish(output(tick))
            inputs += connection.due()
        assert [item.text.split(" characters")[0] for item in inputs] == [f"{ME} sent 251"] * 3

    def test_it_is_told_when_the_client_goes(self):
        connection = connect()
        connection.receive(b"\0\n", output(0))
        (log,) = connection.closed()
        assert "1 character in 1 line" in log.text
        assert connect().closed() == []

    @pytest.mark.parametrize("line", ["textmsg('\x1b')", "x = 1", "\tx = 1", "'\ufffd'", ")"])
    def test_what_may_be_script_is_left_to_the_language(self, line):
        assert connect().receive(line.encode() + b"\n", output(0)) == [RunUnit(ME, "line", line)]

    def test_remote_control_is_what_the_last_tick_says(self):
        connection = connect()
        connection.receive(b"stop task", output(0))
        connection.publish(output(1, is_remote=False))
        (log,) = connection.closed()
        assert isinstance(log, AddLog)
        connection.publish(output(2))
        assert connection.receive(b"stop task\n", output(2)) == [Do(ME, StopTask())]
