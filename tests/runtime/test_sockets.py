"""Named connections of a program: opening, sending, waiting, sharing, the end."""

from __future__ import annotations

import pytest

from elitescript.devices.channels.network import Peer, VirtualNetwork
from elitescript.environment.memory import MemoryEnvironment
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.messages.enums import ChannelError
from elitescript.messages.events import ChannelActivity
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.outputs import CHANNEL_WINDOW, CloseChannel, CreditChannel, OpenChannel, SendChannel
from elitescript.runtime.connections.sockets import CONNECTIONS_MAX
from tests.runtime.machine import Bench


class Recorder(Peer):
    """A server that notes what it gets, on a class of its own for each test."""

    def __init_subclass__(cls):
        cls.log = []

    def opened(self):
        self.log.append(("opened", self.link.time_s))

    def received(self, data):
        self.log.append((data, self.link.time_s))

    def closed(self):
        self.log.append(("closed", self.link.time_s))

    @classmethod
    def bytes(cls):
        return b"".join(what for what, _ in cls.log if isinstance(what, bytes))


def run(body, server=None, *, until=25_000, steps=False):
    """Run a program against a server on port 5000; a body is given without its frame."""
    channels = VirtualNetwork({} if server is None else {5000: server})
    text = "def main():\n" + "".join(f"  {line}\n" for line in body.strip("\n").split("\n")) + "end\n"
    return Bench(world=MemoryEnvironment(channels=channels), steps=steps).start(text).run(until)


def remote(body):
    """A program whose connections are held by the test: host, requests and events by hand."""
    world = RequestEnvironment(MemoryEnvironment().files)
    text = "def main():\n" + "".join(f"  {line}\n" for line in body.strip("\n").split("\n")) + "end\n"
    bench = Bench(world=world).start(text)
    return bench, world.channels


def tick(bench, *events):
    """One tick with what has happened outside."""
    for event in events:
        bench.host.channel_event(event)
    bench.host.run_tick(bench.machine.tick)
    bench.machine.tick += 1


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('socket_send_line("x")\nsocket_send_line("y")\nsocket_read_string()', ["sent"]),
        ('socket_read_string()\nsocket_send_line("x")', ["read"]),
        ('socket_open("h", 5000)\nsocket_close()\nsocket_send_line("x")', ["sent"]),
        ('socket_open("h", 5000)\nsocket_send_line("x")\nsocket_close()', []),
    ],
)
def test_what_is_asked_of_a_socket_that_is_not_open_is_said_once(body, expected):
    class Server(Recorder):
        pass

    warnings = [text for text in run(body, Server).warnings if "no open socket" in text]
    assert warnings == [f"there is no open socket 'socket_0': nothing is {done}" for done in expected]


def test_a_pause_puts_the_time_out_of_a_read_off_whatever_trickles():
    bench, _ = remote('socket_open("h", 1)\ntextmsg(socket_read_byte_list(2, "socket_0", 1.0))')
    tick(bench)
    tick(bench, ChannelOpened(1, True))
    bench.host.pause()
    for _ in range(500):
        tick(bench)
    bench.host.resume()
    tick(bench)
    tick(bench, ChannelData(1, b"a"))
    for _ in range(200):
        tick(bench)
    assert bench.log == []
    tick(bench, ChannelData(1, b"b"))
    assert bench.log == ["[2, 97, 98]"]


def test_a_read_does_not_end_while_ticks_are_made_up_for():
    bench, _ = remote('socket_open("h", 1)\ntextmsg(socket_read_byte_list(1, "socket_0", 0.2))')
    tick(bench)
    bench.host.set_lag(60)
    tick(bench, ChannelOpened(1, True))
    for lag in range(59, -1, -1):
        bench.host.set_lag(lag)
        tick(bench)
    assert bench.log == []
    tick(bench, ChannelData(1, b"a"))
    assert bench.log == ["[1, 97]"]


def test_a_read_from_a_silent_peer_ends_after_its_time_once_robot_time_has_caught_up():
    bench, _ = remote('socket_open("h", 1)\ntextmsg(socket_read_byte_list(1, "socket_0", 0.2))')
    tick(bench)
    bench.host.set_lag(60)
    tick(bench, ChannelOpened(1, True))
    begin = bench.machine.tick
    for lag in [*range(59, 0, -1), *[0] * 60]:
        bench.host.set_lag(lag)
        tick(bench)
        if bench.log:
            break
    assert bench.log == ["[0, -1]"]
    assert bench.machine.tick - begin == 60 + 50


