"""`serve` and `ctl` as processes: one controller for the whole module, on free ports."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from elitescript.cli import serve
from elitescript.cli.ctl import answer_lines
from elitescript.cli.main import main
from elitescript.cli.serve import chosen_ports
from elitescript.errors import UsageError
from tests.protocol import modbus_client

SOURCE = Path(__file__).resolve().parent.parent.parent / "src"
pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")


@pytest.fixture(scope="module")
def place() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        yield Path(folder)


def start(place: Path, *options: str) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": str(SOURCE), "XDG_RUNTIME_DIR": str(place), "PYTHONHASHSEED": "0"}
    return subprocess.Popen(
        [sys.executable, "-m", "elitescript", "serve", "--port", "all=0", *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )


def line_with(process: subprocess.Popen[str], words: str) -> str:
    assert process.stdout is not None
    for line in process.stdout:
        if words in line:
            return line
    assert process.stderr is not None
    raise AssertionError(f"it ended without saying {words!r}: {process.stderr.read()}")


def ports_in(ready: str) -> dict[str, int]:
    return {name: int(number) for name, number in re.findall(r"(\w+) (\d+)", ready.split(": ", 1)[1])}


def stop(process: subprocess.Popen[str], number: int = signal.SIGINT) -> tuple[int, str]:
    process.send_signal(number)
    out, err = process.communicate(timeout=20)
    assert "Traceback" not in err
    return process.returncode, out


@pytest.fixture(scope="module")
def served(place: Path) -> Iterator[tuple[subprocess.Popen[str], dict[str, int]]]:
    process = start(place, "--in-process", "--power-on")
    ready = line_with(process, "ready")
    assert ready.startswith("ready on 127.0.0.1: CS66: ")
    yield process, ports_in(ready)
    code, out = stop(process)
    assert code == 0
    assert out.endswith("stopped\n")


def ctl(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str
) -> tuple[int, str]:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(place))
    code = main(["ctl", *words])
    captured = capsys.readouterr()
    return code, captured.out + captured.err


def test_programs_that_come_in_are_heard_on_the_terminal(served: Any) -> None:
    process, ports = served
    with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
        peer.sendall(b'def hello():\n  textmsg("it works: ", get_standard_digital_in(3))\nend\n')
        assert "it works: False" in line_with(process, "it works")


def test_ctl_sets_an_input_that_a_program_sees(served: Any, place: Path, monkeypatch: Any, capsys: Any) -> None:
    process, ports = served
    assert ctl(place, monkeypatch, capsys, "set", "standard_digital_in[5]=true") == (0, "standard_digital_in[5]=True\n")
    assert ctl(place, monkeypatch, capsys, "get") == (0, "standard_digital_in[5] = true\n")
    with socket.create_connection(("127.0.0.1", ports["primary"])) as peer:
        peer.sendall(b'def p():\n  textmsg("input: ", get_standard_digital_in(5))\nend\n')
        assert "input: True" in line_with(process, "input: ")


def test_ctl_speaks_json(served: Any, place: Path, monkeypatch: Any, capsys: Any) -> None:
    code, text = ctl(place, monkeypatch, capsys, "--json", "state")
    assert code == 0
    assert json.loads(text)["result"]["robot_mode"] == "RUNNING"


def test_what_becomes_of_a_task_is_printed(place: Path, tmp_path: Path, monkeypatch: Any, capsys: Any) -> None:
    (tmp_path / "pick.script").write_text("def pick():\n  sleep(0.1)\nend\n", encoding="utf-8")
    (tmp_path / "bad.script").write_text("def bad():\n  x = [1][5]\nend\n", encoding="utf-8")
    process = start(place, "--in-process", "--instance", "7", "--task-dir", str(tmp_path))
    line_with(process, "ready")
    robot = ("--instance", "7")
    assert ctl(place, monkeypatch, capsys, *robot, "load", "pick.script") == (0, "Loaded task: pick.script\n")
    code, text = ctl(place, monkeypatch, capsys, *robot, "play")
    assert (code, "(`elitescript ctl brakes`)" in text) == (1, True)
    ctl(place, monkeypatch, capsys, *robot, "brakes")
    line = ""
    while "robot_mode = RUNNING" not in line:
        line = ctl(place, monkeypatch, capsys, *robot, "state")[1]
    code, text = ctl(place, monkeypatch, capsys, *robot, "play", "--wait")
    assert (code, text.endswith(" s: finished\n")) == (0, True)
    ctl(place, monkeypatch, capsys, *robot, "load", "bad.script")
    code, text = ctl(place, monkeypatch, capsys, *robot, "play", "--wait")
    assert (code, "alarm R100 in line 2: IndexError" in text) == (1, True)
    _, out = stop(process)
    words = re.findall(r"\[(.*?)\] (\S+)", out)
    assert words == [
        ("loaded", "pick.script"),
        ("started", "pick"),
        ("finished", "pick"),
        ("loaded", "bad.script"),
        ("started", "bad"),
        ("ended by an alarm", "bad"),
    ]


def test_a_second_serve_says_which_robot_ctl_speaks_to(served: Any, place: Path) -> None:
    second = start(place, "--in-process")
    line_with(second, "ctl at")
    second.send_signal(signal.SIGINT)
    _, err = second.communicate(timeout=20)
    assert re.search(r"another serve has \S+/serve-0\.sock: .* `elitescript ctl --socket \S+-\d+\.sock`", err)


def test_ctl_exits_with_1_when_refused_and_with_2_when_misused(
    served: Any, place: Path, monkeypatch: Any, capsys: Any
) -> None:
    assert ctl(place, monkeypatch, capsys, "popup", "confirm") == (1, "elitescript ctl: no message window is open\n")
    assert ctl(place, monkeypatch, capsys, "dance")[0] == 2
    assert ctl(place, monkeypatch, capsys, "state", "please")[0] == 2
    assert ctl(place, monkeypatch, capsys, "--instance", "9", "state")[0] == 2


def test_several_robots_have_their_own_ports_and_end_with_sigterm(place: Path) -> None:
    process = start(place, "--in-process", "--json", "--robot", "CS63", "--robot", "CS612", "--instance", "4")
    record = json.loads(line_with(process, '"ready"'))
    assert [robot["model"] for robot in record["robots"]] == ["CS63", "CS612"]
    numbers = [number for robot in record["robots"] for number in robot["ports"].values()]
    assert len(set(numbers)) == 18
    for robot in record["robots"]:
        with socket.create_connection(("127.0.0.1", robot["ports"]["dashboard"])) as peer:
            reader = peer.makefile("rb")
            peer.sendall(b"robot -t\n")
            assert f"{robot['model']}\r\n".encode() in [reader.readline() for _ in range(4)]
    code, out = stop(process, signal.SIGTERM)
    assert code == 0
    assert json.loads(out.splitlines()[-1]) == {"type": "stopped"}


@pytest.mark.parametrize("options", [("--in-process",), ()])
def test_what_is_kept_survives_a_kill(place: Path, tmp_path: Path, options: tuple[str, ...]) -> None:
    state = tmp_path / "state.json"
    for count in range(2):
        process = start(place, "--state", str(state), *options)
        ports = ports_in(line_with(process, "ready"))
        with socket.create_connection(("127.0.0.1", ports["modbus"])) as peer:
            reader = peer.makefile("rb")
            peer.sendall(modbus_client.frame(1, modbus_client.read(3, 256, 1)))
            assert modbus_client.words(modbus_client.frames(reader.read(11))[0][2]) == [count]
            peer.sendall(modbus_client.frame(2, modbus_client.write(6, 256, count + 1)))
            assert len(reader.read(12)) == 12
            while not state.exists() or f'"general_register[0]": {count + 1}' not in state.read_text():
                peer.sendall(modbus_client.frame(3, modbus_client.read(3, 256, 1)))
                reader.read(11)
        process.kill()
        process.communicate(timeout=20)
    process = start(place, "--state", str(state), "--in-process")
    line_with(process, "ready")
    second = start(place, "--state", str(state), "--in-process", "--instance", "7")
    assert "another `elitescript` uses it" in second.communicate(timeout=20)[1]
    assert second.returncode == 2
    assert stop(process)[0] == 0


def test_a_state_file_of_somebody_else_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "notes.json"
    path.write_text('{"mine": 1}')
    assert main(["serve", "--port", "all=0", "--in-process", "--state", str(path)]) == 2
    assert "It was left as it is" in capsys.readouterr().err
    assert path.read_text() == '{"mine": 1}'


def test_a_port_in_use_ends_it_at_once(place: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        number = taken.getsockname()[1]
        process = start(place, "--in-process", "--port", f"query={number}")
        out, err = process.communicate(timeout=20)
    assert process.returncode == 2
    assert "ready" not in out
    assert f"port {number} (query) is in use" in err


def test_without_a_jail_other_computers_are_not_served(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--host", "0.0.0.0", "--in-process"]) == 2
    assert "--trust-network" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform == "win32", reason="robots are in this process there")
def test_a_world_file_that_programs_can_change_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tasks = tmp_path / "tasks"
    (tasks / "cell").mkdir(parents=True)
    world = tasks / "cell" / "cell.toml"
    world.write_text("")
    assert main(["serve", "--task-dir", str(tasks), "--world", str(world)]) == 2
    assert "programs of the robot can change it" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["rtsi", "rtsi=x", "rtsi=-1", "all=7"])
def test_a_port_that_cannot_be_read_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="--port"):
        chosen_ports([text])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--joints", "0,0,0,0,0,99"], "joint "),
        (["--joints", "0,0"], "write six numbers in rad"),
        (["--speed", "7"], "speed must be in [0, 1], got 7.0"),
        (["--set", "standard_analog_in[0]=99"], "must be in [0, 10] V"),
        (["--set", "standard_digital_in[16]=true"], "has indices 0 to 15, not 16"),
        (["--set", "standard_digital_in[3]=5"], "takes True or False"),
        (["--robot", "CS99"], "CS99"),
        (["--world", "CELL"], "cell.toml:2"),
        (["--world", "no.toml"], "cannot read no.toml"),
    ],
)
def test_wrong_options_are_told_as_by_run_before_anything_starts(
    options: list[str], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def start_nothing(*_: Any, **__: Any) -> None:
        raise AssertionError("a robot was started")

    monkeypatch.setattr(serve, "make_link", start_nothing)
    (tmp_path / "cell.toml").write_text("[safety]\ntcp_speed = -1\n")
    (tmp_path / "p.script").write_text("sleep(0)\n")
    given = [str(tmp_path / "cell.toml") if option == "CELL" else option for option in options]
    assert main(["serve", *given]) == 2
    served = capsys.readouterr().err
    assert main(["run", str(tmp_path / "p.script"), *given]) == 2
    assert served.removeprefix("elitescript serve: ") == capsys.readouterr().err.removeprefix("elitescript run: ")
    assert words in served


def test_a_port_that_the_firmware_does_not_have_cannot_be_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--firmware", "2.10", "--port", "interpreter=0"]) == 2
    assert "--port interpreter=0: firmware 2.10 does not have that port" in capsys.readouterr().err


def test_the_ready_line_says_which_ports_the_firmware_does_not_have(place: Path) -> None:
    process = start(place, "--in-process", "--firmware", "2.10", "--instance", "7")
    ready = line_with(process, "ready")
    stop(process)
    assert ready.endswith(" (firmware 2.10 has no interpreter, query)\n")
    assert not {"interpreter", "query"} & ports_in(ready.partition(" (")[0]).keys()


def test_a_firmware_that_is_not_known_is_told_by_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["serve", "--firmware", "1.0"])
    assert caught.value.code == 2
    assert "invalid choice: '1.0'" in capsys.readouterr().err


def test_all_means_every_port() -> None:
    assert chosen_ports(["all=0", "rtsi=7"]) == {**chosen_ports(["all=0"]), "rtsi": 7}


def test_answers_are_shown_for_people() -> None:
    clients = {"port": 1, "clients": [{"origin": "rtsi#1", "peer": "127.0.0.1:2", "missed_packages": 0}]}
    assert answer_lines({"ok": True, "result": {"rtsi": clients, "speed": 0.5, "joints": [1.0, 2], "on": True}}) == [
        "rtsi 1: rtsi#1 from 127.0.0.1:2",
        "speed = 0.5",
        "joints = [1, 2]",
        "on = true",
    ]
