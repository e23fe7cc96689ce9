"""What programs see of a channel on which things go wrong."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.modbus.frames.pdu import read
from elitescript.modbus.frames.tcp import TcpSplitter, tcp_frame
from elitescript.runtime.environment import NoChannels
from elitescript.testing.world import Fault, ModbusDevice, SerialDevice, TcpServer, World, XmlRpcServer
from tests.devices.programs import run


class Echo(TcpServer):
    port = 5000

    def received(self, connection, data):
        return data


class Bench:
    """A world without a robot, its faulty channels and what comes from them."""

    def __init__(self, *faults, devices=None, port=5000, seed=0):
        self.channels = World(devices=devices or [Echo()], faults=faults, seed=seed).channels
        self.tick = 0
        self.channels.arrivals(0)
        self.channel = self.channels.open("h", port, 2.0)
        self.opening = self.play(1)

    def play(self, ticks):
        """Events by tick."""
        found = []
        for _ in range(ticks):
            self.tick += 1
            found += [(self.tick, event) for event in self.channels.arrivals(self.tick)]
        return found

    def data(self, ticks=10):
        return [(tick, event.data) for tick, event in self.play(ticks) if isinstance(event, ChannelData)]

    def say(self, data, ticks=10):
        self.channels.send(self.channel, data)
        return self.data(ticks)


def test_without_a_fault_nothing_changes():
    bench = Bench()
    assert bench.opening == [(1, ChannelOpened(1, True))]
    assert bench.say(b"abc") == [(3, b"abc")]


@pytest.mark.parametrize(
    "fault, expected",
    [
        (Fault("drop", 5000, direction="to_robot"), []),
        (Fault("drop", 5000, direction="to_device"), []),
        (Fault("silence", 5000, at_s=0.004), []),
        (Fault("delay", 5000, delay_s=0.02, direction="to_robot"), [(8, b"abc")]),
        (Fault("delay", 5000, delay_s=0.02), [(13, b"abc")]),
        (Fault("duplicate", 5000, direction="to_robot"), [(3, b"abc"), (3, b"abc")]),
        (Fault("trickle", 5000, direction="to_robot"), [(3, b"a"), (4, b"b"), (5, b"c")]),
        (Fault("trickle", 5000, chunk=2, direction="to_robot"), [(3, b"ab"), (4, b"c")]),
        (Fault("wrong_reply", 5000, reply="no!"), [(3, b"no!")]),
        (Fault("wrong_reply", 5000, reply=b"\xff"), [(3, b"\xff")]),
        (Fault("drop", "h:5000"), []),
        (Fault("drop", "other:5000"), [(3, b"abc")]),
        (Fault("drop", 5000, at_s=1.0), [(3, b"abc")]),
        (Fault("drop", 5000, share=0.0), [(3, b"abc")]),
    ],
)
def test_what_becomes_of_an_answer(fault, expected):
    assert Bench(fault).say(b"abc", 14) == expected


def test_corruption_changes_one_bit_in_eight_bytes_by_the_seed():
    def heard(seed):
        return Bench(Fault("corrupt", 5000, direction="to_robot"), seed=seed).say(bytes(32))[0][1]

    for begin in range(0, 32, 8):
        assert sum(byte.bit_count() for byte in heard(1)[begin : begin + 8]) == 1
    assert heard(1) == heard(1)
    assert heard(1) != heard(2)


def test_only_the_messages_that_were_meant():
    bench = Bench(Fault("drop", 5000, direction="to_robot", nth=2, count=2))
    assert [bool(bench.say(b"x", 3)) for _ in range(5)] == [True, False, False, True, True]


def test_a_share_of_the_messages():
    bench = Bench(Fault("drop", 5000, direction="to_robot", share=0.5))
    lost = sum(not bench.say(b"x", 3) for _ in range(200))
    assert 70 < lost < 130


def test_a_fault_ends():
    bench = Bench(Fault("drop", 5000, for_s=0.1))
    assert bench.say(b"x", 5) == []
    bench.play(20)
    assert bench.say(b"y", 5) != []


def test_nothing_overtakes_what_is_late():
    bench = Bench(Fault("delay", 5000, direction="to_robot", delay_s=0.04, count=1))
    bench.channels.send(bench.channel, b"1")
    bench.play(1)
    bench.channels.send(bench.channel, b"2")
    assert [data for _, data in bench.data(20)] == [b"1", b"2"]


def test_trickled_messages_follow_each_other():
    bench = Bench(Fault("trickle", 5000, direction="to_robot"))
    bench.channels.send(bench.channel, b"abc")
    bench.channels.send(bench.channel, b"def")
    ticks = [tick for tick, _ in bench.data(20)]
    assert ticks == [3, 4, 5, 5, 6, 7]


def test_refusing_and_ending_it():
    bench = Bench(Fault("refuse", 5000, for_s=0.02))
    assert bench.opening == [(1, ChannelOpened(1, False, "connection refused", ChannelError.REFUSED))]
    bench.play(5)
    bench.channels.open("h", 5000, 2.0)
    assert bench.play(1) == [(7, ChannelOpened(2, True))]


def test_silence_does_not_answer_an_attempt():
    bench = Bench(Fault("silence", 5000))
    assert bench.opening == []
    assert bench.play(10) == []
    bench.channels.close(bench.channel)


def test_a_disconnect_breaks_connections_and_refuses_until_reconnect():
    bench = Bench(Fault("disconnect", 5000, at_s=0.02), Fault("reconnect", 5000, at_s=0.04))
    assert bench.play(4) == [(5, ChannelClosed(1, "connection reset by peer"))]
    bench.channels.open("h", 5000, 2.0)
    assert bench.play(1) == [(6, ChannelOpened(2, False, "connection refused", ChannelError.REFUSED))]
    bench.play(4)
    bench.channels.open("h", 5000, 2.0)
    assert bench.play(1) == [(11, ChannelOpened(3, True))]


def test_credit_is_given_for_what_is_lost_and_not_taken_for_what_is_doubled():
    bench = Bench(
        Fault("drop", 5000, direction="to_device", count=1), Fault("duplicate", 5000, direction="to_device", nth=2)
    )
    for data in (b"lost", b"twice"):
        bench.channels.send(bench.channel, data)
        events = [event for _, event in bench.play(4)]
        assert sum(event.size for event in events if isinstance(event, ChannelCredit)) == len(data)


def test_a_flood_through_drops_and_doubles_keeps_to_the_window():
    class Flood(TcpServer):
        port = 5000

        def opened(self, connection):
            connection.send(bytes(5 * CHANNEL_WINDOW))

    bench = Bench(Fault("drop", 5000, share=0.3), Fault("duplicate", 5000, share=0.3), devices=[Flood()], seed=3)
    unread = 0
    for _ in range(200):
        unread += sum(len(data) for _, data in bench.data(1))
        bench.channels.credit(bench.channel, unread)
        unread = 0
    assert bench.channels.next_tick(bench.tick) is None


def test_what_was_sent_before_a_close_still_leaves():
    seen = []

    class Server(TcpServer):
        port = 5000

        def received(self, connection, data):
            seen.append(data)

        def closed(self, connection):
            seen.append("closed")

    bench = Bench(Fault("delay", 5000, direction="to_device", delay_s=0.1), devices=[Server()])
    bench.channels.send(bench.channel, b"last")
    bench.channels.close(bench.channel)
    assert bench.play(100) == []
    assert seen == [b"last", "closed"]


def modbus_answer(**settings):
    bench = Bench(
        Fault("wrong_reply", 502, **settings), devices=[ModbusDevice(port=502, holding_registers=[7])], port=502
    )
    ((_, data),) = bench.say(tcp_frame(9, 1, read(3, 0, 1)))
    return TcpSplitter().feed(data)


def test_wrong_replies_of_modbus():
    assert modbus_answer(form="exception", code=6) == [(9, 1, b"\x83\x06")]
    assert modbus_answer(form="transaction") == [(10, 1, b"\x03\x02\x00\x07")]
    assert modbus_answer(form="unit") == [(9, 2, b"\x03\x02\x00\x07")]


TOOL = "tool_serial_config(True, 9600, 0, 1, 8, True)\n"


@pytest.mark.parametrize(
    "settings",
    [
        {"kind": "wrong_reply", "form": "checksum"},
        {"kind": "wrong_reply", "form": "unit"},
        {"kind": "wrong_reply", "form": "exception", "code": 2},
        {"kind": "corrupt", "direction": "to_robot"},
        {"kind": "drop", "direction": "to_robot"},
        {"kind": "silence"},
        {"kind": "disconnect"},
    ],
)
def test_on_a_line_one_message_is_met_and_the_next_is_whole(settings):
    body = "for n in range(3):\n  textmsg(tool_modbus_read_registers(1, 0, 1, 0.3))\n  sleep(0.1)\nend"
    once = {} if settings["kind"] in ("silence", "disconnect") else {"nth": 2, "count": 1}
    until = {"for_s": 0.2, "at_s": 0.1} if not once else {}
    device = ModbusDevice(line="tool", unit=1, holding_registers=[7])
    assert run(TOOL + body, device, faults=[Fault(on="tool", **settings, **once, **until)]).log == ["[7]", "[]", "[7]"]


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"form": "fault", "code": 4, "reply": "a < b"}, "fault 4: a < b"),
        ({"form": "http", "code": 500}, "500"),
    ],
)
def test_wrong_replies_of_xmlrpc(settings, words):
    class Server(XmlRpcServer):
        port = 8000

        def ready(self):
            return True

    body = 's = rpc_factory("xmlrpc", "http://h:8000")\ntry:\n  s.ready()\nexcept Exception as e:\n  textmsg(e)\nend'
    assert words in run(body, Server(), faults=[Fault("wrong_reply", 8000, **settings)]).log[0]


def test_a_line_has_faults_too():
    class Beacon(SerialDevice):
        line = "tool"

        def opened(self):
            self.every(0.1, lambda: self.send("0123456789"))

    world = World(devices=[Beacon()], faults=[Fault("duplicate", "tool", nth=2, count=1)])
    world.channels.arrivals(0)
    world.channels.open_line("tool", LineSettings(115200, 0, 1, 8))
    data = b"".join(
        event.data for tick in range(1, 80) for event in world.channels.arrivals(tick) if isinstance(event, ChannelData)
    )
    assert data.count(b"0123456789\n") >= 2
    assert len(data) == 4 * 11


def test_the_record_says_when_a_fault_acts_for_the_first_time():
    body = 'socket_open("h", 5000)\nfor n in range(3):\n  socket_send_string("x")\n  sleep(0.1)\nend'
    events = run(body, Echo(), faults=[Fault("delay", 5000, delay_s=0.1, at_s=0.05)]).events
    notes = [(event.tick, event.text) for event in events if type(event).__name__ == "DeviceNoted"]
    assert notes == [(26, "delay on port 5000 acts")]


def test_faults_come_and_go_while_a_world_lives():
    world = World(devices=[Echo()])
    world.fault("drop", 5000)
    with pytest.raises(UsageError, match="reconnect on 5000 has no disconnect"):
        world.fault("reconnect", 5000)
    world.channels.arrivals(0)
    channel = world.channels.open("h", 5000, 2.0)
    world.channels.arrivals(1)
    world.channels.send(channel, b"x")
    assert [event for tick in range(2, 6) for event in world.channels.arrivals(tick)] == [ChannelCredit(channel, 1)]
    world.end_faults()
    world.channels.send(channel, b"x")
    assert [event for tick in range(6, 9) for event in world.channels.arrivals(tick)][1] == ChannelData(channel, b"x")


def test_a_fault_that_comes_in_the_middle_of_a_message_does_not_go_by_one_that_has_ended():
    class Talker(SerialDevice):
        line = "tool"

        def opened(self):
            self.send(bytes(200))

    world = World(devices=[Talker()], faults=[Fault("drop", "tool", nth=9)])
    world.channels.arrivals(0)
    world.channels.open_line("tool", LineSettings(9600, 0, 1, 8))

    def heard(ticks):
        return sum(isinstance(event, ChannelData) for tick in ticks for event in world.channels.arrivals(tick))

    assert heard(range(1, 20)) > 10
    world.end_faults()
    world.fault("silence", "tool")
    assert heard(range(20, 80)) == 0


def test_without_a_network_there_is_nothing_to_break():
    from elitescript.devices.channels.faulty_channels import FaultyChannels
    from elitescript.devices.channels.machine_faults import channel_fault

    channels = FaultyChannels(NoChannels(), [channel_fault(Fault("drop", 5000))])
    assert channels.open("h", 5000, 2.0) == 0
    assert channels.open_line("tool", LineSettings(9600, 0, 1, 8)) == 0
    assert channels.next_tick(0) is None


def test_leaps_cannot_be_told_from_steps_with_faults():
    body = """
