"""MODBUS-RTU as programs see it: every command, sharing, silence, time."""

from __future__ import annotations

import pytest

from elitescript.environment.memory import MemoryEnvironment
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.messages.inputs import ChannelClosed, ChannelData, ChannelOpened
from elitescript.messages.outputs import SendChannel
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import rtu_frame
from tests.runtime.line_bench import (
    BOX,
    TOOL,
    TOOL_RTU,
    Device,
    Slave,
    bench,
    failure,
    kinds,
    ports,
    program,
    run,
    shown,
    slave,
)
from tests.runtime.machine import Bench

SLAVE = "slave 1 on the serial port of the tool"


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
    def test_a_call_without_a_time_out_waits_for_its_transaction(self):
        given = slave((1, pdu.write_register(0, 5)), (1, pdu.registers_read(3, [5])))
        main = program(f"{TOOL_RTU}\nsleep(2)")
        one = bench(given, steps=True).start(main)
        one.run(until=3)
        one.secondary(
            "sec s():\n  textmsg(tool_modbus_write_single_register(1, 0, 5))\n"
            "  textmsg(tool_modbus_read_registers(1, 0, 1))\nend\n"
        ).run()
        assert one.log == ["1", "[5]"]
        assert [what for what, _ in given.log] == [pdu.write_register(0, 5), pdu.read(3, 0, 1)]
        assert one.warnings == []

    @pytest.mark.parametrize(
        "call", ["tool_modbus_read_registers(1, 0, 1, 5)", "tool_modbus_read_registers(1, 0, 1, time_out=5.0)"]
    )
    def test_a_call_with_a_time_out_looks_once(self, call):
        given = slave((1, pdu.registers_read(3, [5])))
        one = bench(given, steps=True).start(program(f"{TOOL_RTU}\nsleep(2)")).run(until=3)
        one.secondary(f"sec s():\n  textmsg({call})\nend\n").run()
        assert one.log == ["[]"]
        assert one.warnings == [f"{SLAVE}: no answer in time"]

    def test_without_an_answer_it_goes_on_within_its_second(self):
        one = bench(slave(), steps=True).start(program(f"{TOOL_RTU}\nsleep(9)")).run(until=3)
        text = "sec s():\n  textmsg(tool_modbus_read_registers(1, 0, 1))\nend\n"
        one.secondary(text).run()
        assert one.log == ["[]"]
        assert one.warnings == [f"{SLAVE}: no answer in time"]

    def test_a_second_call_without_an_answer_looks_once(self):
        one = bench(slave(), steps=True).start(program(f"{TOOL_RTU}\nsleep(9)")).run(until=3)
        call = "  textmsg(tool_modbus_read_registers(1, 0, 1))\n"
        one.secondary(f"sec s():\n{call}{call}end\n").run()
        assert one.log == ["[]", "[]"]
        assert not any("stopped after" in text for text in one.warnings)

    def test_it_waits_for_another_thread_and_then_asks(self):
        given = slave()
        main = program(f"{TOOL_RTU}\ntool_modbus_read_registers(1, 0, 1, 0.2)")
        one = bench(given, steps=True).start(main).run(until=3)
        one.secondary("sec s():\n  textmsg(tool_modbus_write_single_register(1, 0, 5))\nend\n").run()
        assert one.log == ["0"]
        assert len(given.log) == 2

    def test_with_a_time_out_it_asks_nothing_while_another_thread_does(self):
        given = slave()
        main = program(f"{TOOL_RTU}\ntool_modbus_read_registers(1, 0, 1, 0.2)")
        one = bench(given, steps=True).start(main).run(until=3)
        one.secondary("sec s():\n  textmsg(tool_modbus_write_single_register(1, 0, 5, 1))\nend\n").run()
        assert one.log == ["0"]
        assert len(given.log) == 1

    def test_it_can_configure_a_port(self):
        one = bench(slave()).secondary(f"sec s():\n  textmsg({TOOL_RTU})\nend\n").run()
        assert one.log == ["True"]
        assert one.host.background.lines["tool"].is_open


class TestSilence:
    def remote(self, body):
        bench = Bench(world=RequestEnvironment(MemoryEnvironment().files)).start(program(body))
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
