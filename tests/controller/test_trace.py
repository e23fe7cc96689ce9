"""Recording a trace: which rows there are, and what they cost."""

import pytest

from elitescript import VirtualRobot
from elitescript.controller.controller import Controller
from elitescript.controller.views.trace import SPAN_ROWS_MAX, Trace, TraceSpan
from elitescript.errors import UsageError
from elitescript.kinematics.tcp import TcpKinematics
from elitescript.kinematics.transforms import IDENTITY, pose_from_transform
from elitescript.models.model import load_model
from elitescript.motion.segment import Segment

PROGRAM = """def main():
  movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  sleep(2)
  movel([0.4, -0.2, 0.4, 3.14, 0, 0], a=1.2, v=0.05)
end
"""


@pytest.fixture
def spans(monkeypatch):
    """The spans in which rows are recorded."""
    found = []
    span_of = Trace._span

    def span(self, controller, ticks):
        found.append(span_of(self, controller, ticks))
        return found[-1]

    monkeypatch.setattr(Trace, "_span", span)
    return found


def calls_of(monkeypatch, owner, name):
    calls = []
    function = getattr(owner, name)
    monkeypatch.setattr(owner, name, lambda self, *args: calls.append(args) or function(self, *args))
    return calls


@pytest.mark.parametrize("step_s", [0.004, 0.02])
def test_rows_are_sampled_by_spans_and_only_those_that_are_asked_for(monkeypatch, spans, step_s):
    joints = calls_of(monkeypatch, Controller, "joints_at")
    sampled = calls_of(monkeypatch, Segment, "setpoints")
    run = VirtualRobot("CS66").run(PROGRAM, trace=True, trace_step_s=step_s)
    assert sum(len(span.ticks) for span in spans) == len(run.trace) > 2000 * 0.004 / step_s
    assert len(spans) <= len(run.trace) / SPAN_ROWS_MAX + 12
    # Rows that stand alone before a tick that is due, and one for each span at rest.
    assert len(joints) < 20 + len(spans)
    assert sum(len(times) for (times,) in sampled) <= len(run.trace)


def test_a_span_at_rest_has_its_numbers_once(spans):
    VirtualRobot("CS66").run("sleep(0.8)\n", trace=True)
    longest = max(spans, key=lambda span: len(span.ticks))
    assert longest.is_at_rest
    assert len(longest.ticks) > 100
    assert len(longest.targets) == len(longest.tcp_poses) == 1
    rows = list(longest.rows())
    assert [row.t for row in rows] == [tick / 250 for tick in longest.ticks]
    assert len({row[1:7] for row in rows}) == 1


def test_rows_of_a_span_are_in_the_order_of_time():
    numbers = [tuple(float(6 * k + i) for i in range(6)) for k in range(3)]
    tcp = TcpKinematics(load_model("CS66").arm, IDENTITY)
    poses = [pose_from_transform(tcp.arm.forward(q)) for q in numbers]
    span = TraceSpan(range(10, 16, 2), False, 7, [(q, q) for q in numbers], tcp, "playing", numbers, {})
    assert [(row.t, row.line, row.q, row.qd, row.tcp_pose, row.q_actual) for row in span.rows()] == [
        (0.04, 7, numbers[0], numbers[0], poses[0], numbers[0]),
        (0.048, 7, numbers[1], numbers[1], poses[1], numbers[1]),
        (0.056, 7, numbers[2], numbers[2], poses[2], numbers[2]),
    ]


def test_another_tcp_gives_a_resting_arm_another_pose():
    program = "set_tcp([0, 0, 0.1, 0, 0, 0])\nsleep(0.1)\nset_tcp([0, 0, 0.2, 0, 0, 0])\nsleep(0.1)\n"
    run = VirtualRobot("CS66").run(program, trace=True)
    heights = [row.tcp_pose[2] for row in run.trace]
    assert max(heights) - min(heights) == pytest.approx(0.1)
    assert run.trace[-1].tcp_pose == run.tcp_pose
    assert len({row.q for row in run.trace}) == 1


@pytest.mark.parametrize(
    "window_s", [(0.0, 0.0), (0.1, 0.2), (0.0995, 0.2021), (1.0, 3.1), (2.5, 1e9), (2.5, float("inf")), (0.0, 99.0)]
)
def test_a_window_has_the_rows_of_its_time(window_s):
    begin_s, end_s = window_s
    whole = VirtualRobot("CS66").run(PROGRAM, trace=True).trace
    part = VirtualRobot("CS66").run(PROGRAM, trace=True, trace_window_s=window_s).trace
    assert part == [row for row in whole if begin_s <= row.t <= end_s]
    assert len(part) > 0


def test_a_window_may_have_a_step_of_its_own():
    whole = VirtualRobot("CS66").run(PROGRAM, trace=True).trace
    part = VirtualRobot("CS66").run(PROGRAM, trace=True, trace_window_s=(1.0, 2.0), trace_step_s=0.02).trace
    assert part == whole.between(1.0, 2.0, 5)


def test_outside_its_window_nothing_is_sampled(spans):
    run = VirtualRobot("CS66").run(PROGRAM, trace=True, trace_window_s=(0.4, 0.5))
    assert sum(len(span.ticks) for span in spans) == len(run.trace) == 26
    assert VirtualRobot("CS66").run(PROGRAM, trace=True, trace_window_s=(1e4, 1e5)).trace == []


@pytest.mark.parametrize("window_s", [(-0.1, 1.0), (2.0, 1.0), (float("nan"), 1.0), (0.0, float("nan"))])
def test_a_window_that_makes_no_sense_is_refused(window_s):
    with pytest.raises(UsageError, match="the window of a trace must begin"):
        VirtualRobot("CS66").run(PROGRAM, trace=True, trace_window_s=window_s)


@pytest.mark.parametrize("window_s", [3, (1.0,), (0.0, 1.0, 2.0), ("a", "b"), (None, 1.0)])
def test_a_window_that_is_not_two_numbers_is_refused_with_what_it_is(window_s):
    with pytest.raises(UsageError, match="two times in s, begin and end, got"):
        VirtualRobot("CS66").run(PROGRAM, trace=True, trace_window_s=window_s)
