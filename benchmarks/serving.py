"""Ten RTSI clients at 250 Hz: how late their packages are and whether one is missing, also while a program burns CPU.

The server is `elitescript serve` in a process of its own; the clients are one selector loop in this one. How late a
package is is measured against its robot time, counted from the package that came with the least delay: at its client's
socket, as the operating system stamps it, and once this process has read it, which reads one client after the other.
In lockstep a single client does nothing but answer. CPU times are those of the server and its child. `SERVING_SECONDS`
sets how long each row is measured; `SERVING_SECONDS=600 python -m benchmarks.serving` takes twenty minutes.
"""

from __future__ import annotations

import os
import selectors
import socket
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from re import findall
from time import CLOCK_REALTIME, clock_gettime, perf_counter
from typing import IO

from benchmarks.measure import environment
from benchmarks.table import Row, Time, print_rows, timed_row

SECONDS = float(os.environ.get("SERVING_SECONDS", "10"))
CLIENTS = 10
SO_TIMESTAMPNS = 35
"""Of Linux: every `recvmsg` tells when the data came."""
STEADY_S = 50e-6
"""Between two reads the two clocks drift less than this, unless somebody sets one."""
BUSY = b"def busy():\n  while True:\n    pass\n  end\nend\n"
MOVING = b"""def move():
  while True:
    movej([0.3, -1.5, 1.2, -1.0, 1.5, 0.2], a=1.4, v=1.05)
    movej([-0.5, -1.0, 0.8, -1.4, 1.2, 0.7], a=1.4, v=1.05)
  end
end
"""
PAGE = """
import sys
from urllib.parse import urlsplit
from websockets.sync.client import connect
at = urlsplit(sys.argv[1])
address = f"ws://{at.netloc}/socket?{at.query}"
with connect(address, origin=f"http://{at.netloc}", compression=None, max_size=None, proxy=None) as socket:
    for _ in socket:
        pass
"""
"""A page that reads and shows nothing: what a browser does with it is another matter."""
TWO = "timestamp,actual_joint_positions"
OUTPUTS = (
    "timestamp,payload_mass,payload_cog,script_control_line,target_joint_positions,target_joint_speeds,"
    "actual_joint_torques,actual_joint_positions,actual_joint_speeds,actual_joint_current,actual_TCP_pose,"
    "actual_TCP_speed,actual_TCP_force,target_TCP_pose,target_TCP_speed,actual_digital_input_bits,"
    "actual_digital_output_bits,joint_temperatures,robot_mode,joint_mode,safety_status,speed_scaling,"
    "target_speed_fraction,actual_robot_voltage,actual_robot_current,runtime_state,elbow_position,robot_status_bits,"
    "safety_status_bits,analog_io_types,standard_analog_input0,standard_analog_input1,standard_analog_output0,"
    "standard_analog_output1,io_current,tool_mode"
)
"""A recipe as clients that show a robot ask for it, some 1,000 bytes."""


@contextmanager
def served(*options: str, stderr: IO[bytes] | None = None) -> Iterator[tuple[dict[str, int], int]]:
    """A controller on free ports; their numbers, of several robots those of the last, and the number of its process.

    With `--studio`, a page is open too: a process that reads all that the studio sends.
    """
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        process = subprocess.Popen(
            [sys.executable, "-m", "elitescript", "serve", "--port", "all=0", "--power-on", *options],
            stdout=subprocess.PIPE,
            stderr=stderr,
            env={**environment(), "XDG_RUNTIME_DIR": folder},
            text=True,
        )
        assert process.stdout is not None
        try:
            line = next(line for line in process.stdout if line.startswith("ready"))
            words = findall(r"(\w+) (\d+)\b", line.partition(": ")[2])
            ports = {name: int(number) for name, number in words}
            if "--studio" not in options:
                yield ports, process.pid
                return
            address = next(line for line in process.stdout if line.startswith("ready http")).split()[1]
            page = subprocess.Popen([sys.executable, "-c", PAGE, address])
            try:
                yield ports, process.pid
            finally:
                page.terminate()
                page.wait()
        finally:
            process.terminate()
            process.wait()


def message(letter: str, payload: bytes = b"") -> bytes:
    """A message of RTSI."""
    return struct.pack(">HB", 3 + len(payload), ord(letter)) + payload


def processes_of(pid: int) -> list[int]:
    """Return the served robot's process and its child, if it has one; needs Linux."""
    return [pid, *map(int, Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split())]


def used_s(processes: list[int]) -> list[float]:
    """Return the CPU time that each of them has taken so far, s."""
    from elitescript.services.child.process import processor_time_s

    return [processor_time_s(process) or 0.0 for process in processes]