for n in range(8):
  socket_open("h", 5000)
  socket_send_line("abc")
  textmsg(socket_read_string("socket_0", "", "\\n", 0.3))
  socket_close()
  sleep(0.2)
end
"""
    faults = [
        Fault("delay", 5000, delay_s=0.05, share=0.5),
        Fault("corrupt", 5000, share=0.3),
        Fault("trickle", 5000, direction="to_robot", share=0.5),
        Fault("disconnect", 5000, at_s=0.9, for_s=0.3),
    ]
    leaps, steps = (run(body, Echo(), faults=faults, seed=5, steps=steps).events for steps in (False, True))
    assert leaps == steps


def test_a_robot_takes_faults_of_its_real_channels_before_its_time_begins():
    from elitescript import VirtualRobot

    robot = VirtualRobot("CS66")
    robot.fault("refuse", on=5000)
    found = run('textmsg(socket_open("127.0.0.1", 5000))', robot=robot)
    assert found.log == ["False"]
    assert not found.is_paced  # nobody has asked the real network
    robot.fault("drop", on=5001)
    with pytest.raises(UsageError, match="refuse on 'tool'"):
        robot.fault("refuse", on="tool")
    late = VirtualRobot("CS66")
    late.advance(0.1)
    with pytest.raises(UsageError, match="before its time begins"):
        late.fault("refuse", on=5000)


def test_a_robot_in_a_world_takes_faults_at_any_time():
    from tests.devices.programs import robot_in

    robot = robot_in(World(devices=[Echo()]))
    robot.advance(1.0)
    robot.fault("refuse", on=5000, for_s=1.0)
    assert run('textmsg(socket_open("h", 5000))\nsleep(1)\ntextmsg(socket_open("h", 5000))', robot=robot).log == [
        "False",
        "True",
    ]
