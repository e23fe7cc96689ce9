"""`python -m benchmarks.served_day HOURS`: memory of a served robot, MB, on the way through so much robot time.

The robot, the line between parent and child, and the connections of every port run in this process, as fast as they
can and without sockets. A program moves the arm, writes texts, shows popups and talks to a peer; clients stream, write
inputs, ask and go again; scripts run beside the program. Prints robot hours, wall seconds and memory, 24 times.
"""

from __future__ import annotations

import struct
import sys
from time import perf_counter

from benchmarks.day import resident_mb
from benchmarks.serving import OUTPUTS, message
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened, Input, RunUnit
from elitescript.messages.outputs import ChannelRequest, CloseChannel, OpenChannel, Output, SendChannel
from elitescript.protocol.connection import Connection
from elitescript.protocol.ports import SERVICES
from elitescript.services.child.output_changes import OutputReader, OutputWriter

PROGRAM = """def day():
  n = 0
  while True:
    n = n + 1
    movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    textmsg("part ", n)
    set_standard_digital_out(0, True)
    set_payload(1, [0, 0, 0.05])
    socket_open("127.0.0.1", 50000, "peer")
    socket_send_string("part", "peer")
    got = socket_read_string("peer", timeout=0.1)
    socket_close("peer")
    movej([-0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    set_payload(0, [0, 0, 0])
    set_standard_digital_out(0, False)
    if n % 20 == 0:
      popup("part", blocking=False)
    end
    write_output_integer_register(0, n % 1000)
    sleep(0.3)
  end
end
"""
SAID_BY_PORT = {
    "dashboard": b"robotMode\nstatus\nspeed\npopup -s part\nclosePopup\n",
    "primary": b"sec blink():\n  set_standard_digital_out(1, True)\nend\n",
    "interpreter": b"",
    "query": b"req 1 get_actual_joint_positions()\n",
}
STREAMS = 10
STRETCHES = 24
VISIT_TICKS = 500
"""How long a client stays."""


class Peers:
    """Everybody that the robot's programs connect to: they answer every line and never go by themselves."""

    def take(self, requests: tuple[ChannelRequest, ...]) -> list[Input]:
        """What comes back."""
        found: list[Input] = []
        for request in requests:
            if isinstance(request, OpenChannel):
                found.append(ChannelOpened(request.channel, True, ""))
            elif isinstance(request, SendChannel):
                found.append(ChannelCredit(request.channel, len(request.data)))
                found.append(ChannelData(request.channel, b"answer\n"))
            elif isinstance(request, CloseChannel):
                found.append(ChannelClosed(request.channel, ""))
        return found


class Clients:
    """Ten streams that stay and write, and one client of every port that comes and goes."""

    def __init__(self, kernel: Kernel, output: Output) -> None:
        self._connects = {service.name: service.open(kernel.description) for service in SERVICES}
        self._count = 0
        self._answer = message("U", b"\1" + struct.pack(">i", 7))
        self._streams = [self._stream(output) for _ in range(STREAMS)]
        self._streams[0].receive(message("I", b"input_int_register0"), output)
        self._visitors: list[Connection] = []

    def step(self, output: Output) -> list[Input]:
        """Give everybody a tick; return what they ask for."""
        inputs: list[Input] = []
        if output.tick % VISIT_TICKS == 0:
            for visitor in self._visitors:
                inputs += visitor.closed()
            self._visitors = [self._stream(output), *(self._visitor(name) for name in self._connects)]
        elif output.tick % VISIT_TICKS == 20:
            for visitor in self._visitors:
                name = visitor.origin.partition("#")[0]
                inputs += visitor.receive(SAID_BY_PORT.get(name, b""), output)
        if output.tick % 5 == 0:
            inputs += self._streams[0].receive(self._answer, output)
        for connection in (*self._streams, *self._visitors):
            connection.publish(output)
            inputs += connection.due()
            connection.take()
        return inputs

    def _visitor(self, name: str) -> Connection:
        self._count += 1
        return self._connects[name](f"{name}#{self._count}")

    def _stream(self, output: Output) -> Connection:
        connection = self._visitor("rtsi")
        connection.receive(message("O", struct.pack(">d", 250.0) + OUTPUTS.encode()) + message("S"), output)
        return connection


def main(hours: float) -> None:
    """Print robot hours, wall seconds and memory after each 24th."""
    kernel, peers = Kernel(RobotOptions(power_on=True)), Peers()
    writer, reader = OutputWriter(), OutputReader()
    output = reader.read(*writer.message(kernel.tick_and_snapshot()))
    clients = Clients(kernel, output)
    inputs: list[Input] = [RunUnit("primary#0", "program", PROGRAM)]
    began = perf_counter()
    said: dict[str, int] = {}
    for stretch in range(1, STRETCHES + 1):
        for _ in range(round(hours * 3600 * 250 / STRETCHES)):
            output = reader.read(*writer.message(kernel.tick_and_snapshot(inputs)))
            for event in output.events:
                said[type(event).__name__] = said.get(type(event).__name__, 0) + 1
            inputs = peers.take(output.requests)
            inputs += clients.step(output)
        hours_s = output.tick * 0.004 / 3600
        print(f"{hours_s:8.3f} h  {perf_counter() - began:8.1f} s  {resident_mb():7.2f} MB", flush=True)
        if stretch in (1, STRETCHES):
            print("         ", ", ".join(f"{count} {name}" for name, count in sorted(said.items())), flush=True)


if __name__ == "__main__":
    main(float(sys.argv[1]))
