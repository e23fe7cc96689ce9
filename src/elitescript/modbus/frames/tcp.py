"""Frames of MODBUS TCP: a header of seven bytes (MBAP) before each request or answer.

Source: MODBUS Messaging on TCP/IP Implementation Guide V1.0b, chapter 3.
"""

from __future__ import annotations

from struct import Struct
from typing import Final

from elitescript.modbus.frames.pdu import PDU_MAX
from elitescript.records import NamedTuple

PORT: Final = 502

LENGTH_MAX: Final = PDU_MAX + 1
"""Largest length in a header: it counts the unit and the request or answer."""

TOLERATED_LENGTH_MAX: Final = 266
"""Largest length that a slave reads to the end, and answers with an exception: function 23 with 255 bytes to write.
Other stacks send too many registers by mistake, and their next request is whole."""

_HEADER: Final = Struct(">HHHB")
_HEADER_SIZE: Final = 7


class TcpFrame(NamedTuple):
    """A received frame."""

    transaction: int
    unit: int
    pdu: bytes


def tcp_frame(transaction: int, unit: int, pdu: bytes) -> bytes:
    """Return a request or an answer with its header.

    Args:
        transaction: number that the answer repeats, 0 to 65535.
        unit: number of the slave, 0 to 255.
        pdu: the request or answer.
    """
    return _HEADER.pack(transaction, 0, len(pdu) + 1, unit) + pdu


class TcpSplitter:
    """Cuts a stream into frames.

    Args:
        length_max: largest length in a header.

    A frame of another protocol is left out. After an invalid length the begin of the next frame is unknown: `is_lost`
    is True from then on, all further bytes are dropped, and the connection should be closed.

    Attributes:
        is_lost: whether an invalid length was received.
        foreign: number of frames of another protocol.
    """

    __slots__ = ("_length_max", "_rest", "foreign", "is_lost")

    def __init__(self, length_max: int = LENGTH_MAX) -> None:
        self._length_max = length_max
        self._rest = b""
        self.is_lost = False
        self.foreign = 0

    @property
    def waiting(self) -> int:
        """Number of bytes of an incomplete frame."""
        return len(self._rest)

    def feed(self, data: bytes) -> list[TcpFrame]:
        """Take bytes; return the frames that are complete now, in order."""
        frames: list[TcpFrame] = []
        if self.is_lost:
            return frames
        if self._rest:
            data = self._rest + data
        offset, size = 0, len(data)
        while size - offset >= _HEADER_SIZE:
            transaction, protocol, length, unit = _HEADER.unpack_from(data, offset)
            if not 2 <= length <= self._length_max:
                self.is_lost = True
                self._rest = b""
                return frames
            end = offset + 6 + length
            if end > size:
                break
            if protocol == 0:
                frames.append(TcpFrame(transaction, unit, data[offset + 7 : end]))
            else:
                self.foreign += 1
            offset = end
        self._rest = data[offset:]
        return frames
