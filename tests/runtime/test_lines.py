"""Serial ports as programs see them: configuring, plain bytes, sharing, time, the end."""

from __future__ import annotations

import pytest

from elitescript.environment.memory import MemoryEnvironment
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW, NOT_CONNECTED, CloseChannel, OpenLine, SendChannel
from elitescript.runtime.connections.serial_line import close_lines
from tests.runtime.line_bench import TOOL, TOOL_RTU, Device, bench, program, run
from tests.runtime.machine import Bench

BOX = "/dev/ttymxc0"


def remote(body):
    """A program whose line is held by the test."""
    world = RequestEnvironment(MemoryEnvironment().files)
    return Bench(world=world).start(program(body)), world.channels


def tick(bench, *events):
    """One tick with what has happened outside."""
    for event in events:
        bench.host.channel_event(event)
    bench.host.run_tick(bench.machine.tick)
    bench.machine.tick += 1


class Echo(Device):
    """Sends back what it hears."""

    def received(self, data):
        super().received(data)
        self.link.send(data)


def talker(*sayings):
    """A device that says something at times after the line was opened; None breaks the line."""

    class Talker(Device):
        def opened(self):
            for after_s, data in sayings:
                act = self.link.close if data is None else lambda data=data: self.link.send(data)
                self.link.later(after_s, act)

    return Talker


