"""A child that says anything at all: it is ended, and nothing else happens to the serving process."""

from __future__ import annotations

import random
from copy import deepcopy
from types import SimpleNamespace
from typing import Any

import pytest

from elitescript.codec import json_text
from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import field_shapes, shape_of
from elitescript.codec.values import CodecError
from elitescript.environment.memory import MemoryFiles
from elitescript.errors import ElitescriptError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.kernel.restart import restored_inputs, restored_options
from elitescript.messages.inputs import RunUnit
from elitescript.messages.outputs import Output
from elitescript.services.child import frames, output_changes
from elitescript.services.child.output_changes import OutputReader, OutputWriter
from elitescript.services.child.remote_files import FileDesk
from elitescript.services.options_data import options_data, options_from_data
from elitescript.services.output_text import output_text
from tests.protocol.snapshots import output
from tests.services.test_child_link import FakeChild, children, clock, with_link  # noqa: F401
from tests.services.test_untrusted_numbers import say_everywhere

SHAPE = shape_of(Output)
PROGRAM = 'def f():\n  textmsg("a")\n  socket_open("127.0.0.1", 1, "s")\n  nothing()\nend'


def outputs() -> list[Any]:
    """Outputs of a robot that moves, speaks and fails, as they are written."""
    kernel = Kernel(RobotOptions(power_on=True))
    begin = RunUnit("primary#1", "program", PROGRAM)
    found = [kernel.tick_and_snapshot(inputs) for inputs in ((), [begin], (), ())]
    return [from_text(output_text(output)) for output in found]


WHOLES = outputs()
LEAVES: tuple[Any, ...] = (
    None, True, 0, -1, 1, 10**400, -(2**63), 2**63, 0.5, "NaN", "Infinity", "", "x", "\ud800", "A" * 5000,
    [], [[]], [None], {}, {"x": 1}, ["float", "NaN"], ["list"], ["Do"], ["OpenChannel", 1, "tcp", "x" * 5000, 1, "NaN"],
)  # fmt: skip


def mutated(data: Any, chance: random.Random) -> Any:
    """The same with a few places changed: another value, one more, one less, two exchanged."""
    data = deepcopy(data)
    for _ in range(chance.randint(1, 3)):
        inner = data
        while True:
            places = list(range(len(inner))) if type(inner) is list else list(inner)
            deeper = [place for place in places if type(inner[place]) in (list, dict) and inner[place]]
            if deeper and chance.random() < 0.8:
                inner = inner[chance.choice(deeper)]
            else:
                break
        if not places:
            continue
        place, leaf = chance.choice(places), chance.choice(LEAVES)
        match chance.randrange(4):
            case 0:
                inner[place] = leaf
            case 1 if type(inner) is list:
                inner.insert(place, leaf)
            case 2:
                del inner[place]
            case _:
                other = chance.choice(places)
                inner[place], inner[other] = inner[other], inner[place]
    return data


@pytest.mark.parametrize("seed", range(12))
def test_any_structure_is_refused_or_can_be_served_and_gone_on_from(seed: int) -> None:
    chance = random.Random(seed)
    description = Kernel(RobotOptions()).description
    for _ in range(60):
        data = mutated(chance.choice(WHOLES), chance)
        try:
            text = to_text(data).encode()
            output = OutputReader().read(frames.OUTPUT, text)
        except (CodecError, UnicodeEncodeError):
            continue
        assert say_everywhere(data)
        if chance.random() < 0.1:
            goes_on_from(output, description)


def goes_on_from(output: Output, description: Any) -> None:
    config = restored_options(RobotOptions(), description, output.snapshot, 7)
    config = options_from_data(from_text(to_text(options_data(config))))
    Kernel(config).tick_and_snapshot(restored_inputs(output.snapshot))


@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", 1e308])
@pytest.mark.parametrize("field", ["q_actual", "speed_scale", "tcp_offset", "gravity", "payload", "signals"])
def test_a_robot_goes_on_from_a_picture_without_sense(field: str, value: Any) -> None:
    whole = deepcopy(WHOLES[0])
    snapshot, robot = whole[4], whole[4][0]
    names = list(field_shapes(type(SHAPE.decode(WHOLES[0]).snapshot.robot)))
    if field == "signals":
        signals = snapshot[list(field_shapes(type(SHAPE.decode(WHOLES[0]).snapshot))).index("signals")]
        for index, family in enumerate(signals):
            if type(family) is list and family and type(family[0]) is float:
                signals[index] = [value] * len(family)
    elif field == "payload":
        robot[names.index(field)] = [value, [value] * 3, [value] * 6]
    elif field == "speed_scale":
        robot[names.index(field)] = value
    else:
        place = names.index(field)
        robot[place] = [value] * len(robot[place])
    output = SHAPE.decode(whole)
    goes_on_from(output, Kernel(RobotOptions()).description)


