from __future__ import annotations

import pytest

from tests.lint.checking import body, repaired


@pytest.mark.parametrize(
    ("lines", "places"),
    [
        (("while True:", "  sync", "end"), ["W204 2:3", "W215 3:5"]),
        (("if get_tool_analog_in > 3:", "  sync()", "end"), ["W215 2:6"]),
        (("x = get_standard_digital_in", "if x:", "  sync()", "end"), ["W215 2:7"]),
        (("if not get_standard_digital_in:", "  sync()", "end"), ["W215 2:10"]),
        (("textmsg(1) if get_steptime else sync()",), ["W215 2:17"]),
        (("halt",), ["W215 2:3"]),
    ],
)
def test_a_command_that_is_not_called_is_found(lines, places):
    assert body(*lines) == places


@pytest.mark.parametrize(
    "lines",
    [
        ("start_thread(sync, ())",),
        ("read = get_standard_digital_in", "textmsg(read(3))"),
        ("table = {'a': sin, 'b': cos}", "textmsg(table['a'](1))"),
        ("f = sin", "textmsg(list(map(f, [1, 2])))"),
        ("def sync():", "  pass", "end", "sync"),
        ("force = 3", "if force > 2:", "  sync()", "end"),
        ("f = get_flag", "if f is get_flag:", "  textmsg(f(1))", "end"),
    ],
)
def test_a_command_that_is_handed_on_is_none(lines):
    assert [finding for finding in body(*lines) if finding.startswith("W215")] == []


def test_the_fix_calls_it():
    assert repaired("def job():\n  sync\nend\n") == "def job():\n  sync()\nend\n"