class TestConfiguring:
    def test_the_ports_are_closed_at_first(self):
        rows = "textmsg(tool_serial_is_open(), serial_is_open())\ntextmsg(tool_serial_mode() + serial_mode())"
        assert run(rows, Echo).log == ["FalseFalse", "CLOSECLOSE"]

    @pytest.mark.parametrize(("is_modbus", "mode"), [(False, "RS485"), (True, "MODBUS-RTU")])
    def test_enabling_opens_them_in_their_mode(self, is_modbus, mode):
        body = f"""
        textmsg(tool_serial_config(True, 115200, 1, 2, 8, {is_modbus}))
        textmsg(tool_serial_is_open(), tool_serial_mode())
        textmsg(tool_serial_config(False, 115200, 1, 2, 8, {is_modbus}))
        textmsg(tool_serial_is_open(), tool_serial_mode())
        """
        assert run(body, Echo).log == ["True", f"True{mode}", "False", "FalseCLOSE"]

    def test_firmware_2_10_writes_the_plain_mode_as_its_manual_prints_it(self):
        rows = "textmsg({}(True, 9600, 0, 1, 8, False), {}())"
        tool = rows.format("tool_serial_config", "tool_serial_mode")
        assert run(tool, Echo, firmware="2.10").log == ["TrueRS-485"]
        assert run(tool, Echo).log == ["TrueRS485"]
        box = rows.format("serial_config", "serial_mode")
        assert run(box, Echo, name=BOX, firmware="2.10").log == ["TrueRS-485"]
        modbus = "textmsg(tool_serial_config(True, 9600, 0, 1, 8, True), tool_serial_mode())"
        assert run(modbus, Echo, firmware="2.10").log == ["TrueMODBUS-RTU"]

    @pytest.mark.parametrize(("is_modbus", "mode"), [(False, "RS485"), (True, "MODBUS-RTU")])
    def test_the_control_box_says_true_when_disabling(self, is_modbus, mode):
        body = f"""
        textmsg(serial_config(True, 2400, 2, 1, 8, {is_modbus}))
        textmsg(serial_is_open(), serial_mode())
        textmsg(serial_config(False, 2400, 2, 1, 8, {is_modbus}))
        textmsg(serial_is_open(), serial_mode())
        """
        assert run(body, Echo, name=BOX).log == ["True", f"True{mode}", "True", "FalseCLOSE"]

    @pytest.mark.parametrize(
        ("call", "name", "settings"),
        [
            ("tool_serial_config(True, 2000000, 2, 1, 7)", "tool", LineSettings(2_000_000, 2, 1, 7)),
            ("tool_serial_config(True, 9600, 0, 1, 7, True)", "tool", LineSettings(9600, 0, 1, 8)),
            ("serial_config(True, 500000, 1, 2, 7)", BOX, LineSettings(500_000, 1, 2, 7)),
            ("masterboard_serial_config(True, 9600, 0, 1)", BOX, LineSettings(9600, 0, 1, 8)),
            ("serial_config(True, 9600, 0, 1, port='/dev/ttyS2')", "/dev/ttyS2", LineSettings(9600, 0, 1, 8)),
        ],
    )
    def test_the_line_gets_its_settings(self, call, name, settings):
        bench, channels = remote(call)
        tick(bench)
        assert channels.take() == (OpenLine(1, name, settings),)

    def test_seven_bits_are_not_for_modbus_and_change_nothing(self):
        body = """
        serial_config(True, 9600, 0, 1, 7)
        textmsg(serial_config(True, 9600, 0, 1, 7, True), serial_mode())
        """
        done = run(body, Echo, name=BOX)
        assert done.log == ["FalseRS485"]
        assert done.warnings == ["serial_config: size must be 8 bit with modbus_rtu, got 7; nothing was changed"]

    def test_the_ports_have_nothing_to_do_with_each_other(self):
        body = f"""
        {TOOL}
        textmsg(serial_is_open(), serial_is_open("/dev/ttyS2"))
        tool_serial_write("x")
        textmsg(serial_write("x"))
        """
        assert run(body, Echo).log == ["FalseFalse", "False"]

    def test_older_firmware_has_one_port_in_the_box(self):
        done = run("textmsg(serial_mode('/dev/ttyS2'))", firmware="2.10")
        assert (done.alarms[0].code, done.alarms[0].details["limit"]) == ("R102", BOX)

    def test_configuring_anew_drops_what_waits(self):
        body = f"""
        {TOOL}
        sleep(0.1)
        textmsg({TOOL})
        textmsg(tool_serial_read(5, True, 0.04))
        """
        assert run(body, talker((0.05, b"old"))).log == ["True", "[]"]

    def test_a_port_stays_configured_when_the_program_ends(self):
        one = bench(Echo).start(program(TOOL)).run()
        assert one.ends == ["finished"]
        one.start(program('tool_serial_write("a")\ntextmsg(tool_serial_mode(), tool_serial_read(1, True, 1))')).run()
        assert one.log == ["RS485[97]"]

    def test_a_controller_that_starts_anew_closes_its_ports(self):
        one = bench(Echo).start(program(TOOL)).run()
        close_lines(one.host.background.lines, one.host.connections)
        one.start(program("textmsg(tool_serial_mode())")).run()
        assert one.log == ["CLOSE"]
        assert one.host.connections == {}

    def test_closing_tells_the_device(self):
        class Heard(Device):
            pass

        run(f"{TOOL}\ntool_serial_config(False, 9600, 0, 1)", Heard)
        assert [what for what, _ in Heard.log] == ["closed"]

    def test_a_port_with_nothing_on_it_is_open_and_silent(self):
        body = f"""
        textmsg({TOOL})
        textmsg(tool_serial_write("abc"), tool_serial_read(1, True, 0.1))
        textmsg(tool_serial_mode())
        """
        done = run(body)
        assert done.log == ["True", "3[]", "RS485"]
        assert done.warnings == ["nothing is connected to the serial port of the tool: it is open, and silent"]
        assert done.machine.tick == 25

    def test_it_is_the_same_where_the_answer_comes_later(self):
        one, channels = remote(f"textmsg({TOOL})\ntextmsg(tool_serial_is_open())")
        tick(one)
        tick(one, ChannelOpened(1, False, NOT_CONNECTED, ChannelError.NOTHING_BOUND))
        assert one.log == ["True", "True"]
        assert one.host.connections == {}
        assert channels.take() == (OpenLine(1, "tool", LineSettings(115200, 0, 1, 8)),)

    def test_a_device_that_cannot_be_opened_says_why(self):
        one, _ = remote(f"textmsg({TOOL})\ntextmsg(tool_serial_is_open())\ntextmsg({TOOL})")
        tick(one)
        tick(one, ChannelOpened(1, False, "permission denied"))
        tick(one, ChannelOpened(2, False, "permission denied"))
        assert one.log == ["False", "False", "False"]
        assert one.warnings == ["the serial port of the tool cannot be opened: permission denied"]
        assert one.host.connections == {}

    def test_a_device_that_does_not_answer_is_given_up(self):
        one, channels = remote(f"textmsg({TOOL})")
        one.run(until=499)
        assert one.log == []
        one.run(until=500)
        assert one.log == ["False"]
        assert channels.take() == (OpenLine(1, "tool", LineSettings(115200, 0, 1, 8)), CloseChannel(1))

    def test_a_program_that_is_stopped_meanwhile_leaves_it_closed(self):
        one, channels = remote(TOOL)
        tick(one)
        one.host.stop("")
        tick(one)
        assert channels.take()[1:] == (CloseChannel(1),)
        assert not one.host.background.lines["tool"].is_open
        assert one.host.connections == {}

    def test_the_last_of_two_threads_that_configure_it_has_it(self):
        body = f"""
        def other():
          textmsg("other", {TOOL_RTU})
        end
        start_thread(other, ())
        textmsg("main", {TOOL})
        sleep(0.1)
        textmsg(tool_serial_mode())
        """
        done = run(body, Echo)
        assert sorted(done.log) == ["MODBUS-RTU", "mainFalse", "otherTrue"]
        assert done.warnings == [
            "the serial port of the tool cannot be opened: it was configured by another thread meanwhile"
        ]

    def test_a_device_that_goes_closes_the_port(self):
        body = f"""
        {TOOL}
        textmsg(tool_serial_read(5, False, 0))
        textmsg(tool_serial_is_open(), tool_serial_mode(), tool_serial_write("x"))
        textmsg({TOOL}, tool_serial_mode())
        """
        done = run(body, talker((0.05, b"ab"), (0.1, None)))
        assert done.log == ["b'ab'", "FalseCLOSE0", "TrueRS485"]
        assert done.warnings == ["the serial port of the tool is closed: its device has gone"]

    def test_the_reason_is_told(self):
        one, _ = remote(f"{TOOL}\nsleep(0.004)\ntextmsg(tool_serial_write('x'))")
        tick(one)
        tick(one, ChannelOpened(1, True))
        tick(one, ChannelClosed(1, "device was unplugged"))
        assert one.log == ["0"]
        assert one.warnings == ["the serial port of the tool is closed: device was unplugged"]


