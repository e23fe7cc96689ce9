"""200 MODBUS TCP signals, each its own request, 250 times a second: the most that the controller's manual allows.

The slave is ours, in a process of its own. Ours is the controller's master, ticked by a clock as a served or paced
robot ticks it; what arrives is looked at as soon as it arrives only to see when a cycle was done, and handed over at
the next tick. The other is pymodbus' asynchronous client, which asks for the same registers in the same cycles,
one request after the other on each connection. A cycle is done when its last answer has come. `DEVICES_SECONDS` sets
how long each row is measured.
"""

from __future__ import annotations

import asyncio
import os
import selectors
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib.util import find_spec
from time import perf_counter, process_time, sleep
from typing import Any

from benchmarks.measure import environment
from benchmarks.table import Row, not_installed, print_rows

SECONDS = float(os.environ.get("DEVICES_SECONDS", "5"))
SIGNALS = 200
PORTS = 8
PERIOD_S = 0.004
ANSWER_SIZE = 11
"""Bytes of an answer with one register."""
WARM_UP = 250
"""Cycles in which connections are made and windows grow; they do not count."""
POLL_S = 0.0002


def serve() -> None:
    """Be the slave: print the ports, answer until standard input ends."""
    from elitescript.modbus.slave import MemoryTables, Slave, TcpSlave

    slave = Slave(MemoryTables(holding_registers=list(range(1000))))
    listeners = [socket.create_server(("127.0.0.1", 0)) for _ in range(PORTS)]
    selector = selectors.DefaultSelector()
    for listener in listeners:
        selector.register(listener, selectors.EVENT_READ)
    selector.register(sys.stdin, selectors.EVENT_READ)
    print(*(listener.getsockname()[1] for listener in listeners), flush=True)
    while True:
        for key, _ in selector.select():
            one = key.fileobj
            if not isinstance(one, socket.socket):
                return
            if key.data is None:
                peer, _ = one.accept()
                peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                selector.register(peer, selectors.EVENT_READ, TcpSlave(slave))
            elif data := one.recv(65536):
                one.sendall(key.data.take(data))
            else:
                selector.unregister(one)
                one.close()


