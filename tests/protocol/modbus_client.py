"""A Modbus TCP client without a socket, written from the specification and nothing of ours."""

from __future__ import annotations

import struct


def read(function: int, address: int, count: int) -> bytes:
    return struct.pack(">BHH", function, address, count)


def write(function: int, address: int, value: int) -> bytes:
    """One coil (function 5; 0 or 0xFF00) or register (function 6)."""
    return struct.pack(">BHH", function, address, value)


def write_coils(address: int, levels: list[bool]) -> bytes:
    word = sum(level << index for index, level in enumerate(levels))
    data = word.to_bytes((len(levels) + 7) // 8, "little")
    return struct.pack(">BHHB", 15, address, len(levels), len(data)) + data


def write_registers(address: int, values: list[int]) -> bytes:
    return struct.pack(f">BHHB{len(values)}H", 16, address, len(values), 2 * len(values), *values)


def read_write(read_address: int, count: int, write_address: int, values: list[int]) -> bytes:
    head = struct.pack(">BHHHHB", 23, read_address, count, write_address, len(values), 2 * len(values))
    return head + struct.pack(f">{len(values)}H", *values)


def frame(transaction: int, pdu: bytes, unit: int = 255) -> bytes:
    return struct.pack(">HHHB", transaction, 0, len(pdu) + 1, unit) + pdu


def frames(data: bytes) -> list[tuple[int, int, bytes]]:
    """Transaction, unit and PDU of every answer."""
    found = []
    while data:
        transaction, protocol, length, unit = struct.unpack_from(">HHHB", data)
        assert protocol == 0
        assert len(data) >= 6 + length
        found.append((transaction, unit, data[7 : 6 + length]))
        data = data[6 + length :]
    return found


def words(pdu: bytes) -> list[int]:
    """The registers of an answer."""
    assert pdu[0] in (3, 4, 23)
    assert len(pdu) == 2 + pdu[1]
    return list(struct.unpack(f">{pdu[1] // 2}H", pdu[2:]))


def levels(pdu: bytes, count: int) -> list[bool]:
    """The bits of an answer."""
    assert pdu[0] in (1, 2)
    assert pdu[1] == len(pdu) - 2 == (count + 7) // 8
    word = int.from_bytes(pdu[2:], "little")
    assert word >> count == 0
    return [bool(word >> index & 1) for index in range(count)]
