"""`run --case` and `plot --case` play a failing run of a sweep again and say whether the failure came again."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from elitescript.cli.main import main
from elitescript.sweep.failures.cases import digest_of

PROGRAM = "def p():\n  set_standard_digital_out(1, True)\n  sleep(2)\n  set_standard_digital_out(1, False)\nend\n"
CASE = f"""
program = "../cell.script"
digest = "{digest_of(PROGRAM)}"
seed = 5
[options]
model = "CS63"
[[stop]]
kind = "protective_stop"
at_s = 1.0
[expect]
property = "no_output_left_on"
state = "alarm"
line = 2
"""


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONHASHSEED", "0")
    monkeypatch.setenv("ELITESCRIPT_WATCHED", "0")
    # The limit of a process would be that of these tests, and of the browsers that later ones start.
    monkeypatch.setattr("elitescript.cli.run.limit_memory", lambda size: None)
    (tmp_path / "cell.script").write_text(PROGRAM, encoding="utf-8")
    (tmp_path / "cases").mkdir()
    path = tmp_path / "cases" / "CASE.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def test_a_case_is_played_from_anywhere(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--case", "cases/CASE.toml"]) == 1
    err = capsys.readouterr().err
    assert "The failure came again: no_output_left_on does not hold." in err
    assert "1.000 s  the safety system stopped the arm" in err
    assert "note:" not in err


def test_the_program_may_be_named_and_changed(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mended = PROGRAM.replace("def p():\n", "def p():\n  set_runstate_standard_digital_output_to_value(1, 1)\n")
    Path("mended.script").write_text(mended, encoding="utf-8")
    assert main(["run", "mended.script", "--case", str(case)]) == 1  # it is stopped all the same
    err = capsys.readouterr().err
    assert "note: mended.script has changed since the case was written" in err
    assert "The failure did not come again: no_output_left_on holds now." in err


def test_json_says_it_before_the_end(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--case", str(case), "--json"]) == 1
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["type"] for line in lines[-2:]] == ["case", "end"]
    said = lines[-2]
    assert (said["property"], said["came_again"], said["same"], said["changed"]) == (
        "no_output_left_on",
        True,
        True,
        False,
    )
    assert said["story"]["moments"][0] == {"t": 1.0, "line": 0, "text": "the safety system stopped the arm"}
    assert lines[-1]["state"] == "alarm"


def test_a_trace_is_written(case: Path) -> None:
    assert main(["run", "--case", str(case), "--trace", "rows.csv", "--step", "0.1"]) == 1
    assert len(Path("rows.csv").read_text().splitlines()) > 10


def test_a_page_is_written(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", "--case", str(case), "-o", "page.html"]) == 1
    assert "s of CS63, alarm" in capsys.readouterr().out
    assert Path("page.html").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "flag"),
    [(["--world", "x.toml"], "--world"), (["--robot", "CS66"], "--robot"), (["--set", "a=1"], "--set")],
)
def test_what_a_case_says_itself_cannot_be_given(
    case: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], flag: str
) -> None:
    assert main(["run", "--case", str(case), *arguments]) == 2
    assert f"{flag} does not go with --case" in capsys.readouterr().err


def test_a_case_that_makes_no_sense_is_refused_with_its_line(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.write_text(CASE.replace("protective_stop", "protectiv_stop"), encoding="utf-8")
    assert main(["run", "--case", str(case)]) == 2
    assert "CASE.toml:8: stop[0].kind: 'protectiv_stop' is not known" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "plot"])
def test_neither_a_program_nor_a_case_is_refused(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command]) == 2
    assert "FILE is missing" in capsys.readouterr().err
