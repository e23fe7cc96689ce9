"""Files that people write, as editors of Windows save them: a byte order mark changes nothing, UTF-16 is told."""

from __future__ import annotations

import codecs
from pathlib import Path

import pytest

from elitescript.cli.main import main
from tests.cli.calls import CALLS, MOVES, Call, prepare

SWEEP = ("sweep", "moves.script", "--runs", "1", "--jobs", "1", "--no-cases")
POINTS = "q0,q1,q2,q3,q4,q5,x,y,z,rx,ry,rz\n0.4,-1.3,-1.7,-1.4,1.5,0.2,-0.3,-0.4,0.3,0,3,0\n"
TRACE = "".join(
    f'{{"type": "row", "t": {t}, "q": [0, -1.5, -1.5, -1.5, 1.5, 0], "tcp": [0, 0, 0, 0, 0, 0]}}\n' for t in (0.0, 0.1)
)
STATE = '{"format": "elitescript state", "version": 1, "signals": {"flag[3]": true}}\n'
FETCH = ("shadow", "127.0.0.1", "--port", "ssh=1", "--fetch-program", "x", "--ssh-password", "@pw.txt")

CELL = {"moves.script": MOVES}
MORE = (
    Call("run --robot", ("run", "moves.script", "--robot", "a.toml"), {**CELL, "a.toml": 'base = "CS66"\n'}),
    Call("run --state", ("run", "moves.script", "--state", "s.json"), {**CELL, "s.json": STATE}),
    Call("sweep --chaos", (*SWEEP, "--chaos", "c.toml"), {**CELL, "c.toml": 'base = "channels"\n'}),
    Call("sweep --ensure", (*SWEEP, "--ensure", "p.py:ok"), {**CELL, "p.py": "def ok(run):\n    return True\n"}),
    Call("fit --pairs", ("fit", "--pairs", "points.csv"), {"points.csv": POINTS}),
    Call("plot", ("plot", "t.jsonl", "-o", "page.html"), {"t.jsonl": TRACE}),
    Call("shadow", FETCH, {"pw.txt": "secret\n"}),
)
"""Kinds of files that are in no call of the table."""

READS = [
    (call, name)
    for call in (*(call for call in CALLS if call.command != "sweep" or call.name == "sweep"), *MORE)
    if call.ends == "itself" and not call.beside and not call.needs_page
    for name in call.files
    if Path(name).suffix not in (".mcap", ".journal") and not (call in MORE and name in CELL)
]
"""Calls with the files that they read and people write."""


def called(call: Call, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    capsys.readouterr()
    code = main(list(call.words))
    return code, capsys.readouterr().err


@pytest.mark.parametrize(("call", "name"), READS, ids=[f"{call.name}: {name}" for call, name in READS])
def test_a_mark_changes_nothing_and_utf_16_is_told(call, name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    prepare(call, tmp_path)
    path = tmp_path / name
    plain = path.read_bytes()
    usual, told = called(call, capsys)
    for written in call.writes:
        (tmp_path / written).unlink()
    path.write_bytes(codecs.BOM_UTF8 + plain)
    assert called(call, capsys)[0] == usual, told
    for written in call.writes:
        (tmp_path / written).unlink()
    for data in (plain.decode().encode("utf-16"), plain.decode().encode("utf-16-le")):
        path.write_bytes(data)
        capsys.readouterr()
        # A repair converts the file.
        assert main(list(call.words)) in ((usual,) if "--fix" in call.words else (2, 3))
        told = "".join(capsys.readouterr())
        # Records of a run do not name its program.
        assert name in told or "--json" in call.words
        assert "UTF-16" in told and "UTF-8" in told
