"""On simulated systems other than Linux every module is imported, programs run, and controllers are served.

See `other_platform.py` for what is simulated. What the two systems really do has not been tried.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.other_platform import record

HELPER = Path(__file__).with_name("other_platform.py")
ROOT = HELPER.parent.parent
OTHERS = ("darwin", "win32")
END_S = 30.0
HANGING = "def cell():\n  x = sum(range(10**12))\nend\n"

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="other systems are simulated on Linux")


def call(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a piece as if on another system."""
    return subprocess.run([*command(), *words], env=environment(folder), capture_output=True, text=True, timeout=60)


def command() -> list[str]:
    return [sys.executable, str(HELPER)]


def environment(folder: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONHASHSEED": "0", "XDG_RUNTIME_DIR": str(folder)}


@pytest.mark.parametrize("platform", OTHERS)
def test_every_module_is_imported_and_programs_leave_the_same_record(platform: str, tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    found = call(tmp_path, platform, "record", str(there))
    assert found.stderr == ""
    assert found.stdout.rstrip() == record(str(here))
    for name in ("result.txt", "state.json"):
        assert (there / name).read_text() == (here / name).read_text()


@pytest.mark.parametrize("platform", OTHERS)
def test_a_call_that_does_not_return_is_ended_by_the_limit_of_wall_time(platform: str, tmp_path: Path) -> None:
    (tmp_path / "cell.script").write_text(HANGING)
    found = call(tmp_path, platform, "start", "run", str(tmp_path / "cell.script"), "--max-wall", "0.3")
    assert found.returncode == 4, found.stderr
    assert "does not come back" in found.stderr


@pytest.mark.parametrize("platform", OTHERS)
def test_a_controller_is_served_and_ended_by_ctrl_c(platform: str, tmp_path: Path) -> None:
    served = subprocess.Popen(
        [*command(), platform, "command", "serve", "--port", "all=0", "--power-on"],
        env=environment(tmp_path),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert served.stdout is not None
        assert re.match(r"ready on 127\.0\.0\.1: CS66: dashboard \d+", served.stdout.readline())
        address = served.stdout.readline()
        assert address.rstrip().endswith("serve-0.json" if platform == "win32" else "serve-0.sock")
        state = call(tmp_path, platform, "command", "ctl", "state")
        assert "robot_mode = RUNNING" in state.stdout, state.stderr
        served.send_signal(signal.SIGINT)
        _, errors = served.communicate(timeout=END_S)
        assert (served.returncode, errors) == (0, "")
    finally:
        served.kill()
        served.communicate()


def test_doctor_says_that_windows_has_no_process_for_robots(tmp_path: Path) -> None:
    found = call(tmp_path, "win32", "command", "doctor")
    assert found.returncode == 1
    assert "robots have no process of their own on this system (win32); use --in-process" in found.stdout
