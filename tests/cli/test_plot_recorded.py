"""`elitescript plot` with the built front end: the recording in its page, and two runs in one."""

import re
from functools import partial
from itertools import pairwise

import pytest

from elitescript.cli import plot
from elitescript.cli.main import main
from elitescript.plotting import page as pages
from elitescript.plotting.sampling import Sampling
from tests.plotting.front_end import pretend_built, recordings_of

PROGRAM = "def job():\n  global n\n  sleep(0.1)\n  textmsg(n)\n  movej([0.2, -1.5, -1.5, -1.6, 1.5, 0])\nend\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pretend_built(tmp_path, monkeypatch)
    (tmp_path / "job.script").write_text(PROGRAM)
    return tmp_path


def said(run, kind):
    return [message for message in run["said"] if message["type"] == kind]


def test_a_program_is_recorded(folder, capsys):
    assert main(["plot", "job.script", "--set", "n=7", "--robot", "CS620"]) == 0
    captured = capsys.readouterr()
    assert re.fullmatch(r"job\.plot\.html: \d\.\d{3} s of CS620, finished \(\d+ kB\)\n", captured.out)
    assert "page" not in captured.err
    (run,) = recordings_of(folder / "job.plot.html")
    (hello,), (scene,), (file,) = said(run, "hello"), said(run, "scene"), said(run, "file")
    assert (hello["mode"], hello["title"], hello["abilities"]) == ("recorded", "job.script", ["seek", "step"])
    assert (scene["robot"], file["text"]) == ("CS620", PROGRAM)
    (ended,) = said(run, "run_ended")
    assert (ended["state"], ended["moment"]["globals"][0]["value"]) == ("finished", "7")
    ticks = [round(tick) for tick in run["columns"]["tick"]]
    assert ticks == list(range(len(ticks)))
    assert ticks[-1] * 0.004 == pytest.approx(ended["moment"]["t"])


def test_it_equals_the_trace(folder, capsys):
    assert main(["run", "job.script", "--set", "n=7", "--trace", "out.csv"]) == 0
    assert main(["plot", "job.script", "--set", "n=7"]) == 0
    assert main(["plot", "out.csv"]) == 0
    (run,), (trace,) = recordings_of(folder / "job.plot.html"), recordings_of(folder / "out.plot.html")
    head, *rows = (folder / "out.csv").read_text().splitlines()
    for name, column in run["columns"].items():
        if name != "tick":
            known = [float(row.split(",")[head.split(",").index(name)]) for row in rows]
            assert column == pytest.approx(known, abs=1e-6)
            assert trace["columns"][name] == column
    assert said(trace, "file") == []
    assert [message["line"] for message in said(trace, "lines")] == [message["line"] for message in said(run, "lines")]


def test_signals_of_a_trace_are_events(folder, capsys):
    (folder / "job.script").write_text("sleep(0.1)\nset_standard_digital_out(2, True)\nsleep(0.1)\n")
    assert main(["run", "job.script", "--trace", "out.jsonl", "--trace-signals", "standard_digital_out"]) == 0
    assert main(["plot", "out.jsonl"]) == 0
    (run,) = recordings_of(folder / "out.plot.html")
    (events,) = said(run, "events")
    (event,) = events["list"]
    assert (event["name"], event["value"]) == ("standard_digital_out[2]", True)
    assert event["t"] == pytest.approx(0.1, abs=0.005)


def test_an_alarm_has_its_line_and_pose(folder, capsys):
    (folder / "job.script").write_text("movel([3, 0, 0.3, 3.14, 0, 0])\n")
    assert main(["plot", "job.script"]) == 1
    (ended,) = said(recordings_of(folder / "job.plot.html")[0], "run_ended")
    assert (ended["state"], ended["alarm"]["line"], ended["alarm"]["asked_pose"][0]) == ("alarm", 1, 3)


def test_two_arms_and_two_versions(folder, capsys):
    (folder / "old.script").write_text(PROGRAM.replace("0.1)", "0.3)"))
    assert main(["plot", "job.script", "--set", "n=7", "--compare-robot", "CS612", "-o", "arms.html"]) == 0
    assert main(["plot", "job.script", "--set", "n=7", "--compare", "old.script", "-o", "versions.html"]) == 0
    words = capsys.readouterr().out
    assert "of CS66, finished; compared with" in words
    assert "of CS612, finished" in words
    first, second = recordings_of(folder / "arms.html")
    assert [said(run, "scene")[0]["robot"] for run in (first, second)] == ["CS66", "CS612"]
    first, second = recordings_of(folder / "versions.html")
    times = [said(run, "run_ended")[0]["moment"]["t"] for run in (first, second)]
    assert times[1] - times[0] == pytest.approx(0.2)


def test_a_program_and_a_trace_of_it(folder, capsys):
    assert main(["run", "job.script", "--set", "n=7", "--trace", "out.csv"]) == 0
    assert main(["plot", "job.script", "--set", "n=7", "--compare", "out.csv"]) == 0
    first, second = recordings_of(folder / "job.plot.html")
    assert first["columns"]["q1"] == second["columns"]["q1"]


def test_a_page_that_would_be_too_large_has_fewer_rows_and_says_so(folder, capsys, monkeypatch):
    monkeypatch.setattr(pages, "BYTES_MAX", 6_000)
    (folder / "job.script").write_text(
        "movej([0.2, -1.5, -1.5, -1.6, 1.5, 0])\nmovej([1.2, -1.2, -1.1, -1.3, 1.2, 0.7])\nsleep(3)\n"
    )
    assert main(["plot", "job.script"]) == 0
    step = re.search(r", a row every (\d+) ms", capsys.readouterr().out)
    assert int(step[1]) in (8, 16, 32)
    ticks = recordings_of(folder / "job.plot.html")[0]["columns"]["tick"]
    assert max(later - t for t, later in pairwise(ticks)) * 4 <= int(step[1]) + 4


def test_a_long_run_is_sampled_as_before(folder, capsys, monkeypatch):
    monkeypatch.setattr(plot, "Sampling", partial(Sampling, 300))
    (folder / "job.script").write_text("while True:\n  sleep(1)\n")
    assert main(["plot", "job.script", "--until", "2"]) == 4
    assert ", a row every 8 ms (" in capsys.readouterr().out


def test_no_text_leaves_its_place(folder, capsys):
    text = "</script><!-- \\u2028 @@recording@@ "
    (folder / "a<b>&.script").write_text(f"textmsg('{text}\\ud800')\n")
    assert main(["plot", "a<b>&.script", "-o", "x.html"]) == 0
    page = (folder / "x.html").read_text(encoding="utf-8")
    assert page.startswith("<title>a&lt;b&gt;&amp;.script</title>")
    assert (page.count("</script>"), page.count("<!--"), page.endswith("<p>end</p>")) == (1, 0, True)
    (event,) = said(recordings_of(folder / "x.html")[0], "events")[0]["list"]
    assert event["text"] == "</script><!-- \u2028 @@recording@@ \\ud800"
