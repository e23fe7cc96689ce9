"""`elitescript sweep`: exit codes, tables, and the same bytes after any end."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from elitescript.cli.main import main
from elitescript.environment.process import module_environment

PROGRAM = """\
def cell():
  pause_s = 0.5
  sleep(pause_s)
  textmsg("random ", random())
  if pause_s > 0.9:
    x = 1 / 0
  end
end
"""
VARY = ["--vary", "pause_s=uniform(0,1)"]
USUAL = [*VARY, "--ensure", "time_s < 0.5", "--measure", "twice=2 * time_s", "--jobs", "1", "--no-cases"]


@pytest.fixture
def program(tmp_path: Path) -> str:
    path = tmp_path / "cell.script"
    path.write_text(PROGRAM)
    return str(path)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--vary", "pause_s=unifrom(0,1)"], "did you mean 'uniform'"),
        (["--vary", "pase_s=uniform(0,1)"], "did you mean 'pause_s'"),
        (["--runs", "0"], "--runs must be 1 or more"),
        (["--jobs", "0"], "--jobs must be 1 or more"),
        (["--max-wall", "0"], "--max-wall must be > 0"),
        (["--ensure", "tim_s < 1"], "did you mean 'time_s'"),
        (["--measure", "time_s"], "write NAME=EXPRESSION"),
        (["--measure", "state=time_s"], "a column that every table has"),
        (["--measure", "a=time_s", "--measure", "a=time_s"], "a is measured twice"),
        (["--out", "out.xlsx"], "must end in .csv"),
        (["--out", ""], "--out : the name of the file is missing"),
        (["--runs", "9" * 30], "--runs must be 1000000000000 at most"),
        (["--vary", f"pause_s=uniform(0,{'9' * 400})"], "a number is too large"),
        (["--json", "--measure", "type=time_s"], "a column called 'type' would hide what each line is"),
        (["--out", "nowhere/out.csv"], "there is no folder nowhere"),
        (["--resume"], "--resume goes with --out"),
        (["--chaos", "chanels"], "did you mean 'channels'"),
        (["--until", "-1"], "--until must be >= 0"),
        (["--speed", "2"], "--speed must be in"),
    ],
)
def test_usage(program: str, arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", program, *arguments]) == 2
    assert words in capsys.readouterr().err


def test_a_program_that_does_not_compile(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cell.script").write_text("def p():\n  sleep(\nend\n")
    assert main(["sweep", str(tmp_path / "cell.script")]) == 3
    assert "cell.script:2:" in capsys.readouterr().err


def test_rows_are_the_same_for_any_number_of_processes_and_any_end(
    program: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = tmp_path / "whole.csv"
    assert main(["sweep", program, *USUAL, "--runs", "60", "--out", str(whole)]) == 1
    rows = whole.read_text().splitlines()
    assert rows[0] == "run,seed,pause_s,state,time_s,twice,failed,digest"
    assert rows[1] == "0,2993405329634522,0.2645246165300056,finished,0.268,0.536,,6841d4002d4c91d1"
    assert len(rows) == 61
    assert not (tmp_path / "whole.csv.part").exists()
    assert "of 60 runs hold" in capsys.readouterr().out

    killed = tmp_path / "killed.csv"
    command = [sys.executable, "-m", "elitescript", "sweep", program, *USUAL, "--runs", "60", "--out", str(killed)]
    with subprocess.Popen([*command, "--json"], stdout=subprocess.PIPE, env=module_environment()) as process:
        assert process.stdout is not None
        first = [json.loads(process.stdout.readline()) for _ in range(5)]
        os.kill(process.pid, signal.SIGKILL)
    assert [row["run"] for row in first] == list(range(5))
    assert first[0]["twice"] == 0.536
    assert not killed.exists()
    part = killed.with_name("killed.csv.part")
    assert part.exists()

    assert main(["sweep", program, *USUAL, "--runs", "60", "--out", str(killed), "--resume", "--seed", "4"]) == 2
    assert "was begun with other settings: --seed 4 now, --seed 0 then" in capsys.readouterr().err
    again = ["2" if word == "1" else word for word in USUAL]
    assert main(["sweep", program, *again, "--runs", "60", "--out", str(killed), "--resume"]) == 1
    assert "runs are there already" in capsys.readouterr().err
    assert killed.read_bytes() == whole.read_bytes()
    assert not part.exists()

    # A finished table belongs to its settings, as does one that is not finished.
    before = whole.read_bytes()
    for arguments, words in (
        (["--seed", "4"], "was made with other settings: --seed 4 now, --seed 0 then"),
        (["--ensure", "time_s < 2", "--runs", "70"], "time_s < 2"),
    ):
        assert main(["sweep", program, *USUAL, "--runs", "60", "--out", str(whole), "--resume", *arguments]) == 2
        assert words in capsys.readouterr().err
    assert main(["sweep", program, *USUAL, "--runs", "60", "--out", str(whole), "--resume"]) == 0
    assert "whole.csv is finished: it has the 60 runs of these settings, and" in capsys.readouterr().out
    assert main(["sweep", program, *USUAL, "--runs", "5", "--out", str(whole), "--resume", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["type"], said["runs"], said["out"]) == ("finished", 60, str(whole))
    assert said["failed"] == sum(line.split(",")[-2] != "" for line in rows[1:])
    assert whole.read_bytes() == before
    # More runs are no other setting.
    assert main(["sweep", program, *USUAL, "--runs", "64", "--out", str(whole), "--resume"]) == 1
    assert "60 of 64 runs are there already" in capsys.readouterr().err
    assert whole.read_bytes().startswith(before)
    assert len(whole.read_bytes().splitlines()) == 65
    Path(f"{whole}.sweep").unlink()
    assert main(["sweep", program, *USUAL, "--runs", "64", "--out", str(whole), "--resume"]) == 2
    assert "is there, but no whole.csv.sweep beside it" in capsys.readouterr().err


def test_ctrl_c_keeps_what_is_there(program: str, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    command = [
        sys.executable,
        "-m",
        "elitescript",
        "sweep",
        program,
        *USUAL,
        "--runs",
        "100000",
        "--out",
        str(out),
        "--json",
    ]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=module_environment(), text=True
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        rows, words = process.communicate(timeout=60)
    assert process.returncode == 130
    summary = json.loads(rows.splitlines()[-1])
    assert summary["type"] == "summary"
    assert 0 < summary["runs"] < 100000
    assert f"{summary['runs']:,} of 100,000 runs are done; --resume goes on from {out}.part" in words
    assert not out.exists()


def test_a_run_that_hangs_costs_itself_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cell.py").write_text(
        "from threading import Event\n"
        "from elitescript.testing.world import Device\n"
        "class Lamp(Device):\n"
        "    def signal_changed(self, name, value):\n"
        "        Event().wait()\n"
    )
    (tmp_path / "cell.toml").write_text('[[device]]\nclass = "cell.py:Lamp"\n')
    (tmp_path / "cell.script").write_text(
        "def p():\n  global n\n  if n == 1:\n    set_standard_digital_out(0, True)\n  end\n  sync()\nend\n"
    )
    arguments = [str(tmp_path / "cell.script"), "--world", str(tmp_path / "cell.toml"), "--vary", "n=grid(0,2,3)"]
    out = tmp_path / "out.jsonl"
    assert main(["sweep", *arguments, "--max-wall", "1", "--jobs", "1", "--json", "--out", str(out)]) == 1
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    rows = [json.loads(line) for line in (tmp_path / "out.jsonl").read_text().splitlines()]
    assert rows == [{name: value for name, value in line.items() if name != "type"} for line in lines[:3]]
    assert [(row["n"], row["state"], row["failed"], row["time_s"]) for row in rows] == [
        (0, "finished", "", 0.004),
        (1, "hung", "hung", None),
        (2, "finished", "", 0.004),
    ]
    assert lines[-1]["states"] == {"finished": 2, "hung": 1}
    assert lines[-2]["type"] == "failure"
    assert Path(lines[-2]["case"]).exists()


def test_the_numbers_add_up_and_are_the_same_for_any_number_of_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cell.script").write_text(PROGRAM)
    told: list[list[dict[str, Any]]] = []
    for jobs in ("1", "3"):
        arguments = ["--ensure", "time_s < 0.5", "--ensure", "no_alarm", "--runs", "30", "--jobs", jobs, "--json"]
        assert main(["sweep", "cell.script", *VARY, *arguments]) == 1
        told.append([json.loads(line) for line in capsys.readouterr().out.splitlines()])
        (tmp_path / "CASE.toml").rename(tmp_path / f"{jobs}.toml")
        for path in tmp_path.glob("CASE*"):
            path.unlink()
    assert told[0] == told[1]
    assert (tmp_path / "1.toml").read_bytes() == (tmp_path / "3.toml").read_bytes()
    failures = [line for line in told[0] if line["type"] == "failure"]
    numbers = told[0][-1]["numbers"]
    assert numbers["runs"] == 30 == sum(line["type"] == "row" for line in told[0])
    assert numbers["failed"] == told[0][-1]["failed"]
    assert numbers["shrink_runs"] == sum(line["tried"] for line in failures) > 0
    assert numbers["shrunk"] == len(failures)
    assert numbers["cases_written"] == sum(line["written"] for line in failures)
    assert all(line["complete"] for line in failures)


def test_a_budget_for_making_failures_smaller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cell.script").write_text(PROGRAM)
    usual = ["sweep", "cell.script", *VARY, "--ensure", "time_s < 0.6", "--runs", "5", "--jobs", "1"]
    assert main([*usual, "--shrink-runs", "2"]) == 1
    out = capsys.readouterr().out
    assert "made smaller in 2 tries and perhaps not the smallest, see --shrink-runs" in out
    assert "5 runs of the plan, 2 to make 1 of " in out
    (tmp_path / "CASE.toml").unlink()
    assert main([*usual, "--shrink-runs", "0"]) == 1
    assert "5 runs of the plan; 1 case is written" in capsys.readouterr().out
    assert main([*usual, "--shrink-runs", "-1"]) == 2
    assert "--shrink-runs must be 0 or more, got -1" in capsys.readouterr().err