class TestOpening:
    def test_a_server_that_listens_accepts(self):
        class Server(Recorder):
            pass

        bench = run('textmsg(socket_open("10.0.0.1", 5000, "a"))\ntextmsg(socket_is_connected("a"))', Server)
        assert bench.log == ["True", "True"]
        assert Server.log[0] == ("opened", 0.004)

    def test_a_port_without_a_server_refuses_and_the_log_says_why(self):
        bench = run('textmsg(socket_open("10.0.0.1", 5001, "a"))\ntextmsg(socket_is_connected("a"))')
        assert bench.log == ["False", "False"]
        assert bench.warnings == ["socket 'a' cannot connect to 10.0.0.1:5001: connection refused"]

    def test_a_loop_that_tries_again_warns_once(self):
        bench = run('for n in range(50):\n  socket_open("10.0.0.1", 5001)\n  sleep(0.1)\nend')
        assert len(bench.warnings) == 1

    def test_a_server_that_accepts_when_it_was_given_up_changes_nothing(self):
        bench, channels = remote('textmsg(socket_open("h", 1))\nsleep(0.1)\ntextmsg(socket_is_connected())')
        while not bench.log:
            tick(bench)
        assert CloseChannel(1) in channels.take()
        tick(bench, ChannelOpened(1, True))
        for _ in range(40):
            tick(bench, ChannelData(1, b"late"))
        assert bench.log == ["False", "False"]

    def test_without_a_network_it_fails_at_once(self):
        bench = Bench().start('def main():\n  textmsg(socket_open("10.0.0.1", 5000))\nend\n').run()
        assert bench.log == ["False"]
        assert bench.warnings == ["socket 'socket_0' cannot connect to 10.0.0.1:5000: this run has no network"]

    def test_it_tries_for_two_seconds(self):
        bench, channels = remote('textmsg(socket_open("h", 5))\ntextmsg(socket_open("h", 5))')
        tick(bench)
        assert channels.take() == (OpenChannel(1, "tcp", "h", 5, 2.0),)
        bench.run(until=499)
        assert channels.take() == ()
        bench.run(until=500)
        assert channels.take() == (CloseChannel(1), OpenChannel(2, "tcp", "h", 5, 2.0))
        assert bench.log == ["False"]
        assert bench.warnings == ["socket 'socket_0' cannot connect to h:5: no answer within 2 s"]

    @pytest.mark.parametrize(
        ("error", "what"), [(ChannelError.TIMED_OUT, "timeout"), (ChannelError.REFUSED, "refused")]
    )
    def test_the_record_tells_a_time_out_from_a_refusal(self, error, what):
        bench, _ = remote('textmsg(socket_open("h", 5))')
        tick(bench)
        tick(bench, ChannelOpened(1, False, "no way", error))
        assert [(event.what, event.data) for event in bench.machine.events if isinstance(event, ChannelActivity)] == [
            (what, "h:5: no way")
        ]

    def test_a_late_answer_is_nobodys(self):
        bench, _ = remote('socket_open("h", 5)\nsocket_close()\ntextmsg(socket_is_connected())')
        bench.run(until=500)
        tick(bench, ChannelOpened(1, True), ChannelData(1, b"late"))
        assert bench.log == ["False"]
        assert bench.host.connections == {}

    def test_one_that_stands_is_kept(self):
        class Server(Recorder):
            pass

        bench = run('socket_open("h", 5000)\ntextmsg(socket_open("elsewhere", 1))', Server)
        assert bench.log == ["True"]
        assert [what for what, _ in Server.log] == ["opened", "closed"]

    def test_one_that_the_peer_has_closed_is_opened_anew_without_what_was_not_read(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(b"x")
                self.link.close()

        bench = run(
            """
            socket_open("h", 5000)
            sleep(0.1)
            textmsg(socket_is_connected())
            textmsg(socket_open("h", 5000))
            textmsg(socket_read_string())
            textmsg(socket_read_string())
            """.replace("            ", ""),
            Server,
        )
        assert bench.log == ["False", "True", "x", ""]

    def test_a_thread_that_opens_the_same_name_waits_for_the_same_attempt(self):
        body = """
def other():
  textmsg("other ", socket_open("h", 5000, "a"))
t = start_thread(other, ())
textmsg("main ", socket_open("h", 5000, "a"))
join_thread(t)"""

        class Server(Recorder):
            pass

        bench = run(body, Server)
        assert sorted(bench.log) == ["main True", "other True"]
        assert [what for what, _ in Server.log].count("opened") == 1

    def test_a_thread_that_is_stopped_gives_its_attempt_up(self):
        bench, channels = remote(
            """
def other():
  socket_open("h", 5, "a")
end
t = start_thread(other, ())
sync()
stop_thread(t)
sleep(9)"""
        )
        bench.run(until=5)
        assert channels.take() == (OpenChannel(1, "tcp", "h", 5, 2.0), CloseChannel(1))

    def test_names_are_limited(self):
        class Server(Recorder):
            pass

        body = f'for n in range({CONNECTIONS_MAX + 1}):\n  socket_open("h", 5000, str(n))\nend'
        (alarm,) = run(body, Server).alarms
        assert (alarm.class_name, alarm.line) == ("RuntimeError", 3)
        assert f"{CONNECTIONS_MAX} sockets are open already" in alarm.text

    def test_closed_ones_do_not_count(self):
        class Server(Recorder):
            def opened(self):
                self.link.close()

        body = (
            f'for n in range({3 * CONNECTIONS_MAX}):\n  socket_open("h", 5000, str(n))\n  sync()\nend\ntextmsg("done")'
        )
        assert run(body, Server).log == ["done"]


class TestReading:
    def test_it_waits_until_all_is_there(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(b"\x00\x00\x00\x01\xff\xff")
                self.link.later(0.4, lambda: self.link.send(b"\xff\xfe"))

        bench = run('socket_open("h", 5000)\ntextmsg(socket_read_binary_integer(2))', Server)
        assert bench.log == ["[2, 1, -2]"]
        # The peer sends in tick 1, 100 ticks later, and the program has it in the next one.
        assert [event.tick for event in bench.machine.events if hasattr(event, "text")] == [102]

    def test_when_time_is_up_it_returns_what_is_complete_and_leaves_the_rest(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(b"\x00\x00\x00\x01\x00\x00")
                self.link.later(1.0, lambda: self.link.send(b"\x00\x02"))

        bench = run(
            """
socket_open("h", 5000)
textmsg(socket_read_binary_integer(2, "", 0.5))
textmsg(socket_read_binary_integer(1))""",
            Server,
        )
        assert bench.log == ["[1, 1, -1]", "[1, 2]"]
        assert [event.tick for event in bench.machine.events if hasattr(event, "text")] == [1 + 125, 252]

    def test_a_server_that_trickles_does_not_put_the_limit_off(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(b"x")
                self.link.later(0.004, self.opened)

        bench = run('socket_open("h", 5000)\ntextmsg(socket_read_string(suffix="\\n", timeout=0.1))', Server, until=500)
        assert [(event.text, event.tick) for event in bench.machine.events if hasattr(event, "text")] == [("", 26)]

    @pytest.mark.parametrize("timeout", ["0", "-1"])
    def test_without_a_limit_it_waits_for_ever(self, timeout):
        class Server(Recorder):
            def opened(self):
                self.link.later(1000.0, lambda: self.link.send(b"\x01"))

        bench = run(f'socket_open("h", 5000)\ntextmsg(socket_read_byte_list(1, "", {timeout}))', Server, until=300_000)
        assert bench.log == ["[1, 1]"]
        assert len(bench.ticks) < 10

    def test_the_shortest_limit_is_a_tick(self):
        class Server(Recorder):
            pass

        bench = run(
            'socket_open("h", 5000)\nfor n in range(10):\n  socket_read_string(timeout=1e-9)\nend\ntextmsg("")', Server
        )
        assert [event.tick for event in bench.machine.events if hasattr(event, "text")] == [11]

    def test_what_came_before_the_peer_closed_can_still_be_read(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(b"\x07\x08\x09")
                self.link.close()

        bench = run(
            'socket_open("h", 5000)\nsleep(1)\ntextmsg(socket_read_byte_list(2))\ntextmsg(socket_read_byte_list(2))',
            Server,
        )
        assert bench.log == ["[2, 7, 8]", "[1, 9, -1]"]

    def test_the_end_of_the_connection_ends_the_wait(self):
        class Server(Recorder):
            def opened(self):
                self.link.later(0.1, self.link.close)

        bench = run('socket_open("h", 5000)\ntextmsg(socket_read_byte_list(2, "", 0))', Server)
        assert bench.log == ["[0, -1, -1]"]
        assert bench.machine.tick == 28

    @pytest.mark.parametrize("steps", [False, True])
    def test_a_read_that_must_fail_lets_a_tick_go_by(self, steps):
        bench = run(
            'n = 0\nwhile n < 20:\n  n += 1\n  socket_read_byte_list(1, "none", 0)\nend\ntextmsg(n)', steps=steps
        )
        assert bench.log == ["20"]
        assert bench.machine.tick == 20

    def test_threads_share_connections(self):
        class Server(Recorder):
            def opened(self):
                for number in range(6):
                    self.link.later(0.1 * number, lambda number=number: self.link.send(bytes([number])))

        body = """
def reader(name):
  for n in range(3):
    textmsg(name, socket_read_byte_list(1, "a", 0))
  end
end
socket_open("h", 5000, "a")
t = start_thread(reader, ("t",))
reader("m")
join_thread(t)"""
        found = sorted(line[1:] for line in run(body, Server).log)
        assert found == [f"[1, {number}]" for number in range(6)]

    def test_a_blocked_read_can_be_stopped_and_takes_nothing(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(b"\x00\x00\x00\x09\x00")

        body = """
def reader():
  socket_read_binary_integer(5, "a", 0)
end
socket_open("h", 5000, "a")
t = start_thread(reader, ())
sleep(0.1)
stop_thread(t)
join_thread(t)
textmsg(socket_read_binary_integer(1, "a"))"""
        assert run(body, Server).log == ["[1, 9]"]

    def test_who_waits_for_ever_for_a_silent_peer_says_so(self):
        class Server(Recorder):
            pass

        bench = run('socket_open("h", 5000, "a")\nsocket_read_string("a", timeout=0)', Server)
        assert [thread.waits_for for thread in bench.host.threads()] == ["data on socket 'a'"]

    def test_stepping_and_leaping_are_the_same(self):
        class Server(Recorder):
            def received(self, data):
                super().received(data)
                self.link.later(0.03, lambda: self.link.send(data + b"\n"))

        body = """
socket_open("h", 5000)
for n in range(20):
  socket_send_line(str(n))
  sleep(0.01 * n)
  textmsg(socket_read_string(suffix="\\n", timeout=0.05))
end"""
        assert run(body, Server, steps=True).trace == run(body, Server).trace


class TestBackPressure:
    def test_the_peer_is_told_what_was_read(self):
        bench, channels = remote('socket_open("h", 5)\nwhile True:\n  socket_read_byte_list(512, timeout=0)\nend')
        tick(bench)
        tick(bench, ChannelOpened(1, True))
        channels.take()
        tick(bench, ChannelData(1, bytes(512 * 20)))
        assert channels.take() == ()
        tick(bench, ChannelData(1, bytes(512 * 20)))
        assert channels.take() == (CreditChannel(1, CHANNEL_WINDOW // 4),)

    def test_what_nobody_reads_is_bounded(self):
        bench, channels = remote('socket_open("h", 5)\nsleep(1)\ntextmsg(socket_is_connected())')
        tick(bench)
        tick(bench, ChannelOpened(1, True))
        tick(bench, ChannelData(1, bytes(CHANNEL_WINDOW)))
        assert channels.take()[1:] == ()
        tick(bench, ChannelData(1, b"x"))
        assert channels.take() == (CloseChannel(1),)
        bench.run()
        assert bench.log == ["False"]

    def test_a_server_that_sends_more_than_fits_is_held_back(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(bytes(range(256)) * 1024)

        body = """
socket_open("h", 5000)
total = 0
while total < 262144:
  part = socket_read_byte_list(512)
  total += part[0]
end
textmsg(total)"""
        assert run(body, Server).log == ["262144"]

    def test_sending_waits_for_room_and_keeps_the_order(self):
        bench, channels = remote(
            """
socket_open("h", 5)
socket_send_string("a" * 65000)
textmsg(socket_send_string("b" * 1000))
textmsg("on")"""
        )
        tick(bench)
        tick(bench, ChannelOpened(1, True))
        assert channels.take()[1:] == (SendChannel(1, b"a" * 65000), SendChannel(1, b"b" * 536))
        tick(bench)
        assert bench.log == []
        tick(bench, ChannelCredit(1, 400))
        assert channels.take() == (SendChannel(1, b"b" * 400),)
        assert bench.log == []
        tick(bench, ChannelCredit(1, 400))
        assert channels.take() == (SendChannel(1, b"b" * 64), CloseChannel(1))
        assert bench.log == ["True", "on"]

    def test_sending_fails_when_the_connection_ends_meanwhile(self):
        bench, _ = remote('socket_open("h", 5)\ntextmsg(socket_send_string("a" * 70000))')
        tick(bench)
        tick(bench, ChannelOpened(1, True))
        tick(bench, ChannelClosed(1, "reset"))
        assert bench.log == ["False"]


class TestTheEnd:
    @pytest.mark.parametrize("last", ["halt()", "1 / 0", "pass"])
    def test_a_program_leaves_no_connection_open(self, last):
        class Server(Recorder):
            pass

        bench = run(f'socket_open("h", 5000, "a")\nsocket_open("h", 5000, "b")\nsleep(0.1)\n{last}', Server)
        assert [entry for entry in Server.log if entry[0] == "closed"] == [("closed", 0.112)] * 2
        assert bench.host.connections == {}

    def test_one_that_is_stopped_in_a_read_closes_in_that_tick(self):
        bench, channels = remote('socket_open("h", 5)\nsocket_read_string(timeout=0)')
        tick(bench)
        tick(bench, ChannelOpened(1, True))
        channels.take()
        bench.host.stop("test")
        tick(bench)
        assert channels.take() == (CloseChannel(1),)
        assert bench.ends == ["stopped"]

    def test_a_stopped_program_can_still_say_goodbye(self):
        class Server(Recorder):
            pass

        body = """
socket_open("h", 5000)
try:
  halt()
finally:
  socket_send_string("bye")
  socket_close()
end"""
        run(body, Server)
        assert Server.bytes() == b"bye"

    def test_it_cannot_open_another_one(self):
        class Server(Recorder):
            pass

        run('try:\n  halt()\nfinally:\n  socket_open("h", 5000)\nend', Server)
        assert Server.log == []

    def test_the_next_program_does_not_find_the_connections_of_the_last(self):
        class Server(Recorder):
            pass

        bench = run('socket_open("h", 5000)', Server)
        bench.start("def main():\n  textmsg(socket_is_connected())\nend\n").run()
        assert bench.log == ["False"]


class TestSecondaryPrograms:
    def test_they_use_the_connections_of_the_program_and_read_what_is_there(self):
        class Server(Recorder):
            def opened(self):
                self.link.send(b"\x05\x06")

        channels = VirtualNetwork({5000: Server})
        bench = Bench(world=MemoryEnvironment(channels=channels))
        bench.start('def main():\n  socket_open("h", 5000, "a")\n  while True:\n    sync()\n  end\nend\n').run(until=10)
        bench.secondary("""
sec peek():
  textmsg(socket_read_byte_list(3, "a", 5))
  textmsg(socket_read_byte_list(1, "a", 0))
end
""").run(until=11)
        assert bench.log == ["[2, 5, 6, -1]", "[0, -1]"]

    def test_alone_they_hand_a_value_to_a_computer_and_close(self):
        class Server(Recorder):
            pass

        bench = Bench(world=MemoryEnvironment(channels=VirtualNetwork({5000: Server})))
        bench.secondary('sec tell():\n  socket_open("h", 5000, "x")\n  socket_send_string(1.5, "x")\nend\n').run()
        assert Server.bytes() == b"1.5"
        assert Server.log[-1][0] == "closed"
        assert bench.host.connections == {}
