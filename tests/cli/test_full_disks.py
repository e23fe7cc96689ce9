"""A disk that is full at any byte: what is written is whole or refused with a sentence, never half and silent."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Final

import pytest

from elitescript.page import MARK
from tests.cli.calls import Call, chosen, finish, prepare

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="needs limits of processes"),
]

SIZES: Final = (0, 1, 100, 511, 512, 4_095, 4_096, 20_000, 65_536, 200_000, 500_000, 1_000_000)
"""Bytes that a file may have in the process: a larger one is refused by the system, as on a full disk."""
TEXT: Final = """def job():
  for n in range(20):
    movej([0.02 * n, -1.57, -1.57, -1.57, 1.57, 0])
    textmsg("pass ", n)
    write_port_register(256 + n, n + 1)
  end
end
"""
CALLS: Final = {
    "trace": (["run", "job.script", "--trace", "out.csv"], "out.csv"),
    "trace of lines": (["run", "job.script", "--trace", "out.jsonl"], "out.jsonl"),
    "state": (["run", "job.script", "--state", "out.json"], "out.json"),
    "page": (["plot", "job.script", "-o", "out.html"], "out.html"),
    "table": (["sweep", "job.script", "--runs", "3", "--jobs", "1", "--out", "out.csv"], "out.csv"),
    "layout": (["fmt", "job.script"], "job.script"),
}


def _limit(size: int) -> None:
    import resource
    import signal

    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def called(words: list[str], folder: Path, size: int | None) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-B", "-m", "elitescript", *words],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=120.0,
        check=False,
        preexec_fn=None if size is None else partial(_limit, size),
    )


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", CALLS)
def test_a_file_is_whole_or_its_loss_is_said(name: str, size: int, tmp_path: Path) -> None:
    words, out = CALLS[name]
    for folder in ("whole", "full"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "job.script").write_text(TEXT if name != "layout" else TEXT.replace("    ", "       "))
    assert called(words, tmp_path / "whole", None).returncode == 0
    before = (tmp_path / "full" / "job.script").read_bytes()
    found = called(words, tmp_path / "full", size)
    assert b"Traceback" not in found.stderr
    whole, full = tmp_path / "whole" / out, tmp_path / "full" / out
    is_whole = full.exists() and full.stat().st_size == whole.stat().st_size
    if found.returncode == 0:
        assert is_whole
    else:
        assert found.stderr.strip()
        assert b"elitescript" in found.stderr
    if name == "layout":
        assert full.read_bytes() in (before, whole.read_bytes())


OLDER: Final = {
    ".html": f"<html><head>{MARK}</head></html>",
    ".json": '{"format": "elitescript state", "version": 1, "signals": {"flag[3]": true}}',
}


@pytest.mark.parametrize("size", [0, 100, 4_096, 65_536])
@pytest.mark.parametrize("call", chosen(lambda call: call.writes and call.ends == "itself" and not call.beside))
def test_the_older_file_is_left_where_the_new_one_is_not_whole(call: Call, size: int, tmp_path: Path) -> None:
    prepare(call, tmp_path)
    older = {name: OLDER.get(Path(name).suffix, "older").encode() for name in call.writes}
    for name, content in older.items():
        (tmp_path / name).write_bytes(content)
    done = finish(call, tmp_path, preexec_fn=partial(_limit, size))
    if done.returncode == call.code:
        assert {name: (tmp_path / name).read_bytes() for name in older} != older
    else:
        assert done.returncode == 2
        assert {name: (tmp_path / name).read_bytes() for name in older} == older
        # A sweep keeps its rows in a journal first.
        assert all(name in done.stderr.decode() or b"journal: " in done.stderr for name in older)
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []
