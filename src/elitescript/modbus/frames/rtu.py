"""Frames of MODBUS RTU: number of the slave, request or answer, checksum (CRC-16).

A line marks the end of a frame by silence. Behind drivers and networks silence is unreliable, so frames are found by
the length that their function code implies, and by their checksum. Source: MODBUS over Serial Line
Specification and Implementation Guide V1.02, chapter 2.5.1 and appendix B.
"""

from __future__ import annotations

from typing import Final

from elitescript.modbus.frames.pdu import (
    BIT_READS,
    EXCEPTION_BIT,
    PDU_MAX,
    READ_WRITE_REGISTERS,
    REGISTER_READS,
    WRITE_COIL,
    WRITE_COILS,
    WRITE_REGISTER,
    WRITE_REGISTERS,
)
from elitescript.records import NamedTuple

BROADCAST: Final = 0
FRAME_MAX: Final = PDU_MAX + 3
FRAME_MIN: Final = 4

UNKNOWN: Final = -1
"""Length of a frame whose function code implies none."""

_POLYNOMIAL: Final = 0xA001
_READS: Final = (*BIT_READS, *REGISTER_READS)
_SINGLE_WRITES: Final = (WRITE_COIL, WRITE_REGISTER)
_WRITES: Final = (WRITE_COILS, WRITE_REGISTERS)


def _table() -> tuple[int, ...]:
    rows = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = crc >> 1 ^ _POLYNOMIAL if crc & 1 else crc >> 1
        rows.append(crc)
    return tuple(rows)


_TABLE: Final = _table()


class RtuFrame(NamedTuple):
    """A received frame with a correct checksum."""

    unit: int
    pdu: bytes


def crc16(data: bytes | bytearray | memoryview) -> int:
    """Return the checksum; on the wire its low byte comes first."""
    crc = 0xFFFF
    for byte in data:
        crc = crc >> 8 ^ _TABLE[(crc ^ byte) & 0xFF]
    return crc


def rtu_frame(unit: int, pdu: bytes) -> bytes:
    """Return a request or an answer with the number of its slave and its checksum."""
    body = bytes((unit,)) + pdu
    return body + crc16(body).to_bytes(2, "little")


def request_length(head: bytes | bytearray | memoryview) -> int | None:
    """Return the length of the request frame that begins with these bytes.

    Returns:
        The length, `UNKNOWN` for an unknown function, None if more bytes are needed.
    """
    if len(head) < 2:
        return None
    function = head[1]
    if function in _READS or function in _SINGLE_WRITES:
        return 8
    if function in _WRITES:
        return None if len(head) < 7 else 9 + head[6]
    if function == READ_WRITE_REGISTERS:
        return None if len(head) < 11 else 13 + head[10]
    return UNKNOWN


def answer_length(head: bytes | bytearray | memoryview) -> int | None:
    """Return the length of the answer frame that begins with these bytes; see `request_length`."""
    if len(head) < 2:
        return None
    function = head[1]
    if function & EXCEPTION_BIT:
        return 5
    if function in _READS or function == READ_WRITE_REGISTERS:
        return None if len(head) < 3 else 5 + head[2]
    if function in _SINGLE_WRITES or function in _WRITES:
        return 8
    return UNKNOWN


class RtuSplitter:
    """Cuts a stream into frames with a correct checksum; the bytes between them are dropped.

    A frame of an unknown function is found by `silence` only.

    Args:
        is_slave: whether the frames are requests, not answers.

    Attributes:
        dropped: number of bytes that belonged to no frame.
    """

    __slots__ = ("_buffer", "_length", "dropped")

    def __init__(self, *, is_slave: bool) -> None:
        self._length = request_length if is_slave else answer_length
        self._buffer = bytearray()
        self.dropped = 0

    @property
    def waiting(self) -> int:
        """Number of bytes that may become a frame."""
        return len(self._buffer)

    def feed(self, data: bytes) -> list[RtuFrame]:
        """Take bytes; return the frames that are complete now, in order."""
        frames: list[RtuFrame] = []
        buffer = self._buffer
        buffer += data
        while buffer:
            length = self._length(buffer)
            if length is None:
                break
            if length == UNKNOWN:
                if len(buffer) <= FRAME_MAX:
                    break
            elif length <= FRAME_MAX:
                if len(buffer) < length:
                    break
                if self._take(length, frames):
                    continue
            # No frame begins here.
            del buffer[0]
            self.dropped += 1
        return frames

    def silence(self) -> list[RtuFrame]:
        """End the frame, after the silence that ends one: return what is a frame, drop the rest."""
        frames: list[RtuFrame] = []
        buffer = self._buffer
        while buffer:
            if FRAME_MIN <= len(buffer) <= FRAME_MAX and self._take(len(buffer), frames):
                break
            del buffer[0]
            self.dropped += 1
            frames += self.feed(b"")
        return frames

    def _take(self, length: int, frames: list[RtuFrame]) -> bool:
        """Take the first bytes as a frame, if their checksum is correct."""
        buffer = self._buffer
        if crc16(buffer[: length - 2]) != buffer[length - 2] | buffer[length - 1] << 8:
            return False
        frames.append(RtuFrame(buffer[0], bytes(buffer[1 : length - 2])))
        del buffer[:length]
        return True
