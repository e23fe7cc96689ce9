"""One client floods a port: lateness of a 250 Hz client and of a stop meanwhile, memory, processor time of a tick.

Each row is an `elitescript serve --ssh` of its own, with a program that runs, an RTSI client at 250 Hz and a dashboard
client that stops the program and starts it again. The flood comes from a process of its own, which has the lowest
priority: what it uses itself is no matter here. Lateness is counted as in `serving`; memory is the peak of the serving
process. On a busy machine lateness says little; the last part of each row does not depend on it: the processor time
that the serving thread uses from one tick to the next, in a server of its own.

`python -m benchmarks.floods NAME ...` measures the named floods alone, with `--cpu` first their last part alone.
`FLOODS_SECONDS` sets how long.
"""

from __future__ import annotations

import asyncio
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import perf_counter, thread_time
from typing import TYPE_CHECKING, Any

from benchmarks.measure import environment
from benchmarks.serving import Stream, message, used_s
from benchmarks.table import Row, print_rows
from elitescript.messages.enums import TaskState

if TYPE_CHECKING:
    from elitescript.services.server import ServeSession

SECONDS = float(os.environ.get("FLOODS_SECONDS", "5"))
PASSWORD = "secret"
PROGRAM = b"def work():\n  while True:\n    sleep(0.004)\n  end\nend\n"
LOG = "/opt/elite/data/log/log_history.csv"

# SFTP
OPEN, CLOSE, READ, WRITE, FSTAT, FSETSTAT, OPENDIR, READDIR, REALPATH, STAT = 3, 4, 5, 6, 8, 10, 11, 12, 16, 17


