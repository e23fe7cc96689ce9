"""Connections of the primary port: what clients get and when, and what comes of the bytes that they send."""

from __future__ import annotations

import random
from types import SimpleNamespace

import pytest

from elitescript.language.units import MAX_UNIT_BYTES
from elitescript.messages.events import Alarm, TextMessage, Warned
from elitescript.messages.inputs import AddLog, Do, Input, RunUnit
from elitescript.messages.machine import SetSpeedScale, StopTask
from elitescript.protocol import primary
from elitescript.protocol.connection import ProtocolError
from elitescript.protocol.primary import (
    MAX_BYTES_PER_TICK,
    MAX_LINES_PER_TICK,
    MAX_SILENT_LINE_BYTES,
    MAX_UNITS_AT_ONCE,
    MAX_WAITING_BYTES,
    PORTS,
    PRIMARY,
    READ_ONLY,
    REALTIME,
    SECONDARY,
    SILENCE_TICKS,
    SPACING_TICKS,
    UNITS_PER_TICK,
    PrimaryConnection,
    PrimaryFeed,
    PrimaryPort,
)
from elitescript.protocol.primary_messages import WAITING_MAX
from tests.protocol import primary_client as client
from tests.protocol.snapshots import description, output

ME = "primary#1"
PROGRAM = "def pick():\n\tmovej([0, -1.57, -1.57, 0, 1.57, 0])\nend"


def connect(port: PrimaryPort = PRIMARY, **options) -> PrimaryConnection:
    return PrimaryConnection(ME, description(), PrimaryFeed(description(), port, **options))


def text(n: int, tick: int = 0) -> TextMessage:
    return TextMessage(tick, f"text {n}", "main", 1)


def alarm(tick: int = 0) -> Alarm:
    return Alarm(tick, "R100", "NameError", "no", 2, 3, "main")


def run(connection: PrimaryConnection, ticks, **first) -> dict[int, list[bytes]]:
    """Publish ticks, the first of them with these changes; return what is sent at which."""
    sent = {}
    for tick in ticks:
        connection.publish(output(tick, **first))
        first = {}
        if messages := connection.take():
            sent[tick] = messages
    return sent


def states(sent: dict[int, list[bytes]]) -> list[int]:
    """Ticks at which a robot state is sent."""
    return [tick for tick, messages in sent.items() for message in messages if message[4] == 16]


def notes(sent: dict[int, list[bytes]]) -> list[tuple[int, str]]:
    """Ticks and texts of robot messages."""
    found = []
    for tick, messages in sent.items():
        found += [(tick, client.robot_message(message)["text"]) for message in messages if message[4] == 20]
    return found


def told(connection: PrimaryConnection, tick: int = 0) -> dict:
    """The one robot message that waits for a client which has its state."""
    sent = run(connection, range(tick, tick + 1))
    (message,) = [message for messages in sent.values() for message in messages if message[4] == 20]
    return client.robot_message(message)


class TestState:
    def test_the_first_one_comes_at_once(self):
        (message,) = run(connect(), [1003])[1003]
        assert (len(message), message[4]) == (1157, 16)

    @pytest.mark.parametrize(
        ("port", "in_a_second"), [(PRIMARY, 10), (SECONDARY, 10), (REALTIME, 125), (READ_ONLY, 10)]
    )
    def test_it_comes_at_the_rate_of_the_port(self, port, in_a_second):
        assert len(states(run(connect(port), range(2500)))) == 10 * in_a_second

    def test_clients_that_come_later_fall_in_step(self):
        assert states(run(connect(), range(1003, 1080))) == [1003, 1025, 1050, 1075]

    def test_a_tick_that_is_skipped_delays_one_state_only(self):
        assert states(run(connect(), [0, 20, 27, 30, 49, 50])) == [0, 27, 50]

    def test_each_message_is_one_write(self):
        sent = run(connect(), range(25), events=(alarm(), text(1)))
        assert [len(client.messages(message)) for messages in sent.values() for message in messages] == [1] * 3

    def test_it_shows_the_tick_at_which_it_is_sent(self):
        sent = run(connect(), range(51))
        times = [client.robot_mode(message[5:])["timestamp"] for messages in sent.values() for message in messages]
        assert times == [0, 100_000, 200_000]


