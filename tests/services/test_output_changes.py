"""Outputs as changes: what arrives is what was sent, and what is sent is checked."""

import struct
from dataclasses import replace
from math import inf
from random import Random

import pytest

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.values import CodecError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import RobotMode
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.inputs import RunUnit
from elitescript.said import said
from elitescript.services.child import frames
from elitescript.services.child.output_changes import OutputReader, OutputWriter
from elitescript.services.output_text import output_text
from tests.protocol.snapshots import output

PROGRAM = (
    "def p():\n  textmsg('on')\n  set_standard_digital_out(1, True)\n  movej([0.1, -1.4, -1.6, -1.5, 1.5, 0.2])\nend\n"
)


def sent(writer, reader, whole):
    letter, text = writer.message(whole)
    return letter, reader.read(letter, text)


def test_what_arrives_is_what_was_sent():
    kernel, writer, reader = Kernel(RobotOptions(power_on=True)), OutputWriter(), OutputReader()
    letters = []
    for tick in range(400):
        whole = kernel.tick_and_snapshot([RunUnit("primary#1", "program", PROGRAM)] if tick == 10 else ())
        letter, found = sent(writer, reader, whole)
        letters.append(letter)
        assert found == whole
        assert reader.text() == output_text(whole)
    assert letters == [frames.OUTPUT] + [frames.OUTPUT_CHANGES] * 399


def test_a_robot_at_rest_says_little():
    kernel, writer = Kernel(RobotOptions(power_on=True)), OutputWriter()
    sizes = [len(writer.message(kernel.tick_and_snapshot())[1]) for _ in range(100)]
    assert max(sizes[1:]) < sizes[0] / 8


def test_the_sign_of_a_zero_is_a_change():
    writer, reader = OutputWriter(), OutputReader()
    first = output(1)
    first = replace(first, snapshot=replace(first.snapshot, tcp_force=(0.0,) * 6))
    sent(writer, reader, first)
    second = replace(first, snapshot=replace(first.snapshot, tcp_force=(0.0,) * 5 + (-0.0,)))
    _, found = sent(writer, reader, second)
    assert repr(found.snapshot.tcp_force) == repr(second.snapshot.tcp_force)


def test_texts_keep_their_template_and_the_digest_has_the_text_alone():
    inner = said("{limit} is the limit", limit=3)
    text = said("{value:.1f} is too much: {why}", value=4, why=inner)
    alarm = Alarm(1, "R102", "ValueError", text, 1, 1, "main", "", {"hint": inner, "hints": [inner]})
    events = (Warned(1, text, hint=inner), alarm)
    details = {"hint": str(inner), "hints": [str(inner)]}
    plain = (Warned(1, str(text), hint=str(inner)), replace(alarm, text=str(text), details=details))
    for first in (True, False):
        writer, reader = OutputWriter(), OutputReader()
        if not first:
            sent(writer, reader, output(0))
        whole = replace(output(1), events=events)
        _, found = sent(writer, reader, whole)
        assert found == whole
        for event in found.events:
            assert event.text.template == "{value} is too much: {why}"
            assert event.text.values["why"].values == {"limit": 3}
        assert found.events[0].hint.template == inner.template
        assert found.events[1].details["hint"].template == inner.template
        assert found.events[1].details["hints"][0].template == inner.template
        assert reader.text() == output_text(whole) == output_text(replace(whole, events=plain))


def changes(rest=None, *, bits=0, numbers=b"", tick=2):
    """A message of changes."""
    return struct.pack("<qqQ", tick, tick, bits) + numbers + (b"" if rest is None else to_text(rest).encode())


TIME, MODE = 0, 1
"""Places of two fields of the robot's state: a number, and one that travels as JSON."""


def test_a_change_is_taken_by_its_place():
    reader = OutputReader()
    before = reader.read(*OutputWriter().message(output(1))).snapshot.robot
    after = reader.read(frames.OUTPUT_CHANGES, changes([[], [], [], [MODE, 5]], bits=1 << TIME, numbers=bytes(8)))
    assert after.snapshot.robot == replace(before, tick=2, time_s=0.0, robot_mode=RobotMode.IDLE)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        changes()[:-1],
        changes([]),
        changes([[], [], []]),
        changes([[], [], [], [], []]),
        changes([[], [], [], 0]),
        changes([[], [], [], {}]),
        changes([[], [], [], [MODE]]),
        changes([[], [], [], [TIME, 0.5]]),
        changes([[], [], [], [-1, 0]]),
        changes([[], [], [], [1000, 0]]),
        changes([[], [], [], [str(MODE), 7]]),
        changes([[], [], [], [True, 7]]),
        changes([[], [], [], [MODE, 99]]),
        changes([[], [], [], [MODE, "7"]]),
        changes([[], [], [], [MODE, 7, MODE]]),
        changes([[["Kernel"]], [], [], []]),
        changes([0, [], [], []]),
        changes({}),
        changes(tick=-1),
        changes(tick=2**62),
        changes() + b"[",
        changes() + b"\xff",
        changes(bits=1),
        changes(bits=1, numbers=bytes(47)),
        changes(bits=1, numbers=bytes(49)),
        changes(bits=1 << 63),
        changes(bits=2**64 - 1, numbers=bytes(4000)),
    ],
)
def test_what_makes_no_sense_is_refused(content):
    reader = OutputReader()
    reader.read(*OutputWriter().message(output(1)))
    with pytest.raises(CodecError):
        reader.read(frames.OUTPUT_CHANGES, content)


def test_any_bytes_are_an_output_or_refused():
    random = Random(7)
    writer = OutputWriter()
    whole = writer.message(output(1))
    first = output(1)
    later = writer.message(replace(first, snapshot=replace(first.snapshot, popup="a", tcp_force=(1.0,) * 6)))[1]
    refused = 0
    for _ in range(500):
        reader = OutputReader()
        reader.read(*whole)
        content = bytearray(later)
        for _ in range(random.randint(1, 4)):
            content[random.randrange(len(content))] = random.randrange(256)
        try:
            reader.read(frames.OUTPUT_CHANGES, bytes(content[: random.choice((len(content), 60))]))
        except CodecError:
            refused += 1
    assert 50 < refused < 500


def test_numbers_keep_every_bit():
    writer, reader = OutputWriter(), OutputReader()
    first = output(1)
    sent(writer, reader, first)
    numbers = (0.1, -0.0, 5e-324, inf, -inf, 1.7976931348623157e308)
    second = replace(first, snapshot=replace(first.snapshot, raw_wrench=numbers, io_current=1 / 3))
    _, found = sent(writer, reader, second)
    assert repr(found) == repr(second)
    assert reader.text() == output_text(second)


def test_changes_of_nothing_are_refused():
    with pytest.raises(CodecError, match="not sent"):
        OutputReader().read(frames.OUTPUT_CHANGES, changes())


def test_an_output_that_is_whole_begins_anew():
    reader = OutputReader()
    for tick in (1, 7):
        text = OutputWriter().message(output(tick))[1]
        assert reader.read(frames.OUTPUT, text).tick == from_text(text)[0] == tick
