"""Moments and details of a run: exact, at any time, and undone steps."""

from __future__ import annotations

import os
from pathlib import Path
from random import Random

import pytest

from elitescript.conversation.messages import SignalInput
from elitescript.devices.world import World
from elitescript.messages.timing import TICKS_PER_S
from elitescript.robot import VirtualRobot
from elitescript.studio.live import looking
from elitescript.studio.live.detail import sample
from elitescript.studio.live.jobs import Job, job_data
from elitescript.studio.live.looking import look, position_of, position_text
from tests.conversation.frames import joints_by_tick
from tests.studio.live.links import ListLink, no_jail

EXAMPLES = Path(__file__).parents[3] / "examples"

TEXT = """def job():
  global total
  total = 0
  def pick(n):
    movej([0.1 * n, -1.57, -1.57, -1.57, 1.57, 0])
    return n
  end
  def blink():
    for n in range(3):
      set_standard_digital_out(1, n % 2 == 0)
      sleep(0.1)
    end
  end
  start_thread(blink, ())
  for n in range(3):
    total = total + pick(n)
  end
end
"""


def looked(text, *asked, until_s=60.0, **job):
    """Return the answers of a looker."""
    link = ListLink(*asked)
    request = {"do": "look", "job": job_data(Job("job.script", text, **job)), "run": 2, "until_s": until_s}
    with pytest.raises(EOFError):
        look(link, request, no_jail)
    return link.messages


def seek(t, ask=1):
    return {"do": "seek", "t": t, "ask": ask}


def step(by, *, thread="main", t=0.0, position="", ask=1):
    return {"do": "step", "by": by, "thread": thread, "t": t, "position": position, "ask": ask}


