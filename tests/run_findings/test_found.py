"""Findings of text and run in one list: folded, in order, counted."""

import pytest

from elitescript import VirtualRobot
from elitescript.findings.found import KINDS_MAX, Findings, Found, finding_of
from elitescript.language.diagnostics import diagnostic
from elitescript.messages.events import Alarm, DeviceNoted, Warned
from elitescript.messages.findings import Finding


def listed(*events, text=()):
    found = Found()
    for event in events:
        found.take(event, 0)
    return found.listed(text)


def rows(findings):
    return [(row.severity, row.code, row.line, row.t, row.count, row.source) for row in findings]


def test_the_worst_first_then_by_line_and_what_has_no_line_last():
    note = Warned(1, "n", line=1, code="N280", severity="note")
    found = listed(
        note, Warned(2, "w", line=9), Warned(3, "v"), Warned(4, "x", line=2), Alarm(5, "R100", "E", "a", 7, 1, "")
    )
    assert rows(found) == [
        ("error", "R100", 7, 0.02, 1, "run"),
        ("warning", "", 2, 0.016, 1, "run"),
        ("warning", "", 9, 0.008, 1, "run"),
        ("warning", "", 0, 0.012, 1, "run"),
        ("note", "N280", 1, 0.004, 1, "end"),
    ]


def test_equal_ones_are_one_row_with_their_number_and_first_time():
    found = listed(*(Warned(tick, f"radius {tick / 7} m is shortened", "main", 4, "W235") for tick in range(25, 65)))
    assert rows(found) == [("warning", "W235", 4, 0.1, 40, "run")]
    assert found[0].text == f"radius {25 / 7} m is shortened"


@pytest.mark.parametrize(
    "other",
    [
        Warned(9, "other words", "main", 4, "W235"),
        Warned(9, "text", "main", 5, "W235"),
        Warned(9, "text", "w", 4, "W235"),
        Warned(9, "text", "main", 4, "W236"),
        DeviceNoted(9, "plc", "text", is_warning=True),
    ],
)
def test_what_differs_in_words_line_thread_or_code_is_another_row(other):
    assert len(listed(Warned(1, "text", "main", 4, "W235"), other)) == 2


def test_the_refusal_of_an_argument_is_one_row_however_its_value_is_shown():
    text = [diagnostic("E304", 4, 7, "socket_send_string: str must be a text, not bytearray bytearray([1])")]
    words = "socket_send_string: str must be a text, not bytearray bytearray(b'\\x01')"
    assert rows(listed(Alarm(1, "R101", "TypeError", words, 4, 1, ""), text=text)) == [
        ("error", "E304", 4, 0.004, 1, "check")
    ]
    other = Alarm(1, "R101", "TypeError", "socket_send_string: socket_name must be a str", 4, 1, "")
    assert [row.code for row in listed(other, text=text)] == ["R101", "E304"]


def test_what_text_and_run_have_found_is_one_row():
    text = [diagnostic("W235", 4, 7, "the radius"), diagnostic("W235", 4, 30, "another"), diagnostic("E301", 2, 1, "x")]
    found = listed(*(Warned(tick, "the radius", "main", 4, "W235") for tick in (10, 20)), text=text)
    assert rows(found) == [
        ("error", "E301", 2, None, 1, "check"),
        ("warning", "W235", 4, 0.04, 2, "check"),
        ("warning", "W235", 4, None, 1, "check"),
    ]
    assert [row.column for row in found] == [1, 7, 30]


def test_a_device_that_only_says_something_is_no_finding():
    assert finding_of(DeviceNoted(1, "plc", "hello")) is None
    assert rows(listed(DeviceNoted(1, "plc", "gone", is_warning=True))) == [("warning", "", 0, 0.004, 1, "device")]


@pytest.mark.parametrize(
    ("code", "source"), [("W273", "contact"), ("W270", "end"), ("W230", "run"), ("R140", "limit"), ("R130", "end")]
)
def test_sources(code, source):
    event = Alarm(1, code, "E", "a", 7, 1, "") if code[0] == "R" else Warned(1, "w", code=code)
    assert listed(event)[0].source == source


def test_kinds_are_bounded_and_nothing_is_lost():
    events = [Warned(1, f"kind {'a' * number}", code="W230") for number in range(KINDS_MAX + 50)]
    found = listed(*events)
    assert len(found) == KINDS_MAX + 1
    assert sum(row.count for row in found) == KINDS_MAX + 50


def test_counts_and_words():
    def of(severity):
        return Finding("", severity, 1, 1, "t")

    assert Findings().words == ""
    assert Findings().is_clean
    assert Findings([of("note")]).is_clean
    many = Findings([of("error"), of("warning"), of("warning"), of("note")])
    assert many.counts() == {"error": 1, "warning": 2, "note": 1}
    assert (many.error, many.warning, many.note, many.is_clean) == (1, 2, 1, False)
    assert many.words == "1 error, 2 warnings, 1 note"


class TestOfARun:
    def test_text_and_run_in_one_list(self):
        run = VirtualRobot().run("def f():\n  movej([90, 0, 0, 0, 0, 0])\nend\n")
        assert ("error", "R110", 2, "limit") in [(r.severity, r.code, r.line, r.source) for r in run.findings]
        assert ("W230", "check", 2) in [(r.code, r.source, r.line) for r in run.findings]

    def test_an_alarm_that_check_has_foretold_is_one_row(self):
        run = VirtualRobot().run("def f():\n  set_standard_digital_out(99, True)\nend\n")
        assert run.state == "alarm"
        assert [(r.code, r.severity, r.source, r.t) for r in run.findings] == [("E305", "error", "check", 0.0)]

    def test_time_counts_from_the_begin_of_the_run(self):
        robot = VirtualRobot()
        robot.advance(5.0)
        run = robot.run("def f():\n  sleep(0.1)\n  1 / 0\nend\n")
        assert [(row.code, row.t) for row in run.findings if row.source == "run"] == [("R100", 0.1)]

    def test_more_than_ten_of_a_kind_are_counted_though_they_have_no_event(self):
        robot = VirtualRobot()
        run = robot.start("def f():\n  sync()\nend\n")
        for _ in range(25):
            robot.controller.emit(Warned(robot.tick, "again", "main", 2))
        robot.run_started()
        assert [(row.text, row.count) for row in run.findings] == [("again", 25)]

    def test_a_sound_program_has_none(self):
        assert VirtualRobot().run("def f():\n  sleep(0.1)\nend\n").findings == ()
