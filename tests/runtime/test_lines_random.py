"""Random programs on serial lines with random devices: nothing hangs, nothing breaks, every run is the same."""

from __future__ import annotations

import random

import pytest

from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import RtuSplitter, rtu_frame
from tests.runtime.line_bench import Device, run

CALLS = (
    "tool_modbus_read_registers(1, {a}, {n}, {t})",
    "tool_modbus_read_bits(1, {a}, {n}, {t})",
    "tool_modbus_write_registers(1, {a}, [1] * {n}, {t})",
    "tool_modbus_write_bits(1, {a}, [1] * {n}, {t})",
    "tool_modbus_write_single_register(1, {a}, {n}, {t})",
    "tool_modbus_write_single_bit(1, {a}, 1, {t})",
    "tool_serial_read({n}, True, {t})",
    "tool_serial_write([{a}] * {n})",
    "tool_serial_config(True, {baud}, 0, 1, 8, {rtu})",
    "tool_serial_mode()",
    "sleep({t})",
)


class Wild(Device):
    """Answers as it should, or does anything else."""

    draw: random.Random

    def __init__(self, link):
        super().__init__(link)
        self.splitter = RtuSplitter(is_slave=True)

    def opened(self):
        if self.draw.random() < 0.3:
            self.link.later(self.draw.uniform(0.1, 1.0), self.chatter)

    def chatter(self):
        self.link.send(self.draw.randbytes(self.draw.randrange(1, 40)))
        self.link.later(self.draw.uniform(0.001, 0.4), self.chatter)

    def received(self, data):
        super().received(data)
        if self.draw.random() < 0.1:
            self.link.send(data)
        for frame in self.splitter.feed(data):
            self.answer(frame)

    def answer(self, frame):
        request = pdu.request_of(frame.pdu)
        if request.function in (1, 2):
            answer = pdu.bits_read(request.function, [1] * request.quantity)
        elif request.function in (3, 4):
            answer = pdu.registers_read(request.function, [7] * request.quantity)
        else:
            answer = frame.pdu[:5]
        data = rtu_frame(1, answer)
        draw = self.draw
        match draw.randrange(12):
            case 0:
                return
            case 1:
                data = bytes((data[0] ^ 1 << draw.randrange(8),)) + data[1:]
            case 2:
                data = data[: draw.randrange(len(data))]
            case 3:
                data = draw.randbytes(draw.randrange(20)) + data
            case 4:
                data = rtu_frame(1, pdu.exception(request.function, draw.randrange(1, 12)))
            case 5:
                data = rtu_frame(2, answer)
            case 6:
                self.link.close()
                return
        self.link.later(draw.choice((0.0, 0.0, 0.02, 0.3)), lambda: self.link.send(data))


def random_program(draw):
    """Two threads that call anything, and complain about calls that take longer than they may."""

    def calls(count):
        for _ in range(count):
            t = draw.choice((0.02, 0.1, 0.25))
            call = draw.choice(CALLS).format(
                a=draw.randrange(200),
                n=draw.randrange(1, 30),
                t=t,
                baud=draw.choice((9600, 115200)),
                rtu=draw.random() < 0.7,
            )
            # Opening takes two ticks; a line of 9600 baud takes a write of 30 bytes at once.
            yield f"  check({call!r}, lambda: {call}, {t})\n"

    return (
        "import time\n"
        "def check(name, call, longest):\n"
        "  start = time.time()\n"
        "  value = call()\n"
        "  if time.time() - start > longest + 0.0085:\n"
        '    textmsg("late: ", name, time.time() - start)\n'
        "  end\n"
        "  textmsg(name, value)\n"
        "end\n"
        "def other():\n" + "".join(calls(25)) + "end\n"
        "tool_serial_config(True, 115200, 0, 1, 8, True)\n"
        "thread = start_thread(other, ())\n" + "".join(line[2:] for line in calls(25)) + "join_thread(thread)\n"
    )


@pytest.mark.parametrize("seed", range(25))
def test_nothing_hangs_and_every_run_is_the_same(seed):
    def outcome(**options):
        class Given(Wild):
            draw = random.Random(seed)

        done = run(random_program(random.Random(1000 + seed)), Given, **options)
        assert done.ends == ["finished"]
        assert done.alarms == []
        return done.trace, Given.log

    first = outcome()
    assert not [text for _, _, text in first[0] if text.startswith("late")]
    assert outcome() == first
    assert outcome(steps=True) == first
