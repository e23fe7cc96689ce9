"""What comes of the bytes that clients of a script port send: programs, lines, silence, garbage."""

from __future__ import annotations

import random
from types import SimpleNamespace

import pytest

from elitescript.language.limits import MAX_UNIT_BYTES
from elitescript.messages.inputs import AddLog, Do, Input, RunUnit
from elitescript.messages.machine import SetSpeedScale, StopTask
from elitescript.protocol.connection import ProtocolError
from elitescript.protocol.primary.connection import (
    MAX_BYTES_PER_TICK,
    MAX_LINES_PER_TICK,
    MAX_SILENT_LINE_BYTES,
    MAX_UNITS_AT_ONCE,
    MAX_WAITING_BYTES,
    PORTS,
    SILENCE_TICKS,
    UNITS_PER_TICK,
)
from tests.invariants.cases import first_of
from tests.protocol import primary_client as client
from tests.protocol.primary_link import ME, PROGRAM, connect, run, told
from tests.protocol.snapshots import output


def feed_in(pieces, ticks_between: int = 0) -> list[Input]:
    """Send pieces, publish in between, close."""
    connection = connect()
    inputs: list[Input] = []
    tick = 0
    for piece in pieces:
        inputs += connection.receive(piece, output(tick))
        for _ in range(ticks_between):
            tick += 1
            connection.publish(output(tick))
            inputs += connection.due()
    return inputs + connection.closed()


STREAMS = {
    "program": (PROGRAM + "\n", [RunUnit(ME, "program", PROGRAM)]),
    "crlf": (PROGRAM.replace("\n", "\r\n") + "\r\n", [RunUnit(ME, "program", PROGRAM)]),
    "extra line feeds": (f"\n{PROGRAM}\n\n\n", [RunUnit(ME, "program", PROGRAM)]),
    "two programs": (
        f"{PROGRAM}\n\ndef b():\n halt()\nend\n",
        [RunUnit(ME, "program", PROGRAM), RunUnit(ME, "program", "def b():\n halt()\nend")],
    ),
    "secondary": (
        "sec a():\n set_standard_digital_out(0, True)\nend\n",
        [RunUnit(ME, "secondary", "sec a():\n set_standard_digital_out(0, True)\nend")],
    ),
    "bare line": ("popup('hi')\n", [RunUnit(ME, "line", "popup('hi')")]),
    "command": ("stop task\n", [Do(ME, StopTask())]),
    "command and program": (
        f"stop task\n{PROGRAM}\nset speed 0.25\n",
        [Do(ME, StopTask()), RunUnit(ME, "program", PROGRAM), Do(ME, SetSpeedScale(0.25))],
    ),
    "no last line feed": (PROGRAM, [RunUnit(ME, "program", PROGRAM)]),
    "command without line feed": ("stop task", [Do(ME, StopTask())]),
    "command inside a program": ("def a():\nstop task\nend\n", [RunUnit(ME, "program", "def a():\nstop task\nend")]),
    "other letters": (
        "def a():\n textmsg('你好')\nend\n",
        [RunUnit(ME, "program", "def a():\n textmsg('你好')\nend")],
    ),
    "only blanks": ("\n \t\r\n\n# nothing\n", []),
}


