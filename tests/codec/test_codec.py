"""Every message there and back; nothing else comes out, whatever goes in."""

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from enum import IntEnum
from math import copysign, inf, isnan, nan
from random import Random
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

import pytest

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.codec.values import CodecError, with_parts, without_parts
from elitescript.messages import events, faults, inputs, machine, motion, outcomes, outputs, snapshot, state, yielding
from elitescript.messages.enums import AnalogDomain, RobotMode
from elitescript.messages.events import Alarm, Event, Printed, SignalChanged, Warned
from elitescript.messages.faults import ChannelFault
from elitescript.messages.inputs import ChannelData, Do, Input, PlayTask, RunUnit
from elitescript.messages.line import LineSettings
from elitescript.messages.machine import SetTcp, WriteSignal
from elitescript.messages.outputs import NOT_WRITTEN, ChannelRequest, Output
from elitescript.messages.plant import PlantConfig
from elitescript.messages.signals import SIGNALS, Signal
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.said import said
from tests.protocol.snapshots import output

IMAGE = [field.name for field in fields(Snapshot)].index("signals")
MODULES = (events, faults, inputs, machine, motion, outcomes, outputs, snapshot, state, yielding)
MESSAGES = sorted(
    {
        kind
        for module in MODULES
        for kind in vars(module).values()
        if isinstance(kind, type) and is_dataclass(kind) and kind.__module__.startswith("elitescript.messages")
    },
    key=lambda kind: kind.__name__,
)


