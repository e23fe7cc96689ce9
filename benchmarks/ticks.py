"""What a tick of a served robot costs, in microseconds of processor time, apart and as a whole.

Parts run here, one tick after the other, with everything in the caches. The rows of `serve` are measured at a running
`elitescript serve` on its own clock, where every tick begins after a rest, with caches that others have used meanwhile:
what parent and child take there is some times the sum of the parts. Processor time hardly depends on what else the
computer does, lateness does. `TICKS_SECONDS` sets how long each row of `serve` is measured.
"""

from __future__ import annotations

import os
import selectors
import socket
import struct
import time
from collections.abc import Callable
from statistics import median

from benchmarks.serving import BUSY, OUTPUTS, Stream, message, processes_of, served, used_s
from benchmarks.table import Row

SECONDS = float(os.environ.get("TICKS_SECONDS", "4"))
TICKS = 2000
RUNS = 3
CLIENTS = 10
MOVING = b"""def moving():
  while True:
    movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
    movej([-0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  end
end
"""
STREAMING = b"""def streaming():
  q = get_target_joint_positions()
  middle = q[0]
  n = 0
  while True:
    n = n + 1
    q[0] = middle + 0.4 * sin(n * 0.004)
    servoj(q, t=0.004, lookahead_time=0.1, gain=300)
  end
end
"""
PROGRAMS = {"the arm rests": b"", "movej": MOVING, "servoj": STREAMING, "a program burns CPU": BUSY}


def rows() -> list[Row]:
    """The rows of this module."""
    table = [row for what, text in PROGRAMS.items() for row in _parts(what, text)]
    table += [_served(f"no clients, {what}", 0, PROGRAMS[what]) for what in ("the arm rests", "movej")]
    table += [_served(f"1 client, {what}", 1, PROGRAMS[what]) for what in ("the arm rests", "movej")]
    table.append(_served("1 client, in process, the arm rests", 1, b"", "--in-process"))
    table += [_served(f"{CLIENTS} clients, {what}", CLIENTS, text) for what, text in PROGRAMS.items()]
    table.append(_served(f"{CLIENTS} clients, in process", CLIENTS, b"", "--in-process"))
    return table


def _parts(what: str, program: bytes) -> list[Row]:
    from elitescript.kernel import Kernel, RobotOptions
    from elitescript.messages.inputs import Input, RunUnit
    from elitescript.messages.outputs import Output
    from elitescript.protocol.rtsi.connection import RtsiConnection
    from elitescript.protocol.rtsi.recipes import RtsiPort
    from elitescript.services.child.output_changes import OutputReader, OutputWriter

    kernel = Kernel(RobotOptions(power_on=True))
    begin: list[Input] = [RunUnit("primary#1", "program", program.decode())] if program else []
    writer, reader = OutputWriter(), OutputReader()
    port = RtsiPort()
    clients = [RtsiConnection(f"rtsi#{index}", kernel.description, port) for index in range(CLIENTS)]
    first = kernel.tick_and_snapshot()
    for client in clients:
        client.receive(message("O", struct.pack(">d", 250.0) + OUTPUTS.encode()) + message("S"), first)
    reader.read(*writer.message(kernel.tick_and_snapshot(begin)))
    for _ in range(TICKS // 10):
        reader.read(*writer.message(kernel.tick_and_snapshot()))
    times: list[list[float]] = [[], [], [], [], []]
    for _ in range(RUNS):
        outputs: list[Output] = []
        alone_s = _each_s(kernel.tick)
        times[4].append(alone_s)
        times[0].append(_each_s(lambda outputs=outputs: outputs.append(kernel.tick_and_snapshot())) - alone_s)
        left = iter(outputs)
        messages: list[tuple[str, bytes]] = []
        times[1].append(_each_s(lambda left=left, messages=messages: messages.append(writer.message(next(left)))))
        waiting = iter(messages)
        times[2].append(_each_s(lambda waiting=waiting: reader.read(*next(waiting))))
        shown = iter(outputs)
        times[3].append(_each_s(lambda shown=shown: _publish(clients, next(shown))) / CLIENTS)
    names = ("snapshot", "writing", "reading", "one package", "kernel")
    parts = zip(names, map(median, times), strict=True)
    return [Row(f"part of a tick, {what}: {name}", "us", cpu_s=time_s) for name, time_s in parts]


def _publish(clients: list, output: object) -> None:  # type: ignore[type-arg]
    for client in clients:
        client.publish(output)
        client.take()


def _each_s(step: Callable[[], object]) -> float:
    began = time.process_time()
    for _ in range(TICKS):
        step()
    return (time.process_time() - began) / TICKS


def _served(what: str, count: int, program: bytes, *options: str) -> Row:
    with served(*options) as (ports, pid):
        processes = processes_of(pid)
        streams = [Stream(ports["rtsi"], OUTPUTS) for _ in range(count)]
        selector = selectors.DefaultSelector()
        for stream in streams:
            selector.register(stream.socket, selectors.EVENT_READ, stream)
            stream.socket.sendall(message("S"))
        if program:
            with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
                peer.sendall(program)
        for seconds in (1.0, SECONDS):
            before = used_s(processes)
            began = time.perf_counter()
            while (left := began + seconds - time.perf_counter()) > 0:
                for key, _ in selector.select(left):
                    key.data.read()
            ticks = (time.perf_counter() - began) * 250
            used = [(now - start) / ticks for now, start in zip(used_s(processes), before, strict=True)]
        for stream in streams:
            stream.socket.close()
    names = ("parent", "child")
    shares = ", ".join(f"{name} {share * 1e6:.0f} us" for name, share in zip(names, used, strict=False))
    return Row(f"a tick of serve, {what}", "us", cpu_s=sum(used), words=f"{shares}; {sum(used) * 250:.0%} of a core")
