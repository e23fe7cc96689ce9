"""MODBUS RTU on the wire: the number of the slave, the request or answer, and a checksum (CRC-16).

A line marks the end of a frame by silence. Where bytes come through drivers and networks, silence says little, so
frames are found by the length that their function code implies, and by their checksum. Source: MODBUS over Serial Line
Specification and Implementation Guide V1.02, chapter 2.5.1 and appendix B.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from elitescript.modbus.frames.pdu import (
    EXCEPTION_BIT,
    PDU_MAX,
    READ_COILS,
    READ_DISCRETE_INPUTS,
    READ_HOLDING_REGISTERS,
    READ_INPUT_REGISTERS,
    READ_WRITE_REGISTERS,
    WRITE_COIL,
    WRITE_COILS,
    WRITE_REGISTER,
    WRITE_REGISTERS,
)

BROADCAST: Final = 0
FRAME_MAX: Final = PDU_MAX + 3
FRAME_MIN: Final = 4

UNKNOWN: Final = -1
"""The length of a frame whose function code implies none."""

_POLYNOMIAL: Final = 0xA001
_READS: Final = (READ_COILS, READ_DISCRETE_INPUTS, READ_HOLDING_REGISTERS, READ_INPUT_REGISTERS)
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
    """A frame that has arrived, its checksum being right."""

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
    """Return the number of bytes of the request frame that begins so.

    Returns:
        The length, `UNKNOWN` for a function that is not known here, None if more bytes are needed to say.
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
    """Return the number of bytes of the answer frame that begins so; see `request_length`."""
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
    """Cuts a stream into frames whose checksum is right; what lies between them is dropped.

    A frame of an unknown function is found by `silence` alone.

    Args:
        is_slave: whether requests arrive here, not answers.

    Attributes:
        dropped: bytes that belonged to no frame so far.
    """

    __slots__ = ("_buffer", "_length", "dropped")

    def __init__(self, *, is_slave: bool) -> None:
        self._length = request_length if is_slave else answer_length
        self._buffer = bytearray()
        self.dropped = 0

    @property
    def waiting(self) -> int:
        """Bytes that may become a frame."""
        return len(self._buffer)

    def feed(self, data: bytes) -> list[RtuFrame]:
        """Take bytes; return the frames that are complete by now, in order."""
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
        """The line was silent for the time that ends a frame: what waits is a frame now or never."""
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
        """Take the first bytes as a frame, if their checksum is right."""
        buffer = self._buffer
        if crc16(buffer[: length - 2]) != buffer[length - 2] | buffer[length - 1] << 8:
            return False
        frames.append(RtuFrame(buffer[0], bytes(buffer[1 : length - 2])))
        del buffer[:length]
        return True
