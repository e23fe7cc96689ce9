"""Connections of the primary port: what clients get and when, in remote and in local control, at which port."""

from __future__ import annotations

import pytest

from elitescript.messages.events import Alarm, TextMessage, Warned
from elitescript.messages.inputs import AddLog, Do
from elitescript.messages.machine import StopTask
from elitescript.protocol.primary import connection as primary
from elitescript.protocol.primary.connection import (
    PORTS,
    PRIMARY,
    READ_ONLY,
    REALTIME,
    SECONDARY,
    SPACING_TICKS,
    PrimaryConnection,
    PrimaryFeed,
)
from elitescript.protocol.primary.messages import WAITING_MAX
from tests.protocol import primary_client as client
from tests.protocol.primary_link import ME, PROGRAM, connect, run
from tests.protocol.snapshots import description, output


def text(n: int, tick: int = 0) -> TextMessage:
    return TextMessage(tick, f"text {n}", "main", 1)


def alarm(tick: int = 0) -> Alarm:
    return Alarm(tick, "R100", "NameError", "no", 2, 3, "main")


def states(sent: dict[int, list[bytes]]) -> list[int]:
    """Ticks at which a robot state is sent."""
    return [tick for tick, messages in sent.items() for message in messages if message[4] == 16]


def notes(sent: dict[int, list[bytes]]) -> list[tuple[int, str]]:
    """Ticks and texts of robot messages."""
    found = []
    for tick, messages in sent.items():
        found += [(tick, client.robot_message(message)["text"]) for message in messages if message[4] == 20]
    return found


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

    def test_the_read_only_port_ignores_what_comes_in_and_says_so_once(self):
        connection = connect(READ_ONLY)
        (log,) = connection.receive(f"{PROGRAM}\nstop task\nstop task".encode(), output(0))
        text = "this port only sends, and what comes in is not read; send programs to 30001"
        assert log == AddLog(ME, f"{ME}: {text}", is_warning=True)
        assert connection.receive(b"stop task\n", output(1)) == []
        run(connection, range(100))
        assert connection.due() == connection.closed() == []

    def test_a_port_without_messages_refuses_in_the_log(self):
        connection = connect(SECONDARY)
        (log,) = connection.receive(b"set speed 2\n", output(0))
        assert isinstance(log, AddLog)
        assert notes(run(connection, range(10))) == []
