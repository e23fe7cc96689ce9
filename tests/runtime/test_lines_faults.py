"""Every MODBUS-RTU command with every way in which a slave and a line can fail."""

from __future__ import annotations

import pytest

from elitescript.messages.events import TextMessage
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import rtu_frame
from tests.runtime.line_bench import Slave, failure, kinds, ports, run, shown

SLAVE = "slave 1 on the serial port of the tool"


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
    slave.link.send(b"\xff\x00\xfe" * 60)


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


EVERYWHERE = [cut_short, noise, noise_before, noise_after]
"""What no fault of a channel does; every command with those is in `tests/faults/outcomes.toml`."""


@pytest.mark.parametrize(
    ("fault", "works", "why"),
    [(row[0], bool(row[1]), row[3]) for row in FAULTS if row[0] in EVERYWHERE],
    ids=[fault.__name__ for fault, *_ in FAULTS if fault in EVERYWHERE],
)
@kinds
@ports
def test_every_command_with_what_else_a_slave_can_say(
    prefix, name, config, kind, args, request_pdu, answer, result, fault, works, why
):
    class Given(Faulty):
        first = fault

    Given.answer = answer
    call = f"textmsg({prefix}{kind}({args}, 1.5))"
    done = run(f"{config}\n{call}\nsleep(0.5)\n{call}", Given, name=name)
    good = shown(prefix, kind, result)
    assert done.log == [good if works else failure(prefix, kind), good]
    assert [text.rpartition(": ")[2] for text in done.warnings] == ([why] if why else [])


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
