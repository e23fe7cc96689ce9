"""Messages of the RTSI port as a client sends and reads them, without I/O.

A message is its size (u16, of the whole message), a command (one letter) and what the command carries; the table of
commands is `protocol.rtsi.connection.COMMANDS`.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping, Sequence
from operator import itemgetter
from typing import Final

from elitescript.errors import PeerError
from elitescript.protocol.binary import Field, FieldList, Number, WireType, WireValue
from elitescript.protocol.rtsi.connection import PROTOCOL_VERSION
from elitescript.protocol.rtsi.inputs import INPUTS
from elitescript.protocol.rtsi.recipes import DATA_PACKAGE, HEAD
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.records import NamedTuple

TYPES: Final[dict[str, WireType]] = {
    wire.name: wire for wire in (*(row.type for row in OUTPUTS.values()), *INPUTS.values())
} | {wire.name: wire for wire in (WireType("UINT64", "Q"), WireType("VECTOR6UINT32", "I", 6))}
"""Types by the names that answers to set-ups have."""

_FRAME: Final = struct.Struct(">HB")
_VERSION: Final = struct.Struct(">IIII")
_LEVELS: Final = ("exception", "error", "warning", "info")


class Frame(NamedTuple):
    """One message of a controller."""

    command: int
    """Code of its letter."""
    payload: bytes


class FrameReader:
    """Cuts the stream of a controller into messages, however it arrives."""

    __slots__ = ("_rest",)

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> list[Frame]:
        """Return the messages that are complete now.

        Raises:
            PeerError: a size that no message has; what follows cannot be read.
        """
        if self._rest:
            data = self._rest + data
        frames: list[Frame] = []
        at, end = 0, len(data)
        while end - at >= _FRAME.size:
            size, command = _FRAME.unpack_from(data, at)
            if size < _FRAME.size:
                if frames:
                    # What came in front is whole; the next call raises.
                    break
                raise PeerError(f"RTSI: a message says that it has {size} bytes; the shortest has {_FRAME.size}")
            if end - at < size:
                break
            frames.append(Frame(command, data[at + _FRAME.size : at + size]))
            at += size
        self._rest = data[at:]
        return frames


def message(letter: str, payload: bytes = b"") -> bytes:
    """Return a message to the controller."""
    return _FRAME.pack(_FRAME.size + len(payload), ord(letter)) + payload


def version_request() -> bytes:
    """Return the question whether the controller speaks this version of the protocol."""
    return message("V", PROTOCOL_VERSION.to_bytes(2, "big"))


def output_request(names: Sequence[str], frequency_hz: float) -> bytes:
    """Return the request for packages of these variables."""
    return message("O", struct.pack(">d", frequency_hz) + ",".join(names).encode())


def input_request(names: Sequence[str]) -> bytes:
    """Return the request to write these variables."""
    return message("I", ",".join(names).encode())


def accepted(payload: bytes, what: str) -> bool:
    """Return whether the answer to V, S or P is yes.

    Raises:
        PeerError: it has no byte.
    """
    if not payload:
        raise PeerError(f"RTSI: the answer to {what} is empty")
    return payload[0] != 0


def controller_version(payload: bytes) -> tuple[int, int, int, int]:
    """Return major, minor, bug fix and build.

    Raises:
        PeerError: it is too short.
    """
    if len(payload) < _VERSION.size:
        raise PeerError(f"RTSI: the controller's version has {len(payload)} bytes, not {_VERSION.size}")
    major, minor, bug_fix, build = _VERSION.unpack_from(payload)
    return major, minor, bug_fix, build


def text_of(payload: bytes) -> tuple[str, str]:
    """Return level and words of a text message."""
    level = payload[0] if payload else len(_LEVELS)
    return (_LEVELS[level] if level < len(_LEVELS) else f"level {level}"), payload[1:].decode("utf-8", "replace")


class SetUp(NamedTuple):
    """Answer to the set-up of a recipe."""

    ident: int
    """0 if it is refused, by some controllers."""
    words: tuple[str, ...]
    """For each variable its type, or why it cannot be had: `NOT_FOUND`, `IN_USE`."""

    @property
    def is_complete(self) -> bool:
        """Whether every variable can be had."""
        return self.ident > 0 and all(word in TYPES for word in self.words)


def set_up_of(payload: bytes, names: Sequence[str], direction: str) -> SetUp:
    """Return the answer to a set-up.

    Args:
        payload: of the message.
        names: that were asked for.
        direction: `output` or `input`, for texts.

    Raises:
        PeerError: it does not fit the request.
    """
    if not payload:
        raise PeerError(f"RTSI: the answer to the {direction} recipe is empty")
    words = tuple(word.strip() for word in payload[1:].decode("ascii", "replace").split(","))
    if len(words) != len(names):
        raise PeerError(f"RTSI: {len(names)} {direction} variables were asked for, and {len(words)} types came back")
    return SetUp(payload[0], words)


class OutputLayout:
    """How the packages of one output recipe are read; made once, so that a package is cheap.

    Args:
        ident: number of the recipe.
        names: of its variables in order.
        words: name of the type of each, a key of `TYPES`.
        frequency_hz: that was asked for.
    """

    __slots__ = ("_slices", "_struct", "frequency_hz", "ident", "names", "size", "types")

    def __init__(self, ident: int, names: Sequence[str], words: Sequence[str], frequency_hz: float) -> None:
        self.ident = ident
        self.names = tuple(names)
        self.types = tuple(TYPES[word] for word in words)
        self.frequency_hz = frequency_hz
        self._struct = struct.Struct(">B" + "".join(wire.layout for wire in self.types))
        self.size = self._struct.size
        """Bytes of a package behind its head, with the number of the recipe."""
        self._slices: dict[str, int | slice] = {}
        at = 1
        for name, wire in zip(self.names, self.types, strict=True):
            self._slices[name] = slice(at, at + wire.length) if wire.is_vector else at
            at += wire.length

    def flat(self, payload: bytes) -> tuple[Number, ...]:
        """Return all numbers of a package in order; the first is the number of the recipe.

        Raises:
            PeerError: it has another size.
        """
        if len(payload) != self.size:
            raise PeerError(f"RTSI: a package of recipe {self.ident} has {len(payload)} bytes, not {self.size}")
        return self._struct.unpack(payload)

    def getter(self, name: str) -> itemgetter[int | slice]:
        """Return what takes one variable out of the numbers of a package: a number, or a tuple for a vector."""
        return itemgetter(self._slices[name])

    def values(self, flat: Sequence[Number]) -> dict[str, WireValue]:
        """Return the values by variable."""
        return {name: flat[where] for name, where in self._slices.items()}  # type: ignore[misc]


class InputLayout:
    """How values are written to one input recipe.

    Args:
        ident: number of the recipe.
        names: of its variables in order.
        words: name of the type of each, a key of `TYPES`.
    """

    __slots__ = ("_fields", "ident", "names")

    def __init__(self, ident: int, names: Sequence[str], words: Sequence[str]) -> None:
        self.ident = ident
        self.names = tuple(names)
        self._fields = FieldList(*(Field(name, TYPES[word]) for name, word in zip(names, words, strict=True)))

    def package(self, values: Mapping[str, WireValue]) -> bytes:
        """Return the message with a value for each variable.

        Raises:
            ValueError: a value does not fit its type; names the variable.
        """
        body = self._fields.pack([values[name] for name in self.names])
        return HEAD.pack(HEAD.size + len(body), DATA_PACKAGE, self.ident) + body


class LossCounter:
    """Counts packages that did not arrive, by the controller's own time.

    Args:
        frequency_hz: at which they are sent.
    """

    __slots__ = ("_last_s", "_period_s", "arrived", "lost", "restarts")

    def __init__(self, frequency_hz: float) -> None:
        self._period_s = 1.0 / frequency_hz
        self._last_s: float | None = None
        self.arrived = 0
        self.lost = 0
        self.restarts = 0
        """How often time began anew: the controller was restarted."""

    def take(self, timestamp_s: float) -> int:
        """Take the time of a package; return how many are missing in front of it."""
        self.arrived += 1
        last, self._last_s = self._last_s, timestamp_s
        if last is None:
            return 0
        if timestamp_s < last:
            self.restarts += 1
            return 0
        missing = max(round((timestamp_s - last) / self._period_s) - 1, 0)
        self.lost += missing
        return missing


def known(names: Iterable[str], words: Iterable[str]) -> tuple[str, ...]:
    """Return the variables that a controller has, by its answer to a set-up."""
    return tuple(name for name, word in zip(names, words, strict=True) if word in TYPES)
