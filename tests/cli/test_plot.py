"""`elitescript plot` as its contract says: what it writes, what it says, exit codes; its pages are the plain ones."""

import json
import re
from functools import partial

import pytest

from elitescript.cli import plot
from elitescript.cli.main import main
from elitescript.plotting.sampling import Sampling
from tests.plotting.front_end import pretend_not_built

PROGRAM = "def job():\n  global n\n  sleep(0.1)\n  textmsg(n)\n  movej([0.2, -1.5, -1.5, -1.6, 1.5, 0])\nend\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pretend_not_built(tmp_path, monkeypatch)
    (tmp_path / "job.script").write_text(PROGRAM)
    return tmp_path


def data_of(path):
    text = path.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])


def test_a_program_is_run_and_plotted(folder, capsys):
    assert main(["plot", "job.script", "--set", "n=7", "--robot", "CS620", "--speed", "0.5"]) == 0
    data = data_of(folder / "job.plot.html")
    assert (data["title"], data["model"], data["state"]) == ("job.script", "CS620", "finished")
    assert [mark["text"] for mark in data["marks"]] == ["7"]
    captured = capsys.readouterr()
    assert re.fullmatch(r"job\.plot\.html: \d\.\d{3} s of CS620, finished \(\d+ kB\)\n", captured.out)
    assert "7" in captured.err


def test_without_the_front_end_one_line_says_what_to_do(folder, capsys):
    assert main(["plot", "job.script", "--set", "n=7"]) == 0
    (line,) = [line for line in capsys.readouterr().err.splitlines() if "page" in line]
    assert line.startswith("a plain page is written: ")
    assert "run `make studio`" in line


def test_the_plain_page_compares_nothing(folder, capsys):
    assert main(["plot", "job.script", "--set", "n=7", "--compare-robot", "CS612"]) == 2
    assert "--compare" in capsys.readouterr().err
    assert not (folder / "job.plot.html").exists()


def test_the_page_goes_where_it_is_wanted(folder):
    assert main(["plot", "job.script", "--set", "n=7", "--joints", "0.1,-1.5,-1.5,-1.6,1.5,0", "-o", "x.html"]) == 0
    curve = data_of(folder / "x.html")["joints"][0]["q"]
    assert (curve["min"], curve["max"]) == pytest.approx((0.1, 0.2))


def test_a_trace_is_plotted_without_its_program(folder, capsys):
    assert main(["run", "job.script", "--set", "n=7", "--trace", "out.csv"]) == 0
    (folder / "job.script").unlink()
    assert main(["plot", "out.csv"]) == 0
    data = data_of(folder / "out.plot.html")
    assert (data["title"], data["marks"], data["source"]) == ("out.csv", [], {})
    assert {line for line, *_ in data["table"]} >= {3, 5}


def test_an_alarm_is_on_the_page_and_in_the_exit_code(folder, capsys):
    assert main(["plot", "job.script"]) == 1
    (mark,) = data_of(folder / "job.plot.html")["marks"]
    assert (mark["kind"], mark["line"]) == ("alarm", 4)
    assert "ALARM" in capsys.readouterr().err


def test_an_alarm_brings_its_hint(folder, capsys):
    (folder / "job.script").write_text("def job():\n  slep(1)\nend\n")
    assert main(["plot", "job.script"]) == 1
    (mark,) = data_of(folder / "job.plot.html")["marks"]
    assert (mark["line"], mark["hints"]) == (2, ["is `sleep` meant?"])


def test_signal_columns_of_a_trace_are_lanes(folder, capsys):
    (folder / "job.script").write_text("sleep(0.1)\nset_standard_digital_out(2, True)\nsleep(0.1)\n")
    for name in ("out.csv", "out.jsonl"):
        assert main(["run", "job.script", "--trace", name, "--trace-signals", "standard_digital_out"]) == 0
        assert main(["plot", name]) == 0
        data = data_of(folder / "out.plot.html")
        assert [(lane["name"], lane["v"]) for lane in data["signals"]["lanes"]][2] == (
            "standard_digital_out[2]",
            [0, 1],
        )
        assert data["channels"]["lanes"] == []


def test_threads_are_on_the_page(folder, capsys):
    text = "def job():\n  def other():\n    sleep(0.2)\n  end\n  start_thread(other, ())\n  sleep(0.5)\nend\n"
    (folder / "job.script").write_text(text)
    assert main(["plot", "job.script"]) == 0
    (thread,) = data_of(folder / "job.plot.html")["threads"]
    assert (thread["name"], thread["line"][0]) == ("other", 3)


def test_half_a_surrogate_pair_is_a_page(folder, capsys):
    (folder / "job.script").write_text("textmsg('\\ud800')\n")
    assert main(["plot", "job.script"]) == 0
    assert data_of(folder / "job.plot.html")["marks"][0]["text"] == r"\ud800"


def test_a_program_without_an_end_is_cut_off(folder, capsys):
    (folder / "job.script").write_text("while True:\n  sleep(1)\n")
    assert main(["plot", "job.script", "--until", "2.5"]) == 4
    assert data_of(folder / "job.plot.html")["end"] == 2.5
    assert "cut off at 2.5 s (--until)" in capsys.readouterr().out


def test_a_program_that_does_not_compile_leaves_no_page(folder, capsys):
    (folder / "job.script").write_text("x = (\n")
    assert main(["plot", "job.script"]) == 3
    assert "job.script:1:" in capsys.readouterr().err
    assert not (folder / "job.plot.html").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none.script"], "none.script"),
        (["none.csv"], "cannot read none.csv"),
        (["bad.csv"], "bad.csv:1: not a trace"),
        (["bad.csv", "--until", "3"], "--until goes with a program; bad.csv is a trace"),
        (["bad.csv", "--set", "n=3"], "--set goes with a program"),
        (["job.script", "--robot", "CS99"], "CS99"),
        (["job.script", "--until", "-1"], "--until must be >= 0 s, got -1"),
        (["job.script", "-o", "job.script"], "this is the file that is to be plotted"),
        (["job.script", "--set", "n=7", "-o", "no/such/folder.html"], "-o no/such/folder.html"),
    ],
)
def test_a_call_that_makes_no_sense(folder, capsys, arguments, words):
    (folder / "bad.csv").write_text("a,b\n")
    assert main(["plot", *arguments]) == 2
    assert words in capsys.readouterr().err
    assert (folder / "job.script").read_text() == PROGRAM


def test_a_run_too_long_for_a_row_each_period_says_how_often_it_is_sampled(folder, capsys, monkeypatch):
    monkeypatch.setattr(plot, "Sampling", partial(Sampling, 300))
    (folder / "job.script").write_text("while True:\n  sleep(1)\n")
    assert main(["plot", "job.script", "--until", "2"]) == 4
    assert ", a row every 8 ms (" in capsys.readouterr().out
    assert data_of(folder / "job.plot.html")["end"] == 2.0
