"""Addresses of the controller's Modbus server, and numbers of the protocol, against tables written by hand.

D: the vendor's sheet shows address and meaning. B: it shows the block, meaning and unit are assumed. A: assumed.
Function codes, exception codes and limits are those of the MODBUS Application Protocol Specification V1.1b3.
"""

from __future__ import annotations

import pytest

from elitescript.modbus.frames import pdu
from elitescript.modbus.port_map import COILS, REGISTERS
from tests.tables import rows

REGISTER_TABLE = """
  0     1   R    D   standard digital inputs                                    bit i: input i
  1     1   R    D   configurable digital inputs, tool digital inputs           bits 0 to 7, bits 8 to 11
  2     1   RW   D   standard digital outputs                                   bit i: output i
  3     1   RW   D   configurable digital outputs, tool digital outputs         bits 0 to 7, bits 8 to 11
  4     1   R    D   analog input 0                                             mA or mV
  5     1   RW   D   domain of analog input 0                                   0 current, 1 voltage
  6     1   R    D   analog input 1                                             mA or mV
  7     1   RW   D   domain of analog input 1                                   0 current, 1 voltage
  8     1   R    D   tool analog input                                          mA or mV
  9     1   RW   D   domain of tool analog input                                0 current, 1 voltage
 10     1   RW   D   analog output 0                                            mA or mV
 11     1   RW   D   domain of analog output 0                                  0 current, 1 voltage
 12     1   RW   D   analog output 1                                            mA or mV
 13     1   RW   D   domain of analog output 1                                  0 current, 1 voltage
 14     1   RW   D   tool analog output                                         mA or mV
 15     1   RW   D   domain of tool analog output                               0 current, 1 voltage
 16     1   RW   D   tool voltage: 0, 12 or 24                                  V
 17    46   R    D   reserved                                                   .
 63     3   R    D   controller version: major, minor, bug fix                  .
 66     1   R    D   robot mode, as RTSI numbers it                             .
 67     1   R    D   power is on                                                0 or 1
 68     1   R    D   protective stop                                            0 or 1
 69     1   R    D   emergency stop                                             0 or 1
 70     1   R    D   reduced mode                                               0 or 1
 73     6   R    D   joint positions                                            mrad, signed
 84     6   R    B   joint velocities                                           mrad/s, signed
 95     6   R    B   joint currents                                             mA, signed
105     6   R    B   joint temperatures                                         degC
256   128   RW   D   general purpose: kept; only clients and programs use them                  .
384     6   R    B   TCP: x, y, z, rx, ry, rz (roll-pitch-yaw), base frame      0.1 mm, mrad, signed
400     6   R    B   velocity of the TCP, base frame                            mm/s, mrad/s, signed
410     6   R    B   TCP offset from the flange                                 0.1 mm, mrad, signed
449    63   R    D   reserved                                                   .
"""

COIL_TABLE = """
 0   16   R    D   standard digital inputs
16    8   R    D   configurable digital inputs
24    4   R    A   tool digital inputs
32   16   RW   D   standard digital outputs
48    8   RW   D   configurable digital outputs
56    4   RW   D   tool digital outputs
60   68   RW   D   general purpose: kept; only clients and programs use them
"""

MARKS = {
    "D": "documented",
    "B": "block documented, meaning and unit *assumed*",
    "A": "*assumed*",
}


def test_registers() -> None:
    shown = [
        (
            str(row.first),
            str(row.size),
            "RW" if row.write else "R",
            row.evidence.replace("; reads as 0 *assumed*", ""),
            row.content,
            row.unit,
        )
        for row in REGISTERS
    ]
    assert shown == [
        (at, size, access, MARKS[mark], what, unit) for at, size, access, mark, what, unit in rows(REGISTER_TABLE)
    ]


def test_coils() -> None:
    shown = [
        (str(row.first), str(row.size), "RW" if row.is_writable else "R", row.evidence, row.content) for row in COILS
    ]
    assert shown == [(at, size, access, MARKS[mark], what) for at, size, access, mark, what in rows(COIL_TABLE)]


@pytest.mark.parametrize(
    ("name", "number"),
    rows(
        """
        READ_COILS                1
        READ_DISCRETE_INPUTS      2
        READ_HOLDING_REGISTERS    3
        READ_INPUT_REGISTERS      4
        WRITE_COIL                5
        WRITE_REGISTER            6
        WRITE_COILS               15
        WRITE_REGISTERS           16
        READ_WRITE_REGISTERS      23
        EXCEPTION_BIT             128
        ILLEGAL_FUNCTION          1
        ILLEGAL_ADDRESS           2
        ILLEGAL_VALUE             3
        DEVICE_FAILURE            4
        ACKNOWLEDGE               5
        DEVICE_BUSY               6
        NEGATIVE_ACKNOWLEDGE      7
        MEMORY_PARITY             8
        GATEWAY_NO_PATH           10
        GATEWAY_NO_ANSWER         11
        READ_BITS_MAX             2000
        READ_REGISTERS_MAX        125
        WRITE_BITS_MAX            1968
        WRITE_REGISTERS_MAX       123
        READ_WRITE_WRITE_MAX      121
        ADDRESSES                 65536
        PDU_MAX                   253
        COIL_ON                   65280
        """
    ),
)
def test_numbers_of_the_specification(name: str, number: str) -> None:
    assert getattr(pdu, name) == int(number)


def test_every_exception_code_is_explained() -> None:
    assert list(pdu.EXCEPTIONS) == [1, 2, 3, 4, 5, 6, 7, 8, 10, 11]
