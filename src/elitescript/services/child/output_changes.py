"""Outputs on their way from a child to its parent: the first one whole, of later ones what is new.

Most of a snapshot is the same as a tick before, and writing and reading all of it again would take longer than the tick
itself. So both ends keep the last snapshot, and a field travels only when it has changed. What changes in every tick of
an arm that moves is numbers: those travel as they are, all else as JSON. The message `frames.OUTPUT_CHANGES` is

- the tick of the output, the tick of the robot's state (i64 each), and a word of bits (u64), one for each number or
  vector of `_Columns` that has changed,
- the numbers of those that have, one behind the other (f64),
- if there is more: JSON `[events, requests, replies, changes of the snapshot, changes of its robot]`, where changes are
  indices of fields with their values.

Little-endian. What arrives is checked like any other message, field by field, and before it is read, whether it has so
many values that reading them would take the time of others.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from operator import attrgetter
from typing import Any, Final, get_args, get_origin, get_type_hints

from elitescript.errors import UsageError
from elitescript.messages.codec import Codec, from_text, to_text
from elitescript.messages.outputs import Output
from elitescript.messages.shapes import CodecError, Decode, Encode, check_list
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.state import RobotState
from elitescript.services.child import frames
from elitescript.services.config_codec import output_text, without_points

_HEAD: Final = struct.Struct("<qqQ")
_ROBOT: Final = "robot"
_TICK: Final = "tick"
SAID_MAX: Final = 10_000
"""Events, requests and replies of one output, of each: a program says less, by its work in a tick."""
VALUES_MAX: Final = 100_000
"""Values of one output, about; as many take 50 ms to be read."""
_TEXT: Final = re.compile(rb'"[^"\\]*+(?:\\.[^"\\]*+)*+"', re.DOTALL)
_SAID: Final = ("events", "requests", "replies")


class _Column:
    """A field of a snapshot, or of its robot, that holds a float or a fixed number of them."""

    __slots__ = ("index", "is_of_robot", "layout", "name", "pack", "read", "size")

    def __init__(self, name: str, index: int, length: int, *, is_of_robot: bool) -> None:
        self.name = f"{_ROBOT}.{name}" if is_of_robot else name
        self.index = index
        """Of the field in its class."""
        self.is_of_robot = is_of_robot
        self.layout = struct.Struct(f"<{length or 1}d")
        self.size = self.layout.size
        self.pack: Callable[[Any], bytes] = self.layout.pack if not length else lambda values: self.layout.pack(*values)
        self.read: Callable[[bytes, int], Any] = self.layout.unpack_from
        if not length:
            self.read = lambda data, at: self.layout.unpack_from(data, at)[0]


def _columns() -> tuple[_Column, ...]:
    """In the order of the bits."""
    found = []
    for kind in (Snapshot, RobotState):
        for index, (name, hint) in enumerate(get_type_hints(kind).items()):
            parts = get_args(hint) if get_origin(hint) is tuple else ()
            if hint is float or (parts and set(parts) == {float}):
                found.append(_Column(name, index, len(parts), is_of_robot=kind is RobotState))
    assert len(found) <= 64, "the word of bits is too short"
    return tuple(found)


class OutputWriter:
    """The child's end.

    Args:
        codec: of everything that an output holds.
    """

    __slots__ = ("_columns", "_last", "_numbers", "_numbers_of", "_packed", "_robot", "_said", "_shape", "_snapshot")

    def __init__(self, codec: Codec) -> None:
        self._shape = codec.shape(Output)
        said = codec.field_shapes(Output)
        self._said = [said[name].encode for name in _SAID]
        columns = _columns()
        self._columns = [(1 << bit, column.pack) for bit, column in enumerate(columns)]
        self._numbers_of = attrgetter(*(column.name for column in columns))
        self._numbers: tuple[Any, ...] = ()
        self._packed: list[bytes] = []
        taken = {(column.is_of_robot, column.index) for column in columns}
        self._snapshot = _encoders(codec, Snapshot, {index for of_robot, index in taken if not of_robot})
        self._robot = _encoders(codec, RobotState, {index for of_robot, index in taken if of_robot})
        self._last: Snapshot | None = None

    def message(self, output: Output) -> tuple[str, bytes]:
        """Letter and content of the message for an output."""
        snapshot = output.snapshot
        last, self._last = self._last, snapshot
        numbers, before = self._numbers_of(snapshot), self._numbers
        self._numbers = numbers
        if last is None:
            self._packed = [pack(value) for (_, pack), value in zip(self._columns, numbers, strict=True)]
            return frames.OUTPUT, output_text(self._shape, output).encode()
        bits = 0
        packed = self._packed
        parts = [b""]
        for place, value in enumerate(numbers):
            if value is not before[place]:
                bit, pack = self._columns[place]
                data = pack(value)
                # Equal is not the same: 0.0 and -0.0.
                if data != packed[place]:
                    packed[place] = data
                    parts.append(data)
                    bits |= bit
        robot = snapshot.robot
        parts[0] = _HEAD.pack(output.tick, robot.tick, bits)
        changes = _changes(self._snapshot, last, snapshot)
        robot_changes = _changes(self._robot, last.robot, robot)
        if changes or robot_changes or output.events or output.requests or output.replies:
            said = without_points(output)
            written = [encode(getattr(said, name)) for name, encode in zip(_SAID, self._said, strict=True)]
            parts.append(to_text([*written, changes, robot_changes]).encode())
        return frames.OUTPUT_CHANGES, b"".join(parts)


class OutputReader:
    """The parent's end of the line from one child.

    Args:
        codec: of everything that an output holds.
    """

    __slots__ = (
        "_columns",
        "_data",
        "_robot",
        "_robot_index",
        "_robot_values",
        "_said",
        "_shape",
        "_snapshot",
        "_tick",
        "_values",
    )

    def __init__(self, codec: Codec) -> None:
        self._shape = codec.shape(Output)
        said = codec.field_shapes(Output)
        self._said = [said[name].decode for name in _SAID]
        self._columns = _columns()
        self._tick = codec.field_shapes(RobotState)[_TICK].decode
        self._robot_index = list(codec.field_shapes(Snapshot)).index(_ROBOT)
        self._snapshot: list[Decode | None] = [shape.decode for shape in codec.field_shapes(Snapshot).values()]
        self._robot: list[Decode | None] = [shape.decode for shape in codec.field_shapes(RobotState).values()]
        for column in self._columns:
            (self._robot if column.is_of_robot else self._snapshot)[column.index] = None
        self._snapshot[self._robot_index] = self._robot[0] = None
        self._data: list[Any] = []
        self._values: list[Any] = []
        self._robot_values: list[Any] = []

    def read(self, letter: str, content: bytes) -> Output:
        """The output of a message.

        Raises:
            CodecError: it is none, or changes come before there is anything to change.
        """
        check_values(content)
        if letter == frames.OUTPUT:
            data = from_text(content)
            if type(data) is list and len(data) == len(Output.__dataclass_fields__):
                check_said(data[1:4])
            output = self._shape.decode(data)
            snapshot = output.snapshot
            self._data = data
            self._values = [getattr(snapshot, name) for name in Snapshot.__dataclass_fields__]
            self._robot_values = [getattr(snapshot.robot, name) for name in RobotState.__dataclass_fields__]
            return output
        whole = self._data
        if not whole:
            raise CodecError("changes of a snapshot that was not sent")
        values, robot_values = self._values, self._robot_values
        events: Any = ()
        requests: Any = ()
        replies: Any = ()
        whole[1:4] = [], [], []
        try:
            tick, robot_tick, bits = _HEAD.unpack_from(content)
            robot_values[0] = self._tick(robot_tick)
            at = self._take_numbers(bits, content)
            if at < len(content):
                more = from_text(content[at:])
                check_list(more, 5)
                check_said(more[:3])
                events, requests, replies = [read(item) for read, item in zip(self._said, more, strict=False)]
                _apply(more[3], self._snapshot, whole[4], values)
                _apply(more[4], self._robot, whole[4][self._robot_index], robot_values)
                whole[1:4] = more[:3]
            values[self._robot_index] = RobotState(*robot_values)
            snapshot = Snapshot(*values)
        except (ValueError, TypeError, UsageError, struct.error) as error:
            raise CodecError(f"changes of a snapshot: {error}") from None
        whole[0] = tick
        return Output(tick, events, requests, replies, snapshot)

    def text(self) -> str:
        """The last output whole, as `output_text` writes it."""
        data = self._data[4]
        robot_data = data[self._robot_index]
        robot_data[0] = self._robot_values[0]
        for column in self._columns:
            value = (self._robot_values if column.is_of_robot else self._values)[column.index]
            written = list(value) if type(value) is tuple else value
            (robot_data if column.is_of_robot else data)[column.index] = written
        return to_text(self._data)

    def _take_numbers(self, bits: int, content: bytes) -> int:
        """Put numbers that have changed into their places; return where they end."""
        columns = self._columns
        if bits >> len(columns):
            raise CodecError("a change of a number that is not there")
        at = _HEAD.size
        while bits:
            lowest = bits & -bits
            bits ^= lowest
            column = columns[lowest.bit_length() - 1]
            value = column.read(content, at)
            at += column.size
            if column.is_of_robot:
                self._robot_values[column.index] = value
            else:
                self._values[column.index] = value
        return at


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


def check_said(said: list[Any]) -> None:
    """Refuse a tick with too many events, requests or replies.

    Raises:
        CodecError: it has.
    """
    for items in said:
        if type(items) is list and len(items) > SAID_MAX:
            raise CodecError(f"an output with {len(items)} events, requests or replies; {SAID_MAX} are read")


def _encoders(codec: Codec, kind: type, taken: set[int]) -> list[tuple[int, str, Encode]]:
    """Of every field that travels as JSON: index, name, encoder."""
    return [
        (index, name, shape.encode)
        for index, (name, shape) in enumerate(codec.field_shapes(kind).items())
        if index not in taken and name not in (_ROBOT, _TICK)
    ]


def _changes(encoders: list[tuple[int, str, Encode]], before: Any, now: Any) -> list[Any]:
    """Index and value of every field that is written in another way than before, one behind the other."""
    found: list[Any] = []
    for index, name, encode in encoders:
        value, old = getattr(now, name), getattr(before, name)
        # Equal is not the same: 1 and True.
        if value is not old and (value != old or repr(value) != repr(old)):
            found += (index, encode(value))
    return found


def _apply(changes: Any, decoders: list[Decode | None], data: list[Any], values: list[Any]) -> None:
    """Put changed fields into their places, as they arrived and as they are."""
    check_list(changes, -1)
    if len(changes) % 2:
        raise CodecError("a change has an index and a value")
    for at in range(0, len(changes), 2):
        index, item = changes[at], changes[at + 1]
        decode = decoders[index] if type(index) is int and 0 <= index < len(decoders) else None
        if decode is None:
            raise CodecError("a change of a field that is not there")
        values[index], data[index] = decode(item), item