class TestDaemon:
    CONFIG = "tool_serial_config(True, 115200, 0, 1, 8, {}, 1)"

    @pytest.mark.parametrize(("is_modbus", "mode"), [(False, "RS485"), (True, "MODBUS-RTU")])
    def test_its_port_is_open_without_a_line(self, is_modbus, mode):
        one, channels = remote(f"textmsg({self.CONFIG.format(is_modbus)}, tool_serial_is_open(), tool_serial_mode())")
        tick(one)
        assert one.log == [f"TrueTrue{mode}"]
        assert channels.take() == ()

    @pytest.mark.parametrize(
        "call",
        [
            "tool_serial_read(1, True, 1)",
            "tool_serial_read(0, True, 1)",
            "tool_serial_write('x')",
            "tool_modbus_read_registers(1, 0, 1)",
            "tool_modbus_read_bits(1, 0, 1)",
            "tool_modbus_read_input_registers(1, 0, 1)",
            "tool_modbus_read_input_bits(1, 0, 1)",
            "tool_modbus_write_registers(1, 0, 1)",
            "tool_modbus_write_bits(1, 0, 1)",
            "tool_modbus_write_single_register(1, 0, 1)",
            "tool_modbus_write_single_bit(1, 0, 1)",
        ],
    )
    @pytest.mark.parametrize("is_modbus", [True, False])
    def test_programs_that_use_it_get_an_alarm(self, call, is_modbus):
        done = run(f"{self.CONFIG.format(is_modbus)}\n{call}", Echo)
        (alarm,) = done.alarms
        assert (alarm.code, alarm.class_name, alarm.line) == ("R123", "PermissionError", 3)
        why = "the serial port of the tool belongs to a daemon (usage 1); programs may not use it"
        assert alarm.text == f"{call.partition('(')[0]}: {why}"

    def test_programs_can_take_it_back(self):
        body = f'{self.CONFIG.format(False)}\n{TOOL}\ntool_serial_write("a")\ntextmsg(tool_serial_read(1, True, 1))'
        assert run(body, Echo).log == ["[97]"]

    def test_it_can_be_switched_off(self):
        body = f"{self.CONFIG.format(False)}\ntool_serial_config(False, 9600, 0, 1)\ntextmsg(tool_serial_mode())"
        assert run(body, Echo).log == ["CLOSE"]


