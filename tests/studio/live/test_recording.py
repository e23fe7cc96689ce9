"""Runs recorded for comparisons and pages, in a worker's place."""

from __future__ import annotations

from base64 import b64decode

import pytest

from elitescript.robot import VirtualRobot
from elitescript.studio.live.jobs import Job, job_data
from elitescript.studio.live.recording import record_run
from tests.conversation.test_recording import read
from tests.plotting.front_end import pretend_built
from tests.studio.live.links import ListLink, no_jail

TEXT = "def job():\n  global n\n  n = 3\n  movej([0.1, -1.57, -1.57, -1.57, 1.57, 0])\n  n = 4\nend\n"


def answer(text, form="recording", name="job.script", until_s=120.0):
    link = ListLink()
    request = {"do": "record", "job": job_data(Job(name, text)), "ask": 9, "form": form, "until_s": until_s}
    record_run(link, request, no_jail)
    (found,) = link.messages
    assert found["ask"] == 9
    return found


def test_a_recording_has_every_row_and_the_end():
    found = answer(TEXT)
    assert found["type"] == "recorded"
    (run,) = read(b64decode(found["content"]))
    trace = VirtualRobot().run(TEXT, trace=True).trace
    assert run["columns"]["q1"] == pytest.approx([row.q[0] for row in trace], abs=1e-6)
    assert run["said"][-1]["moment"]["globals"][0]["value"] == "4"


def test_a_page_is_one_file(tmp_path, monkeypatch):
    pretend_built(tmp_path, monkeypatch)
    found = answer(TEXT, "page")
    assert found["content"].startswith("<title>job.script</title>")


def test_a_run_without_an_end_is_cut_off_where_the_page_cuts_it():
    (run,) = read(b64decode(answer("while True:\n  sleep(1)\n", until_s=2.0)["content"]))
    assert (run["said"][-1]["state"], run["said"][-1]["moment"]["t"]) == ("time_limit", 2.0)


def test_a_trace_is_read(tmp_path):
    rows = VirtualRobot().run(TEXT, trace=True).trace[:2]
    names = ["t", "line", *(f"q{j}" for j in range(1, 7)), *(f"qd{j}" for j in range(1, 7)), "x", "y", "z", "rx", "ry"]
    lines = [",".join([*names, "rz", "state"])]
    lines += [",".join(map(str, (r.t, r.line, *r.q, *r.qd, *r.tcp_pose, r.state))) for r in rows]
    (run,) = read(b64decode(answer("\n".join(lines), name="old.csv")["content"]))
    assert run["columns"]["tick"] == [0, 1]
    assert "file" not in [message["type"] for message in run["said"]]


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [("x = (\n", "job.script", "line 1, column 5"), ("a,b\n", "old.csv", "old.csv:1: not a trace")],
)
def test_what_cannot_be_recorded_is_refused_with_its_place(text, name, words):
    found = answer(text, name=name)
    assert found["type"] == "refused"
    assert words in found["text"]
