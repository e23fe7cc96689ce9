"""TCP servers of a test: lines, answers, time, connections."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.testing.world import DeviceError, TcpServer, World
from tests.devices.programs import run

OPEN = 'socket_open("h", 5000)\n'


class Camera(TcpServer):
    port = 5000

    def line_received(self, connection, line):
        return f"<{line}>"


def log_of(body, *devices, **rest):
    found = run(OPEN + body, *devices, **rest)
    assert found.state == "finished", found.alarms
    return found.log


def test_a_text_that_is_returned_is_sent_as_a_line():
    assert log_of('socket_send_line("hello")\ntextmsg(socket_read_string("socket_0", "", "\\n"))', Camera()) == [
        "<hello>"
    ]


def test_bytes_that_are_returned_are_sent_as_they_are():
    class Raw(TcpServer):
        port = 5000

        def received(self, connection, data):
            return data[::-1]

    assert log_of('socket_send_string("abc")\ntextmsg(socket_read_string())', Raw()) == ["cba"]


def test_a_greeting_comes_without_a_question():
    class Greeter(TcpServer):
        port = 5000

        def opened(self, connection):
            return f"number {connection.number}"

    assert log_of('textmsg(socket_read_string("socket_0", "", "\\n"))', Greeter()) == ["number 1"]


@pytest.mark.parametrize(
    "line_end, sent", [("\n", "a\\nb\\n"), ("\n", "a\\r\\nb\\r\\n"), (";", "a;b;"), ("\r", "a\\rb\\r")]
)
def test_lines_end_as_the_device_says(line_end, sent):
    seen = []

    class Listener(TcpServer):
        port = 5000

        def line_received(self, connection, line):
            seen.append(line)

    log_of(f'socket_send_string("{sent}")\nsleep(0.1)', Listener(line_end=line_end))
    assert seen == ["a", "b"]


def test_without_a_line_end_whatever_arrives_together_is_one():
    seen = []

    class Listener(TcpServer):
        port = 5000
        line_end = ""

        def line_received(self, connection, line):
            seen.append(line)

    log_of('socket_send_string("where?")\nsleep(0.1)\nsocket_send_string("a\\nb")\nsleep(0.1)', Listener())
    assert seen == ["where?", "a\nb"]


def test_a_line_without_its_end_is_explained_once():
    found = run(OPEN + 'socket_send_string("where?")\nsleep(3)\nsocket_send_string("x")\nsleep(3)', Camera())
    (warning,) = found.warnings
    assert "Camera: waits for the end of the line b'where?'" in warning
    assert "socket_send_line" in warning


@pytest.mark.parametrize("end", ["", "\nsocket_close()", "\nhalt()"])
def test_a_line_without_its_end_is_explained_when_the_program_ends(end):
    (warning,) = run(OPEN + 'socket_send_string("done")' + end, Camera()).warnings
    assert "Camera: waits for the end of the line b'done'" in warning
    assert run(OPEN + 'socket_send_string("done\\n")' + end, Camera()).warnings == []


def test_latency_is_the_time_of_what_the_device_sends():
    body = 'socket_send_line("q")\nsocket_read_string()\nglobal t\nt = get_steptime()'
    slow = run(OPEN + body, Camera(latency_s=0.4))
    assert slow.time_s - run(OPEN + body, Camera()).time_s == pytest.approx(0.4 - 0.004)


def test_jitter_comes_from_the_seed_and_nothing_overtakes():
    class Counter(TcpServer):
        port = 5000
        jitter_s = 0.5

        def opened(self, connection):
            for number in range(20):
                self.after(0.02 * number, connection.send_line, str(number))

    def times(seed):
        body = 'for n in range(20):\n  textmsg(socket_read_string("socket_0", "", "\\n"))\nend'
        return [
            (event.tick, event.text)
            for event in run(OPEN + body, Counter(), seed=seed).events
            if hasattr(event, "text")
        ]

    assert [text for _, text in times(1)] == [str(number) for number in range(20)]
    assert times(1) == times(1)
    assert times(1) != times(2)


def test_connections_are_apart_and_hear_of_the_end():
    seen = []

    class Server(TcpServer):
        port = 5000

        def line_received(self, connection, line):
            connection.count = getattr(connection, "count", 0) + 1
            return f"{connection.number}.{connection.count}"

        def closed(self, connection):
            seen.append((connection.number, len(self.connections)))

    body = """