class Stream:
    """One client that notes when its packages come."""

    def __init__(self, port: int, names: str, frequency_hz: float = 250.0, host: str = "127.0.0.1") -> None:
        self.socket = socket.create_connection((host, port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if sys.platform == "linux":
            self.socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self.buffer = self.package = b""
        """What is not a whole message yet; the last package."""
        self.offset = 0.0
        """What the clock of the stamps showed more than that of this process when data was read last."""
        self.times: list[tuple[float, float, float]] = []
        """Robot time of each package, when it was at the socket, when it was read."""
        self.socket.sendall(message("O", struct.pack(">d", frequency_hz) + names.encode()))

    def read(self) -> int:
        """Read what has come; return how many packages."""
        data, notes, _, _ = self.socket.recvmsg(65536, 64)
        arrived = now = perf_counter()
        offset = clock_gettime(CLOCK_REALTIME) - now
        for _, kind, stamp in notes:
            # The clock of the stamps may have been set while the data waited; that of the robot's ticks never is.
            if kind == SO_TIMESTAMPNS and abs(offset - self.offset) < STEADY_S:
                whole, part = struct.unpack("qq", stamp)
                arrived = whole + part / 1e9 - offset
        self.offset = offset
        self.buffer += data
        count = 0
        while len(self.buffer) >= 3 and len(self.buffer) >= (size := int.from_bytes(self.buffer[:2])):
            package, self.buffer = self.buffer[:size], self.buffer[size:]
            if package[2] == ord("U"):
                self.package = package
                self.times.append((struct.unpack_from(">d", package, 4)[0], arrived, now))
                self.take(package, arrived)
                count += 1
        return count

    def take(self, package: bytes, arrived: float) -> None:
        """Take a package, and when it was at the socket; nothing here, for those who want more of it."""


def _paced(what: str, program: bytes, *options: str, clients: int = CLIENTS) -> list[Row]:
    with served(*options) as (ports, pid):
        streams = [Stream(ports["rtsi"], OUTPUTS) for _ in range(clients)]
        selector = selectors.DefaultSelector()
        for stream in streams:
            selector.register(stream.socket, selectors.EVENT_READ, stream)
            stream.socket.sendall(message("S"))
        if program:
            with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
                peer.sendall(program)
        # What happens in the first second is how a connection begins, not how it goes on.
        for seconds in (1.0, SECONDS):
            for stream in streams:
                stream.times.clear()
            before = sum(used_s(processes_of(pid)))
            end = perf_counter() + seconds
            while (left := end - perf_counter()) > 0:
                for key, _ in selector.select(left):
                    key.data.read()
        used = sum(used_s(processes_of(pid))) - before
        for stream in streams:
            stream.socket.close()
    arrivals = [(robot, arrived, read) for stream in streams for robot, arrived, read in stream.times]
    lost = repeated = 0
    for stream in streams:
        ticks = {round(robot * 250) for robot, _, _ in stream.times}
        lost += max(ticks) - min(ticks) + 1 - len(ticks)
        repeated += len(stream.times) - len(ticks)
    at_socket = _late([arrived - robot for robot, arrived, _ in arrivals])
    as_read = _late([read - robot for robot, _, read in arrivals])
    return [
        Row(
            f"{clients} RTSI clients, 250 Hz, {what}: late",
            words=f"{at_socket} (read: {as_read}); of {len(arrivals)} {lost} lost, {repeated} twice",
            beside="aim: p50 < 0.2, p99 < 1 ms, none lost",
        ),
        Row(f"{clients} RTSI clients, 250 Hz, {what}: a tick", "us", cpu_s=used / (SECONDS * 250)),
    ]


def _late(delays: list[float]) -> str:
    best = min(delays)
    late_ms = sorted((delay - best) * 1e3 for delay in delays)
    p50, p99 = late_ms[len(late_ms) // 2], late_ms[int(len(late_ms) * 0.99)]
    return f"p50 {p50:.2f}, p99 {p99:.2f}, max {late_ms[-1]:.1f} ms"


def _lockstep(what: str, names: str, program: bytes = b"", frequency_hz: float = 250.0) -> Row:
    with served("--lockstep", "rtsi") as (ports, pid):
        if program:
            with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
                peer.sendall(program)
        client = Stream(ports["rtsi"], names, frequency_hz)
        client.socket.sendall(message("I", b"input_int_register0") + message("S"))
        answer = message("U", bytes([1]) + struct.pack(">i", 7))
        client.read()
        before, end = sum(used_s(processes_of(pid))), perf_counter() + min(SECONDS, 5.0)
        client.socket.sendall(answer)
        while perf_counter() < end:
            if client.read():
                client.socket.sendall(answer)
        used = sum(used_s(processes_of(pid))) - before
        client.socket.close()
    (robot_a, wall_a, _), (robot_b, wall_b, _) = client.times[0], client.times[-1]
    simulated_s = robot_b - robot_a
    per_second = Time((wall_b - wall_a) / simulated_s, used / simulated_s)
    return timed_row(f"lockstep with one client, {what}", per_second, simulated_s=1.0)


def page_rows() -> list[Row]:
    """Two clients while the arm moves, without and with an open page of the studio, by turns."""
    without = _paced("the arm moves", MOVING, clients=2)
    return [*without, *_paced("the arm moves, a page is open", MOVING, "--studio", clients=2)]


def paced_rows() -> list[Row]:
    """Ten clients, idle and with a program that burns CPU; `python -m benchmarks.serving` prints these alone."""
    return [*_paced("idle", b""), *_paced("a program burns CPU", BUSY)]


def rows() -> list[Row]:
    """The rows of this module."""
    return [
        *paced_rows(),
        *_paced("a program burns CPU, in process", BUSY, "--in-process"),
        _lockstep("two variables", TWO),
        _lockstep("two variables, the arm moves", TWO, MOVING),
        _lockstep("two variables at 25 Hz", TWO, frequency_hz=25.0),
        _lockstep("two variables at 25 Hz, the arm moves", TWO, MOVING, 25.0),
        _lockstep("36 variables", OUTPUTS),
    ]


if __name__ == "__main__":
    print_rows([*paced_rows(), *page_rows()])
