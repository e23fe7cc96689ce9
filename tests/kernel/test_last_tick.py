"""What a served program gives away in its last tick leaves the robot before the end of its connection."""

from __future__ import annotations

import pytest

from elitescript.kernel import RobotOptions
from elitescript.kernel.kernel import Kernel
from elitescript.messages.inputs import ChannelOpened, RunUnit
from elitescript.messages.outputs import CloseChannel, OpenChannel, SendChannel
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.tcp import tcp_frame


def requests(kernel, text, ticks=60):
    """Run a program on a kernel whose connections all stand at once; return what it asks of them, in order."""
    inputs, asked = [RunUnit("test", "program", text)], []
    for _ in range(ticks):
        output = kernel.tick_and_snapshot(inputs)
        asked += output.requests
        inputs = [ChannelOpened(one.channel, True) for one in output.requests if isinstance(one, OpenChannel)]
    return [one for one in asked if not isinstance(one, OpenChannel)]


@pytest.mark.parametrize("last", ["pass", "halt()", "1 / 0", "socket_close()"])
def test_bytes_leave_before_the_end_of_the_connection(last):
    text = f'def a():\n  socket_open("10.0.0.5", 5000)\n  socket_send_line("done")\n  {last}\nend\n'
    assert requests(Kernel(RobotOptions(power_on=True)), text) == [SendChannel(1, b"done\n"), CloseChannel(1)]


@pytest.mark.parametrize("is_once", [True, False])
def test_a_modbus_request_leaves_though_the_program_is_over(is_once):
    text = f'def a():\n  modbus_send_custom_command("10.0.0.9", 255, 6, [0, 9, 1, 2], {is_once})\nend\n'
    first = requests(Kernel(RobotOptions(power_on=True)), text)[0]
    assert first == SendChannel(1, tcp_frame(1, 255, pdu.write_register(9, 258)))
