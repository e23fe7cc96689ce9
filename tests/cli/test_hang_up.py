"""The end of a terminal ends what records and serves as SIGTERM does: everything is written to its end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

from elitescript.cli.watched import MARK
from tests.cli.calls import LIMIT_S, Call, await_ready, beside, chosen, prepare, start

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="there is no SIGHUP")

MCAP_END = b"\x89MCAP0\r\n"


@pytest.fixture(autouse=True)
def _heeds_hang_ups() -> Iterator[None]:
    """Start processes that end by SIGHUP: below `nohup` and some runners of CI jobs they would not."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


def test_a_recording_has_its_footer_and_index(tmp_path: Path) -> None:
    from io import BytesIO

    reader = pytest.importorskip("mcap.reader")
    call = Call("record", ("record", "--out", "out.mcap"), beside="controller")
    file = tmp_path / "out.mcap"
    with beside(call, tmp_path) as words:
        process = start(call, tmp_path, words)
        try:
            deadline_s = time.monotonic() + LIMIT_S
            while not (file.exists() and file.stat().st_size) and time.monotonic() < deadline_s:
                time.sleep(0.01)
            process.send_signal(signal.SIGHUP)
            out, err = process.communicate(timeout=LIMIT_S)
        finally:
            process.kill()
    assert (process.returncode, b"rows at" in out) == (0, True), err
    data = file.read_bytes()
    assert data.endswith(MCAP_END)
    summary = reader.make_reader(BytesIO(data)).get_summary()
    assert summary is not None and summary.chunk_indexes


@pytest.mark.slow
@pytest.mark.parametrize("call", chosen(lambda call: call.ends == "signal"))
def test_what_a_signal_ends_ends_alike(call: Call, tmp_path: Path) -> None:
    found = []
    for number in (signal.SIGTERM, signal.SIGHUP):
        folder = tmp_path / number.name
        folder.mkdir()
        prepare(call, folder)
        process = start(call, folder)
        try:
            await_ready(process)
            process.send_signal(number)
            process.communicate(timeout=LIMIT_S)
        finally:
            process.kill()
        assert set(call.writes) <= {path.name for path in folder.iterdir() if path.stat().st_size}
        found.append(process.returncode)
    assert found == [call.code, call.code]


LEFT_WHILE_IT_WRITES = """
import importlib, os, sys, time
from elitescript.cli.main import main

number, command = int(sys.argv[1]), sys.argv[2]

def stopped(options):
    os.kill(os.getpid(), number)
    time.sleep(60.0)

setattr(importlib.import_module(f"elitescript.cli.{command}"), command, stopped)
del sys.argv[1]
sys.exit(main())
"""


def _is_writing(call: Call) -> bool:
    return call.ends == "itself" and not call.beside and bool(call.writes or call.changes)


QUICK: Final = ("fit --out", "replay --trace")


@pytest.mark.parametrize(
    "call",
    [
        *chosen(lambda call: call.name in QUICK),
        *(
            pytest.param(*row.values, id=row.id, marks=[*row.marks, pytest.mark.slow])
            for row in chosen(lambda call: _is_writing(call) and call.name not in QUICK)
        ),
    ],
)
def test_a_signal_in_the_middle_leaves_no_unfinished_file(call: Call, tmp_path: Path) -> None:
    prepare(call, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    environment = {**os.environ, "PYTHONHASHSEED": "0", MARK: "1"}
    words = [sys.executable, "-c", LEFT_WHILE_IT_WRITES, str(int(signal.SIGTERM)), *call.words]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, timeout=LIMIT_S, check=False)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before, done
    assert done.returncode == 128 + signal.SIGTERM, done