class TestDesk:
    @pytest.mark.parametrize(
        "question",
        [
            ["read", 1, 10**400, 1],
            ["read", 10**400, 0, 1],
            ["read", 1, 0, -(10**400)],
            ["truncate", 1, 10**30],
            ["end", 2**63],
        ],
    )
    def test_numbers_that_no_file_has_are_no_question(self, question):
        desk = FileDesk(MemoryFiles({"a": b"x"}))
        assert desk.answer(["open", "a", "rb"]) == ["ok", 1]
        with pytest.raises(CodecError, match="too large"):
            desk.answer(question)

    @pytest.mark.parametrize("seed", range(4))
    def test_any_question_has_an_answer_or_is_none(self, seed):
        chance = random.Random(seed)
        desk = FileDesk(MemoryFiles({"a": b"x", "b/c": b"y"}))
        desk.answer(["open", "a", "r+b"])
        questions = [
            ["open", "a", "rb"], ["open", "n\0", "wb"], ["read", 1, 0, 5], ["write", 1, 3, "QUJD"], ["truncate", 1, 2],
            ["end", 1], ["close", 1], ["kind", "a"], ["size", "b"], ["names", "."], ["remove", "../x"],
            ["make_folder", "d"],
        ]  # fmt: skip
        for _ in range(500):
            try:
                answer = desk.answer(mutated(chance.choice(questions), chance))
            except CodecError:
                continue
            assert answer[0] in ("ok", "error")


class TestLink:
    @pytest.mark.parametrize("letter", [frames.DESCRIBED, frames.LOCKED_IN, frames.FAILED, frames.OUTPUT, "?"])
    def test_nothing_more_is_read_of_one_that_is_ended(self, children, letter, monkeypatch):  # noqa: F811
        read = []
        loads = json_text.json.loads

        async def body(link):
            await link.tick(())
            child = children[0]
            child.is_mute = True
            for _ in range(3):
                child.say(letter, b'["usage", "no"]')
            monkeypatch.setattr(json_text.json, "loads", lambda text, **how: read.append(text) or loads(text, **how))
            for _ in range(50):
                child.say(letter, b"[0]")
            assert read == []
            await link.tick(())
            assert child.is_killed
            assert link.restarts == 1

        with_link(body)

    @pytest.mark.parametrize("letter", [frames.OUTPUT, frames.QUESTION, frames.OUTPUT_CHANGES])
    @pytest.mark.parametrize("seed", range(3))
    def test_anything_said_ends_a_child_at_most(self, children, letter, seed):  # noqa: F811
        chance = random.Random(seed)

        async def body(link):
            await link.tick(())
            for _ in range(40):
                child = children[-1]
                child.is_mute = True
                await link.tick(())
                if child.is_killed:
                    continue
                try:
                    text = to_text(mutated(chance.choice(WHOLES), chance)).encode()
                except UnicodeEncodeError:
                    continue
                if letter == frames.OUTPUT_CHANGES:
                    text = chance.randbytes(chance.randint(0, 60)) + text[: chance.randint(0, len(text))]
                if letter != frames.QUESTION:
                    text = frames.answer_content(chance.choice((0, 5, -1, frames.NEVER)), text)
                child.say(letter, text)
                children[-1].is_mute = False
                await link.tick(())

        with_link(body, files=MemoryFiles({}))

    @pytest.mark.parametrize("announced, sent, is_killed", [(1, 1, False), (2, 1, True), (1, 2, True), (0, 1, True)])
    def test_rows_that_were_not_asked_for_end_a_child(self, children, announced, sent, is_killed):  # noqa: F811
        async def body(link):
            async def outlet() -> None:
                assert link._transport.unanswered[0].ahead == 1
                writer = OutputWriter()
                _, text = writer.message(output(1))
                children[0].say(frames.OUTPUT, frames.answer_content(0, text, rows=announced))
                for number in range(sent):
                    children[0].say(frames.ROW, writer.changes(output(2 + number)))

            await link.tick(())
            children[0].is_mute = True
            await link.tick((), asks_due=False, outlet=outlet)
            children[0].is_mute = False
            if not children[0].is_killed:
                children[0].tick = 2 + sent
                await link.tick(())
                await link.tick(())
            assert children[0].is_killed == is_killed

        with_link(body)

    @pytest.mark.parametrize("line", [2**40, -1, "5", 1.5, True])
    def test_a_line_that_no_program_has_ends_a_child(self, children, line):  # noqa: F811
        async def body(link):
            await link.tick(())
            child = children[0]
            child.is_mute = True
            await link.tick((), parts=0)
            number = link._transport.unanswered[0].number
            child.say(frames.RESULT, frames.answer_content(0, to_text([line, [number, [], [], []]])))
            await link.tick(())
            assert child.is_killed

        with_link(body)

    def test_when_none_comes_up_from_the_last_picture_one_begins_as_the_first_did(self, children, monkeypatch):  # noqa: F811
        async def body(link):
            await link.tick(())
            monkeypatch.setattr(FakeChild, "answer", lambda child, **_: child.end("poison"))
            with pytest.raises(ElitescriptError):
                for _ in range(2000):
                    await link.tick(())
            begun = [data for child in children for letter, data in child.told if letter == frames.BEGIN]
            assert [data["joints"] is None for data in begun] == [True, False, False, True, True, True]

        with_link(body)


class TestFlood:
    def test_too_many_events_are_refused_before_they_are_made(self):
        data = deepcopy(WHOLES[0])
        data[1] = [["TextMessage", 1, "x", "main", 1]] * 12_000
        reader, made = OutputReader(), []
        reader._shape = SimpleNamespace(decode=made.append)
        with pytest.raises(CodecError, match="12000 events"):
            reader.read(frames.OUTPUT, to_text(data).encode())
        assert made == []

    def test_too_many_values_are_refused_before_they_are_read(self):
        with pytest.raises(CodecError, match="more than 100000 values"):
            OutputReader().read(frames.OUTPUT, b"[" + b"0," * 200_000 + b"0]")

    def test_commas_in_texts_are_no_values(self):
        output_changes.check_values(to_text(["a," * 200_000 + '"\\', "b"]).encode())
