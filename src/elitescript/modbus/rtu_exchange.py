"""One request to a slave on a serial line, and its answer among all received bytes.

A line carries more than answers: noise, late answers, and with some adapters an echo of the sent bytes. The answer is
searched for at every byte, by slave, function, the length that the request implies and checksum. Source: MODBUS over
Serial Line Specification and Implementation Guide V1.02, chapter 2.5.1.
"""

from __future__ import annotations

from math import ceil
from typing import Final

from elitescript.modbus.frames.pdu import (
    BIT_READS,
    EXCEPTION_BIT,
    REGISTER_READS,
    WRITE_COIL,
    WRITE_REGISTER,
    AnswerError,
    values_of,
)
from elitescript.modbus.frames.rtu import answer_length, crc16, rtu_frame

GAP_CHARACTERS: Final = 3.5
GAP_MIN_S: Final = 0.00175
"""Silence before a request: so many characters, but not less than this."""

_EXCEPTION_LENGTH: Final = 5
_WRITTEN_LENGTH: Final = 8
_FRAME_BYTES: Final = 5
"""Bytes of an answer to a reading function besides the values."""


def gap_s(character_s: float) -> float:
    """Return the silence, s, that a line needs before a request, from the time of one character."""
    return max(GAP_CHARACTERS * character_s, GAP_MIN_S)


class RtuExchange:
    """One request and its answer.

    Args:
        slave: its number, 1 to 247.
        request: as `pdu` builds it.

    Attributes:
        frame: the bytes to send.
        repeats: whether the answer repeats the request, and so looks like its echo.
    """

    __slots__ = ("_length", "_request", "_slave", "frame", "repeats")

    def __init__(self, slave: int, request: bytes) -> None:
        self._slave = slave
        self._request = request
        function = request[0]
        self.frame = rtu_frame(slave, request)
        self.repeats = function in (WRITE_COIL, WRITE_REGISTER)
        count = int.from_bytes(request[3:5], "big")
        if function in BIT_READS:
            self._length = _FRAME_BYTES + ceil(count / 8)
        elif function in REGISTER_READS:
            self._length = _FRAME_BYTES + 2 * count
        else:
            self._length = _WRITTEN_LENGTH

    def echo_end(self, data: bytes | bytearray) -> int:
        """Return where an echo of the request ends; 0 if there is none."""
        return data.find(self.frame) + len(self.frame) if self.frame in data else 0

    def answer(self, data: bytes | bytearray) -> tuple[int, ...] | None:
        """Return the values that were read, none for a write; None while no answer is complete.

        Raises:
            ExceptionResponse: the slave refuses.
        """
        for begin in self._begins(data):
            is_refusal = bool(data[begin + 1] & EXCEPTION_BIT)
            length = _EXCEPTION_LENGTH if is_refusal else self._length
            frame = data[begin : begin + length]
            if _is_sound(frame, length):
                try:
                    return values_of(self._request, bytes(frame[1:-2]))
                except AnswerError:
                    # The answer to an earlier request for other values.
                    continue
        return None

    def has_begun(self, data: bytes | bytearray) -> bool:
        """Return whether the data may hold the begin of an answer that is incomplete or damaged."""
        return any(not _is_frame(data, begin) for begin in self._begins(data))

    def _begins(self, data: bytes | bytearray) -> list[int]:
        """Return the places of the slave's number followed by the function."""
        function = self._request[0]
        heads = (bytes((self._slave, function)), bytes((self._slave, function | EXCEPTION_BIT)))
        return sorted(begin for head in heads for begin in _finds(data, head))


def _is_frame(data: bytes | bytearray, begin: int) -> bool:
    """Return whether a whole answer of any length begins there, such as one to an earlier request."""
    length = answer_length(data[begin : begin + 3])
    return length is not None and _is_sound(data[begin : begin + length], length)


def _is_sound(frame: bytes | bytearray, length: int) -> bool:
    return len(frame) == length and crc16(frame[:-2]) == frame[-2] | frame[-1] << 8


def _finds(data: bytes | bytearray, what: bytes) -> list[int]:
    places = []
    place = data.find(what)
    while place >= 0:
        places.append(place)
        place = data.find(what, place + 1)
    return places
