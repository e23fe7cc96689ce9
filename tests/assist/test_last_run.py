"""Lines of a text that ran in a text that was changed since, and the record that is made of a run."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.assist.last_run import LastRun, LineTime, ShortenedBlend
from elitescript.lsp.last_run import last_run_of
from elitescript.messages.motion import RADIUS_SHORTENED, shortened_radius
from elitescript.plotting.line_times import stretches

PROGRAM = """def job():
  global n
  n = [1, 2]
  movej(get_inverse_kin([0.4, 0, 0.30, 3.14, 0, 0]))
  for i in range(2):
    movel([0.4, 0, 0.34, 3.14, 0, 0], r=0.05)
    movel([0.4, 0.2, 0.34, 3.14, 0, 0])
  end
  sleep(0.5)
  movej([0, 0, 0, 0, 0, 99])
end
"""


@pytest.mark.parametrize(
    ("ran", "now", "lines"),
    [
        ("a\nb\nc", "a\nb\nc", [1, 2, 3]),
        ("a\nb\nc", "x\na\nb\nc", [0, 1, 2, 3]),
        ("a\nb\nc", "a\nb\nc\nx", [1, 2, 3, 0]),
        ("a\nb\nc", "a\nx\nc", [1, 0, 3]),
        ("a\nb\nc", "a\nc", [1, 3]),
        ("a\nb\nc", "", [0]),
        ("", "a", [0]),
        ("a\na", "a\na\na", [1, 2, 0]),
        ("a\r\nb", "a\nb", [1, 2]),
    ],
)
def test_lines_that_are_the_same(ran, now, lines):
    same = LastRun(ran).same_lines(now.split("\n"))
    assert [same.earlier(line + 1) for line in range(len(now.split("\n")))] == lines


def test_the_warning_about_a_radius_is_read_back():
    assert shortened_radius(RADIUS_SHORTENED.format(r=0.05, most=0.02)) == (0.05, 0.02)
    assert shortened_radius("r = 0.05 m is taken for 0") is None
    assert shortened_radius("") is None


@pytest.fixture(scope="module")
def last():
    run = VirtualRobot("CS66").run(PROGRAM, trace=True)
    return run, last_run_of(run, PROGRAM, stretches=stretches(run.trace))


class TestOfARun:
    def test_moves_by_line(self, last):
        run, found = last
        assert {line: time.times for line, time in found.moves.items()} == {4: 1, 6: 2, 7: 2}
        moved = sum(time.total_s for time in found.moves.values())
        assert moved == pytest.approx(run.time_s - 0.5, abs=0.1)

    def test_lines_add_up_to_the_run(self, last):
        run, found = last
        assert found.lines[9].total_s == pytest.approx(0.5, abs=0.01)
        assert sum(time.total_s for time in found.lines.values()) == pytest.approx(run.time_s, abs=0.05)

    def test_values_blends_and_alarms(self, last):
        _, found = last
        assert found.values == {"": {"n": "[1, 2]"}}
        assert found.blends == {6: ShortenedBlend(0.05, 0.02)}
        assert [(alarm.line, alarm.code) for alarm in found.alarms] == [(10, "R110")]

    def test_counts_and_values_from_elsewhere_are_kept(self, last):
        run, _ = last
        found = last_run_of(run, PROGRAM, counts={6: 2, 3: 1}, values={"f": {"x": "1"}})
        assert found.lines[6].times == 2
        assert found.lines[3] == LineTime(1, 0.0)
        assert found.values["f"] == {"x": "1"}
