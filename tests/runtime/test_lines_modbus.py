"""MODBUS-RTU as programs see it: every command with every way in which a slave and a line can fail."""

from __future__ import annotations

import pytest

from elitescript.messages.events import TextMessage
from elitescript.messages.inputs import ChannelClosed, ChannelData, ChannelOpened
from elitescript.messages.outputs import SendChannel
from elitescript.modbus import pdu
from elitescript.modbus.rtu_frames import rtu_frame
from elitescript.worlds.memory import MemoryWorld
from elitescript.worlds.request_channels import RequestWorld
from tests.runtime.line_bench import TOOL, TOOL_RTU, Device, Slave, bench, program, run, slave
from tests.runtime.machine import Bench

BOX = "/dev/ttymxc0"
BOX_RTU = "serial_config(True, 115200, 0, 1, 8, True)"
SLAVE = "slave 1 on the serial port of the tool"

KINDS = [
    ("read_registers", "1, 2, 3", pdu.read(3, 2, 3), pdu.registers_read(3, [7, 0, 65535]), [7, 0, 65535]),
    ("read_bits", "1, 2, 10", pdu.read(1, 2, 10), pdu.bits_read(1, [1, 0] * 5), [1, 0] * 5),
    ("read_input_registers", "1, 2, 1", pdu.read(4, 2, 1), pdu.registers_read(4, [9]), [9]),
    ("read_input_bits", "1, 0, 3", pdu.read(2, 0, 3), pdu.bits_read(2, [0, 1, 1]), [0, 1, 1]),
    ("write_registers", "1, 2, [5, 6]", pdu.write_registers(2, [5, 6]), pdu.write_registers(2, [5, 6])[:5], 2),
    ("write_registers", "1, 2, 5", pdu.write_registers(2, [5]), pdu.write_registers(2, [5])[:5], 1),
    ("write_bits", "1, 2, [1, False, 7]", pdu.write_coils(2, [1, 0, 1]), pdu.write_coils(2, [1, 0, 1])[:5], 3),
    ("write_bits", "1, 2, True", pdu.write_coils(2, [1]), pdu.write_coils(2, [1])[:5], 1),
    ("write_single_bit", "1, 2, 1", pdu.write_coil(2, 1), pdu.write_coil(2, 1), 1),
    ("write_single_bit", "1, 2, 0", pdu.write_coil(2, 0), pdu.write_coil(2, 0), 1),
    ("write_single_bit", "1, 2, -3", pdu.write_coil(2, 1), pdu.write_coil(2, 1), 1),
    ("write_single_register", "1, 2, 300", pdu.write_register(2, 300), pdu.write_register(2, 300), 1),
]
"""Command without its prefix, arguments, request, answer, result."""

PORTS = [("tool_modbus_", "tool", TOOL_RTU), ("serial_modbus_", BOX, BOX_RTU)]

ports = pytest.mark.parametrize(("prefix", "name", "config"), PORTS, ids=["tool", "box"])
kinds = pytest.mark.parametrize(
    ("kind", "args", "request_pdu", "answer", "result"), KINDS, ids=[f"{row[0]}({row[1]})" for row in KINDS]
)


def shown(prefix, kind, result):
    """A result as `textmsg` writes it: for several values the tool says whether, the box how many."""
    return str(bool(result)) if prefix == "tool_modbus_" and kind in ("write_registers", "write_bits") else str(result)


def failure(prefix, kind):
    """What a command returns when it fails."""
    return shown(prefix, kind, [] if kind.startswith("read") else 0)