class TestReading:
    def test_numbers_or_bytes(self):
        body = f"{TOOL}\ntextmsg(tool_serial_read(2, True, 1))\ntextmsg(tool_serial_read(2, False, 1))"
        assert run(body, talker((0.0, b"\x00\xffab"))).log == ["[0, 255]", "b'ab'"]

    def test_the_box_reads_numbers_for_a_tenth_of_a_second_unless_told_otherwise(self):
        body = """
        serial_config(True, 115200, 0, 1)
        textmsg(serial_read(2))
        textmsg(serial_read(2, False, 1))
        """
        done = run(body, talker((0.0, b"a"), (0.2, b"bc")), name=BOX)
        assert done.log == ["[97]", "b'bc'"]
        assert done.ticks[-1] == 52

    def test_what_has_come_when_time_is_up(self):
        body = f"{TOOL}\ntextmsg(tool_serial_read(5, True, 0.1))\ntextmsg(tool_serial_read(5, True, 0.2))"
        done = run(body, talker((0.05, b"ab"), (0.25, b"c")))
        assert done.log == ["[97, 98]", "[99]"]
        assert done.machine.tick == 1 + 25 + 50

    @pytest.mark.parametrize("time_out", [0, -1])
    def test_without_a_time_out_it_waits_for_ever(self, time_out):
        body = f"{TOOL}\ntextmsg(tool_serial_read(2, True, {time_out}))"
        assert run(body, talker((0.1, b"a"), (50.0, b"b"))).log == ["[97, 98]"]

    def test_and_can_be_stopped(self):
        one = bench(talker()).start(program(f"{TOOL}\ntool_serial_read(2, True, 0)")).run()
        assert one.host.threads()[0].waits_for == "2 bytes on the serial port of the tool"
        one.host.stop("")
        one.run()
        assert one.ends == ["stopped"]
        one.start(program("textmsg(tool_serial_read(1, True, 0.1))")).run()
        assert one.log == ["[]"]

    def test_no_bytes_come_at_once(self):
        done = run(f"{TOOL}\ntextmsg(tool_serial_read(0, True, 0), tool_serial_read(0, False, 0))", talker())
        assert done.log == ["[]b''"]

    def test_more_than_may_be_on_the_way(self):
        size = CHANNEL_WINDOW + 5000
        body = f"tool_serial_config(True, 2000000, 0, 1)\ntextmsg(len(tool_serial_read({size}, False, 0)))"
        assert run(body, talker((0.0, b"x" * size))).log == [str(size)]

    def test_a_secondary_program_looks_once(self):
        one = bench(talker((0.04, b"ab"))).start(program(f"{TOOL}\nsleep(0.1)")).run(until=3)
        one.secondary("sec s():\n  textmsg(tool_serial_read(5, True, 0))\nend\n").run(until=20)
        assert one.log == ["[]"]
        one.secondary("sec s():\n  textmsg(tool_serial_read(5, True, 0))\nend\n").run()
        assert one.log == ["[]", "[97, 98]"]

    @pytest.mark.parametrize("call", ["tool_serial_read(3, {}, 1)", "serial_read(3, {}, 1)"])
    @pytest.mark.parametrize(("is_number", "result"), [(True, "[]"), (False, "b''")])
    def test_a_closed_port_gives_nothing_after_one_tick(self, call, is_number, result):
        done = run(f"textmsg({call.format(is_number)})", talker())
        assert done.log == [result]
        assert done.machine.tick == 1
        name = "of the tool" if call.startswith("tool") else BOX
        assert done.warnings == [f"the serial port {name} is not enabled"]

    def test_so_does_a_port_in_the_other_mode(self):
        done = run(f"{TOOL_RTU}\ntextmsg(tool_serial_read(1, True, 1))", talker((0.0, b"abc")))
        assert done.log == ["[]"]
        assert done.warnings == ["the serial port of the tool is in mode MODBUS-RTU, not RS485"]

    def test_flushing_drops_what_has_come(self):
        body = """
        serial_config(True, 115200, 0, 1)
        sleep(0.1)
        textmsg(serial_flush())
        textmsg(serial_read(5, False, 0.2))
        """
        assert run(body, talker((0.05, b"old"), (0.2, b"new")), name=BOX).log == ["None", "b'new'"]

    def test_flushing_a_closed_port_does_no_harm(self):
        done = run("serial_flush()\nserial_flush()")
        assert done.warnings == [f"the serial port {BOX} is not enabled"]


