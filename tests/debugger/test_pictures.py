"""Pictures of a moment: the arm is where the trace has it, however the moment was reached; steps are undone."""

from __future__ import annotations

import os
from random import Random

import pytest

from elitescript.debugger import snapshots
from elitescript.robot import VirtualRobot
from tests.debugger.sessions import debugging

FORKS = [False, pytest.param(True, marks=pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here"))]

TEXT = """def job():
  global total
  total = 0
  hidden = 5
  def pick(n):
    global total
    movej([0.1 * n, -1.57, -1.57, -1.57, 1.57, 0], r=0.02)
    total = total + n
  end
  def blink():
    while True:
      set_standard_digital_out(1, True)
      sleep(0.03)
      set_standard_digital_out(1, False)
      sleep(0.03)
    end
  end
  start_thread(blink, ())
  for n in range(3):
    pick(n)
  end
  stop = [0.3, -1.5, -1.5, -1.6, 1.5, 0.1]
  movej(stop)
  for n in range(20):
    servoj([0.001 * n + q for q in stop], t=0.004)
  end
end
"""


@pytest.fixture(scope="module")
def rows():
    run = VirtualRobot("CS66").run(TEXT, trace=True)
    assert run.state == "finished"
    return {round(row.t * 250): row for row in run.trace}


@pytest.mark.parametrize("forks", FORKS)
def test_the_arm_is_where_the_trace_has_it(rows, forks):
    with debugging(TEXT, forks=forks) as session:
        session.start(stop_on_entry=True)
        random = Random(3)
        for tick in [0, max(rows), *random.choices(list(rows), k=12)]:
            session.run_to_tick(tick)
            picture = session.picture()
            assert (picture.tick, picture.t) == (tick, rows[tick].t)
            assert (picture.joints, picture.tcp_pose) == (rows[tick].q, rows[tick].tcp_pose)
            assert dict(picture.signals) == dict(rows[tick].signals)


@pytest.mark.parametrize("forks", FORKS)
def test_steps_of_a_thread_are_undone_and_show_the_arm_of_their_time(rows, forks):
    with debugging(TEXT, forks=forks) as session:
        session.start(stop_on_entry=True)
        session.run_to_tick(10)
        names = [thread.name for thread in session.threads()]
        assert names[0] == "main"
        forward = []
        for _ in range(8):
            stop = session.step_in(1)
            forward.append((stop.position, stop.line))
            picture = session.picture()
            assert picture.joints == rows[picture.tick].q
            assert session.stop.position == stop.position
        assert {line for _, line in forward} >= {7, 8}
        for position, line in reversed(forward[:-1]):
            stop = session.step_in_back(1)
            assert (stop.position, stop.line) == (position, line)


def test_back_from_the_first_statement_is_the_start():
    with debugging(TEXT) as session:
        first = session.start(stop_on_entry=True)
        assert session.step_in_back(1).position == first.position


def test_it_has_names_threads_and_functions():
    with debugging(TEXT) as session:
        session.start(stop_on_entry=True)
        session.run_to_tick(10)
        picture = session.picture()
    assert [(variable.name, variable.value, variable.type) for variable in picture.globals] == [("total", "0", "int")]
    assert [(thread.name, thread.line) for thread in picture.threads] == [("main", 7), ("blink", 15)]
    assert picture.functions == ("pick", "blink")
    assert picture.line == 7


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_times_back_and_far_ahead_begin_at_copies(rows, monkeypatch):
    monkeypatch.setattr(snapshots, "EACH_S", 0.0)
    with debugging(TEXT, forks=True) as session:
        session.start(stop_on_entry=True)
        session.run_to_tick(max(rows) - 1)
        # No execution begins at the start any more.
        monkeypatch.setattr(session, "_new_engine", None)
        for tick in (max(rows) // 2, 20, max(rows) - 5):
            session.run_to_tick(tick)
            assert session.picture().joints == rows[tick].q