@kinds
@ports
class TestEveryCommand:
    def test_asks_and_returns_what_the_slave_says(self, prefix, name, config, kind, args, request_pdu, answer, result):
        given = slave((1, answer))
        done = run(f"{config}\ntextmsg({prefix}{kind}({args}))", given, name=name)
        assert done.log == [shown(prefix, kind, result)]
        assert [what for what, _ in given.log] == [request_pdu]
        assert done.warnings == []

    def test_gives_up_when_time_is_up(self, prefix, name, config, kind, args, request_pdu, answer, result):
        done = run(f"{config}\ntextmsg({prefix}{kind}({args}, 0.1))", slave(), name=name)
        assert done.log == [failure(prefix, kind)]
        assert done.machine.tick == 1 + 25
        assert done.warnings[0].endswith(": no answer in time")

    def test_waits_for_five_seconds_unless_told_otherwise(
        self, prefix, name, config, kind, args, request_pdu, answer, result
    ):
        done = run(f"{config}\n{prefix}{kind}({args})", slave(), name=name)
        assert done.machine.tick == 1 + 1250

    def test_waits_for_ever_if_told_so_and_can_be_stopped(
        self, prefix, name, config, kind, args, request_pdu, answer, result
    ):
        one = bench(slave(), name=name).start(program(f"{config}\n{prefix}{kind}({args}, 0)")).run()
        assert one.host.threads()[0].waits_for.startswith("the answer of slave 1 on the serial port")
        one.host.stop("")
        one.run()
        assert one.ends == ["stopped"]

    def test_fails_when_the_slave_refuses(self, prefix, name, config, kind, args, request_pdu, answer, result):
        given = slave((1, pdu.exception(request_pdu[0], pdu.ILLEGAL_ADDRESS)))
        done = run(f"{config}\ntextmsg({prefix}{kind}({args}))", given, name=name)
        assert done.log == [failure(prefix, kind)]
        assert done.warnings[0].endswith("it refuses: exception 2: illegal data address")
        assert done.machine.tick < 10

    def test_fails_in_one_tick_on_a_closed_port(self, prefix, name, config, kind, args, request_pdu, answer, result):
        done = run(f"textmsg({prefix}{kind}({args}))", slave((1, answer)), name=name)
        assert (done.log, done.machine.tick) == ([failure(prefix, kind)], 1)
        assert done.warnings[0].endswith(" is not enabled")

    def test_fails_in_one_tick_on_a_port_in_the_other_mode(
        self, prefix, name, config, kind, args, request_pdu, answer, result
    ):
        plain = config.replace(", 8, True", "")
        done = run(f"{plain}\ntextmsg({prefix}{kind}({args}))", slave((1, answer)), name=name)
        assert (done.log, done.machine.tick) == ([failure(prefix, kind)], 2)
        assert done.warnings[0].endswith(" is in mode RS485, not MODBUS-RTU")


class Faulty(Slave):
    """Answers the first request by `first`, later ones as they should be."""

    request = pdu.read(3, 0, 1)
    answer = pdu.registers_read(3, [7])
    echoes = False

    def received(self, data):
        if self.echoes:
            self.link.send(data)
        super().received(data)

    def __init__(self, link):
        super().__init__(link)
        self.left = [b"first", rtu_frame(1, self.answer)]

    def reply(self, answer):
        if answer == b"first":
            self.first(rtu_frame(1, self.answer))
        else:
            self.link.send(answer)

    def first(self, frame):
        """What is said instead of the frame."""


def wrong_checksum(slave, frame):
    slave.link.send(frame[:-1] + bytes((frame[-1] ^ 1,)))


def wrong_slave(slave, frame):
    slave.link.send(rtu_frame(2, frame[1:-2]))


def wrong_function(slave, frame):
    slave.link.send(rtu_frame(1, pdu.bits_read(1, [1])))


def other_count(slave, frame):
    slave.link.send(rtu_frame(1, pdu.registers_read(3, [1, 2])))


def cut_short(slave, frame):
    slave.link.send(frame[:-2])


def silence(slave, frame):
    pass


def noise(slave, frame):
    slave.link.send(bytes(range(200)))


def noise_before(slave, frame):
    slave.link.send(b"\x00\x01\x03\xff\x01" + frame)


def noise_after(slave, frame):
    slave.link.send(frame + b"\xff\x00\x01\x03")


def trickle(slave, frame):
    for index, byte in enumerate(frame):
        slave.link.later(0.1 + 0.1 * index, lambda byte=byte: slave.link.send(bytes((byte,))))


