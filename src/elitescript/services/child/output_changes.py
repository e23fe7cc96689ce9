"""Outputs on their way from a child to its parent: the first one whole, of later ones what is new.

Most of a snapshot is the same as a tick before, and writing and reading all of it again would take longer than the tick
itself. So both ends keep the values of the last snapshot, and a field travels only when it has changed. What changes in
every tick of an arm that moves is numbers: those travel as they are, all else as JSON. The message
`frames.OUTPUT_CHANGES` is

- the tick of the output, the tick of the robot's state (i64 each), and a word of bits (u64), one for each number or
  vector of numbers that has changed,
- those numbers, one behind the other (f64),
- if there is more: JSON `[events, requests, replies, changes]`, where changes are places of fields with their values.

Little-endian. What arrives is checked like any other message, field by field, and before it is read, whether it has so
many values that reading them would take the time of others.
"""

from __future__ import annotations

import re
import struct
from functools import cache
from operator import attrgetter
from typing import Any, Final, get_args, get_origin, get_type_hints

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import field_shapes, shape_of
from elitescript.codec.values import CodecError, Shape, check_list, with_parts, without_parts
from elitescript.errors import UsageError
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.messages.state import RobotState
from elitescript.records import NamedTuple, fields_of
from elitescript.services.child import frames
from elitescript.services.output_text import without_points

_HEAD: Final = struct.Struct("<qqQ")
LISTS_MAX: Final = 10_000
"""Events, requests and replies of one output, of each: a program makes fewer, by its work in a tick."""
VALUES_MAX: Final = 100_000
"""Values of one output, about; as many take 50 ms to be read."""
_TEXT: Final = re.compile(rb'"[^"\\]*+(?:\\.[^"\\]*+)*+"', re.DOTALL)
_LISTS: Final = ("events", "requests", "replies")
_OF_ROBOT: Final = len(fields_of(RobotState)) - 1
"""Fields of a robot's state that come first in the order of `_fields`; all but its tick."""


class _Field(NamedTuple):
    """A field of a snapshot or of its robot."""

    name: str
    """From the snapshot on."""
    shape: Shape[Any]
    numbers: struct.Struct | None
    """Its layout, if it holds a float or a fixed number of them."""
    is_vector: bool


@cache
def _fields() -> list[_Field]:
    """Return the fields of the robot's state but its first one, the tick, then those of the snapshot but the robot."""
    found = []
    for kind, start in ((RobotState, "robot."), (Snapshot, "")):
        hints = get_type_hints(kind)
        for name, shape in list(field_shapes(kind).items())[1:]:
            parts = get_args(hints[name]) if get_origin(hints[name]) is tuple else ()
            is_vector = bool(parts) and set(parts) == {float}
            has_numbers = is_vector or hints[name] is float
            layout = struct.Struct(f"<{len(parts) or 1}d") if has_numbers else None
            found.append(_Field(start + name, shape, layout, is_vector))
    assert sum(field.numbers is not None for field in found) <= 64, "the word of bits is too short"
    return found


class OutputWriter:
    """Writes outputs at the child's end."""

    __slots__ = ("_fields", "_lists", "_packed", "_shape", "_values", "_values_of")

    def __init__(self) -> None:
        self._shape = shape_of(Output)
        shapes = field_shapes(Output)
        self._lists = [shapes[name].encode for name in _LISTS]
        fields = _fields()
        self._values_of = attrgetter(*(field.name for field in fields))
        self._fields: list[tuple[int, Any]] = []
        """For each field its bit and what packs it, or 0 and what encodes it."""
        bit = 1
        for field in fields:
            if field.numbers is None:
                self._fields.append((0, field.shape.encode))
                continue
            self._fields.append((bit, _packer(field.numbers) if field.is_vector else field.numbers.pack))
            bit <<= 1
        self._values: tuple[Any, ...] = ()
        self._packed: dict[int, bytes] = {}
        """The numbers of the last snapshot by the bit of their field."""

    def message(self, output: Output) -> tuple[str, bytes]:
        """Return the letter and content of the message for an output."""
        if self._values:
            return frames.OUTPUT_CHANGES, self.changes(output)
        self._values = self._values_of(output.snapshot)
        for value, (bit, pack) in zip(self._values, self._fields, strict=True):
            if bit:
                self._packed[bit] = pack(value)
        return frames.OUTPUT, to_text(with_parts(self._shape.encode(without_points(output)))).encode()

    def changes(self, output: Output) -> bytes:
        """Return what is new in an output since the last one that was written."""
        last, self._values = self._values, self._values_of(output.snapshot)
        packed = self._packed
        bits = 0
        parts = [b""]
        changes: list[Any] = []
        for place, value in enumerate(self._values):
            old = last[place]
            if value is old:
                continue
            bit, write = self._fields[place]
            # Equal is not the same: 0.0 and -0.0, 1 and True.
            if bit:
                data = write(value)
                if data != packed[bit]:
                    packed[bit] = data
                    parts.append(data)
                    bits |= bit
            elif value != old or repr(value) != repr(old):
                changes += (place, write(value))
        parts[0] = _HEAD.pack(output.tick, output.snapshot.robot.tick, bits)
        if changes or output.events or output.requests or output.replies:
            short = without_points(output)
            written = [encode(getattr(short, name)) for name, encode in zip(_LISTS, self._lists, strict=True)]
            if output.events:
                written[0] = with_parts(written[0])
            parts.append(to_text([*written, changes]).encode())
        return b"".join(parts)


