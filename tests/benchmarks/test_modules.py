"""Every benchmark can be imported and begins: what nobody runs for months breaks in silence."""

from __future__ import annotations

import asyncio
import inspect
import socket
from importlib import import_module
from pathlib import Path

import pytest

from benchmarks.__main__ import KNOWN

ROOT = Path(__file__).resolve().parent.parent.parent
TOOLS = {"__main__", "against", "day", "framed", "measure", "quoted", "table", "served_day"}
"""What others are made of; the last one prints a table of its own."""
MODULES = sorted(path.stem for path in (ROOT / "benchmarks").glob("*.py"))


@pytest.mark.parametrize("name", [name for name in MODULES if name not in TOOLS])
def test_a_benchmark_is_a_module_with_rows_that_need_no_arguments(name: str) -> None:
    rows = import_module(f"benchmarks.{name}").rows
    needed = [param for param in inspect.signature(rows).parameters.values() if param.default is param.empty]
    assert needed == []


def test_those_that_have_a_name_on_the_command_line_are_there() -> None:
    assert set(KNOWN) <= set(MODULES)


def test_the_robot_that_is_flooded_comes_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("asyncssh")
    from benchmarks.floods import FLOODS, session_here

    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))

    async def come_up() -> dict[str, int]:
        session = session_here(in_process=True)
        await session.open()
        try:
            return dict(session.servers[0].ports)
        finally:
            await session.close()

    ports = asyncio.run(come_up())
    assert {"primary", "rtsi", "dashboard", "query", "interpreter", "modbus", "ssh"} <= ports.keys()
    assert all(callable(flood) for flood in FLOODS.values())


def test_a_day_of_a_served_robot_begins(capsys: pytest.CaptureFixture[str]) -> None:
    from benchmarks.served_day import STRETCHES, main

    main(STRETCHES * 5 / 3600 / 250)
    assert capsys.readouterr().out.count(" h  ") == STRETCHES


def test_the_connections_of_the_benchmark_of_devices_are_made() -> None:
    from benchmarks.devices import Sockets

    sockets = Sockets()
    with socket.create_server(("127.0.0.1", 0)) as server:
        channel = sockets.open("127.0.0.1", server.getsockname()[1], 1.0)
        sockets.poll()
        peer, _ = server.accept()
        sockets.open_channels[channel].drop()
        assert peer.recv(1) == b""
        peer.close()