class TestUploads:
    @pytest.mark.parametrize("name", STREAMS)
    def test_whole(self, name):
        stream, inputs = STREAMS[name]
        assert feed_in([stream.encode()]) == inputs

    @pytest.mark.parametrize("name", STREAMS)
    def test_byte_by_byte(self, name):
        stream, inputs = STREAMS[name]
        assert feed_in([bytes([byte]) for byte in stream.encode()]) == inputs

    @pytest.mark.parametrize("name", STREAMS)
    def test_with_a_trailing_line_that_never_ends(self, name):
        stream, inputs = STREAMS[name]
        *_, last = feed_in([stream.encode() + b"\ndef open_one():\n"])
        assert isinstance(last, AddLog)
        assert "no `end`" in last.text
        assert feed_in([stream.encode() + b"\ndef open_one():\n"])[:-1] == inputs

    def test_a_client_that_leaves_after_sending_is_served(self):
        connection = connect()
        inputs = connection.receive(PROGRAM.encode(), output(0))
        assert inputs == []
        assert connection.closed() == [RunUnit(ME, "program", PROGRAM)]

    def test_lines_are_counted_from_the_unit_itself(self):
        assert [unit.first_line for unit in feed_in([f"\n\n{PROGRAM}\n{PROGRAM}\n".encode()])] == [1, 1]

    def test_a_program_that_another_one_interrupts_is_refused(self):
        connection = connect()
        run(connection, [0])
        inputs = connection.receive(f"def a():\n x = 1\n{PROGRAM}\n".encode(), output(1))
        assert inputs[1:] == [RunUnit(ME, "program", PROGRAM)]
        assert isinstance(inputs[0], AddLog)
        message = told(connection, 1)
        assert (message["kind"], message["line"], message["column"]) == (10, 1, 1)
        assert message["text"] == f"SyntaxError: {inputs[0].text.removeprefix('SyntaxError: ')}"
        assert "line 3 begins another one" in message["text"]

    def test_damaged_text_runs_and_warns(self):
        connection = connect()
        run(connection, [0])
        log, unit = connection.receive(b"def a():\n textmsg('\xff')\nend\n", output(1))
        assert log == AddLog(ME, f"{ME}: some bytes of a program are not UTF-8; each was replaced by U+FFFD", True)
        assert unit == RunUnit(ME, "program", "def a():\n textmsg('\ufffd')\nend")
        message = told(connection, 1)
        assert (message["kind"], message["level"]) == (6, 1)
        assert "not UTF-8" in message["text"]

    def test_a_program_in_gbk_runs_and_its_text_is_in_the_log(self):
        connection = connect()
        run(connection, [0])
        log, unit = connection.receive("def a():\n textmsg('开始')\nend\n".encode("gbk"), output(1))
        assert isinstance(unit, RunUnit)
        assert isinstance(log, AddLog)
        assert log.is_warning
        assert "as GBK it reads `textmsg('开始')`" in log.text
        assert "as GBK it reads" in told(connection, 1)["text"]
        (unit,) = connection.receive("def a():\n textmsg('停止')\nend\n".encode(), output(2))
        assert isinstance(unit, RunUnit)

    def test_a_text_without_end_is_thrown_away_at_the_limit(self):
        connection = connect()
        connection.receive(b"def a():\n", output(0))
        line = b" #" + b"x" * (MAX_BYTES_PER_TICK - 3) + b"\n"
        inputs = []
        for tick in range(1, MAX_UNIT_BYTES // len(line) + 2):
            inputs += connection.receive(line, output(tick))
        assert inputs == []
        size = len(b"def a():\n") + tick * len(line) + len(b"end\n")
        refusal, stop = connection.receive(b"end\nstop task\n", output(tick + 1))
        assert isinstance(refusal, AddLog)
        assert f"the text has {size:,} bytes, at most {MAX_UNIT_BYTES:,} are read" in refusal.text
        assert stop == Do(ME, StopTask())

    def test_a_flood_of_programs_is_run_in_portions(self):
        connection = connect()
        portions = [connection.receive(b"halt()\n" * 1000, output(1))]
        for tick in range(2, 1010):
            connection.publish(output(tick))
            portions.append(connection.due())
        assert [unit for portion in portions for unit in portion] == [RunUnit(ME, "line", "halt()")] * 1000
        assert max(map(len, portions)) == 1
        assert not connection.is_busy

    def test_commands_and_secondary_programs_come_in_pairs(self):
        connection = connect()
        portions = [connection.receive(b"set speed 0.5\n" * 5 + b"sec a():\n  x = 1\nend\n" * 2, output(1))]
        for tick in range(2, 6):
            connection.publish(output(tick))
            portions.append(connection.due())
        assert list(map(len, portions)) == [UNITS_PER_TICK] * 3 + [1, 0]

    def test_a_client_with_units_ready_is_not_read(self):
        connection = connect()
        connection.receive(b"halt()\n" * 2, output(1))
        assert connection.is_busy
        connection.publish(output(2))
        assert len(connection.due()) == 1
        assert not connection.is_busy

    def test_a_flood_of_programs_is_cut_off_when_its_sender_goes(self):
        connection = connect()
        sent = connection.receive(b"halt()\n" * 1000, output(1))
        *last, log = connection.closed()
        assert len(sent) == 1
        assert last == [RunUnit(ME, "line", "halt()")] * MAX_UNITS_AT_ONCE
        assert isinstance(log, AddLog)
        assert "the rest is lost" in log.text

    def test_a_long_program_is_read_over_several_ticks(self):
        program = "def a():\n" + " x = 1\n" * (3 * MAX_BYTES_PER_TICK // 7) + "end"
        connection = connect()
        assert connection.receive(f"{program}\nstop task\n".encode(), output(0)) == []
        found = []
        for tick in range(1, 20):
            connection.publish(output(tick))
            if due := connection.due():
                found.append((tick, due))
        (tick, due), (next_tick, rest) = found
        assert (due, rest) == ([RunUnit(ME, "program", program)], [Do(ME, StopTask())])
        assert 3 <= tick <= 6
        assert next_tick == tick + 1

    @pytest.mark.parametrize("line_end", [b"\n", b"\r", b"\r\n"])
    def test_a_flood_of_line_ends_is_read_in_portions(self, line_end):
        connection = connect()
        read = []
        monitor = connection._splitter.receive
        connection._splitter = SimpleNamespace(
            receive=lambda data: read.append(data) or monitor(data), pending=False, is_in_program=False
        )
        connection.receive(line_end * 20_000, output(0))
        connection.receive(line_end, output(0))
        assert 0 < sum(map(len, read)) <= MAX_LINES_PER_TICK * len(line_end)
        before = len(read)
        connection.publish(output(1))
        assert len(read) > before

    def test_plain_lines_of_a_program_are_read_by_their_bytes_alone(self):
        program = "def a():\n" + " x = 1\n" * (2 * MAX_LINES_PER_TICK) + "end"
        inputs = connect().receive(f"{program}\nstop task\n".encode(), output(0))
        assert inputs == [RunUnit(ME, "program", program)]

    @pytest.mark.parametrize("line", [" 'x'\n", " # x\n", "end\nx\n", "\u00e9\n", " \\\n"])
    def test_other_lines_are_read_by_their_number(self, line):
        connection = connect()
        lines = []
        splitter = connection._splitter
        receive = lambda data: lines.append(data.count(b"\n")) or splitter.receive(data)  # noqa: E731
        connection._splitter = SimpleNamespace(
            receive=receive, pending=False, is_in_program=True, silence=list, close=list
        )
        connection.receive(b"def a():\n" + line.encode() * (2 * MAX_LINES_PER_TICK), output(0))
        assert 0 < sum(lines) <= MAX_LINES_PER_TICK

    def test_what_was_not_yet_read_counts_when_the_client_goes(self):
        connection = connect()
        connection.receive(b"\n" * (3 * MAX_LINES_PER_TICK) + b"stop task\n" + PROGRAM.encode(), output(0))
        assert connection.closed() == [Do(ME, StopTask()), RunUnit(ME, "program", PROGRAM)]

    def test_says_when_it_has_enough(self):
        connection = connect()
        connection.receive(b"x" * (2 * MAX_BYTES_PER_TICK), output(0))
        assert connection.is_busy
        connection.publish(output(1))
        assert not connection.is_busy

    def test_a_client_that_sends_on_all_the_same_is_cut_off(self):
        connection = connect()
        connection.receive(b"x" * MAX_WAITING_BYTES, output(0))
        with pytest.raises(ProtocolError, match="bytes wait"):
            connection.receive(b"x" * (MAX_BYTES_PER_TICK + 1), output(0))

    def test_a_speed_that_makes_no_sense_is_told(self):
        connection = connect()
        run(connection, [0])
        (log,) = connection.receive(b"set speed 2\n", output(1))
        assert log == AddLog(
            ME, f"{ME}: `set speed` takes a fraction from 0 to 1, such as 0.50, not 2", is_warning=True
        )


class TestSilence:
    @pytest.mark.parametrize("stream", [PROGRAM, "stop task", "halt()"])
    def test_what_is_complete_is_taken_after_a_while(self, stream):
        connection = connect()
        assert connection.receive(stream.encode(), output(10)) == []
        for tick in range(11, 10 + SILENCE_TICKS):
            connection.publish(output(tick))
            assert connection.due() == []
        connection.publish(output(10 + SILENCE_TICKS))
        (unit,) = connection.due()
        assert unit in (RunUnit(ME, "program", PROGRAM), Do(ME, StopTask()), RunUnit(ME, "line", "halt()"))
        assert connection.due() == []
        assert connection.closed() == []

    def test_it_is_a_tenth_of_a_second(self):
        assert SILENCE_TICKS == 25

    def test_each_byte_breaks_it(self):
        pieces = [bytes([byte]) for byte in PROGRAM.encode()]
        assert feed_in(pieces, SILENCE_TICKS - 1) == [RunUnit(ME, "program", PROGRAM)]

    def test_an_open_program_goes_on_waiting(self):
        connection = connect()
        connection.receive(b"def a():\n halt()\n", output(0))
        run(connection, range(1, 500))
        assert connection.due() == []
        assert connection.receive(b"end\n", output(500)) == [RunUnit(ME, "program", "def a():\n halt()\nend")]

    def test_a_very_long_line_waits_for_its_line_feed(self):
        line = "x = '" + "y" * MAX_SILENT_LINE_BYTES + "'"
        connection = connect()
        assert connection.receive(line.encode(), output(0)) == []
        run(connection, range(1, 500))
        assert connection.due() == []
        assert connection.receive(b"\n", output(500)) == [RunUnit(ME, "line", line)]

    def test_what_it_made_is_not_lost_when_the_client_goes(self):
        connection = connect()
        connection.receive(b"stop task", output(0))
        run(connection, range(1, 2 * SILENCE_TICKS))
        assert connection.closed() == [Do(ME, StopTask())]


FRAGMENTS = (
    b"def a():\n",
    b"sec b():\n",
    b"end\n",
    b"end",
    b"\n",
    b"\r",
    b"\r\n",
    b" x = [1,\n",
    b"'''",
    b"\\\n",
    b"(",
    b"stop task\n",
    b"set speed ",
    b"0.5\n",
    b"\xef\xbb\xbf",
    b"\xff\xfe",
    b"\0",
    b"# end\n",
    b"popup('a')\n",
    "你".encode()[:2],
)


@pytest.mark.parametrize("seed", first_of(range(40), 15))
def test_no_bytes_harm_the_connection(seed):
    """Random bytes and fragments, in random pieces, with random pauses: inputs or refusals, never an exception."""
    chance = random.Random(seed)
    connection = connect(chance.choice(PORTS))
    tick = 0
    for _ in range(150):
        piece = b"".join(
            chance.choice(FRAGMENTS) if chance.random() < 0.8 else chance.randbytes(chance.randrange(30))
            for _ in range(chance.randrange(6))
        )
        found = connection.receive(piece, output(tick, is_remote=chance.random() < 0.9))
        for _ in range(chance.choice((0, 1, 3, 30))):
            tick += 1
            connection.publish(output(tick))
            for message in connection.take():
                ((kind, whole),) = client.messages(message)
                assert len(whole) == 1157 if kind == 16 else client.robot_message(whole)["kind"] in (6, 10)
            found += connection.due()
        assert all(isinstance(item, RunUnit | Do | AddLog) and item.origin == ME for item in found)
        assert len(found) <= 31 * (MAX_UNITS_AT_ONCE + 1)
    connection.closed()
    # Nothing that was sent can keep the next program from running.
    fresh = connect()
    assert fresh.receive(f"{PROGRAM}\n".encode(), output(tick)) == [RunUnit(ME, "program", PROGRAM)]


@pytest.mark.parametrize("seed", first_of(range(40), 15))
def test_how_a_stream_is_cut_into_pieces_changes_nothing(seed):
    chance = random.Random(seed)
    stream = b"".join(chance.choice(FRAGMENTS) for _ in range(60))
    cuts = sorted(chance.sample(range(len(stream)), 20))
    pieces = [stream[start:end] for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True)]
    assert feed_in(pieces) == feed_in([stream])
