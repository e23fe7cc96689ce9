"""Recorded sessions of served robots, debugged: their texts, breakpoints in each of them, both directions."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.environment.memory import MemoryFiles
from elitescript.kernel import RobotOptions
from elitescript.messages.inputs import Debug, Do, LoadTask, PlayTask, RunUnit
from elitescript.messages.machine import WriteSignal
from elitescript.services.journal.replay import RecordedRobot
from elitescript.services.journal.writer import Journal
from tests.dap.client import Failed, MemoryClient

TASK = 'textmsg("parts ", open("parts.txt").read())\nsleep(0.2)\n'
JOB = "def job():\n  global n\n  n = 0\n  while n < 5:\n    n = n + 1\n    sleep(0.02)\n  end\nend\n"
BESIDE = "sec beside():\n  set_standard_digital_out(2, True)\nend\n"
INPUTS = {
    2: [LoadTask("dashboard#1", "cell.task"), PlayTask("dashboard#1")],
    100: [RunUnit("primary#1", "program", JOB)],
    110: [RunUnit("primary#1", "secondary", BESIDE), Do("rtsi#1", WriteSignal("input_float_register", 0, 0.5))],
    200: [RunUnit("primary#1", "program", JOB)],
}


def recorded(folder: Path, more: dict | None = None) -> Path:
    path = folder / "day.journal"
    options = RobotOptions(power_on=True)
    journal = Journal(path, options)
    files = MemoryFiles({"cell.task": b"", "cell.script": TASK.encode(), "parts.txt": b"12"})
    robot = RecordedRobot(options, files, journal)
    inputs = {**INPUTS, **(more or {})}
    for tick in range(300):
        robot.tick(inputs.get(tick, ()))
    journal.close()
    return path


@pytest.fixture
def client(tmp_path):
    found = MemoryClient()
    found.initialize()
    found.launch(recorded(tmp_path), stopOnEntry=True, stopOnEnd=True)
    yield found
    found.disconnect()


def test_each_text_is_a_source_once(client):
    sources = client.request("loadedSources")["sources"]
    texts = [client.request("source", source=one, **reference(one))["content"] for one in sources]
    assert texts == [TASK, JOB, BESIDE]
    assert len({one["name"] for one in sources}) == 3


def reference(source):
    return {"sourceReference": source["sourceReference"]}


def test_breakpoints_stop_in_each_text_every_time_it_runs(client):
    _, job, beside = client.request("loadedSources")["sources"]
    client.request("setBreakpoints", source=job, breakpoints=[{"line": 5, "condition": "n == 2"}])
    client.request("setBreakpoints", source=beside, breakpoints=[{"line": 2}])
    stop = client.stop_of(client.launched)
    assert client.stack(stop["body"]["threadId"])[0]["line"] == 1
    seen = []
    while (stop := client.go("continue", stop["body"]["threadId"]))["body"]["reason"] == "breakpoint":
        frame = client.stack(stop["body"]["threadId"])[0]
        tick = client.request("elitescript/state")["tick"]
        seen.append((frame["source"]["sourceReference"], frame["line"], tick))
    assert stop["body"]["reason"] == "end"
    assert [(number, line) for number, line, _ in seen] == [(2, 5), (3, 2), (2, 5)]
    assert seen[1][2] == 110
    assert seen[2][2] == seen[0][2] + 100


def test_it_is_gone_through_backwards(client):
    _, job, _ = client.request("loadedSources")["sources"]
    client.request("setBreakpoints", source=job, breakpoints=[{"line": 5}])
    client.stop_of(client.launched)
    client.request("setBreakpoints", source=job, breakpoints=[])
    assert client.go("continue")["body"]["reason"] == "end"
    client.request("setBreakpoints", source=job, breakpoints=[{"line": 5, "condition": "n == 3"}])
    thread = client.go("reverseContinue")["body"]["threadId"]
    here = client.moment(thread)
    assert client.evaluate("n", thread=thread) == "3"
    client.go("stepBack", thread)
    client.go("next", thread)
    assert client.moment(thread) == here


def test_what_came_from_outside_is_there_again(client):
    client.stop_of(client.launched)
    client.go("elitescript/goto", tick=111)
    frames = client.request("threads")["threads"]
    found = client.request("evaluate", expression="input_float_register[0]", frameId=0, context="watch")
    assert found["result"] == "0.5"
    assert frames
    (said,) = [one for one in client.bodies("output") if one["output"] == "parts 12\n"]
    task, *_ = client.request("loadedSources")["sources"]
    assert (said["source"], said["line"]) == (task, 1)


@pytest.mark.parametrize(("settings", "text"), [({"robot": "CS66"}, "robot is in the journal"), ({}, "cannot be")])
def test_what_makes_no_sense_is_refused(tmp_path, settings, text):
    more = {} if settings else {250: [Debug("ctl#1", "ctl#1", '{"do": "attach"}')]}
    client = MemoryClient()
    client.initialize()
    with pytest.raises(Failed, match=text):
        client.launch(recorded(tmp_path, more), **settings)


def test_a_file_that_is_no_journal_is_refused(tmp_path):
    path = tmp_path / "a.journal"
    path.write_text("{}\n")
    client = MemoryClient()
    client.initialize()
    with pytest.raises(Failed, match="no journal of this program"):
        client.launch(path)
