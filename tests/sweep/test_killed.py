"""Sweeps that are killed, disks that are full, and journals that were damaged: the table is the same, or it is said."""

from __future__ import annotations

import gzip
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
from elitescript.sweep import sweep, uniform

pytestmark = pytest.mark.slow

KILLS = 30
MUTATIONS = 60
SIZES = (0, 1, 50, 200, 1_000, 4_000, 9_000, 12_000, 20_000, 40_000, 80_000, 160_000)
PROGRAM = """\
def cell():
  pause_s = 0.5
  for n in range(20):
    sleep(pause_s)
    textmsg("random ", random())
  end
end
"""
RUNS = 400


def command(folder: Path, out: str, *more: str) -> list[str]:
    words = ["--vary", "pause_s=uniform(0,1)", "--runs", str(RUNS), "--jobs", "2", "--no-cases", "--out", out, *more]
    return [sys.executable, "-m", "elitescript", "sweep", str(folder / "cell.script"), *words]


@pytest.fixture
def whole(tmp_path: Path) -> bytes:
    (tmp_path / "cell.script").write_text(PROGRAM)
    subprocess.run(command(tmp_path, "whole.csv"), cwd=tmp_path, env=module_environment(), check=True, timeout=300)
    return (tmp_path / "whole.csv").read_bytes()


def test_a_sweep_that_is_killed_again_and_again_has_the_same_table(whole: bytes, tmp_path: Path) -> None:
    draw = random.Random(29)
    out = tmp_path / "killed.csv"
    for _ in range(KILLS):
        # A table that is complete is begun anew, and stays until the next one is.
        words = command(tmp_path, "killed.csv", *([] if out.exists() else ["--resume"]))
        with subprocess.Popen(
            words, cwd=tmp_path, env=module_environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as process:
            time.sleep(draw.uniform(0.05, 2.5))
            process.kill()
        assert not out.exists() or out.read_bytes() == whole
    done = subprocess.run(
        command(tmp_path, "killed.csv", "--resume"),
        cwd=tmp_path,
        env=module_environment(),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert out.read_bytes() == whole
    assert sorted(path.name for path in tmp_path.glob("killed*")) == ["killed.csv", "killed.csv.sweep"]


@pytest.mark.parametrize("size", SIZES)
def test_a_disk_that_is_full_is_said_and_leaves_no_half_table(size: int, whole: bytes, tmp_path: Path) -> None:
    def limited() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    done = subprocess.run(
        command(tmp_path, "full.csv"),
        cwd=tmp_path,
        env=module_environment(),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        preexec_fn=limited,
    )
    table = tmp_path / "full.csv"
    assert "Traceback" not in done.stderr
    if done.returncode:
        assert "File too large" in done.stderr
    assert not table.exists() or table.read_bytes() == whole
    again = subprocess.run(
        command(tmp_path, "full.csv", "--resume"), cwd=tmp_path, env=module_environment(), timeout=300, check=False
    )
    assert again.returncode == 0
    assert table.read_bytes() == whole


@pytest.mark.parametrize("end", [".part", ".sweep"])
def test_files_that_were_damaged_are_said_or_give_the_same_table(end: str, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    arguments = {"vary": {"pause_s": uniform(0, 1)}, "runs": 12, "jobs": 1, "out": out}
    sweep(PROGRAM, **arguments)
    table, kept = out.read_bytes(), Path(f"{out}.sweep").read_bytes()
    rows = gzip.decompress(kept).split(b"\n", 1)[1]
    draw = random.Random(30)
    said = 0
    for _ in range(MUTATIONS):
        original = kept if end == ".sweep" else rows
        data = bytearray(original)
        for _ in range(draw.randint(1, 3)):
            at = draw.randrange(len(data))
            match draw.randrange(4):
                case 0:
                    data[at] ^= 1 << draw.randrange(8)
                case 1:
                    del data[at:]
                case 2:
                    data[at:at] = data[draw.randrange(len(data)) :][: draw.randrange(200)]
                case _:
                    del data[at : at + draw.randrange(200)]
            if not data:
                break
        for path in tmp_path.glob("out.csv*"):
            path.unlink()
        Path(f"{out}{end}").write_bytes(data)
        if end == ".sweep":
            out.write_bytes(table)
        try:
            result = sweep(PROGRAM, **arguments, resume=True)
        except UsageError:
            said += 1
        else:
            assert len(result) == 12
            assert out.read_bytes() == table
    assert 0 < said < MUTATIONS
