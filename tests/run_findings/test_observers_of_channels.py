"""Observers of channels: each as a function of what it is given, and in a run."""

import pytest

from elitescript import VirtualRobot
from elitescript.findings.observers.beyond_ascii import BeyondAscii
from elitescript.findings.observers.closed_peers import ClosedPeers
from elitescript.findings.observers.dropped_numbers import DroppedNumbers
from elitescript.findings.observers.odd_answers import OddAnswers
from elitescript.findings.observers.other_servers import OtherServers
from elitescript.findings.observers.unfinished_readings import UnfinishedReadings
from elitescript.messages.observations import (
    NumbersDropped,
    OddAnswer,
    OtherServer,
    PeerClosed,
    ReadingEnded,
    ReadingResumed,
    TextBeyondAscii,
)
from elitescript.testing.world import SerialDevice, TcpServer, World

AT = (100, "cam", "socket", 7, "main")


def told(observer, *seen, ending="finished"):
    rows = [row for one in seen for row in observer.see(one)] + list(observer.end(ending))
    assert all((row.line, row.thread) == (7, "main") for row in rows)
    return [(row.code, row.text, row.hint) for row in rows]


class TestOddAnswers:
    @pytest.mark.parametrize(
        ("earlier", "answer", "is_late", "words"),
        [
            ("", "ack", True, "was 'ack' on socket 'cam', not 'POS <int>': the value is 0"),
            ("", None, True, "no answer to 'GET POS' came in time on socket 'cam': the value is 0"),
            (
                "ack\n",
                "ack",
                False,
                "'ack' came before the answer to 'GET POS' on socket 'cam', and is not 'POS ",
            ),
            ("POS 10\n", None, False, "had come before it: 'POS 10\\n'; it belongs to an earlier question"),
        ],
    )
    def test_what_came_instead(self, earlier, answer, is_late, words):
        ((code, text, _),) = told(OddAnswers(), OddAnswer(*AT, "GET POS", earlier, answer, is_late))
        assert code == "W281"
        assert words in text

    def test_each_kind_once_a_channel(self):
        passed, form = (OddAnswer(*AT, "GET POS", "", "x", is_late) for is_late in (False, True))
        assert len(told(OddAnswers(), passed, passed, form, form)) == 2


class TestDroppedNumbers:
    @pytest.mark.parametrize(
        ("text", "counts", "words", "advice"),
        [
            (
                "1,5, 2,5, 3,5",
                (3, 6, 3),
                "6 numbers came on socket 'cam', 3 were asked for: '(1,5, 2,5, 3,5)'",
                "comma",
            ),
            ("1, 2, 3, 4", (3, 4, 3), "4 numbers came on socket 'cam', 3 were asked for", "as many numbers"),
            ("1 2 3 4 5 6", (3, 6, 3), "6 numbers came on socket 'cam', 3 were asked for", "as many numbers"),
            ("1.5;2.5", (2, 1, 0), "0 of 2 numbers were read on socket 'cam' from '(1.5;2.5)'", "separate"),
        ],
    )
    def test_what_was_dropped(self, text, counts, words, advice):
        ((code, said, hint),) = told(DroppedNumbers(), NumbersDropped(*AT, text, *counts))
        assert code == "W282"
        assert words in said
        assert advice in hint


def ended(data, lacks, wanted, waited_s):
    return ReadingEnded(*AT, data, lacks, wanted, waited_s)