def _text(data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + data


def _sftp(kind: int, body: bytes, number: int = 1) -> bytes:
    return _text(bytes([kind]) + struct.pack(">I", number) + body)


_INIT = _text(b"\x01" + struct.pack(">I", 3))
_HANDLE = _text(bytes(4))
_FILE = _sftp(OPEN, _text(b"/tmp/x") + struct.pack(">II", 2 | 8 | 1, 0))
SFTP: dict[str, bytes] = {
    "FSETSTAT": _sftp(FSETSTAT, _HANDLE + struct.pack(">I", 0)) * 2000,
    "FSETSTAT of no handle": _sftp(FSETSTAT, _text(b"none") + struct.pack(">I", 0)) * 2000,
    "size by FSETSTAT": _sftp(FSETSTAT, _HANDLE + struct.pack(">IQ", 1, 2**24)) * 200
    + _sftp(FSETSTAT, _HANDLE + struct.pack(">IQ", 1, 0)) * 200,
    "STAT": _sftp(STAT, _text(b"/opt/elite/data/log/log_history.csv")) * 1000,
    "REALPATH": _sftp(REALPATH, _text(b"/a/../b/./c")) * 1000,
    "WRITE of a byte": _sftp(WRITE, _HANDLE + struct.pack(">Q", 0) + _text(b"x")) * 1000,
    "OPENDIR": _sftp(OPENDIR, _text(b"/")) * 1000,
    "unknown requests": _sftp(99, b"") * 3000,
}
"""Requests that are sent again and again, their answers taken."""


@contextmanager
def _served() -> Iterator[tuple[dict[str, Any], int]]:
    """A controller on free ports: their numbers and the address for `ctl`, and the number of its process."""
    nice = ["nice", "-n", "-10"] if os.getuid() == 0 else []
    command = [
        sys.executable,
        "-m",
        "elitescript",
        "serve",
        "--port",
        "all=0",
        "--power-on",
    ]
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        process = subprocess.Popen(
            [*nice, *command, "--ssh", "--ssh-password", PASSWORD, "--json"],
            stdout=subprocess.PIPE,
            env={**environment(), "XDG_RUNTIME_DIR": folder},
            text=True,
        )
        assert process.stdout is not None
        try:
            robot = next(row for row in map(json.loads, process.stdout) if row["type"] == "ready")["robots"][0]
            reader = threading.Thread(target=process.stdout.read)
            reader.start()
            yield {**robot["ports"], "ctl": robot["ctl"]}, process.pid
        finally:
            process.terminate()
            process.wait()
            reader.join()


# ---------------------------------------------------------------- floods


async def _ssh(port: int, requests: bytes, *, takes: bool = True) -> None:
    """Log in, begin SFTP, and send requests without a pause; take the answers or not."""
    import asyncssh

    class Session(asyncssh.SSHClientSession):  # type: ignore[misc]
        can_write = asyncio.Event()

        def pause_writing(self) -> None:
            self.can_write.clear()

        def resume_writing(self) -> None:
            self.can_write.set()

    async with await _login(port) as connection:
        window = 2**21 if takes else 2**31 - 1
        channel, session = await connection.create_session(Session, subsystem="sftp", encoding=None, window=window)
        session.can_write.set()
        channel.write(_INIT + _FILE + _sftp(WRITE, _HANDLE + struct.pack(">Q", 0) + _text(bytes(2**15))))
        await asyncio.sleep(0.5)
        if not takes:
            connection.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection._transport.pause_reading()
        while True:
            await session.can_write.wait()
            channel.write(requests)
            await asyncio.sleep(0.001)


async def _login(port: int) -> Any:
    import asyncssh

    return await asyncssh.connect(
        "127.0.0.1", port, username="root", password=PASSWORD, known_hosts=None, client_keys=None, config=None,
        agent_path=None,
    )  # fmt: skip


async def _sessions(port: int) -> None:
    """Open sessions of one connection without end."""
    import asyncssh

    async with await _login(port) as connection:
        kept = []
        while True:
            with suppress(asyncssh.Error):
                kept.append(await connection.create_process("printenv PATH"))


async def _logins(port: int) -> None:
    """Connect again and again, and never log in."""
    held = []
    while True:
        with suppress(OSError):
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(b"SSH-2.0-none\r\n")
            held.append((reader, writer))
        await asyncio.sleep(0.002)
        if len(held) > 100:
            held.pop(0)[1].close()


async def _key_exchanges(port: int) -> None:
    """Let new keys be made again and again."""
    async with await _login(port) as connection:
        while True:
            connection._rekey_bytes = 1
            connection.send_debug("x")
            await asyncio.sleep(0.001)


async def _raw(address: int | str, data: bytes, *, takes: bool = True) -> None:
    """Send the same bytes to a port without a pause."""

    def send() -> None:
        if isinstance(address, str):
            peer = socket.socket(socket.AF_UNIX)
            peer.connect(address)
        else:
            peer = socket.create_connection(("127.0.0.1", address))
        if takes:
            threading.Thread(target=_take, args=(peer,), daemon=True).start()
        while True:
            peer.sendall(data)

    await asyncio.to_thread(send)


def _take(peer: socket.socket) -> None:
    with suppress(OSError):
        while peer.recv(1 << 16):
            pass


_MODBUS = struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 128, 100)
_CTL = json.dumps({"verb": "state", "arguments": [], "values": {}}).encode() + b"\n"
_RTSI = message("V", struct.pack(">H", 1))
_RECIPE = message("O", struct.pack(">d", 1.0) + b",".join([b"timestamp"] * 900))
FLOODS: dict[str, Callable[[dict[str, Any]], Any]] = {
    "nothing": lambda ports: asyncio.sleep(1e6),
    **{f"ssh: {name}": lambda ports, sent=sent: _ssh(ports["ssh"], sent) for name, sent in SFTP.items()},
    "ssh: READ, answers not taken": lambda ports: _ssh(
        ports["ssh"], _sftp(READ, _HANDLE + struct.pack(">QI", 0, 2**22)) * 600, takes=False
    ),
    "ssh: sessions": lambda ports: _sessions(ports["ssh"]),
    "ssh: no login": lambda ports: _logins(ports["ssh"]),
    "ssh: new keys": lambda ports: _key_exchanges(ports["ssh"]),
    "ctl: state": lambda ports: _raw(ports["ctl"], _CTL * 1000),
    "ctl: empty lines": lambda ports: _raw(ports["ctl"], b"\n" * 60000),
    "ctl: state, answers not taken": lambda ports: _raw(ports["ctl"], _CTL * 1000, takes=False),
    "ctl: set": lambda ports: _raw(
        ports["ctl"], json.dumps({"verb": "set", "values": {"standard_digital_in[0]": True}}).encode() * 1 + b"\n"
    ),
    "dashboard": lambda ports: _raw(ports["dashboard"], b"robotMode\n" * 5000),
    "dashboard: what is no command": lambda ports: _raw(ports["dashboard"], b"x\n" * 5000),
    "query": lambda ports: _raw(ports["query"], b"[1]get_actual_joint_positions()\n" * 1000),
    "interpreter": lambda ports: _raw(ports["interpreter"], b"x=1\n" * 5000),
    "primary": lambda ports: _raw(ports["primary"], b"set_standard_digital_out(0, True)\n" * 1000),
    "modbus": lambda ports: _raw(ports["modbus"], _MODBUS * 2000),
    "rtsi: versions": lambda ports: _raw(ports["rtsi"], _RTSI * 5000),
    "rtsi: recipes": lambda ports: _raw(ports["rtsi"], _RECIPE * 100),
}
"""By what is flooded."""

