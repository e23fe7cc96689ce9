"""Observers: each a function of what it is given; and the frame that hands it to them."""

import subprocess
import sys

import pytest

from elitescript import VirtualRobot
from elitescript.errors import CODES
from elitescript.findings.observers.end_under_way import EndUnderWay
from elitescript.findings.observers.unread_data import UnreadData
from elitescript.findings.observing import OBSERVERS, Observer, Observers
from elitescript.messages import events, observations
from elitescript.messages.observations import ChannelLeft, MotionLeft
from elitescript.testing.world import TcpServer, World


def left(data, name="cam"):
    return ChannelLeft(100, name, "socket", data, 3, "main")


class TestUnreadData:
    @pytest.mark.parametrize("data", [b"", b"\n", b"\r\n", b"\0"])
    def test_a_line_end_is_nothing(self, data):
        observer = UnreadData()
        assert list(observer.see(left(data))) == []
        assert list(observer.end("finished")) == []

    @pytest.mark.parametrize(
        ("data", "words"),
        [
            (b"7.25\n", "5 bytes on socket 'cam' were not read when the program ended: '7.25\\n'"),
            (b"x", "1 byte on socket 'cam' were not read when the program ended: 'x'"),
            (b"\xff" + b"a" * 80, "81 bytes on socket 'cam' were not read when the program ended: '\\\\xffaaa"),
        ],
    )
    def test_what_is_left_is_a_note_at_the_line_that_has_opened_it(self, data, words):
        observer = UnreadData()
        observer.see(left(data))
        (found,) = observer.end("finished")
        assert (found.code, found.severity, found.line) == ("N280", "note", 3)
        assert found.text.startswith(words)

    @pytest.mark.parametrize("ending", ["alarm", "stopped"])
    def test_a_program_that_was_ended_reads_nothing_more(self, ending):
        observer = UnreadData()
        observer.see(left(b"7.25\n"))
        assert list(observer.end(ending)) == []


class TestEndUnderWay:
    @pytest.mark.parametrize(
        ("seen", "words", "hint"),
        [
            (
                MotionLeft(1, "servoj", 4, "main", 0.79, 1.0),
                "0.790 rad (45.3 deg) before the target of servoj",
                "movej",
            ),
            (MotionLeft(1, "speedl", 4, "main", 0.0, 0.5), "while speedl moves the arm, 0.500 rad/s", "stopl"),
            (MotionLeft(1, "speedj", 4, "main", 0.0, 0.5), "while speedj moves the arm", "stopj"),
            (MotionLeft(1, "force_mode", 4, "main"), "in force mode", "end_force_mode"),
            (MotionLeft(1, "tracking", 4, "main"), "follows a conveyor", "stop_conveyor_tracking"),
        ],
    )
    def test_it_says_what_and_what_to_do(self, seen, words, hint):
        (found,) = EndUnderWay().see(seen)
        assert (found.code, found.severity, found.line) == ("W280", "warning", 4)
        assert words in found.text
        assert hint in found.hint


class TestFrame:
    def test_every_row_is_an_observer_of_known_types_and_takes_something(self):
        for row in OBSERVERS:
            observer = Observers()._of(row)
            assert isinstance(observer, Observer)
            assert row.takes
        files = {row.file for row in OBSERVERS}
        assert len(files) == len(OBSERVERS)

    def test_events_that_are_observed_are_named_beside_the_events(self):
        taken = {kind for row in OBSERVERS for kind in row.takes}
        assert taken & set(events.Event.__args__) == events.OBSERVED
        assert taken - events.OBSERVED <= set(observations.Observation.__args__)

    def test_codes_that_are_found_at_the_end_exist(self):
        assert set(events.SOURCES) <= set(CODES)

    def test_an_observer_that_has_seen_nothing_is_not_asked_at_the_end(self):
        observers = Observers()
        observers.see(left(b"data"))
        assert [found.code for found in observers.end("finished")] == ["N280"]
        assert Observers().end("finished") == []

    def test_a_plain_run_imports_no_observer(self):
        call = (
            "import sys; from elitescript import VirtualRobot; VirtualRobot().run('def f():\\n  sync()\\nend\\n');"
            "print([name for name in sys.modules if 'elitescript.findings' in name or 'observations' in name])"
        )
        assert subprocess.run([sys.executable, "-c", call], capture_output=True, text=True).stdout == "[]\n"


def found(text, **keywords):
    run = VirtualRobot("CS66", **keywords).run(text)
    return [(row.code, row.line, row.source, row.text) for row in run.findings if row.source == "end"]


class Camera(TcpServer):
    port = 5000
    address = "10.0.0.7"

    def line_received(self, connection, line):
        return b"7.25\n8.5\n"


class TestInRuns:
    def test_servoj_ends_before_its_target(self):
        text = "def f():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.8\n  servoj(q, t=0.008)\nend\n"
        ((code, line, source, words),) = found(text)
        assert (code, line, source) == ("W280", 4, "end")
        assert "before the target of servoj" in words

    def test_speedl_without_a_stop(self):
        ((code, line, _, _),) = found("def f():\n  speedl([0, 0, 0.1, 0, 0, 0], 1, 0.2)\nend\n")
        assert (code, line) == ("W280", 2)

    @pytest.mark.parametrize(
        "text",
        [
            "def f():\n  speedl([0, 0, 0.1, 0, 0, 0], 1, 0.2)\n  stopl(1)\nend\n",
            "def f():\n  movej([0, -1.5, -1.6, -1.5, 1.5, 0], a=1, v=1)\nend\n",
            "def f():\n  movej([0, -1.5, -1.6, -1.5, 1.5, 0], a=1, v=1, r=0.05)\nend\n",
            "def f():\n  speedj([0.2, 0, 0, 0, 0, 0], 1, 0.2)\n  halt()\nend\n",
            "def f():\n  speedj([0.2, 0, 0, 0, 0, 0], 1, 0.2)\n  1 / 0\nend\n",
        ],
    )
    def test_programs_that_come_to_rest_or_are_ended(self, text):
        assert [row for row in found(text) if row[0] == "W280"] == []

    def test_a_text_left_unread(self):
        text = (
            'def f():\n  socket_open("10.0.0.7", 5000, "cam")\n  socket_send_line("GO", 0, "cam")\n  sleep(0.2)\nend\n'
        )
        ((code, line, source, words),) = found(text, world=World([Camera()]))
        assert (code, line, source) == ("N280", 2, "end")
        assert "'7.25\\n8.5\\n'" in words
