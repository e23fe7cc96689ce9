"""Recordings whose recorder is killed, whose disk is full, or whose file was damaged: what was written can be read."""

from __future__ import annotations

import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from elitescript.environment.process import module_environment
from elitescript.errors import UsageError
from elitescript.pytest_plugin.served import ServedRobot
from elitescript.recorder.mcap_file import read_recording

pytest.importorskip("mcap")
pytestmark = pytest.mark.slow

KILLS = 30
MUTATIONS = 300
SIZES = (0, 1, 100, 1_000, 10_000, 20_000, 30_000, 50_000, 80_000, 120_000, 200_000, 400_000)


@pytest.fixture(scope="module")
def served():
    robot = ServedRobot()
    yield robot
    robot.close()


def command(served: ServedRobot, out: str, *more: str) -> list[str]:
    ports = [word for name in ("rtsi", "primary", "dashboard") for word in ("--port", f"{name}={served.ports[name]}")]
    return [sys.executable, "-m", "elitescript", "record", served.host, "--out", out, *ports, *more]


def rows_are_in_order(path: Path) -> int:
    """Return the number of rows of a recording; they rise by a control period but for what is said to be missing."""
    found = read_recording(path)
    steps = [now - before for before, now in zip(found.t, found.t[1:], strict=False)]
    assert all(step > 0.0 for step in steps)
    assert sum(step > 0.006 for step in steps) == len(found.gaps)
    return len(found.t)


def test_a_recorder_that_is_killed_leaves_what_it_had(served: ServedRobot, tmp_path: Path) -> None:
    draw = random.Random(29)
    readable = 0
    for number in range(KILLS):
        path = tmp_path / f"run{number}.mcap"
        with subprocess.Popen(
            command(served, str(path)), env=module_environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as process:
            while not path.exists() and process.poll() is None:
                time.sleep(0.01)
            time.sleep(draw.uniform(0.0, 3.0))
            process.kill()
        if not path.exists() or not path.stat().st_size:
            continue
        try:
            count = rows_are_in_order(path)
        except UsageError as error:
            assert "ended within its first second" in str(error) or "no recording" in str(error)
            continue
        readable += count > 0
    assert readable > KILLS // 3


@pytest.mark.parametrize("size", SIZES)
def test_a_full_disk_is_said_and_what_was_before_can_be_read(size: int, served: ServedRobot, tmp_path: Path) -> None:
    def limited() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    path = tmp_path / "run.mcap"
    done = subprocess.run(
        command(served, str(path), "--for", "4"),
        env=module_environment(),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        preexec_fn=limited,
    )
    assert "Traceback" not in done.stderr
    if done.returncode:
        assert done.returncode == 1
        assert "File too large" in done.stderr
    if path.exists() and path.stat().st_size > 2_000:
        rows_are_in_order(path)


def test_files_that_were_damaged_are_read_or_refused(served: ServedRobot, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    subprocess.run(command(served, str(path), "--for", "2"), env=module_environment(), timeout=60, check=True)
    whole = path.read_bytes()
    draw = random.Random(30)
    refused = 0
    for _ in range(MUTATIONS):
        data = bytearray(whole)
        for _ in range(draw.randint(1, 3)):
            at = draw.randrange(len(data))
            match draw.randrange(4):
                case 0:
                    data[at] ^= 1 << draw.randrange(8)
                case 1:
                    del data[at + 1 :]
                case 2:
                    data[at:at] = data[draw.randrange(len(data)) :][: draw.randrange(200)]
                case _:
                    del data[at + 1 : at + draw.randrange(200)]
        path.write_bytes(data)
        try:
            read_recording(path)
        except UsageError:
            refused += 1
    assert 0 < refused < MUTATIONS
