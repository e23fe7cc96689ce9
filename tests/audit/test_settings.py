"""Payload and TCP offset of a recorded run against those of the simulated one."""

from __future__ import annotations

from functools import cache

import pytest

from elitescript.audit import audit
from elitescript.audit.settings import CENTRE, MASS, TCP, SettingPair, Timeline, difference_at, setter_line
from elitescript.recorder.recording import Message, Recording
from elitescript.records import replace
from elitescript.robot import VirtualRobot
from tests.audit.recording_runs import record_run

PROGRAM = """def p():
  set_payload(1.5, [0, 0.01, 0.05])
  movej([0.1, -1.6, -1.7, -1.3, 1.5, 0.1], a=8, v=1)
  set_tcp([0, 0, 0.1, 0, 0, 0])
  set_payload(2.5, [0, 0.02, 0.05])
  sleep(0.3)
  movej([0.1, -1.3, -1.7, -1.0, 1.2, 0.4], a=8, v=1)
  sleep(0.1)
end
p()
"""


def said(t: float, offset: list[float]) -> Message:
    return Message(t, t, "primary", {"type": "cartesian", "TCP offset": offset})


@cache
def recorded() -> Recording:
    """The run with what the primary port says of its TCP offset, a tenth of a second late."""
    changes: dict[float, list[float]] = {}
    before: list[list[float]] = [[]]

    def watch(robot: VirtualRobot) -> None:
        offset = list(robot.state.tcp_offset)
        if offset != before[0]:
            before[0] = offset
            changes[robot.time_s + 0.1] = offset

    recording = record_run(PROGRAM, acts={0.004 * tick: watch for tick in range(500)}, after_s=0.5)
    return replace(recording, messages=tuple(said(t, offset) for t, offset in changes.items()))


def test_what_is_the_same_agrees():
    found = audit(recorded(), PROGRAM)
    assert found.agrees, str(found)
    assert not any("TCP offset" in note or "payload" in note for note in found.json()["not_compared"])


@pytest.mark.parametrize(
    ("old", "new", "line", "cause", "name", "here", "there"),
    [
        ("(1.5, [", "(1.2, [", 2, "payload", "payload", "1.5 kg", "1.2 kg"),
        ("(2.5, [", "(4, [", 5, "payload", "payload", "2.5 kg", "4 kg"),
        (
            "0, 0.02,",
            "0.3, 0.02,",
            5,
            "payload centre",
            "centre of the payload",
            "[0, 0.02, 0.05] m",
            "[0.3, 0.02, 0.05] m",
        ),
        (
            "0, 0.1, 0",
            "0, 0.12, 0",
            4,
            "tcp",
            "TCP offset",
            "[0, 0, 0.1, 0, 0, 0] m, rad",
            "[0, 0, 0.12, 0, 0, 0] m, rad",
        ),
        (
            "0, 0.1, 0",
            "0, 0.1, 2",
            4,
            "tcp",
            "TCP offset",
            "[0, 0, 0.1, 0, 0, 0] m, rad",
            "[0, 0, 0.1, 2, 0, 0] m, rad",
        ),
    ],
)
def test_another_value_is_a_difference_with_its_line_and_both_sides(old, new, line, cause, name, here, there):
    assert PROGRAM.count(old) == 1
    what = f"{name} {here}, simulated {there}"
    found = audit(recorded(), PROGRAM.replace(old, new))
    assert not found.agrees
    assert [(its.line, its.cause, its.what) for its in found.first.comparison.findings] == [(line, cause, what)]
    divergence = found.json()["divergence"]
    assert (divergence["line"], divergence["what"]) == (line, what)
    assert f"line {line}: {what}" in str(found)


def test_parts_of_the_payload_that_were_0_all_the_time_are_not_in_a_file():
    whole = recorded()
    columns = {name: column for name, column in whole.columns.items() if any(column)}
    assert "payload_cog.0" not in columns
    written = replace(whole, columns=columns, facts={**whole.facts, "host": "127.0.0.1"})
    assert audit(written, PROGRAM.replace("2.5, [", "4, [")).divergence.what == "payload 2.5 kg, simulated 4 kg"
    assert audit(written, PROGRAM).agrees


def test_a_payload_that_only_the_recorded_program_sets_at_its_begin():
    found = audit(recorded(), PROGRAM.replace("set_payload(1.5, [0, 0.01, 0.05])", "i = 0"))
    assert found.divergence.what == "payload 1.5 kg, simulated 0 kg"


def test_a_tcp_offset_that_the_recording_does_not_show_is_said_to_be_not_compared():
    silent = replace(recorded(), messages=())
    lost = replace(
        recorded(), messages=(*recorded().messages, Message(0.3, 0.3, "events", {"type": "lost", "port": "primary"}))
    )
    for recording in (silent, lost):
        found = audit(recording, PROGRAM.replace("0, 0, 0.1, 0", "0, 0, 0.12, 0"))
        assert found.agrees
        assert "TCP offset (set_tcp): the recording does not show it all the time" in found.json()["not_compared"]


def line_of_values(*steps: tuple[float, tuple[float, ...]]) -> Timeline:
    found = Timeline()
    for t, value in steps:
        found.add(t, value)
    return found


class TestByHand:
    def test_a_change_shown_a_row_later_is_none(self):
        pair = SettingPair(
            MASS, line_of_values((0.0, (1.0,)), (1.004, (2.0,))), line_of_values((0.0, (1.0,)), (1.0, (2.0,)))
        )
        assert difference_at(pair, 1.0, 1.0, 0.008, 5.0) is None
        assert difference_at(pair, 1.1, 0.9, 0.008, 5.0).what == "payload 2 kg, simulated 1 kg"

    def test_a_brief_tcp_offset_is_not_expected(self):
        zero, brief = (0.0,) * 6, (0.1, *(0.0,) * 5)
        pair = SettingPair(TCP, line_of_values((0.0, zero)), line_of_values((0.0, zero), (1.0, brief), (1.2, zero)))
        assert difference_at(pair, 1.1, 1.1, 0.008, 5.0) is None
        longer = line_of_values((0.0, zero), (1.0, brief), (1.6, zero))
        assert difference_at(pair._replace(simulated=longer), 1.1, 1.1, 0.008, 5.0).t == pytest.approx(1.0)
        assert difference_at(pair._replace(simulated=longer), 1.1, 1.1, 0.008, 1.4) is None

    def test_another_way_to_write_a_rotation_is_no_difference(self):
        half = 3.141592653589793
        pair = SettingPair(
            TCP, line_of_values((0.0, (0, 0, 0.1, half, 0, 0))), line_of_values((0.0, (0, 0, 0.1, -half, 0, 0)))
        )
        assert difference_at(pair, 1.0, 1.0, 0.008, 5.0) is None

    def test_less_than_what_counts(self):
        pair = SettingPair(CENTRE, line_of_values((0.0, (0.0, 0.0, 0.1))), line_of_values((0.0, (0.0, 0.0, 0.100009))))
        assert difference_at(pair, 1.0, 1.0, 0.008, 5.0) is None

    @pytest.mark.parametrize(
        ("calls", "before", "line", "found"),
        [([2, 5], 0, 3, 2), ([2, 5], 3, 6, 5), ([2, 5], 3, 4, 4), ([], 3, 4, 4), ([4, 5], 3, 6, 5)],
    )
    def test_the_line_of_a_call_that_takes_no_time(self, calls, before, line, found):
        assert setter_line(calls, before, line) == found