# ---------------------------------------------------------------- measuring


class _Watch:
    """Reads packages of 250 Hz, and stops the program again and again."""

    def __init__(self, ports: dict[str, Any]) -> None:
        self.stops_s: list[float] = []
        """From the command to the first package that shows it."""
        self._ports = ports
        self._primary = socket.create_connection(("127.0.0.1", ports["primary"]))
        threading.Thread(target=_take, args=(self._primary,), daemon=True).start()
        self._dashboard = socket.create_connection(("127.0.0.1", ports["dashboard"]))
        threading.Thread(target=_take, args=(self._dashboard,), daemon=True).start()
        self.stream = Stream(ports["rtsi"], "timestamp,runtime_state")
        self.stream.socket.sendall(message("S"))
        self._asked = self._again = 0.0

    def watch(self, seconds: float) -> None:
        """Read for some time; the delays of that time are in `stream.times`."""
        self.stream.times.clear()
        self.stops_s.clear()
        end = perf_counter() + seconds
        self.stream.socket.settimeout(0.05)
        while perf_counter() < end:
            with suppress(TimeoutError):
                self.stream.read()
            self._stop_or_start()

    def _stop_or_start(self) -> None:
        _, arrived, now = self.stream.times[-1] if self.stream.times else (0.0, 0.0, 0.0)
        if not self.stream.times:
            return
        is_playing = self.stream.package[12:16] == struct.pack(">I", int(TaskState.PLAYING))
        if self._asked and not is_playing and arrived > self._asked:
            self.stops_s.append(arrived - self._asked)
            self._asked, self._again = 0.0, now + 0.1
            self._primary.sendall(PROGRAM)
        elif not self._asked and is_playing and now > self._again:
            self._asked, self._again = perf_counter(), 0.0
            self._dashboard.sendall(b"stop\n")
        elif not self._asked and not is_playing and now > self._again + 1.0:
            self._again = now
            self._primary.sendall(PROGRAM)


def _waited_ms(pid: int) -> float:
    """Return how long a process was runnable without a processor so far, ms: that is no matter of the server."""
    return int(Path(f"/proc/{pid}/schedstat").read_text(encoding="ascii").split()[1]) / 1e6