class TestPackingOnce:
    def test_clients_of_a_port_share_the_bytes_of_a_tick(self, monkeypatch):
        packed = []
        pack_state = primary.pack_state
        monkeypatch.setattr(primary, "pack_state", lambda *args: packed.append(1) or pack_state(*args))
        feed = PrimaryFeed(description())
        connections = [PrimaryConnection(f"primary#{n}", description(), feed) for n in range(10)]
        for tick in range(51):
            now = output(tick, events=(text(1),) if tick == 0 else ())
            for connection in connections:
                connection.publish(now)
        taken = [connection.take() for connection in connections]
        assert len(packed) == 3
        assert all(len(messages) == 4 for messages in taken)
        assert all(mine is first for messages in taken for mine, first in zip(messages, taken[0], strict=True))

    def test_ports_do_not_share_what_waits(self):
        one, other = connect(), connect()
        one.receive(b"set speed 2\n", output(0))
        assert notes(run(other, range(10))) == []


class TestMessages:
    def test_an_alarm_goes_out_in_its_tick(self):
        sent = run(connect(), [7], events=(alarm(7),))
        assert notes(sent) == [(7, "NameError: no")]

    def test_messages_keep_their_order_and_their_distance(self):
        sent = run(connect(), range(30), events=(text(1), alarm(), text(2)))
        assert notes(sent) == [(0, "text 1"), (SPACING_TICKS, "NameError: no"), (2 * SPACING_TICKS, "text 2")]

    def test_never_more_than_clients_can_take(self):
        connection = connect()
        count = 0
        for tick in range(2500):
            connection.publish(output(tick, events=(text(tick, tick), text(tick, tick))))
            count += len(connection.take())
        assert 400 < count <= 500

    def test_what_a_script_prints_in_one_tick_comes_whole_and_in_order(self):
        sent = run(connect(), range(WAITING_MAX * SPACING_TICKS), events=tuple(text(n) for n in range(WAITING_MAX)))
        assert [said for _, said in notes(sent)] == [f"text {n}" for n in range(WAITING_MAX)]

    def test_of_still_more_it_says_how_many_are_missing_and_the_error_behind_them_is_there(self):
        events = (*(text(n) for n in range(WAITING_MAX + 10)), alarm(), text(0), text(0), alarm())
        sent = run(connect(), range(WAITING_MAX * SPACING_TICKS + 50), events=events)
        why = "robot messages are missing here: they came faster than they can be sent"
        assert [said for _, said in notes(sent)][WAITING_MAX - 1 :] == [
            f"text {WAITING_MAX - 1}",
            f"warning: 10 {why}",
            "NameError: no",
            f"warning: 2 {why}",
            "NameError: no",
        ]

    @pytest.mark.parametrize(("port", "count"), [(PRIMARY, 1), (SECONDARY, 0), (REALTIME, 0), (READ_ONLY, 1)])
    def test_only_some_ports_have_them(self, port, count):
        assert len(notes(run(connect(port), range(10), events=(alarm(),)))) == count

    def test_no_version_unless_asked_for(self):
        assert notes(run(connect(), range(10))) == []
        greeted = run(connect(sends_version=True), range(100))
        kinds = [client.robot_message(m)["kind"] for messages in greeted.values() for m in messages if m[4] == 20]
        assert kinds == [3]


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
        (unit,) = connection.receive(b"def a():\n textmsg('\xff')\nend\n", output(1))
        assert unit == RunUnit(ME, "program", "def a():\n textmsg('\ufffd')\nend")
        message = told(connection, 1)
        assert (message["kind"], message["level"]) == (6, 1)
        assert "not UTF-8" in message["text"]

    def test_a_text_without_end_is_thrown_away_at_the_limit(self):
        connection = connect()
        connection.receive(b"def a():\n", output(0))
        line = b" #" + b"x" * (MAX_BYTES_PER_TICK - 3) + b"\n"
        inputs = []
        for tick in range(1, MAX_UNIT_BYTES // len(line) + 2):
            inputs += connection.receive(line, output(tick))
        assert [type(found) for found in inputs] == [AddLog]
        assert connection.receive(b"end\nstop task\n", output(tick + 1)) == [Do(ME, StopTask())]

    def test_a_flood_of_programs_is_run_in_portions(self):
        connection = connect()
        portions = [connection.receive(b"halt()\n" * 1000, output(1))]
        for tick in range(2, 600):
            connection.publish(output(tick))
            portions.append(connection.due())
        assert [unit for portion in portions for unit in portion] == [RunUnit(ME, "line", "halt()")] * 1000
        assert max(map(len, portions)) == UNITS_PER_TICK
        assert not connection.is_busy

    def test_a_client_with_units_ready_is_not_read(self):
        connection = connect()
        connection.receive(b"halt()\n" * (UNITS_PER_TICK + 1), output(1))
        assert connection.is_busy
        connection.publish(output(2))
        assert len(connection.due()) == 1
        assert not connection.is_busy

    def test_a_flood_of_programs_is_cut_off_when_its_sender_goes(self):
        connection = connect()
        sent = connection.receive(b"halt()\n" * 1000, output(1))
        *last, log = connection.closed()
        assert len(sent) == UNITS_PER_TICK
        assert last == [RunUnit(ME, "line", "halt()")] * MAX_UNITS_AT_ONCE
        assert isinstance(log, AddLog)
        assert "the rest is lost" in log.text

    def test_a_long_program_is_read_over_several_ticks(self):
        program = "def a():\n" + " x = 1\n" * (3 * MAX_LINES_PER_TICK) + "end"
        connection = connect()
        assert connection.receive(f"{program}\nstop task\n".encode(), output(0)) == []
        found = []
        for tick in range(1, 20):
            connection.publish(output(tick))
            if due := connection.due():
                found.append((tick, due))
        ((tick, due),) = found
        assert due == [RunUnit(ME, "program", program), Do(ME, StopTask())]
        assert 3 <= tick <= 6

    @pytest.mark.parametrize("line_end", [b"\n", b"\r", b"\r\n"])
    def test_a_flood_of_line_ends_is_read_in_portions(self, line_end):
        connection = connect()
        read = []
        monitor = connection._splitter.receive
        connection._splitter = SimpleNamespace(receive=lambda data: read.append(data) or monitor(data), pending=False)
        connection.receive(line_end * 20_000, output(0))
        connection.receive(line_end, output(0))
        assert 0 < sum(map(len, read)) <= MAX_LINES_PER_TICK * len(line_end)
        before = len(read)
        connection.publish(output(1))
        assert len(read) > before

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


class TestControl:
    @pytest.mark.parametrize("stream", [f"{PROGRAM}\n", "stop task\n", "halt()\n", "sec a():\n x = 1\nend\n"])
    def test_local_control_refuses_with_a_warning(self, stream):
        connection = connect()
        run(connection, [0])
        (log,) = connection.receive(stream.encode(), output(1, is_remote=False))
        assert isinstance(log, AddLog)
        assert log.is_warning
        assert f"{ME}: refused: the robot is in local control; switch it" in log.text

    def test_a_warning_reaches_every_client_as_a_robot_error(self):
        connection = connect()
        run(connection, [0])
        connection.publish(output(1, events=(Warned(1, "refused: the robot is in local control"),)))
        message = client.robot_message(next(m for m in connection.take() if m[4] == 20))
        assert (message["kind"], message["level"], message["text"]) == (6, 1, "refused: the robot is in local control")


class TestPorts:
    def test_numbers_and_names_differ(self):
        assert [port.number for port in PORTS] == [30001, 30002, 30003, 30011]
        assert len({port.name for port in PORTS}) == len(PORTS)

    def test_states_fall_on_ticks(self):
        assert all(port.period_ticks * port.rate == 250 for port in PORTS)

    def test_only_the_primary_port_is_documented(self):
        assert [port for port in PORTS if port.evidence != "assumed"] == [PRIMARY]

    @pytest.mark.parametrize("port", [PRIMARY, SECONDARY, REALTIME])
    def test_programs_run(self, port):
        assert connect(port).receive(b"stop task\n", output(0)) == [Do(ME, StopTask())]

    def test_the_read_only_port_ignores_what_comes_in(self):
        connection = connect(READ_ONLY)
        assert connection.receive(f"{PROGRAM}\nstop task\nstop task".encode(), output(0)) == []
        run(connection, range(100))
        assert connection.due() == connection.closed() == []

    def test_a_port_without_messages_refuses_in_the_log(self):
        connection = connect(SECONDARY)
        (log,) = connection.receive(b"set speed 2\n", output(0))
        assert isinstance(log, AddLog)
        assert notes(run(connection, range(10))) == []


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


@pytest.mark.parametrize("seed", range(40))
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


@pytest.mark.parametrize("seed", range(40))
def test_how_a_stream_is_cut_into_pieces_changes_nothing(seed):
    chance = random.Random(seed)
    stream = b"".join(chance.choice(FRAGMENTS) for _ in range(60))
    cuts = sorted(chance.sample(range(len(stream)), 20))
    pieces = [stream[start:end] for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True)]
    assert feed_in(pieces) == feed_in([stream])