@contextmanager
def _slave() -> Iterator[list[int]]:
    process = subprocess.Popen(
        [sys.executable, "-c", "from benchmarks.devices import serve; serve()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment(),
        text=True,
    )
    assert process.stdin is not None and process.stdout is not None
    try:
        yield [int(word) for word in process.stdout.readline().split()]
    finally:
        process.stdin.close()
        process.wait()


class Sockets:
    """The TCP connections of a run, as `environment.local_channels` has them, polled by the benchmark."""

    def __init__(self) -> None:
        self.open_channels: dict[int, Any] = {}
        self.sent = 0

    def open(self, address: str, port: int, timeout_s: float) -> int:
        from elitescript.environment.addresses import LOCAL
        from elitescript.environment.reach import Reach
        from elitescript.environment.tcp_channel import TcpChannel

        number, reach = len(self.open_channels) + 1, Reach(LOCAL)
        self.open_channels[number] = TcpChannel(number, address, port, reach, reach.decide(address, port))
        return number

    def send(self, channel: int, data: bytes) -> None:
        self.open_channels[channel].send(data)
        self.sent += len(data) // 12

    def credit(self, channel: int, size: int) -> None:
        self.open_channels[channel].room += size

    def close(self, channel: int) -> None:
        self.open_channels[channel].close()

    def poll(self) -> list[Any]:
        return [event for channel in self.open_channels.values() for event in channel.poll()]


def _ours(ports: list[int]) -> tuple[float, int, list[float], float]:
    """Requests per second, missed cycles, times of the cycles and the share of a core."""
    from elitescript.messages.inputs import ChannelData
    from elitescript.modbus.master.master import Master
    from elitescript.modbus.master.signals import SignalKind

    sockets, listeners = Sockets(), dict[int, Any]()
    master = Master(sockets, listeners, print, tick=-1)
    for index in range(SIGNALS):
        name = str(index)
        master.add("127.0.0.1", ports[index % len(ports)], name, SignalKind.REGISTER_OUTPUT, 255, index, 1)
        master.retime(name, 250)
    done_s: list[float] = []
    events: list[Any] = []
    received = 0
    cycles = int(SECONDS / PERIOD_S)
    began = perf_counter()
    first_answers, first_missed, first_cpu = 0, 0, 0.0
    for tick in range(WARM_UP + cycles):
        if tick == WARM_UP:
            first_answers, first_cpu = _answers(master), process_time()
            first_missed = sum(signal.missed for signal in master.signals.values())
        due = began + tick * PERIOD_S
        while (left := due - perf_counter()) > 0:
            sleep(left)
        events += sockets.poll()
        received += sum(len(event.data) for event in events if isinstance(event, ChannelData))
        for event in events:
            if event.channel in listeners:
                listeners[event.channel].take(event)
        events = []
        master.tick(tick, is_running=True)
        waiting = ANSWER_SIZE * sockets.sent - received
        while waiting > 0 and perf_counter() < due + PERIOD_S - POLL_S:
            sleep(POLL_S)
            new = sockets.poll()
            waiting -= sum(len(event.data) for event in new if isinstance(event, ChannelData))
            events += new
        if tick >= WARM_UP and waiting <= 0:
            done_s.append(perf_counter() - due)
    cpu = (process_time() - first_cpu) / (cycles * PERIOD_S)
    rate = (_answers(master) - first_answers) / (cycles * PERIOD_S)
    missed = sum(signal.missed for signal in master.signals.values()) - first_missed
    master.close()
    return rate, missed, done_s, cpu


def _answers(master: Any) -> int:
    return sum(link.exchange.answered for link in master.links.values())


async def _pymodbus(ports: list[int]) -> tuple[float, int, list[float], float]:
    from pymodbus.client import AsyncModbusTcpClient

    clients = [AsyncModbusTcpClient("127.0.0.1", port=port) for port in ports]
    for client in clients:
        await client.connect()

    async def ask(number: int) -> None:
        for index in range(number, SIGNALS, len(clients)):
            await clients[number].read_holding_registers(index, count=1, device_id=255)

    done_s: list[float] = []
    missed = 0
    cpu, began = process_time(), perf_counter()
    tick = 0
    while perf_counter() - began < SECONDS:
        due = began + tick * PERIOD_S
        if (left := due - perf_counter()) > 0:
            await asyncio.sleep(left)
        await asyncio.gather(*(ask(number) for number in range(len(clients))))
        done_s.append(perf_counter() - due)
        # What begins while this cycle still went on has no time of its own.
        late = int((perf_counter() - due) / PERIOD_S)
        missed += late * SIGNALS
        tick += 1 + late
    elapsed = perf_counter() - began
    for client in clients:
        client.close()
    return len(done_s) * SIGNALS / elapsed, missed, done_s, (process_time() - cpu) / elapsed


def _rows(what: str, result: tuple[float, int, list[float], float]) -> list[Row]:
    """What a master does: CPU and wall time of one request, and how its cycles went."""
    rate, missed, done_s, cpu = result
    ordered = sorted(done_s) or [float("nan")]
    p50, p99 = ordered[len(ordered) // 2] * 1e3, ordered[int(len(ordered) * 0.99)] * 1e3
    said = f"{missed} missed, done p50 {p50:.1f}, p99 {p99:.1f} ms, {cpu:.0%} of a core"
    return [Row(what, "requests/s", value=rate, words=said), Row(f"{what}: one request", "us", cpu_s=cpu / rate)]


def rows() -> list[Row]:
    """The same signals over four connections and over eight, with our master and with pymodbus' client."""
    table = []
    for connections in (4, 8):
        what = f"{SIGNALS} MODBUS signals at 250 Hz, {connections} connections"
        with _slave() as ports:
            ours = _rows(what, _ours(ports[:connections]))
            theirs: list[Row] = []
            if find_spec("pymodbus"):
                theirs = _rows(f"{what} (pymodbus)", asyncio.run(_pymodbus(ports[:connections])))
        if theirs:
            ours = [
                replace(ours[0], other=theirs[0].value, beside="pymodbus"),
                replace(ours[1], other=theirs[1].cpu_s, beside="pymodbus"),
            ]
        table += ours + theirs
    return table if find_spec("pymodbus") else [*table, not_installed("pymodbus")]


if __name__ == "__main__":
    print_rows(rows())