class TestWriting:
    @pytest.mark.parametrize(
        ("value", "sent"),
        [
            ("'hello'", b"hello"),
            ("'\\u00e9'", b"\xc3\xa9"),
            ("'\\ud800'", b"?"),
            ("255", b"\xff"),
            ("256", b"\x00"),
            ("-1", b"\xff"),
            ("True", b"\x01"),
            ("[255, 0, 10]", b"\xff\x00\n"),
            ("(1, 300, -2)", b"\x01\x2c\xfe"),
            ("b'a\\x00'", b"a\x00"),
            ("bytearray(b'xyz')", b"xyz"),
        ],
    )
    def test_what_goes_out(self, value, sent):
        class Heard(Device):
            pass

        body = f"""
        {TOOL}
        serial_config(True, 115200, 0, 1)
        textmsg(tool_serial_write({value}), serial_write({value}))
        sleep(0.1)
        """
        assert run(body, Heard).log == [f"{len(sent)}True"]
        assert Heard.bytes() == sent

    def test_nothing_to_send(self):
        body = f"{TOOL}\nserial_config(True, 115200, 0, 1)\ntextmsg(tool_serial_write([]), serial_write(''))"
        assert run(body, Echo).log == ["0True"]

    def test_a_closed_port_sends_nothing(self):
        done = run("textmsg(tool_serial_write('x'), serial_write('x'))", Echo)
        assert done.log == ["0False"]

    def test_neither_does_one_in_the_other_mode(self):
        class Heard(Device):
            pass

        done = run(f"{TOOL_RTU}\ntextmsg(tool_serial_write('x'))\nsleep(0.1)", Heard)
        assert (done.log, Heard.bytes()) == (["0"], b"")

    def test_it_waits_for_room(self):
        one, channels = remote(f"{TOOL}\ntextmsg(tool_serial_write(b'x' * {CHANNEL_WINDOW + 10}))")
        tick(one)
        tick(one, ChannelOpened(1, True))
        assert channels.take()[1:] == (SendChannel(1, b"x" * CHANNEL_WINDOW),)
        assert one.log == []
        tick(one, ChannelCredit(1, 100))
        assert channels.take() == (SendChannel(1, b"x" * 10),)
        assert one.log == [str(CHANNEL_WINDOW + 10)]

    def test_a_port_that_closes_meanwhile_says_how_much_has_left(self):
        one, _ = remote(f"{TOOL}\ntextmsg(tool_serial_write(b'x' * {CHANNEL_WINDOW + 10}))")
        tick(one)
        tick(one, ChannelOpened(1, True))
        tick(one, ChannelClosed(1))
        assert one.log == [str(CHANNEL_WINDOW)]

    def test_a_secondary_program_does_not_wait(self):
        one, channels = remote(f"{TOOL}\nsleep(1)")
        tick(one)
        tick(one, ChannelOpened(1, True))
        text = f"sec s():\n  textmsg(tool_serial_write(b'x' * {CHANNEL_WINDOW + 10}))\n"
        one.secondary(text + "  textmsg(tool_serial_write(b'y' * 70000))\n  textmsg(tool_serial_write('z'))\nend\n")
        tick(one)
        assert one.log == [str(CHANNEL_WINDOW + 10), "70000", "0"]
        channels.take()
        tick(one, ChannelCredit(1, CHANNEL_WINDOW))
        assert channels.take() == (SendChannel(1, b"x" * 10 + b"y" * (CHANNEL_WINDOW - 10)),)


