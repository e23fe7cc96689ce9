"""Outputs on their way from a child to its parent: the first one whole, of later ones what is new.

Most of a snapshot is the same as a tick before, and writing and reading all of it again would take longer than the tick
itself. So both ends keep the last snapshot, and a field travels only when it has changed. What arrives is checked like
any other message, field by field.
"""

from __future__ import annotations

from typing import Any

from elitescript.errors import UsageError
from elitescript.messages.codec import Codec, from_text, to_text
from elitescript.messages.outputs import Output
from elitescript.messages.shapes import CodecError, Decode, Encode, check_list
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.state import RobotState
from elitescript.services import frames
from elitescript.services.config_codec import output_text, without_points


class OutputWriter:
    """The child's end.

    Args:
        codec: of everything that an output holds.
    """

    __slots__ = ("_last", "_robot", "_said", "_shape", "_snapshot")

    def __init__(self, codec: Codec) -> None:
        self._shape = codec.shape(Output)
        said = codec.field_shapes(Output)
        self._said = [(name, said[name].encode) for name in ("tick", "events", "requests", "replies")]
        self._snapshot = _encoders(codec, Snapshot)
        del self._snapshot[_robot_index(codec)]
        self._robot = _encoders(codec, RobotState)
        self._last: Snapshot | None = None

    def message(self, output: Output) -> tuple[str, str]:
        """Letter and text of the message for an output."""
        last, self._last = self._last, output.snapshot
        if last is None:
            return frames.OUTPUT, output_text(self._shape, output)
        said = without_points(output)
        data: list[Any] = [encode(getattr(said, name)) for name, encode in self._said]
        data.append(_changes(self._snapshot, last, output.snapshot))
        data.append(_changes(self._robot, last.robot, output.snapshot.robot))
        return frames.OUTPUT_CHANGES, to_text(data)


class OutputReader:
    """The parent's end of the line from one child.

    Args:
        codec: of everything that an output holds.
    """

    __slots__ = ("_data", "_robot", "_robot_index", "_robot_values", "_said", "_shape", "_snapshot", "_values")

    def __init__(self, codec: Codec) -> None:
        self._shape = codec.shape(Output)
        said = codec.field_shapes(Output)
        self._said = [said[name].decode for name in ("tick", "events", "requests", "replies")]
        self._snapshot = [shape.decode for shape in codec.field_shapes(Snapshot).values()]
        self._robot = [shape.decode for shape in codec.field_shapes(RobotState).values()]
        self._robot_index = _robot_index(codec)
        self._data: list[Any] = []
        self._values: list[Any] = []
        self._robot_values: list[Any] = []

    def read(self, letter: str, text: bytes) -> Output:
        """The output of a message.

        Raises:
            CodecError: it is none, or changes come before there is anything to change.
        """
        data = from_text(text)
        if letter == frames.OUTPUT:
            output = self._shape.decode(data)
            snapshot = output.snapshot
            self._data = data
            self._values = [getattr(snapshot, name) for name in Snapshot.__dataclass_fields__]
            self._robot_values = [getattr(snapshot.robot, name) for name in RobotState.__dataclass_fields__]
            return output
        if not self._data:
            raise CodecError("changes of a snapshot that was not sent")
        check_list(data, 6)
        try:
            tick, events, requests, replies = [read(item) for read, item in zip(self._said, data, strict=False)]
            whole = self._data[-1]
            _apply(data[4], self._snapshot, whole, self._values, self._robot_index)
            _apply(data[5], self._robot, whole[self._robot_index], self._robot_values, -1)
            self._values[self._robot_index] = RobotState(*self._robot_values)
            snapshot = Snapshot(*self._values)
        except (ValueError, TypeError, UsageError) as error:
            raise CodecError(f"changes of a snapshot: {error}") from None
        self._data[:4] = data[:4]
        return Output(tick, events, requests, replies, snapshot)

    def text(self) -> str:
        """The last output whole, as `output_text` writes it."""
        return to_text(self._data)


def _encoders(codec: Codec, kind: type) -> dict[int, tuple[str, Encode]]:
    return {index: (name, shape.encode) for index, (name, shape) in enumerate(codec.field_shapes(kind).items())}


def _robot_index(codec: Codec) -> int:
    return list(codec.field_shapes(Snapshot)).index("robot")


def _changes(encoders: dict[int, tuple[str, Encode]], before: Any, now: Any) -> list[Any]:
    """Number and value of every field that is written in another way than before, one behind the other."""
    found: list[Any] = []
    for index, (name, encode) in encoders.items():
        value, old = getattr(now, name), getattr(before, name)
        # Equal is not the same: 0.0 and -0.0, 1 and True.
        if value is not old and (value != old or repr(value) != repr(old)):
            found += (index, encode(value))
    return found


def _apply(changes: Any, decoders: list[Decode], data: list[Any], values: list[Any], fixed: int) -> None:
    """Put changed fields into their places, as they arrived and as they are."""
    check_list(changes, -1)
    if len(changes) % 2:
        raise CodecError("a change has a number and a value")
    for at in range(0, len(changes), 2):
        index, item = changes[at], changes[at + 1]
        if type(index) is not int or not 0 <= index < len(decoders) or index == fixed:
            raise CodecError("a change of a field that is not there")
        values[index], data[index] = decoders[index](item), item
