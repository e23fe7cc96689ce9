"""What `elitescript run` has given away by its end arrives at real peers."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from queue import Queue
from threading import Event, Thread

import pytest

from elitescript.modbus.slave import MemoryTables, Slave, TcpSlave


@pytest.fixture
def peer():
    """A TCP server on a free port; `serve` says what it does with each connection."""
    listening = socket.create_server(("127.0.0.1", 0))
    listening.settimeout(20)
    threads = []

    def start(serve, connections=1):
        def work():
            for _ in range(connections):
                try:
                    connection, _ = listening.accept()
                except OSError:
                    return
                with connection:
                    connection.settimeout(20)
                    serve(connection)

        threads.append(Thread(target=work))
        threads[-1].start()
        return listening.getsockname()[1]

    yield start
    for thread in threads:
        thread.join(30)
    listening.close()


def run(tmp_path, *lines):
    """Run a program; return its exit code and its records."""
    path = tmp_path / "last.script"
    path.write_text("def last():\n" + "".join(f"  {line}\n" for line in lines) + "end\n")
    done = subprocess.run(
        [sys.executable, "-m", "elitescript", "run", "--json", str(path)], capture_output=True, text=True, timeout=60
    )
    return done.returncode, [json.loads(line) for line in done.stdout.splitlines()]


class TestSockets:
    @pytest.mark.parametrize("last", ["pass", "halt()", "socket_close()", "1 / 0"])
    def test_the_last_line_arrives(self, tmp_path, peer, last):
        got = Queue()

        def read(connection):
            data = b""
            while part := connection.recv(1000):
                data += part
                connection.sendall(b"ok\n")
            got.put(data)

        port = peer(read)
        code, records = run(tmp_path, f'socket_open("127.0.0.1", {port})', 'socket_send_line("done")', last)
        assert code == (1 if last == "1 / 0" else 0)
        assert got.get(timeout=20) == b"done\n"
        assert "undelivered" not in records[-1]

    def test_what_a_peer_does_not_take_is_said(self, tmp_path, peer):
        is_over = Event()

        def stand_still(connection):
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            is_over.wait(30)

        port = peer(stand_still)
        lines = [
            "def flood():",
            "  while True:",
            '    socket_send_string("x" * 60000)',
            "  end",
            "end",
            "start_thread(flood, ())",
            "sleep(0.5)",
        ]
        try:
            code, records = run(tmp_path, f'socket_open("127.0.0.1", {port})', *lines)
        finally:
            is_over.set()
        end = records[-1]
        assert (code, end["state"], len(end["undelivered"])) == (0, "finished", 1)
        assert end["undelivered"][0].endswith(f"bytes to 127.0.0.1:{port}")
        assert records[-2]["text"] == "not delivered: " + end["undelivered"][0]


class TestModbus:
    @pytest.mark.parametrize(
        "lines",
        [
            ('modbus_add_signal("127.0.0.1", 255, 3, 3, "x", False, 1, PORT)', 'modbus_set_output_register("x", 258)'),
            ('modbus_send_custom_command("127.0.0.1", 255, 6, [0, 3, 1, 2], True, PORT)',),
            ('modbus_send_custom_command("127.0.0.1", 255, 6, [0, 3, 1, 2], False, PORT)',),
        ],
    )
    def test_an_output_and_a_request_of_the_last_tick_arrive(self, tmp_path, peer, lines):
        tables = MemoryTables(holding_registers=[0] * 10)

        def serve(connection):
            slave = TcpSlave(Slave(tables))
            while data := connection.recv(1000):
                connection.sendall(slave.take(data))

        port = peer(serve)
        code, records = run(tmp_path, *(line.replace("PORT", str(port)) for line in lines))
        assert (code, records[-1]["state"], tables.holding_registers[3]) == (0, "finished", 258)
        assert "undelivered" not in records[-1]

    def test_a_device_that_is_not_there_is_said(self, tmp_path):
        code, records = run(
            tmp_path,
            'modbus_add_signal("127.0.0.1", 255, 3, 3, "x", False, 1, 1)',
            'modbus_set_output_register("x", 7)',
        )
        assert (code, records[-1]["undelivered"]) == (0, ["MODBUS signal 'x' to 127.0.0.1:1, slave 255"])
