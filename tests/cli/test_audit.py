"""`elitescript audit` on files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from elitescript import page
from elitescript.cli.audit import parse_tolerance
from elitescript.cli.main import main
from elitescript.errors import UsageError
from elitescript.recorder.recording import Recording
from elitescript.records import replace
from tests.audit.programs import MOVES
from tests.audit.recording_runs import record_run

pytest.importorskip("mcap")


@pytest.fixture(scope="module")
def recording() -> Recording:
    return replace(record_run(MOVES), attachments={"moves.script": MOVES.encode()})


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, recording: Recording) -> Path:
    from elitescript.recorder.writing import write_recording

    write_recording(tmp_path / "run.mcap", recording)
    (tmp_path / "other.script").write_text(MOVES.replace("v=0.8", "v=0.4"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_it_agrees_with_the_program_that_it_holds(folder, capsys):
    assert main(["audit", "run.mcap"]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].startswith("<moves.script>: 1.388 s of CS66, ")
    assert out[1] == "agrees: target joints, times and signals"


def test_json_names_the_first_difference(folder, capsys):
    assert main(["audit", "run.mcap", "--program", "other.script", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["agrees"] is False
    assert found["divergence"]["line"] == 6
    assert found["divergence"]["cause"] == "speed"
    assert "speed" in found["divergence"]["what"]
    assert found["divergence"]["controller_s"] == pytest.approx(found["divergence"]["t"] + found["runs"][0]["begin_s"])
    assert {"parameters", "errors", "lines", "signals", "not_compared"} <= found.keys()


def test_a_tolerance(folder, capsys):
    assert (
        main(["audit", "run.mcap", "--program", "other.script", "--tolerance", "0.3", "--tolerance", "time=0.5"]) == 0
    )


def test_an_arm_file_is_written(folder, capsys):
    assert main(["audit", "run.mcap", "--fit", "my_arm.toml"]) == 0
    assert 'base = "CS66"' in (folder / "my_arm.toml").read_text()
    assert main(["audit", "run.mcap", "--robot", "my_arm.toml"]) == 0
    assert main(["audit", "run.mcap", "--fit", "my_arm.txt"]) == 2


@pytest.mark.skipif(not page.is_built(), reason="needs the built page")
def test_a_page_has_both_runs(folder, capsys):
    assert main(["audit", "run.mcap", "--program", "other.script", "--page", "out.html"]) == 1
    text = (folder / "out.html").read_text()
    assert "other.script, simulated | run.mcap" in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nothing.mcap"], "nothing.mcap"),
        (["run.mcap", "--program", "nothing.script"], "nothing.script"),
        (["run.mcap", "--run", "2"], "the runs 1 to 1, got 2"),
        (["run.mcap", "--run", "first"], "write the number of a run, or all"),
        (["run.mcap", "--tolerance", "angle=1"], "there are joints, time, share"),
        (["run.mcap", "--tolerance", "joints=-1"], "a number of at least 0"),
        (["run.mcap", "--fit", "run.mcap"], "this is the recording"),
        (["run.mcap", "--fit", "arm.mcap"], "ends in .toml"),
        (["run.mcap", "--page", "run.mcap"], "--page"),
    ],
)
def test_usage(folder, capsys, arguments, words):
    assert main(["audit", *arguments]) == 2
    assert words in capsys.readouterr().err


def test_a_program_that_does_not_compile(folder, capsys):
    Path("broken.script").write_text("def main(:\n")
    assert main(["audit", "run.mcap", "--program", "broken.script"]) == 2
    assert "broken.script:1" in capsys.readouterr().err


def test_tolerances():
    assert parse_tolerance(["0.01", "time=0.1, share=0"]).joints == 0.01
    assert parse_tolerance(["0.01", "time=0.1, share=0"]).time_s == 0.1
    with pytest.raises(UsageError):
        parse_tolerance(["joints=nan"])
