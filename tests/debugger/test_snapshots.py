"""Copies of a run, and the uncounted run that may come to the end first."""

from __future__ import annotations

import os
import signal

import pytest

from elitescript.debugger import snapshots
from elitescript.debugger.api import ALARM_FILTER, END, EXCEPTION, PAUSE
from elitescript.debugger.session import WRITTEN_FILES, DebugSession
from elitescript.debugger.snapshots import Snapshots
from elitescript.debugger.source import ProgramSource

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")

COMPUTING = """
def job():
  total = 0
  for step in range(3):
    count = 0
    while count < {count}:
      count = count + 1
    end
    total = total + count
    textmsg("step ", step)
  end
  {end}
end
"""

ENDLESS = """
def job():
  n = 0
  while True:
    n = n + 1
    if n % 20000 == 0:
      textmsg(n)
    end
  end
end
"""


@pytest.fixture
def always_in_company(monkeypatch):
    """Each run has company from its first copy on, and the copies come soon."""
    monkeypatch.setattr("elitescript.debugger.snapshots.EACH_S", 0.002)
    monkeypatch.setattr("elitescript.debugger.snapshots.COUNTING_MAX", 0.0)
    monkeypatch.setattr("elitescript.debugger.snapshots.cores", lambda: 2)


def run(text, **settings):
    said = []
    session = DebugSession(ProgramSource("job.script", text=text), said.append, forks=True, **settings)
    try:
        stop = session.start()
        state = session.state()
        is_counted = session._engine.is_counted
        return stop, [output.text for output in said], state, is_counted
    finally:
        session.close()


@pytest.mark.usefixtures("always_in_company")
def test_a_run_that_only_computes_ends_when_an_uncounted_one_beside_it_has_ended():
    text = COMPUTING.format(count=100_000, end="total = total + 1")
    alone, in_company = run(text), run(text, keeps_end=False)
    assert alone[0].reason == END
    assert alone[1] == [f"step {number}" for number in range(3)]
    assert (in_company[0].result, in_company[1:3]) == (alone[0].result, alone[1:3])
    assert alone[3]
    assert not in_company[3]


@pytest.mark.usefixtures("always_in_company")
def test_at_an_alarm_the_counted_run_stands():
    text = COMPUTING.format(count=10_000, end="total = 1 / 0")
    alone, in_company = run(text), run(text, keeps_end=False)
    assert in_company == alone
    assert in_company[0].reason == EXCEPTION
    assert in_company[0].exception.filter == ALARM_FILTER
    assert in_company[3]


@pytest.mark.usefixtures("always_in_company")
def test_a_pause_stops_the_counted_run_and_ends_its_company(monkeypatch):
    began = []
    begun = Snapshots._begun
    monkeypatch.setattr(Snapshots, "_begun", lambda *given: began.append(begun(*given)) or began[-1])
    source = ProgramSource("job.script", text=ENDLESS, work_per_tick=10_000)
    session = DebugSession(source, lambda output: len(began) > 1 and session.pause(), forks=True, keeps_end=False)
    try:
        stop = session.start()
        assert stop.reason == PAUSE
        _, company = began
        assert os.waitpid(company._process, 0)[1] == signal.SIGKILL
        assert session.step_back(1).position.is_before(stop.position)
    finally:
        session.close()


def test_processes_that_have_ended_are_reaped():
    session = DebugSession(ProgramSource("job.script", text="n = 1\nn = 2\n"), forks=True)
    try:
        session.start(stop_on_entry=True)
        session.history("n")
    finally:
        session.close()
    assert len(snapshots._children) >= 2
    for child in snapshots._children:
        os.waitid(os.P_PID, child, os.WEXITED | os.WNOWAIT)
    snapshots._reap()
    assert not snapshots._children


def test_a_program_that_opens_files_is_said_to_leave_them_once(tmp_path):
    text = 'def job():\n  file = open("/log.txt", "w")\n  file.close()\nend\n'
    said = []
    session = DebugSession(ProgramSource("job.script", text=text, task_dir=tmp_path), said.append)
    session.start(stop_on_entry=True)
    session.restart()
    session.close()
    assert [output.text for output in said].count(WRITTEN_FILES) == 1