def _packer(layout: struct.Struct) -> Any:
    return lambda values: layout.pack(*values)


class OutputReader:
    """Reads the outputs of one child at the parent's end."""

    __slots__ = ("_data", "_decoders", "_lists", "_numbers", "_robot_tick", "_shape", "_tick", "_values", "_values_of")

    def __init__(self) -> None:
        self._shape = shape_of(Output)
        shapes = field_shapes(Output)
        self._lists = [shapes[name].decode for name in _LISTS]
        self._tick = field_shapes(RobotState)["tick"].decode
        fields = _fields()
        self._values_of = attrgetter(*(field.name for field in fields))
        self._decoders = [field.shape.decode if field.numbers is None else None for field in fields]
        self._numbers = [
            (place, field.numbers, field.is_vector) for place, field in enumerate(fields) if field.numbers is not None
        ]
        self._data: list[Any] = []
        """The last output as it arrived: tick, events, requests, replies, then the fields."""
        self._values: list[Any] = []
        """The fields as they are."""
        self._robot_tick = 0

    def read(self, letter: str, content: bytes, parts: int = ALL_PARTS) -> Output:
        """Return the output of a message; for `parts` see `Output.parts`.

        Raises:
            CodecError: it is none, or changes come before there is anything to change.
        """
        check_values(content)
        if letter == frames.OUTPUT:
            return self._read_whole(from_text(content))
        if not self._data:
            raise CodecError("changes of a snapshot that was not sent")
        values = self._values
        lists: list[Any] = [(), (), ()]
        written: list[Any] = [[], [], []]
        try:
            tick, robot_tick, bits = _HEAD.unpack_from(content)
            self._robot_tick = self._tick(robot_tick)
            at = self._take_numbers(bits, content)
            if at < len(content):
                more = from_text(content[at:])
                check_list(more, 4)
                written = more[:3]
                check_counts(written)
                lists = [read(item) for read, item in zip(self._lists, written, strict=True)]
                self._take_changes(more[3])
            robot = RobotState(self._robot_tick, *values[:_OF_ROBOT])
            snapshot = Snapshot(robot, *values[_OF_ROBOT:])
        except (ValueError, TypeError, UsageError, struct.error) as error:
            raise CodecError(f"changes of a snapshot: {error}") from None
        # The digest of a journal covers the texts alone, whatever their templates are.
        self._data[:4] = tick, without_parts(written[0]), *written[1:]
        events, requests, replies = lists
        return Output(tick, events, requests, replies, snapshot, parts)

    def _read_whole(self, data: Any) -> Output:
        if type(data) is list:
            check_counts(data[1:4])
        output = self._shape.decode(data)
        robot, *rest = data[4]
        self._robot_tick = robot[0]
        self._data = [data[0], without_parts(data[1]), *data[2:4], *robot[1:], *rest]
        self._values = list(self._values_of(output.snapshot))
        return output

    def text(self) -> str:
        """Return the last output whole, as `output_text` writes it."""
        head, data = self._data[:4], self._data[4:]
        for place, _, is_vector in self._numbers:
            value = self._values[place]
            data[place] = list(value) if is_vector else value
        robot = [self._robot_tick, *data[:_OF_ROBOT]]
        return to_text([*head, [robot, *data[_OF_ROBOT:]]])

    def _take_numbers(self, bits: int, content: bytes) -> int:
        """Put numbers that have changed into their places; return where they end."""
        if bits >> len(self._numbers):
            raise CodecError("a change of a number that is not there")
        at = _HEAD.size
        while bits:
            lowest = bits & -bits
            bits ^= lowest
            place, layout, is_vector = self._numbers[lowest.bit_length() - 1]
            numbers = layout.unpack_from(content, at)
            at += layout.size
            self._values[place] = numbers if is_vector else numbers[0]
        return at

    def _take_changes(self, changes: Any) -> None:
        """Put other fields that have changed into their places, as they arrived and as they are."""
        check_list(changes, -1)
        if len(changes) % 2:
            raise CodecError("a change has a place and a value")
        for at in range(0, len(changes), 2):
            place, item = changes[at], changes[at + 1]
            decode = self._decoders[place] if type(place) is int and 0 <= place < len(self._decoders) else None
            if decode is None:
                raise CodecError("a change of a field that is not there")
            self._values[place], self._data[4 + place] = decode(item), item


def check_values(content: bytes) -> None:
    """Refuse a message that has too many values.

    Raises:
        CodecError: it has.
    """
    # Most are short; in those that are not, commas in texts do not count.
    if (
        len(content) > VALUES_MAX
        and content.count(b",") > VALUES_MAX
        and _TEXT.sub(b"", content).count(b",") > VALUES_MAX
    ):
        raise CodecError(f"an output of more than {VALUES_MAX} values; reading it takes the time of other clients")


def check_counts(lists: list[Any]) -> None:
    """Refuse a tick with too many events, requests or replies.

    Raises:
        CodecError: it has.
    """
    for items in lists:
        if type(items) is list and len(items) > LISTS_MAX:
            raise CodecError(f"an output with {len(items)} events, requests or replies; {LISTS_MAX} are read")