def after_a_late_one(slave, frame):
    slave.link.send(rtu_frame(1, pdu.registers_read(3, [1, 2])))
    slave.link.later(0.8, lambda: slave.link.send(frame))


def late(slave, frame):
    slave.link.later(1.2, lambda: slave.link.send(frame[:3] + b"\x00\x63" + rtu_frame(1, b"\x03\x02\x00\x63")[-2:]))


def twice(slave, frame):
    slave.link.send(frame + frame)


FAULTS = [
    # What the slave does, first result, seconds until then, and the reason in the log.
    (wrong_checksum, [], 0.5, "its answer is broken"),
    (wrong_slave, [], 1.0, "no answer in time"),
    (wrong_function, [], 1.0, "no answer in time"),
    (other_count, [], 1.0, "no answer in time"),
    (cut_short, [], 0.5, "its answer is broken"),
    (silence, [], 1.0, "no answer in time"),
    (noise, [], 1.0, "no answer in time"),
    (late, [], 1.0, "no answer in time"),
    (noise_before, [7], 0.0, ""),
    (noise_after, [7], 0.0, ""),
    (trickle, [7], 0.7, ""),
    (after_a_late_one, [7], 0.8, ""),
    (twice, [7], 0.0, ""),
]


@pytest.mark.parametrize(("fault", "result", "after_s", "why"), FAULTS, ids=[row[0].__name__ for row in FAULTS])
@pytest.mark.parametrize("echoes", [False, True], ids=["", "echo"])
class TestFaults:
    BODY = """
    tool_serial_config(True, 115200, 0, 1, 8, True)
    textmsg(tool_modbus_read_registers(1, 0, 1, 1))
    sleep({})
    textmsg(tool_modbus_read_registers(1, 0, 1, 1))
    """

    def test_what_comes_of_them(self, fault, result, after_s, why, echoes):
        class Given(Faulty):
            first = fault

        Given.echoes = echoes
        done = run(self.BODY.format(0.004), Given)
        first, second = done.log
        assert first == str(result)
        said = next(event.tick for event in done.machine.events if isinstance(event, TextMessage))
        taken_s = (said - 1) / 250
        assert after_s <= taken_s <= after_s + 0.03
        assert done.warnings == ([f"{SLAVE}: {why}"] if why else [])
        if fault is not late:
            assert second == "[7]"

    def test_the_next_request_is_not_disturbed(self, fault, result, after_s, why, echoes):
        class Given(Faulty):
            first = fault

        Given.echoes = echoes
        assert run(self.BODY.format(0.5), Given).log[1] == "[7]"

    def test_without_a_time_out_a_broken_answer_does_not_hang(self, fault, result, after_s, why, echoes):
        class Given(Faulty):
            first = fault

        Given.echoes = echoes
        body = self.BODY.format(0.5).replace("0, 1, 1)", "0, 1, 0)")
        done = run(body, Given, until=2000)
        hangs = why == "no answer in time"
        assert len(done.log) == (0 if hangs and fault is not late else 2)


class TestEcho:
    WRITE = """
    tool_serial_config(True, 115200, 0, 1, 8, True)
    textmsg(tool_modbus_read_registers(1, 0, 1, 1))
    textmsg(tool_modbus_write_single_register(1, 0, 5, 0.2))
    textmsg(tool_modbus_read_registers(1, 0, 1, 1))
    """

    @pytest.mark.parametrize(("is_heard", "result"), [(True, "1"), (False, "0")])
    def test_an_echo_does_not_pass_for_an_answer_once_the_line_is_known_to_have_one(self, is_heard, result):
        class Given(Slave):
            answers = (
                rtu_frame(1, pdu.registers_read(3, [7])),
                rtu_frame(1, pdu.write_register(0, 5)) if is_heard else b"",
                rtu_frame(1, pdu.registers_read(3, [8])),
            )

            def received(self, data):
                self.link.send(data)
                super().received(data)

        assert run(self.WRITE, Given).log == ["[7]", result, "[8]"]

    def test_what_follows_shows_that_an_answer_was_an_echo(self):
        class Given(Slave):
            answers = (rtu_frame(1, pdu.write_coil(0, 1)), b"")

            def received(self, data):
                self.link.send(data)
                super().received(data)

            def reply(self, answer):
                self.link.later(0.02, lambda: self.link.send(answer))

        body = """
        tool_serial_config(True, 115200, 0, 1, 8, True)
        textmsg(tool_modbus_write_single_bit(1, 0, 1, 0.2))
        sleep(0.1)
        textmsg(tool_modbus_write_single_bit(1, 0, 1, 0.2))
        """
        assert run(body, Given).log == ["1", "0"]


