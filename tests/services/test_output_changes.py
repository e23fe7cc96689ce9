"""Outputs as changes: what arrives is what was sent, and what is sent is checked."""

from dataclasses import replace

import pytest

from elitescript.kernel import Kernel, KernelConfig
from elitescript.messages.codec import from_text, to_text
from elitescript.messages.inputs import RunUnit
from elitescript.messages.outputs import Output
from elitescript.messages.shapes import CodecError
from elitescript.services import frames
from elitescript.services.config_codec import full_codec, output_text
from elitescript.services.output_changes import OutputReader, OutputWriter
from tests.protocol.snapshots import output

CODEC = full_codec()
PROGRAM = (
    "def p():\n  textmsg('on')\n  set_standard_digital_out(1, True)\n  movej([0.1, -1.4, -1.6, -1.5, 1.5, 0.2])\nend\n"
)


def sent(writer, reader, whole):
    letter, text = writer.message(whole)
    return letter, reader.read(letter, text.encode())


def test_what_arrives_is_what_was_sent():
    kernel, writer, reader = Kernel(KernelConfig(power_on=True)), OutputWriter(CODEC), OutputReader(CODEC)
    letters = []
    for tick in range(400):
        whole = kernel.tick([RunUnit("primary#1", "program", PROGRAM)] if tick == 10 else ())
        letter, found = sent(writer, reader, whole)
        letters.append(letter)
        assert found == whole
        assert reader.text() == output_text(CODEC.shape(Output), whole)
    assert letters == [frames.OUTPUT] + [frames.OUTPUT_CHANGES] * 399


def test_a_robot_at_rest_says_little():
    kernel, writer = Kernel(KernelConfig(power_on=True)), OutputWriter(CODEC)
    sizes = [len(writer.message(kernel.tick())[1]) for _ in range(100)]
    assert max(sizes[1:]) < sizes[0] / 8


def test_the_sign_of_a_zero_is_a_change():
    writer, reader = OutputWriter(CODEC), OutputReader(CODEC)
    first = output(1)
    first = replace(first, snapshot=replace(first.snapshot, tcp_force=(0.0,) * 6))
    sent(writer, reader, first)
    second = replace(first, snapshot=replace(first.snapshot, tcp_force=(0.0,) * 5 + (-0.0,)))
    _, found = sent(writer, reader, second)
    assert repr(found.snapshot.tcp_force) == repr(second.snapshot.tcp_force)


@pytest.mark.parametrize(
    "data",
    [
        [],
        [2, [], [], [], [], []][:5],
        [2, [], [], [], 0, []],
        [2, [], [], [], [3], []],
        [2, [], [], [], [0, []], []],
        [2, [], [], [], [-1, 0], []],
        [2, [], [], [], [1000, 0], []],
        [2, [], [], [], ["1", 0], []],
        [2, [], [], [], [True, 0], []],
        [2, [], [], [], [1, [1.0]], []],
        [2, [], [], [], [], [0, "tick"]],
        [2, [["Kernel"]], [], [], [], []],
        ["2", [], [], [], [], []],
        {},
    ],
)
def test_what_makes_no_sense_is_refused(data):
    reader = OutputReader(CODEC)
    letter, text = OutputWriter(CODEC).message(output(1))
    reader.read(letter, text.encode())
    with pytest.raises(CodecError):
        reader.read(frames.OUTPUT_CHANGES, to_text(data).encode())


def test_changes_of_nothing_are_refused():
    with pytest.raises(CodecError, match="not sent"):
        OutputReader(CODEC).read(frames.OUTPUT_CHANGES, b"[1,[],[],[],[],[]]")


def test_an_output_that_is_whole_begins_anew():
    reader = OutputReader(CODEC)
    for tick in (1, 7):
        text = OutputWriter(CODEC).message(output(tick))[1]
        assert reader.read(frames.OUTPUT, text.encode()).tick == from_text(text)[0] == tick
