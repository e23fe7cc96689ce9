"""Serial devices of a test."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.messages.line import LineSettings
from elitescript.testing.world import SerialDevice, World
from tests.devices.programs import run

TOOL = "tool_serial_config(True, 9600, 0, 1, 8, False)\n"


class Scale(SerialDevice):
    line = "tool"

    def line_received(self, line):
        return f"{line}=1.25"


def test_a_line_is_answered_at_the_speed_of_the_line():
    found = run(TOOL + 'tool_serial_write("W\\n")\ntextmsg(tool_serial_read(7, False, 1))', Scale())
    assert found.log == ["b'W=1.25\\n'"]
    # Two characters there, seven back, at 1.04 ms each; each way ends at a tick.
    assert found.time_s == pytest.approx(0.02, abs=0.004)
    assert run(TOOL.replace("9600", "115200") + "sleep(0)", Scale()).time_s < 0.01


def test_a_device_of_another_speed_gets_and_sends_rubbish():
    seen = []

    class Deaf(Scale):
        baud = 19200

        def received(self, data):
            seen.append(data)
            return b"abcd"

    found = run(TOOL + 'tool_serial_write("W\\n")\ntextmsg(tool_serial_read(4, True, 1))', Deaf())
    assert b"".join(seen) != b"W\n" and len(b"".join(seen)) == 2
    assert found.log != ["[97, 98, 99, 100]"]


def test_who_sends_by_itself_is_lost_while_the_line_is_closed():
    class Beacon(SerialDevice):
        line = "box"

        def started(self):
            self.every(0.1, lambda: self.send("beep"))

        def opened(self):
            return f"at {self.settings.baud}"

    body = """
sleep(0.45)
serial_config(True, 115200, 0, 1)
sleep(0.2)
textmsg(serial_read(64, False, 0.01))
"""
    assert run(body, Beacon()).log == ["b'at 115200\\nbeep\\nbeep\\n'"]


def test_opening_and_closing_is_heard():
    seen = []

    class Door(SerialDevice):
        line = "tool"

        def opened(self):
            seen.append(self.settings)

        def closed(self):
            seen.append(self.settings)

    run(TOOL + "tool_serial_config(False, 9600, 0, 1, 8, False)\nsleep(0.1)", Door())
    assert seen == [LineSettings(9600, 0, 1, 8), None]


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"line": ""}, "line: the robot has no serial port ''"),
        ({"line": "tol"}, "line: the robot has no serial port 'tol'; its ports: tool, box"),
        ({"baud": -1}, "baud: must be in"),
        ({"encoding": "x"}, "encoding: there is no encoding"),
    ],
)
def test_a_setting_that_makes_no_sense_is_named(settings, words):
    with pytest.raises(UsageError, match=words):
        Scale(**settings)


def test_two_devices_cannot_have_one_line_under_two_names():
    with pytest.raises(UsageError, match="line: /dev/ttymxc0 is taken by Scale already"):
        World(devices=[Scale(line="box"), Scale(line="/dev/ttymxc0")])


def test_a_device_says_once_that_it_waits_for_its_line_end():
    class Windows(Scale):
        line_end = "\r\n"

    body = TOOL + 'tool_serial_write("W\\n")\nsleep(2)\ntool_serial_write("W\\n")\nsleep(2)'
    (warning,) = run(body, Windows(name="scale")).warnings
    assert warning.startswith("scale: waits for the end of the line b'W\\n': its line_end is '\\r\\n'")


def test_a_line_without_its_end_is_explained_when_the_program_ends():
    (warning,) = run(TOOL + 'tool_serial_write("done")', Scale(name="scale")).warnings
    assert warning.startswith("scale: waits for the end of the line b'done'")
    assert run(TOOL + 'tool_serial_write("done\\n")', Scale()).warnings == []


def test_a_line_that_comes_in_pieces_is_nothing_to_warn_of():
    body = TOOL + 'tool_serial_write("W")\nsleep(0.5)\ntool_serial_write("W\\n")\nsleep(2)'
    found = run(body, Scale()).findings
    # What nothing has read is a note of its own.
    assert [finding.code for finding in found] == ["N280"]