class TestSharing:
    def test_threads_take_turns_and_no_request_is_torn(self):
        class Given(Slave):
            def __init__(self, link):
                super().__init__(link)
                self.left = [b""] * 12

            def reply(self, answer):
                request = pdu.request_of(self.log[-1][0])
                frame = rtu_frame(1, pdu.registers_read(3, [request.address] * request.quantity))
                self.link.later(0.02, lambda: self.link.send(frame))

        body = """
        def worker(address):
          for n in range(4):
            v = tool_modbus_read_registers(1, address, 2)
            if v != [address, address]:
              textmsg("wrong", v)
            end
          end
          textmsg(address)
        end
        tool_serial_config(True, 19200, 0, 1, 8, True)
        for a in range(3):
          start_thread(worker, (a,))
        end
        sleep(2)
        """
        done = run(body, Given)
        assert done.log == ["0", "1", "2"]
        assert [pdu.request_of(what).address for what, _ in Given.log] == [0, 1, 2] * 4

    def test_waiting_for_a_turn_counts(self):
        body = f"""
        def worker():
          textmsg("worker", tool_modbus_read_registers(1, 0, 1, 1))
        end
        {TOOL_RTU}
        start_thread(worker, ())
        sleep(0.02)
        textmsg("main", tool_modbus_read_registers(1, 0, 1, 0.1))
        sleep(1)
        """
        done = run(body, slave())
        assert done.log == ["main[]", "worker[]"]
        assert done.warnings == [f"{SLAVE}: another thread asks a slave", f"{SLAVE}: no answer in time"]

    def test_a_thread_that_is_stopped_gives_its_turn_away(self):
        body = f"""
        def worker():
          tool_modbus_read_registers(1, 5, 1, 0)
        end
        {TOOL_RTU}
        t = start_thread(worker, ())
        sleep(0.02)
        stop_thread(t)
        textmsg(tool_modbus_read_registers(1, 0, 1, 1))
        """
        assert run(body, slave(b"", (1, pdu.registers_read(3, [7])))).log == ["[7]"]

    def test_a_port_that_is_configured_anew_ends_the_request(self):
        body = f"""
        def worker():
          textmsg(tool_modbus_read_registers(1, 5, 1, 0))
        end
        {TOOL_RTU}
        start_thread(worker, ())
        start_thread(worker, ())
        sleep(0.02)
        {TOOL}
        sleep(0.1)
        """
        done = run(body, slave())
        assert done.log == ["[]", "[]"]
        assert done.warnings == [f"{SLAVE}: the port was closed"]


class TestSecondaryPrograms:
    def test_the_request_goes_out_and_nobody_waits_for_the_answer(self):
        given = slave((1, pdu.write_register(0, 5)), (1, pdu.registers_read(3, [5])))
        main = program(f"{TOOL_RTU}\nsleep(0.1)\ntextmsg(tool_modbus_read_registers(1, 0, 1))")
        one = bench(given, steps=True).start(main)
        one.run(until=3)
        one.secondary("sec s():\n  textmsg(tool_modbus_write_single_register(1, 0, 5))\nend\n").run()
        assert one.log == ["0", "[5]"]
        assert [what for what, _ in given.log] == [pdu.write_register(0, 5), pdu.read(3, 0, 1)]

    def test_it_asks_nothing_while_another_thread_does(self):
        given = slave()
        main = program(f"{TOOL_RTU}\ntool_modbus_read_registers(1, 0, 1, 0.2)")
        one = bench(given, steps=True).start(main).run(until=3)
        one.secondary("sec s():\n  textmsg(tool_modbus_write_single_register(1, 0, 5))\nend\n").run()
        assert one.log == ["0"]
        assert len(given.log) == 1

    def test_it_can_configure_a_port(self):
        one = bench(slave()).secondary(f"sec s():\n  textmsg({TOOL_RTU})\nend\n").run()
        assert one.log == ["True"]
        assert one.host.lines["tool"].is_open