def _peak_mb(pid: int) -> float:
    """Return the most memory that a process has had, MB; needs Linux."""
    line = next(line for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024


def _flooded(name: str) -> Row:
    with _served() as (ports, pid):
        watch = _Watch(ports)
        watch.watch(1.0)
        command = [sys.executable, "-m", "benchmarks.floods", "--flood", name, json.dumps(ports)]
        flood = subprocess.Popen(["nice", "-n", "15", *command], env=environment(), stderr=subprocess.PIPE)
        try:
            # Python starts, keys are made, the client logs in.
            watch.watch(1.5)
            waited_ms, used = _waited_ms(pid), used_s([pid])[0]
            watch.watch(SECONDS)
            waited_ms, used = _waited_ms(pid) - waited_ms, used_s([pid])[0] - used
            ended = flood.poll()
        finally:
            flood.kill()
            _, errors = flood.communicate()
        peak_mb = _peak_mb(pid)
    delays = [arrived - robot for robot, arrived, _ in watch.stream.times]
    best = min(delays, default=0.0)
    late_ms = sorted((delay - best) * 1e3 for delay in delays) or [SECONDS * 1e3]
    stops_ms = sorted(stop * 1e3 for stop in watch.stops_s) or [SECONDS * 1e3]
    words = (
        f"late p50 {late_ms[len(late_ms) // 2]:.2f}, p99 {late_ms[int(len(late_ms) * 0.99)]:.1f}, "
        f"max {late_ms[-1]:.1f} ms; {len(watch.stops_s)} stops, p50 {stops_ms[len(stops_ms) // 2]:.1f}, "
        f"max {stops_ms[-1]:.1f} ms; {peak_mb:.0f} MB; "
        f"CPU {used / SECONDS:.0%}, waited for a processor {waited_ms:.0f} ms"
    )
    if ended is not None:
        words += f" (the flood ended: {errors.decode().strip().splitlines()[-1:]})"
    return Row(f"flood of {name}", words=f"{words}; {_held(name)}", beside="aim: p99 10 ms, stop 20 ms")


def session_here(*, in_process: bool = False) -> ServeSession:
    """Return one robot to be served by this process, on free ports."""
    from elitescript.kernel import RobotOptions
    from elitescript.services.port_numbers import NAMES
    from elitescript.services.robots import robot_link, served_robot
    from elitescript.services.server import ServeSession

    link = robot_link(RobotOptions(power_on=True), task_dir=None, in_process=in_process, is_jailed=True, journal=None)
    server = served_robot("CS66", link, lambda *_: None, ssh_password=PASSWORD)
    return ServeSession([server], ("127.0.0.1",), [dict.fromkeys((*NAMES, "ssh"), 0)], 99)


async def _ticks_ms(name: str) -> list[float]:
    """Return the processor time that a serving thread takes from one tick to the next during a flood, ms, sorted."""
    session = session_here()
    await session.open()
    (server,) = session.servers
    spent: list[float] = []
    last = thread_time()

    def note(_output: object) -> None:
        nonlocal last
        now = thread_time()
        spent.append((now - last) * 1e3)
        last = now

    stream = socket.create_connection(("127.0.0.1", server.ports["rtsi"]))
    stream.sendall(message("O", struct.pack(">d", 250.0) + b"timestamp") + message("S"))
    threading.Thread(target=_take, args=(stream,), daemon=True).start()
    ports = {**server.ports, "ctl": session.control_addresses[0]}
    command = [sys.executable, "-m", "benchmarks.floods", "--flood", name, json.dumps(ports)]
    flood = subprocess.Popen(["nice", "-n", "15", *command], env=environment(), stderr=subprocess.DEVNULL)
    try:
        await asyncio.sleep(2.5)
        server.observers.append(note)
        await asyncio.sleep(SECONDS)
        server.observers.remove(note)
    finally:
        flood.kill()
        flood.wait()
        stream.close()
        await session.close()
    return sorted(spent[1:])


def _held(name: str) -> str:
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        os.environ["XDG_RUNTIME_DIR"] = folder
        spent = asyncio.run(_ticks_ms(name))
    p50, p99 = spent[len(spent) // 2], spent[int(len(spent) * 0.99)]
    return f"CPU of a tick p50 {p50:.2f}, p99 {p99:.1f}, max {spent[-1]:.1f} ms"


def rows(names: list[str] | None = None) -> list[Row]:
    """One row for each flood; those whose name contains one of `names`, if there are any."""
    return [_flooded(name) for name in FLOODS if not names or any(part in name for part in names)]


if __name__ == "__main__":
    if sys.argv[1:2] == ["--flood"]:
        asyncio.run(FLOODS[sys.argv[2]](json.loads(sys.argv[3])))
    else:
        for found in FLOODS:
            if sys.argv[1:2] == ["--cpu"]:
                if not sys.argv[2:] or any(part in found for part in sys.argv[2:]):
                    print(f"flood of {found}: {_held(found)}", flush=True)
            elif not sys.argv[1:] or any(part in found for part in sys.argv[1:]):
                print_rows([_flooded(found)])