@pytest.fixture(params=[False, pytest.param(True, marks=pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork"))])
def forks(request, monkeypatch):
    monkeypatch.setattr(looking, "CAN_COPY", request.param)


@pytest.mark.usefixtures("forks")
class TestSeek:
    @pytest.mark.parametrize("name", ["pick_and_place", "circles", "state_machine"])
    def test_joints_are_those_of_the_trace(self, name):
        text = (EXAMPLES / f"{name}.script").read_text(encoding="utf-8")
        run = VirtualRobot(world=World(), task_dir={}).run(text, trace=True, until_s=12.0)
        rows = {row.t: row for row in run.trace[:-1]}
        times = Random(name).choices(list(rows), k=8)
        for t, answer in zip(times, looked(text, *map(seek, times)), strict=True):
            moment = answer["moment"]
            assert moment["t"] == t
            assert max(abs(a - b) for a, b in zip(moment["joints"], rows[t].q, strict=True)) < 1e-6
            assert max(abs(a - b) for a, b in zip(moment["tcp_pose"], rows[t].tcp_pose, strict=True)) < 1e-6
            assert moment["line"] == rows[t].line
            assert moment["signals"] == dict(rows[t].signals)

    def test_it_shows_threads_and_marks_globals_that_have_changed(self):
        run = VirtualRobot(world=World(), task_dir={}).run(TEXT)
        first, same, last = (found["moment"] for found in looked(TEXT, seek(0.05), seek(0.06), seek(run.time_s)))
        assert [(thread["name"], thread["function"]) for thread in first["threads"]] == [
            ("main", "pick"),
            ("blink", "blink"),
        ]
        assert first["threads"][1]["line"] == 11
        assert [(v["name"], v["value"], v["changed"]) for v in first["globals"]] == [("total", "0", False)]
        assert [(v["value"], v["changed"]) for v in same["globals"]] == [("0", False)]
        assert [(v["value"], v["changed"]) for v in last["globals"]] == [("3", True)]
        assert last["threads"] == []

    def test_inputs_are_those_of_the_run(self):
        inputs = (SignalInput("standard_digital_in[0]", True, 0.0), SignalInput("standard_digital_in[1]", True, 0.5))
        before, after = looked("def job():\n  sleep(1)\nend\n", seek(0.4), seek(0.5), inputs=inputs)
        assert before["moment"]["signals"] == {"standard_digital_in[0]": True}
        assert after["moment"]["signals"] == {"standard_digital_in[0]": True, "standard_digital_in[1]": True}

    def test_what_does_not_run_is_refused(self):
        (answer,) = looked("def job():\n  movej(\nend\n", seek(0.0, 8))
        assert (answer["type"], answer["ask"]) == ("refused", 8)
        (answer,) = looked(TEXT, seek(0.0, 9), robot={"model": "CS67"})
        assert (answer["type"], answer["ask"]) == ("refused", 9)


@pytest.mark.usefixtures("forks")
class TestStep:
    def test_forth_and_back_are_inverse(self):
        class Page(ListLink):
            """Steps from the position that it was shown last."""

            def receive(self):
                found = super().receive()
                shown = self.messages[-1]["moment"]["position"] if self.messages else ""
                return found if found["do"] == "seek" else found | {"position": shown}

        link = Page(seek(0.1), *[step(1)] * 4, *[step(-1)] * 3)
        request = {"do": "look", "job": job_data(Job("job.script", TEXT)), "run": 2, "until_s": 60.0}
        with pytest.raises(EOFError):
            look(link, request, no_jail)
        seen = [(answer["moment"]["t"], answer["moment"]["line"]) for answer in link.messages]
        assert [line for _, line in seen[1:5]] == [6, 16, 5, 6]
        assert seen[5:] == seen[3:0:-1]

    def test_the_last_statement_is_before_the_end(self):
        end_s = VirtualRobot(world=World(), task_dir={}).run(TEXT).time_s
        (answer,) = looked(TEXT, step(-1, t=end_s))
        assert answer["moment"]["line"] == 6
        (answer,) = looked(TEXT, step(1, t=end_s))
        assert (answer["moment"]["t"], answer["moment"]["threads"]) == (end_s, [])

    def test_another_thread(self):
        (answer,) = looked(TEXT, step(1, thread="blink", t=0.15))
        assert (answer["moment"]["t"], answer["moment"]["line"]) == (0.2, 10)

    def test_a_thread_that_is_not_there_is_refused(self):
        (answer,) = looked(TEXT, step(1, thread="blonk", t=0.15, ask=4))
        assert answer == {"type": "refused", "ask": 4, "text": "there is no thread 'blonk' at this moment"}

    def test_it_passes_alarms(self):
        text = "def job():\n  try:\n    a = 1 / 0\n  except:\n    b = 2\n  end\nend\n"
        link = looked(text, step(1), step(1, t=0.0))
        assert all(answer["type"] == "state" for answer in link)


def test_positions_go_and_come_back():
    for text in ("4.0.12.statement", "9007199254740992.1.12.end"):
        assert position_text(position_of(text)) == text
    assert position_of("") is None
    assert position_of("a.b.c.d") is None


class TestDetail:
    def sampled(self, text, from_s, to_s, step_s):
        link = ListLink()
        asked = {"run": 2, "ask": 5, "from_s": from_s, "to_s": to_s, "step_s": step_s}
        sample(link, {"do": "detail", "job": job_data(Job("job.script", text))} | asked, no_jail)
        return link

    def test_rows_are_those_of_the_trace(self):
        rows = {round(row.t * TICKS_PER_S): row.q for row in VirtualRobot(task_dir={}).run(TEXT, trace=True).trace}
        link = self.sampled(TEXT, 0.1, 0.3, 0.004)
        found = joints_by_tick(link.rows)
        assert list(found) == list(range(25, 76))
        for tick, joints in found.items():
            assert joints == pytest.approx(rows[tick], abs=2.5e-7)
        assert link.messages == [{"type": "detail_ended", "ask": 5, "run": 2}]

    def test_step_and_times_are_whole_periods(self):
        assert list(joints_by_tick(self.sampled(TEXT, 0.0995, 0.2, 0.0101).rows)) == list(range(25, 51, 3))

    def test_a_stretch_beyond_the_end_has_the_rows_before_it(self):
        run = VirtualRobot(task_dir={}).run(TEXT)
        found = joints_by_tick(self.sampled(TEXT, run.time_s - 0.02, 99.0, 0.004).rows)
        assert max(found) == round(run.time_s * TICKS_PER_S)

    def test_many_rows_come_in_parts(self):
        link = self.sampled("def job():\n  sleep(20)\nend\n", 0.0, 20.0, 0.004)
        assert len(link.rows) > 1
        assert list(joints_by_tick(link.rows)) == list(range(5001))

    def test_a_text_that_does_not_compile_is_refused(self):
        link = self.sampled("def job(", 0.0, 1.0, 0.04)
        assert (link.one("refused")["ask"], link.rows) == (5, [])