class TestSilence:
    def remote(self, body):
        bench = Bench(world=RequestWorld(MemoryWorld().files)).start(program(body))
        channels = bench.host._world.channels
        self.tick(bench)
        channels.take()
        self.tick(bench, ChannelOpened(1, True))
        return bench, channels

    @staticmethod
    def tick(bench, *events):
        for event in events:
            bench.host.channel_event(event)
        bench.host.run_tick(bench.machine.tick)
        bench.machine.tick += 1

    @pytest.mark.parametrize(("baud", "ticks"), [(115200, 1), (9600, 1), (4800, 2), (2400, 4)])
    def test_a_request_waits_for_three_and_a_half_characters_of_silence(self, baud, ticks):
        config = f"serial_config(True, {baud}, 0, 1, 8, True)"
        one, channels = self.remote(f"{config}\nsleep(0.1)\nserial_modbus_read_registers(1, 0, 1, 1)")
        for _ in range(24):
            self.tick(one)
        self.tick(one, ChannelData(1, b"noise"))
        for _ in range(ticks):
            assert channels.take() == ()
            self.tick(one)
        assert channels.take() == (SendChannel(1, rtu_frame(1, pdu.read(3, 0, 1))),)

    def test_a_line_that_is_never_silent_ends_in_time(self):
        one, channels = self.remote(f"{TOOL_RTU}\ntextmsg(tool_modbus_read_registers(1, 0, 1, 0.1))")
        channels.take()
        one, channels = self.remote(f"{TOOL_RTU}\nsleep(0.004)\ntextmsg(tool_modbus_read_registers(1, 0, 1, 0.1))")
        for _ in range(30):
            self.tick(one, ChannelData(1, b"~"))
        assert one.log == ["[]"]
        assert one.warnings == [f"{SLAVE}: the line is not silent"]
        assert channels.take() == ()

    def test_a_line_that_breaks_ends_the_request(self):
        one, _ = self.remote(f"{TOOL_RTU}\ntextmsg(tool_modbus_read_registers(1, 0, 1, 0))")
        self.tick(one, ChannelClosed(1, "device was unplugged"))
        assert one.log == ["[]"]
        assert one.warnings == [f"{SLAVE}: device was unplugged"]

    def test_the_request_after_one_that_was_given_up_waits_until_that_has_left(self):
        body = """
        serial_config(True, 2400, 0, 1, 8, True)
        serial_modbus_write_registers(1, 0, [0] * 100, 0.1)
        serial_modbus_read_registers(1, 0, 1, 2)
        """

        class Heard(Device):
            pass

        run(body, Heard, name=BOX)
        request_s = (100 * 2 + 9) * 10 / 2400
        after = [at for what, at in Heard.log if at > request_s + 0.006]
        assert after[0] >= request_s + 3.5 * 10 / 2400


@pytest.mark.parametrize(("baud", "count"), [(9600, 42), (115200, 84)])
def test_so_many_registers_can_be_asked_for_in_a_second(baud, count):
    """The line alone would allow 44 and 208; whole ticks make a poll 24 and 12 ms long."""

    class Given(Slave):
        def received(self, data):
            for _ in self.splitter.feed(data):
                self.link.send(rtu_frame(1, pdu.registers_read(3, [7])))

    body = f"""
    import time
    n = 0
    serial_config(True, {baud}, 0, 1, 8, True)
    start = time.time()
    while time.time() - start < 0.999:
      serial_modbus_read_registers(1, 0, 1)
      n = n + 1
    end
    textmsg(n)
    """
    assert run(body, Given, name=BOX).log == [str(count)]
