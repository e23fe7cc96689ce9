"""Settings of a serial line."""

from __future__ import annotations

from typing import Final

from elitescript.records import record

PORT_NAMES: Final = {"tool": "tool", "/dev/ttymxc0": "box"}
"""Names of the robot's serial ports, by the device that programs open."""


def bind_hint(device: str) -> str:
    """Return the option that binds a serial port of the robot to one of this computer."""
    name = PORT_NAMES.get(device, device)
    return f'`--serial {name}=DEVICE`, in Python `lines={{"{name}": DEVICE}}`, binds it to a port of this computer'


@record
class LineSettings:
    """Format of characters on a serial line."""

    baud: int
    """Bits per second."""
    parity: int
    """0 none, 1 odd, 2 even."""
    stop_bits: int
    size: int
    """Data bits of a character."""

    @property
    def character_s(self) -> float:
        """Time of one character: start bit, data, parity, stop bits."""
        return (1 + self.size + (self.parity != 0) + self.stop_bits) / self.baud