class Maker:
    """Makes a random value of any type that a message may hold."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)

    def make(self, kind: Any) -> Any:
        random = self.random
        if kind is float:
            return random.choice([random.uniform(-1e3, 1e3), 0.0, 5e-324, 1e300, 0.1])
        if kind is int:
            return random.choice([0, 1, 7, 100])
        if kind is bool:
            return random.random() < 0.5
        if kind is str:
            return random.choice(["", "a", "prüfen", "\u4e2d\u0000\u2028", '"\\\n'])
        if kind is bytes:
            return random.randbytes(random.randrange(20))
        if kind is Any:
            return random.choice([1, "x", None, True, 2.5, [1, (2, "b")], {"a": [0.5]}])
        origin, parts = get_origin(kind), get_args(kind)
        if origin is tuple:
            if parts[-1] is Ellipsis:
                return tuple(self.make(parts[0]) for _ in range(random.randrange(4)))
            return tuple(map(self.make, parts))
        if origin in (dict, Mapping):
            return {f"key{number}": self.make(parts[1]) for number in range(3)}
        if origin is UnionType:
            return self.make(random.choice(parts))
        if kind is NoneType:
            return None
        if issubclass(kind, IntEnum):
            return random.choice(list(kind))
        return self.message(kind)

    def level(self, row: Signal, kind: type) -> Any:
        value = self.make(kind)
        return min(value, row.high) if kind is int and row.high is not None else value

    def message(self, kind: type) -> Any:
        if kind.__name__ == "PlantConfig":
            return kind(lag_s=0.01, seed=3)
        if kind is LineSettings:
            return kind(9600, self.random.randrange(3), 2, 8)
        hints = get_type_hints(kind)
        written = [field.name for field in fields(kind) if field.metadata != NOT_WRITTEN]
        values = {name: self.make(hints[name]) for name in written}
        if kind is Snapshot:
            kinds = {"bool": bool, "int": int, "float": float}
            values["domains"] = {
                name: tuple(self.random.choice(list(AnalogDomain)) for _ in range(SIGNALS[name].size))
                for name in ("standard_analog_in", "standard_analog_out", "tool_analog_in", "tool_analog_out")
            }
            values["signals"] = {
                name: tuple(self.level(row, kinds[row.kind]) for _ in range(row.size)) for name, row in SIGNALS.items()
            }
        if kind is ChannelFault:
            values["chunk"] = self.random.randrange(1, 9)
        if kind is RunUnit:
            values["kind"] = self.random.choice(inputs.UNIT_KINDS)
        return kind(**values)


def there_and_back(value: Any, kind: Any) -> Any:
    shape = shape_of(kind)
    return shape.decode(from_text(to_text(shape.encode(value))))


class TestMessages:
    @pytest.mark.parametrize("kind", [Random, object, set, complex, list[int], tuple[Random, ...], int | Random])
    def test_other_types_have_no_shape(self, kind):
        with pytest.raises(TypeError, match="is no message"):
            shape_of(kind)

    def test_keys_are_texts(self):
        with pytest.raises(TypeError, match="keys of a message are texts"):
            shape_of(dict[int, int])

    def test_a_shape_is_made_once(self):
        assert shape_of(Input) is shape_of(Input)
        assert shape_of(Output) is shape_of(Output)

    def test_a_field_that_is_not_written_has_its_default(self):
        output = replace(Maker(1).message(Output), parts=3)
        assert len(shape_of(Output).encode(output)) == 5
        assert there_and_back(output, Output) == replace(output, parts=ALL_PARTS)


class TestRoundTrip:
    @pytest.mark.parametrize("kind", MESSAGES, ids=lambda k: k.__name__)
    def test_gives_the_same_message(self, kind):
        for seed in range(10):
            value = Maker(seed).message(kind)
            back = there_and_back(value, kind)
            assert back == value
            assert repr(back) == repr(value)

    def test_a_member_of_a_union_keeps_its_class(self):
        for value in (PlayTask("a"), Do("b", WriteSignal("flag", 3, True)), ChannelData(1, b"\0\xff")):
            assert there_and_back(value, Input) == value

    @pytest.mark.parametrize("value", [True, 1, 1.0, -0.0, 0.1])
    def test_keeps_the_kind_of_a_number_and_every_bit(self, value):
        back = there_and_back(SignalChanged(0, "flag", value), SignalChanged).value
        assert type(back) is type(value)
        assert repr(back) == repr(value)

    def test_keeps_what_is_not_finite_in_strict_json(self):
        message = SetTcp((nan, inf, -inf, -0.0, 1.0, 2.0))
        text = to_text(shape_of(SetTcp).encode(message))
        json.loads(text, parse_constant=pytest.fail)
        back = there_and_back(message, SetTcp).offset
        assert isnan(back[0])
        assert back[1:3] == (inf, -inf)
        assert copysign(1.0, back[3]) == -1.0

    def test_enumerations_come_back_as_such(self):
        back = there_and_back(output(robot_mode=RobotMode.IDLE), Output)
        assert back.snapshot.robot.robot_mode is RobotMode.IDLE
        assert type(back.snapshot.signals["flag"][0]) is bool

    def test_whole_numbers_become_floats_where_floats_are_meant(self):
        assert repr(there_and_back(SetTcp((0, 0, 0, 0, 0, 1)), SetTcp).offset[5]) == "1.0"

    def test_what_is_no_text_becomes_text(self):
        assert there_and_back(Printed(1, "a\ud800b", "main", 1), Printed).text == r"a\ud800b"

    def test_objects_among_the_details_are_named_and_not_asked(self):
        class Trap:
            def __repr__(self) -> str:
                raise AssertionError("was asked")

        alarm = Alarm(1, "R100", "X", "", 1, 1, "main", "", {"value": Trap(), "big": 10**5000, "nan": nan})
        details = there_and_back(alarm, Alarm).details
        assert details["value"] == "<Trap>"
        assert details["big"] == "<int>"
        assert isnan(details["nan"])


def refused(kind: Any, data: Any) -> str:
    with pytest.raises(CodecError) as caught:
        shape_of(kind).decode(data)
    return str(caught.value)


class TestRefusal:
    def test_names_an_unknown_class(self):
        assert "Reboot2" in refused(Input, ["Reboot2", "x"])

    def test_of_a_class_that_is_registered_but_does_not_belong(self):
        assert "is expected" in refused(Input, ["Printed", 1, "x", "main", 1])

    @pytest.mark.parametrize("data", [None, 3, "PlayTask", {}, [], [["PlayTask"]], [None, "a"]])
    def test_of_what_is_no_member(self, data):
        assert "is expected" in refused(Input, data)

    @pytest.mark.parametrize("data", [["RunUnit", "a", "b", "c"], ["RunUnit", "a", "b", "c", 1, 2]])
    def test_of_the_wrong_number_of_fields(self, data):
        assert "4 fields" in refused(Input, data)

    @pytest.mark.parametrize(
        ("index", "value"), [(0, 1), (0, None), (3, 1.0), (3, True), (3, "1"), (3, 2**63), (3, 10**4000), (2, "\ud800")]
    )
    def test_names_the_field(self, index, value):
        data = shape_of(RunUnit).encode(RunUnit("a", "program", "x", 1))
        data[index] = value
        assert refused(RunUnit, data).startswith("RunUnit." + ("origin", "kind", "text", "first_line")[index])

    @pytest.mark.parametrize("value", ["nan", "1.0", 1, True, None, [1.0]])
    def test_of_what_is_no_float(self, value):
        assert "SetTcp.offset" in refused(SetTcp, [[value, 0.0, 0.0, 0.0, 0.0, 0.0]])

    @pytest.mark.parametrize("length", [0, 5, 7])
    def test_of_a_tuple_of_the_wrong_length(self, length):
        assert "list of 6" in refused(SetTcp, [[0.0] * length])

    @pytest.mark.parametrize("value", ["a", "===", "\u00e9", 3, None])
    def test_of_what_is_no_base64(self, value):
        assert "base64" in refused(ChannelData, [1, value])

    def test_of_a_signal_image_with_other_families_or_sizes(self):
        data = shape_of(Output).encode(output())
        image = data[4][IMAGE]
        assert len(image) == len(SIGNALS)
        for index, wrong in ((0, "01"), (0, "2" * 16), (12, [2**31] * 48), (12, [0.5] * 48), (13, [0.0] * 47)):
            broken = [*image[:index], wrong, *image[index + 1 :]]
            assert "Snapshot.signals" in refused(Snapshot, [*data[4][:IMAGE], broken, *data[4][IMAGE + 1 :]])
        assert "list of" in refused(Snapshot, [*data[4][:IMAGE], image[1:], *data[4][IMAGE + 1 :]])

    def test_of_numbers_that_do_not_fit_the_packets(self):
        whole = output()
        data = shape_of(Snapshot).encode(replace(whole.snapshot, tool_analog_mode=256))
        assert "[0, 255]" in refused(Snapshot, data)

    def test_of_no_member_of_an_enumeration(self):
        data = shape_of(Snapshot).encode(output().snapshot)
        data[0][2] = 99
        assert "RobotMode" in refused(Snapshot, data)

    def test_of_details_that_are_too_deep(self):
        deep: Any = 1
        for _ in range(50):
            deep = ["list", deep]
        data = shape_of(Alarm).encode(Alarm(1, "R100", "X", "", 1, 1, "main"))
        assert "plain value" in refused(Alarm, [*data[:-1], {"a": deep}])

    def test_of_values_that_the_class_itself_refuses(self):
        data = shape_of(PlantConfig).encode(PlantConfig())
        assert "lag_s" in refused(PlantConfig, [5.0, *data[1:]])


class TestText:
    @pytest.mark.parametrize("text", ["", "{", "[1,", "nul", "[" * 100_000, "1" * 5000, b"\xff\xfe\x00"])
    def test_of_what_is_no_json_is_refused(self, text):
        with pytest.raises(CodecError, match="no JSON"):
            from_text(text)

    def test_that_is_too_long_is_refused_unread(self):
        with pytest.raises(CodecError, match="at most 10"):
            from_text("[" * 11, 10)

    def test_is_ascii_on_one_line(self):
        text = to_text(shape_of(Printed).encode(Printed(1, "ü\n\u2028", "main", 1)))
        assert text.isascii()
        assert "\n" not in text


class TestGarbage:
    """A hostile sender: whatever arrives, it is a message or a `CodecError`."""

    def mutate(self, data: Any, random: Random) -> Any:
        if random.random() < 0.1 or not isinstance(data, list | dict) or not data:
            return random.choice(
                [None, True, -1, 2**70, 0.5, "NaN", "x" * 3, [], [[]], {}, {"a": 1}, "\ud800", ["float", 1], 1e308]
            )
        if isinstance(data, dict):
            key = random.choice(sorted(data))
            return {**data, key: self.mutate(data[key], random)}
        index = random.randrange(len(data))
        how = random.random()
        if how < 0.1:
            return data[:index] + data[index + 1 :]
        if how < 0.2:
            return [*data, data[index]]
        return [*data[:index], self.mutate(data[index], random), *data[index + 1 :]]

    def test_never_gives_anything_else(self):
        random, outcomes = Random(5), {True: 0, False: 0}
        kinds = [Input, Event, ChannelRequest, Output]
        for round_number in range(3000):
            kind = random.choice(kinds)
            maker = Maker(round_number)
            value = output(events=(maker.make(Event),)) if kind is Output else maker.make(kind)
            data = self.mutate(shape_of(kind).encode(value), random)
            try:
                back = shape_of(kind).decode(data)
            except CodecError as error:
                assert len(str(error)) < 2000
                outcomes[False] += 1
            else:
                # What is accepted is a proper message: it can be written again.
                again = shape_of(kind).decode(from_text(to_text(shape_of(kind).encode(back))))
                assert repr(again) == repr(back)
                outcomes[True] += 1
        assert outcomes[False] > 1000
        assert outcomes[True] > 50


class TestSaid:
    TEXT = said("{value} of {limit}", value="a", limit=said("{n} {{x}}", n=3))

    def test_a_text_alone_in_json(self):
        data = shape_of(Warned).encode(Warned(1, self.TEXT))
        assert '"a of 3 {x}"' in to_text(data)
        assert "template" not in to_text(data)

    def test_with_its_parts(self):
        data = from_text(to_text(with_parts(shape_of(Warned).encode(Warned(1, self.TEXT)))))
        assert data[1] == [
            "said",
            "a of 3 {x}",
            "{value} of {limit}",
            {"value": "a", "limit": ["said", "3 {x}", "{n} {{x}}", {"n": 3}]},
        ]
        found = shape_of(Warned).decode(data).text
        assert found == self.TEXT
        assert (found.template, found.values["limit"].template) == ("{value} of {limit}", "{n} {{x}}")
        assert without_parts(data) == from_text(to_text(shape_of(Warned).encode(Warned(1, self.TEXT))))

    @pytest.mark.parametrize(
        "text",
        [
            ["said"],
            ["said", "a", "a"],
            ["said", "a", "a", []],
            ["said", "a", "b", {}],
            ["said", 1, "a", {}],
            ["said", "a", "{x}", {"x": "b"}],
            ["said", "a", "{x}", {"x": ["said", "a", "b", {}]}],
            ["said", "a", "{x}", {"x": 1.5}],
            ["said", "a", "{x}", {"x": None}],
            ["said", "1" * 20, "{x}", {"x": 10**19 * 2}],
            ["said", "aa", "{x.__class__}", {"x": "a"}],
            ["said", "a", "{x}" * 100_000, {"x": "a" * 100_000}],
        ],
    )
    def test_parts_that_make_no_text_are_refused(self, text):
        data = shape_of(Warned).encode(Warned(1, ""))
        with pytest.raises(CodecError):
            shape_of(Warned).decode([data[0], text, *data[2:]])

    def test_parts_within_parts_end(self):
        text = ["said", "a", "{x}", {"x": "a"}]
        for _ in range(10):
            text = ["said", "a", "{x}", {"x": text}]
        data = shape_of(Warned).encode(Warned(1, ""))
        with pytest.raises(CodecError):
            shape_of(Warned).decode([data[0], text, *data[2:]])

    def test_halves_of_pairs_are_no_parts(self):
        data = with_parts(shape_of(Warned).encode(Warned(1, said("{x}", x="\ud83d"))))
        assert data[1] == "\\ud83d"
