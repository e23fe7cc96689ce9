"""Modbus clients of other people against `elitescript serve`: pymodbus, and Debian's mbpoll (libmodbus)."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

SOURCE = Path(__file__).resolve().parent.parent.parent / "src"
pytestmark = [pytest.mark.peers, pytest.mark.skipif(os.name != "posix", reason="signals")]


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    place = str(tmp_path_factory.mktemp("run"))
    process = subprocess.Popen(
        [sys.executable, "-m", "elitescript", "serve", "--port", "all=0", "--power-on", "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": str(SOURCE), "XDG_RUNTIME_DIR": place},
    )
    assert process.stdout is not None
    ready = next(line for line in process.stdout if b'"ready"' in line)
    # Nobody reads the rest, which is less than a pipe holds.
    yield json.loads(ready)["robots"][0]["ports"]["modbus"]
    process.terminate()
    process.communicate(timeout=20)


class TestPymodbus:
    @pytest.fixture
    def connect(self, port: int) -> Any:
        package = pytest.importorskip("pymodbus.client")

        def connect() -> Any:
            client = package.ModbusTcpClient("127.0.0.1", port=port, timeout=5)
            assert client.connect()
            return client

        return connect

    @pytest.fixture
    def client(self, connect: Any) -> Iterator[Any]:
        client = connect()
        yield client
        client.close()

    def test_reads_with_every_function(self, client: Any) -> None:
        assert client.read_holding_registers(63, count=5).registers == [2, 15, 0, 7, 1]
        assert client.read_input_registers(63, count=5).registers == [2, 15, 0, 7, 1]
        assert client.read_coils(0, count=128).bits[:128] == [False] * 128
        assert client.read_discrete_inputs(60, count=8).bits == [False] * 8

    def test_writes_with_every_function(self, client: Any) -> None:
        assert not client.write_register(256, 65535).isError()
        assert not client.write_registers(257, [1, 2, 3]).isError()
        assert client.read_holding_registers(256, count=4).registers == [65535, 1, 2, 3]
        assert not client.write_coil(33, True).isError()
        assert not client.write_coils(34, [True, False, True]).isError()
        assert client.read_holding_registers(2).registers == [0b010110]
        both = client.readwrite_registers(read_address=256, read_count=3, write_address=257, values=[8], device_id=17)
        assert both.registers == [65535, 8, 2]

    @pytest.mark.parametrize(
        ("ask", "code"),
        [
            (lambda client: client.read_holding_registers(512), 2),
            (lambda client: client.read_coils(127, count=2), 2),
            (lambda client: client.write_register(0, 1), 2),
            (lambda client: client.write_coil(5, True), 2),
            (lambda client: client.write_register(16, 13), 3),
            (lambda client: client.write_coil(59, True), 3),
            (lambda client: client.read_exception_status(), 1),
            (lambda client: client.mask_write_register(address=256, and_mask=1, or_mask=2), 1),
        ],
    )
    def test_gets_exceptions(self, client: Any, ask: Any, code: int) -> None:
        answer = ask(client)
        assert answer.isError()
        assert answer.exception_code == code
        assert not client.read_holding_registers(0).isError()

    def test_many_at_once_lose_no_write(self, connect: Any) -> None:
        def write(number: int) -> None:
            client = connect()
            for value in range(1, 60):
                assert not client.write_register(300 + number, value).isError()
                assert not client.write_coil(60 + number, bool(value % 2)).isError()
                assert client.read_holding_registers(300 + number).registers == [value]
            client.close()

        with ThreadPoolExecutor(8) as pool:
            list(pool.map(write, range(8)))
        client = connect()
        assert client.read_holding_registers(300, count=8).registers == [59] * 8
        assert client.read_coils(60, count=8).bits == [True] * 8
        client.close()


class TestMbpoll:
    @pytest.fixture
    def poll(self, port: int) -> Any:
        program = shutil.which("mbpoll")
        if program is None:
            pytest.skip("mbpoll is not installed")

        def poll(*words: str) -> tuple[dict[int, int], str]:
            """Ask once; return values by address, and everything that was said."""
            done = subprocess.run(
                [program, "-0", "-1", "-p", str(port), *words], capture_output=True, text=True, timeout=20
            )
            rows = re.findall(r"^\[(\d+)\]:\s+(\d+)", done.stdout, re.MULTILINE)
            return {int(address): int(value) for address, value in rows}, done.stdout + done.stderr

        return poll

    def test_reads(self, poll: Any) -> None:
        assert poll("-t", "4", "-r", "63", "-c", "5", "127.0.0.1")[0] == {63: 2, 64: 14, 65: 0, 66: 7, 67: 1}
        assert poll("-t", "3", "-r", "66", "127.0.0.1")[0] == {66: 7}
        assert poll("-t", "1", "-r", "24", "-c", "4", "127.0.0.1")[0] == dict.fromkeys(range(24, 28), 0)

    def test_writes(self, poll: Any) -> None:
        assert "Written 1 references." in poll("-t", "4", "-r", "370", "127.0.0.1", "4711")[1]
        assert "Written 3 references." in poll("-t", "4", "-r", "371", "127.0.0.1", "1", "2", "3")[1]
        assert poll("-t", "4", "-r", "370", "-c", "4", "127.0.0.1")[0] == {370: 4711, 371: 1, 372: 2, 373: 3}
        assert "Written 2 references." in poll("-t", "0", "-r", "126", "127.0.0.1", "1", "1")[1]
        assert poll("-t", "0", "-r", "125", "-c", "3", "127.0.0.1")[0] == {125: 0, 126: 1, 127: 1}

    def test_hears_what_is_wrong(self, poll: Any) -> None:
        assert "Illegal data address" in poll("-t", "4", "-r", "512", "127.0.0.1")[1]
        assert "Illegal data address" in poll("-t", "4", "-r", "73", "127.0.0.1", "1")[1]
        assert "Illegal data value" in poll("-t", "4", "-r", "16", "127.0.0.1", "13")[1]