class TestSharing:
    def test_readers_take_turns(self):
        body = f"""
        def reader(name):
          textmsg(name, tool_serial_read(3, False, 0))
        end
        {TOOL}
        start_thread(reader, ("one ",))
        start_thread(reader, ("two ",))
        sleep(1)
        """
        assert run(body, talker((0.1, b"abcd"), (0.2, b"ef"))).log == ["one b'abc'", "two b'def'"]

    def test_a_reader_whose_turn_does_not_come_in_time_has_nothing(self):
        body = f"""
        def reader():
          textmsg(tool_serial_read(3, False, 0.2))
        end
        {TOOL}
        start_thread(reader, ())
        sleep(0.02)
        textmsg(tool_serial_read(3, False, 0.1))
        sleep(0.1)
        """
        assert run(body, talker((0.05, b"ab"))).log == ["b''", "b'ab'"]

    def test_a_reader_that_is_stopped_gives_its_turn_away(self):
        body = f"""
        def reader():
          tool_serial_read(3, False, 0)
        end
        {TOOL}
        t = start_thread(reader, ())
        sleep(0.02)
        stop_thread(t)
        textmsg(tool_serial_read(3, False, 1))
        """
        assert run(body, talker((0.1, b"abc"))).log == ["b'abc'"]

    def test_one_that_waits_for_its_turn_can_be_stopped(self):
        body = f"""
        def reader():
          tool_serial_read(3, False, 0)
        end
        {TOOL}
        a = start_thread(reader, ())
        b = start_thread(reader, ())
        sleep(0.02)
        stop_thread(b)
        stop_thread(a)
        textmsg(tool_serial_read(3, False, 1))
        """
        assert run(body, talker((0.1, b"abc"))).log == ["b'abc'"]

    def test_a_thread_that_waits_for_bytes_does_not_keep_others_from_sending(self):
        body = f"""
        def reader():
          textmsg(tool_serial_read(3, False, 0))
        end
        {TOOL}
        start_thread(reader, ())
        sleep(0.02)
        tool_serial_write("abc")
        sleep(0.1)
        """
        assert run(body, Echo).log == ["b'abc'"]


class TestTime:
    BODY = """
    tool_serial_config(True, 9600, 0, 1)
    tool_serial_write("x" * 96)
    textmsg(len(tool_serial_read(96, False, 0)))
    """

    def test_a_line_takes_as_long_as_its_speed_says(self):
        done = run(self.BODY, Echo)
        # A tenth of a second there; the first bytes are on their way back meanwhile, the last ones follow by a tick.
        assert done.log == ["96"]
        assert 0.1 <= (done.machine.tick - 1) / 250 <= 0.1 + 0.012

    def test_leaping_is_the_same_as_stepping(self):
        steps, leaps = run(self.BODY, Echo, steps=True), run(self.BODY, Echo)
        assert steps.trace == leaps.trace
        assert len(leaps.ticks) < len(steps.ticks) or leaps.ticks == steps.ticks

    def test_data_that_comes_while_no_program_runs_waits(self):
        one = bench(talker((0.1, b"ab"))).start(program(TOOL)).run()
        one.start(program("textmsg(tool_serial_read(2, False, 0.1))")).run()
        assert one.log == ["b'ab'"]

    def test_what_comes_late_is_nobodys(self):
        read = "textmsg(tool_serial_read(1, True, 0.1))"
        one, _ = remote(f"{TOOL}\ntool_serial_config(False, 9600, 0, 1)\n{TOOL}\n{read}")
        tick(one)
        tick(one, ChannelOpened(1, True))
        tick(one, ChannelOpened(2, True), ChannelData(1, b"x"))
        one.run()
        assert one.log == ["[]"]
