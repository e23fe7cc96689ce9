"""The end of a terminal ends what records and serves as SIGTERM does: everything is written to its end."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

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