socket_open("h", 5000, "a")
socket_open("h", 5000, "b")
socket_send_line("x", 0, "a")
textmsg(socket_read_string("a"))
socket_send_line("x", 0, "a")
textmsg(socket_read_string("a"))
socket_send_line("x", 0, "b")
textmsg(socket_read_string("b"))
socket_close("a")
sleep(0.1)
"""
    server = Server()
    found = run(body, server)
    assert [text.strip() for text in found.log] == ["1.1", "1.2", "2.1"]
    assert seen == [(1, 1), (2, 0)]


def test_the_device_closes_and_the_program_is_told():
    class Once(Camera):
        def line_received(self, connection, line):
            connection.send_line("bye")
            connection.close()

    body = 'socket_send_line("x")\ntextmsg(socket_read_string())\nsleep(0.1)\ntextmsg(socket_is_connected())'
    assert [text.strip() for text in log_of(body, Once())] == ["bye", "False"]


def test_a_device_that_does_not_listen_or_is_full_refuses():
    body = 'textmsg(socket_open("h", 5000, "a"), socket_open("h", 5000, "b"))'
    assert run(body, Camera(is_listening=False)).log == ["FalseFalse"]
    assert run(body, Camera(connections_max=1)).log == ["TrueFalse"]
    assert run(body).log == ["FalseFalse"]


def test_an_address_tells_two_devices_of_one_port_apart():
    class Other(Camera):
        def line_received(self, connection, line):
            return "other"

    body = """
socket_open("10.0.0.2", 5000, "a")
socket_open("anybody", 5000, "b")
socket_send_line("x", 0, "a")
textmsg(socket_read_string("a"))
socket_send_line("x", 0, "b")
textmsg(socket_read_string("b"))
"""
    assert [text.strip() for text in run(body, Camera(), Other(address="10.0.0.2")).log] == ["other", "<x>"]


def test_two_devices_cannot_have_one_port():
    with pytest.raises(UsageError, match="port: 5000 is taken by Camera already"):
        World(devices=[Camera(), Camera()])


def test_a_device_belongs_to_one_world():
    camera = Camera()
    World(devices=[camera])
    with pytest.raises(UsageError, match="Camera is part of another world"):
        World(devices=[camera])


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"port": 0}, "port: is missing"),
        ({"port": 70_000}, r"port: must be in \[1, 65535\], got 70000"),
        ({"port": "5000"}, "port: must be a whole number"),
        ({"latency_s": -1}, "latency_s: must be in"),
        ({"latency_s": float("nan")}, "latency_s: must be in"),
        ({"line_end": 3}, "line_end: must be a text"),
        ({"encoding": "klingon"}, "encoding: there is no encoding called 'klingon'"),
        ({"prot": 3}, "prot: is not known; settings are name, port"),
    ],
)
def test_a_setting_that_makes_no_sense_is_named(settings, words):
    with pytest.raises(UsageError, match=words):
        World(devices=[Camera(**settings)])


def test_settings_of_a_class_without_its_own_begin_are_looked_at_too():
    class Careless(TcpServer):
        port = -3

        def __init__(self):
            self.extra = 1

    with pytest.raises(UsageError, match="port: must be in"):
        World(devices=[Careless()])


def test_what_a_device_returns_must_be_sendable():
    class Wrong(Camera):
        def line_received(self, connection, line):
            return 7

    with pytest.raises(DeviceError, match="returns a str, bytes or None to have it sent, not 7"):
        run(OPEN + 'socket_send_line("x")\nsleep(1)', Wrong())


def test_a_connection_that_is_given_up_before_it_stands_takes_no_place():
    heard = []

    class Picky(TcpServer):
        port = 5000
        connections_max = 1

        def opened(self, connection):
            heard.append("opened")

        def closed(self, connection):
            heard.append("closed")

    device = Picky()
    channels = World(devices=[device]).channels
    channels.arrivals(0)
    for _ in range(3):
        channels.close(channels.open("h", 5000, 2.0))
    channels.arrivals(1)
    assert (device.connections, heard) == ((), [])
    channels.open("h", 5000, 2.0)
    channels.arrivals(2)
    assert heard == ["opened"]
