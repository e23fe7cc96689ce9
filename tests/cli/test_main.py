"""Calls that make no sense: each is answered with what was probably meant."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from pathlib import Path

import pytest

from elitescript.cli.main import main
from elitescript.cli.output.remedies import with_verbs

PROGRAM = "global speed\nspeed = 1\n"


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    with pytest.raises(SystemExit) as left:
        main(list(words))
    assert left.value.code == 2
    return capsys.readouterr().err


def test_a_program_in_the_place_of_a_command_is_to_be_run(capsys: pytest.CaptureFixture[str]) -> None:
    err = refused(capsys, "cell.script", "--until", "5")
    assert err == "elitescript: 'cell.script' is no command; to run it: elitescript run cell.script\n"


def test_a_misspelt_command_is_answered_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "chek").startswith("elitescript: 'chek' is no command; did you mean 'check'?")


def test_a_misspelt_option_is_answered_with_the_usage_of_its_command(capsys: pytest.CaptureFixture[str]) -> None:
    err = refused(capsys, "run", "cell.script", "--wrld", "cell.toml")
    assert err.startswith("usage: elitescript run ")
    assert "unrecognized arguments: --wrld cell.toml; did you mean '--world'?" in err


def test_a_misspelt_signal_is_answered_with_the_nearest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = tmp_path / "cell.script"
    program.write_text(PROGRAM, encoding="utf-8")
    for setting in ("standard_digtal_in[3]=true", "tool_anlog_in=3"):
        assert main(["run", str(program), "--set", setting]) == 2
        assert "did you mean 'standard_digital_in'?" in (err := capsys.readouterr().err) or "'tool_analog_in'?" in err
    assert main(["run", str(program), "--set", "speed=3"]) == 0


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("power on and release the brakes", "power on and release the brakes (`elitescript ctl brakes`)"),
        ("release it (signal emergency_stop to False), then", "release it (`elitescript ctl release`), then"),
        ("then unlock it (unlock_protective_stop), from", "then unlock it (`elitescript ctl unlock`), from"),
        ("restart the safety system (restart_safety)", "restart the safety system (`elitescript ctl restart`)"),
        ("no task is loaded", "no task is loaded"),
    ],
)
def test_advice_for_a_served_robot_names_the_verb_of_ctl(text: str, shown: str) -> None:
    assert with_verbs(text) == shown


DEVICE = """
from elitescript.testing.world import ModbusDevice

log = open("device.log", "w")
log.write("never closed")


class Silent(ModbusDevice):
    pass
"""


@pytest.mark.parametrize("is_on", [True, False])
def test_a_call_in_the_process_of_somebody_else_leaves_its_garbage_collection_alone(
    is_on: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "p.script").write_text("x = 1\n")
    before = gc.isenabled()
    try:
        (gc.enable if is_on else gc.disable)()
        frozen = gc.get_freeze_count()
        assert main(["check", str(tmp_path / "p.script")]) == 0
        assert (gc.isenabled(), gc.get_freeze_count()) == (is_on, frozen)
    finally:
        (gc.enable if before else gc.disable)()


class TestTheEndOfTheProcess:
    """It ends without taking the interpreter apart, and nothing is lost."""

    @staticmethod
    def ended(folder: Path, before: str, *words: str) -> subprocess.CompletedProcess[str]:
        (folder / "p.script").write_text("def a():\n  textmsg('x' * 100000)\nend\n")
        call = f"import sys; {before}; from elitescript.cli.main import main; sys.exit(main())"
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-c", call, *words]
        return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)

    def test_output_is_complete_and_the_code_is_that_of_the_call(self, tmp_path: Path) -> None:
        done = self.ended(tmp_path, "pass", "run", "p.script")
        assert (done.returncode, len(done.stdout) > 100000) == (0, True)
        (tmp_path / "q.script").write_text("def a():\n  x = [1][3]\nend\n")
        assert self.ended(tmp_path, "pass", "run", "q.script").returncode == 1

    def test_what_was_registered_for_the_exit_is_called(self, tmp_path: Path) -> None:
        done = self.ended(tmp_path, "import atexit; atexit.register(print, 'bye')", "check", "p.script")
        assert done.stdout == "bye\n"

    def test_threads_are_waited_for(self, tmp_path: Path) -> None:
        before = "import threading, time; threading.Timer(0.3, print, ['late']).start()"
        assert self.ended(tmp_path, before, "check", "p.script").stdout == "late\n"

    @pytest.mark.parametrize(
        ("options", "expected"),
        [
            (["-m", "cProfile", "-m", "elitescript"], "function calls"),
            (["-m", "profile", "-m", "elitescript"], "function calls"),
            (["-m", "trace", "--count", "--summary", "-C", ".", "--module", "elitescript"], "lines"),
            (["-i", "-m", "elitescript"], "prompt"),
        ],
    )
    def test_what_python_does_afterwards_is_done(self, options: list[str], expected: str, tmp_path: Path) -> None:
        (tmp_path / "p.script").write_text("x = 1\n")
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, *options, "check", "p.script"]
        done = subprocess.run(
            command,
            cwd=tmp_path,
            env=environment,
            input="print('prompt')\n",
            capture_output=True,
            text=True,
            check=False,
        )
        assert expected in done.stdout

    def test_files_of_a_device_are_flushed(self, tmp_path: Path) -> None:
        (tmp_path / "device.py").write_text(DEVICE)
        (tmp_path / "cell.toml").write_text('[[modbus]]\nclass = "device.py:Silent"\nport = 502\n')
        done = self.ended(tmp_path, "pass", "run", "p.script", "--world", "cell.toml")
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "device.log").read_text() == "never closed"