class TestUnfinishedReadings:
    @pytest.mark.parametrize(
        ("data", "lacks", "wanted", "words", "advice"),
        [
            (
                b"12.5\n",
                "suffix",
                "\r\n",
                "'12.5\\n' is there: its suffix '\\r\\n' has not come",
                "ends its texts with",
            ),
            (b"12.5", "suffix", "\n", "its suffix '\\n' has not come", "has not ended its text"),
            (b"12.5\n", "prefix", "\n", "its prefix '\\n' has not come", "write suffix="),
            (b"[1, 2]", "parenthesis", "(", "its parenthesis '(' has not come", "(1.5, 2.5)"),
        ],
    )
    def test_what_is_there_and_what_is_missing(self, data, lacks, wanted, words, advice):
        ((code, text, hint),) = told(UnfinishedReadings(), ended(data, lacks, wanted, 2.0))
        assert code == "W283"
        assert words in text
        assert advice in hint

    def test_a_part_of_bytes_is_a_note(self):
        ((code, text, _),) = told(UnfinishedReadings(), ended(b"abc", "count", "3 of 9 bytes", 0.0))
        assert code == "N283"
        assert "with 3 of 9 bytes: 'abc'" in text

    def test_a_line_end_alone_is_nothing(self):
        assert told(UnfinishedReadings(), ended(b"\r\n", "parenthesis", "(", 2.0)) == []

    def test_a_look_that_a_later_reading_completes_is_nothing(self):
        look = ended(b"12.", "suffix", "\n", 0.1)
        assert told(UnfinishedReadings(), look, look, ReadingResumed(*AT)) == []
        assert [row[0] for row in told(UnfinishedReadings(), look, look)] == ["W283"]


def test_a_closed_peer():
    ((code, text, _),) = told(ClosedPeers(), PeerClosed(*AT, "sent", ""))
    assert (code, text) == ("N281", "socket 'cam' is closed (by its peer): nothing was sent")


def test_another_server_once():
    seen = OtherServer(*AT, "10.0.0.1:5000", "10.0.0.2:6000")
    ((code, text, _),) = told(OtherServers(), seen, seen)
    assert code == "W247"
    assert "what is sent goes to 10.0.0.1:5000" in text


def test_a_text_beyond_ascii_once():
    seen = TextBeyondAscii(*AT, "22 °C")
    ((code, text, _),) = told(BeyondAscii(), seen, seen)
    assert code == "N282"
    assert "'°' in a text on socket 'cam' is not ASCII: it goes as UTF-8, c2 b0" in text


class Device(TcpServer):
    port = 5000
    address = "10.0.0.7"

    def __init__(self, answers=None, is_closing=False):
        super().__init__()
        self.answers = answers or {}
        self.is_closing = is_closing

    def line_received(self, connection, line):
        if self.is_closing:
            connection.close()
        return self.answers.get(line)


def found(body, **device):
    lines = "".join(f"  {line}\n" for line in body)
    text = f'def f():\n  socket_open("10.0.0.7", 5000)\n{lines}end\n'
    run = VirtualRobot("CS66", world=World([Device(**device)])).run(text)
    return [(row.code, row.line) for row in run.findings if row.code != "N280"]


