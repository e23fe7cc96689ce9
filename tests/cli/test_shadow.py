"""`elitescript shadow` against a small controller: exit codes, lines, JSON, and what is refused."""

from __future__ import annotations

import asyncio
import importlib
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from elitescript.cli.main import main
from tests.recorder.controller import HOST, FakeController, closed_port, served, ticks

module = importlib.import_module("elitescript.cli.shadow")
TIMES = list(ticks(1.0, 300))
LAST_S = TIMES[-1] - 1e-6
PROGRAM = "def main():\n  sleep(0.2)\nend\n"


@contextmanager
def controller(line: int) -> Iterator[list[str]]:
    """A controller whose program is in a line from 0.1 s to 0.3 s; the words of a call that name its ports."""
    words: list[str] = []
    ready = threading.Event()
    done: list[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = []

    def values(t: float) -> dict[str, float]:
        runs = 1.1 <= t < 1.3
        return {
            "script_control_line": line * runs,
            "runtime_state": 1 if runs else 3,
            "safety_status": 1,
            "speed_scaling": 1.0,
            "target_speed_fraction": 1.0,
        }

    async def serve() -> None:
        async with served(FakeController(TIMES, values=values)) as target:
            end = asyncio.Event()
            done.append((asyncio.get_running_loop(), end))
            words.extend([HOST, *(f"--port={name}={number}" for name, number in target.ports.items())])
            ready.set()
            await end.wait()

    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    thread.start()
    assert ready.wait(10.0)
    try:
        yield words
    finally:
        loop, end = done[0]
        loop.call_soon_threadsafe(end.set)
        thread.join()


@pytest.fixture
def whole(monkeypatch):
    """Let a call end when the last row of the controller has been compared, however long that takes."""
    is_over = []

    class Followed(module.Shadow):
        def take(self, item):
            super().take(item)
            if item.t >= LAST_S:
                is_over[0].set()

    def ended(_session, _for_s):
        is_over.append(asyncio.Event())
        return asyncio.create_task(is_over[0].wait())

    monkeypatch.setattr(module, "Shadow", Followed)
    monkeypatch.setattr(module, "ended", ended)


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "cell.script"
    path.write_text(PROGRAM)
    return str(path)


@pytest.mark.usefixtures("whole")
def test_they_agree(program, capsys):
    with controller(2) as words:
        assert main(["shadow", *words, "--program", program]) == 0
    assert capsys.readouterr().out.endswith("1 run: no difference\n")


@pytest.mark.usefixtures("whole")
def test_what_check_finds_in_the_text_is_in_the_last_line_too(tmp_path, capsys):
    path = tmp_path / "warned.script"
    path.write_text(PROGRAM.replace("end", "  x = get_standard_digital_in(0) == 'on'\nend"))
    with controller(2) as words:
        assert main(["shadow", *words, "--program", str(path)]) == 0
    out, err = capsys.readouterr()
    assert out.endswith("1 run: no difference; in the text 1 warning\n")
    assert f"{path}:3:7: warning W240" in err


@pytest.mark.usefixtures("whole")
def test_they_part_in_lines_of_json(program, capsys):
    with controller(77) as words:
        assert main(["shadow", *words, "--program", program, "--json"]) == 1
    said = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [its["type"] for its in said if its["type"] != "note"] == ["run", "difference", "end", "summary"]
    found = next(its for its in said if its["type"] == "difference")
    assert (found["run"], found["cause"]) == (1, "program")
    assert found["what"] == "another program runs: it is in line 77"
    assert found["delay_s"] <= 1.0


def test_nobody_is_at_the_address(program, capsys):
    ports = [f"--port={name}={closed_port()}" for name in ("rtsi", "primary", "dashboard")]
    assert main(["shadow", HOST, *ports, "--program", program]) == 2
    assert f"nothing answers at {HOST}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ([], "name the program that runs there"),
        (["--program", "CELL", "--payload", "heavy"], "--payload heavy: write KG or KG,X,Y,Z"),
        (["--program", "CELL", "--wait", "0"], "--wait 0: a number above 0 is needed"),
        (["--program", "CELL", "--port", "modbus=1"], "shadow reads the ports rtsi, primary, dashboard"),
        (["--program", "CELL", "--fetch-program", "/x"], "are two programs"),
    ],
)
def test_what_makes_no_sense_is_refused(program, words, text, capsys):
    assert main(["shadow", HOST, *(program if word == "CELL" else word for word in words)]) == 2
    assert text in capsys.readouterr().err