class TestInRuns:
    @pytest.mark.parametrize(
        ("answer", "expected"),
        [
            (b"POS 7\n", []),
            (b"POS -7\r\n", []),
            (b"ack\n", [("W281", 3)]),
            (b"POS: 7\n", [("W281", 3)]),
            (b"POS 7.0\n", [("W281", 3)]),
            (b"POS 7", [("W283", 3)]),
            (None, [("W281", 3)]),
        ],
    )
    def test_answers(self, answer, expected):
        assert found(['n = socket_get_var("POS")'], answers={"GET POS": answer}) == expected

    def test_a_stray_line_is_told_at_the_first_question_behind_it(self):
        body = ['socket_set_var("GTO", 1)', "sleep(0.1)", 'n = socket_get_var("POS")', 'n = socket_get_var("POS")']
        assert found(body, answers={"SET GTO 1": b"ack\n", "GET POS": b"POS 7\n"}) == [("W281", 5)]

    @pytest.mark.parametrize("stray", [b"ack\n", b"ack\r\n\n", b"POS: 7\nGTO 1\n", b"POSITION 3\n"])
    def test_lines_of_another_form_do_not_shift_answers(self, stray):
        class Gripper(Device):
            count = 0

            def line_received(self, connection, line):
                if not line.startswith("GET"):
                    return stray
                self.count += 10
                return f"POS {self.count}"

        lines = 'socket_open("10.0.0.7", 5000)', 'socket_set_var("GTO", 1)', "sleep(0.1)"
        text = f"{chr(10).join(lines)}\nfor i in range(3): textmsg(socket_get_var('POS'))\n"
        run = VirtualRobot("CS66", world=World([Gripper()])).run(text)
        assert run.log == ["10", "20", "30"]
        assert [row.code for row in run.findings] == ["W281"]

    @pytest.mark.parametrize(
        ("answer", "expected"),
        [
            (b"(1.5, 2.5, 3.5)\n", []),
            (b"(1.5, 2.5)\n", []),
            (b"(1,5, 2,5, 3,5)\n", [("W282", 4)]),
            (b"(1.5;2.5;3.5)\n", [("W282", 4)]),
            (b"1.5,2.5,3.5\n", [("W283", 4)]),
            (b"[1.5,2.5,3.5]\n", [("W283", 4)]),
        ],
    )
    def test_numbers(self, answer, expected):
        assert found(['socket_send_line("x")', "r = socket_read_ascii_float(3)"], answers={"x": answer}) == expected

    def test_an_alarm_says_which_reading_gave_nan(self):
        body = ["r = socket_read_ascii_float(3, timeout=0.1)", "x = r[2]", "movel([x, 0, 0.4, 0, 0, 0])"]
        lines = "".join(f"  {line}\n" for line in body)
        text = f'def f():\n  socket_open("10.0.0.7", 5000)\n{lines}end\n'
        run = VirtualRobot("CS66", world=World([Device()])).run(text)
        assert (
            run.alarms[0]
            .details["hint"]
            .startswith("nan comes from socket_read_ascii_float in line 3, which has read 0 of 3 numbers")
        )
        text = "def f():\n  x = float('nan')\n  movel([x, 0, 0.4, 0, 0, 0])\nend\n"
        assert "nan comes" not in VirtualRobot("CS66").run(text).alarms[0].details["hint"]

    def test_serial_texts_and_data_left_unread(self):
        class Scale(SerialDevice):
            line = "box"

            def line_received(self, line):
                return "12.5"

        text = 'def f():\n  serial_config(True, 115200, 0, 1)\n  serial_write("22 °C\\n")\n  sleep(0.2)\nend\n'
        run = VirtualRobot("CS66", world=World([Scale()])).run(text)
        assert [(row.code, row.line) for row in run.findings] == [("N280", 2), ("N282", 3)]
        assert "'12.5\\n'" in run.findings[0].text

    def test_a_peer_that_has_closed_is_told_once(self):
        body = ['socket_send_line("x")', "sleep(0.1)", *['socket_send_line("y")', "s = socket_read_string()"] * 2]
        assert found(body, is_closing=True) == [("N281", 5)]

    @pytest.mark.parametrize(("name", "expected"), [("", [("W247", 3)]), (', "plc"', [])])
    def test_another_server(self, name, expected):
        class Plc(Device):
            port = 6000

        text = f'def f():\n  socket_open("10.0.0.7", 5000)\n  socket_open("10.0.0.7", 6000{name})\nend\n'
        run = VirtualRobot("CS66", world=World([Device(), Plc()])).run(text)
        assert [(row.code, row.line) for row in run.findings] == expected

    def test_the_same_server_again(self):
        assert found(['socket_open("10.0.0.7", 5000)']) == []

    def test_readings_in_pieces(self):
        body = ['socket_send_line("x")', 's = socket_read_string(suffix="!", timeout=0.05)', 'socket_send_line("y")']
        assert found(body[:2], answers={"x": b"a"}) == [("W283", 4)]
        assert found([*body, 's = socket_read_string(suffix="!")'], answers={"x": b"a", "y": b"b!"}) == []
