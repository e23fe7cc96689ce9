"""Reads and writes of the registers and coils of the controller's own Modbus server; `port_map` is their table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from elitescript.errors import ArgumentRangeError, InvalidValueError, MirroredAddressError
from elitescript.messages.machine import MachineRequest, WriteSignal
from elitescript.messages.signals import WORD_MAX
from elitescript.modbus.port_map import COIL_COUNT, COILS, REGISTER_COUNT, REGISTERS, View, Words
from elitescript.said import said

_REGISTER_ROWS: Final = {address: row for row in REGISTERS for address in range(row.first, row.first + row.size)}
_COIL_ROWS: Final = {address: row for row in COILS for address in range(row.first, row.first + row.size)}


class PortImage:
    """All registers and coils of a machine at one tick, computed when they are read.

    Args:
        view: the machine.
    """

    __slots__ = ("_blocks", "view")

    def __init__(self, view: View) -> None:
        self.view = view
        self._blocks: dict[int, Words] = {}

    def registers(self, first: int, count: int) -> list[int]:
        """Return registers from an address on, 0 to 65535 each.

        Raises:
            ArgumentRangeError: no such registers.
        """
        check_registers(first, count)
        values = [0] * count
        end = first + count
        for row in REGISTERS:
            low, high = max(first, row.first), min(end, row.first + row.size)
            if low < high:
                block = self._blocks.get(row.first)
                if block is None:
                    block = self._blocks[row.first] = row.read(self.view)
                values[low - first : high - first] = block[low - row.first : high - row.first]
        return values

    def coils(self, first: int, count: int) -> list[bool]:
        """Return coils from an address on.

        Raises:
            ArgumentRangeError: no such coils.
        """
        _check(first, count, COIL_COUNT, "coil")
        values = [False] * count
        end, signals = first + count, self.view.snapshot.signals
        for row in COILS:
            low, high = max(first, row.first), min(end, row.first + row.size)
            if low < high:
                start = row.point - row.first
                levels = signals[row.family][start + low : start + high]
                values[low - first : high - first] = map(bool, levels)
        return values


def register_writes(first: int, values: Sequence[int]) -> list[MachineRequest]:
    """Return the requests to the machine that write registers.

    Args:
        first: address of the first one.
        values: 0 to 65535 each.

    Raises:
        ArgumentRangeError: no such registers, or a value out of range.
        InvalidValueError: a register that cannot be written, or an invalid value.
    """
    check_writable_registers(first, len(values))
    requests: list[MachineRequest] = []
    for address, value in enumerate(values, first):
        if not 0 <= value <= WORD_MAX:
            raise ArgumentRangeError(
                said(
                    "register {address} must be in [0, {word_max}], got {value}",
                    address=address,
                    word_max=WORD_MAX,
                    value=value,
                ),
                value=value,
                limit=f"[0, {WORD_MAX}]",
            )
        row = _REGISTER_ROWS[address]
        assert row.write is not None
        try:
            requests += row.write(address - row.first, value)
        except (ArgumentRangeError, InvalidValueError) as error:
            error.set_text(said("register {address}: {mistake}", address=address, mistake=error.said))
            raise
    return requests


def coil_writes(first: int, values: Sequence[bool]) -> list[MachineRequest]:
    """Return the requests to the machine that write coils.

    Raises:
        ArgumentRangeError: no such coils.
        MirroredAddressError: a coil that cannot be written.
    """
    check_writable_coils(first, len(values))
    requests: list[MachineRequest] = []
    for address, value in enumerate(values, first):
        row = _COIL_ROWS[address]
        requests.append(WriteSignal(row.family, row.point + address - row.first, bool(value)))
    return requests


def check_registers(first: int, count: int) -> None:
    """Check that registers exist.

    Raises:
        ArgumentRangeError: no such registers.
    """
    _check(first, count, REGISTER_COUNT, "register")


def check_writable_registers(first: int, count: int) -> None:
    """Check that registers can be written, all of them.

    Raises:
        ArgumentRangeError: no such registers.
        MirroredAddressError: one of them cannot be written.
    """
    check_registers(first, count)
    for address in range(first, first + count):
        row = _REGISTER_ROWS.get(address)
        if row is None or row.write is None:
            raise _read_only("register", address, row.content if row else "reserved")


def check_writable_coils(first: int, count: int) -> None:
    """Check that coils can be written, all of them.

    Raises:
        ArgumentRangeError: no such coils.
        MirroredAddressError: one of them cannot be written.
    """
    _check(first, count, COIL_COUNT, "coil")
    for address in range(first, first + count):
        row = _COIL_ROWS.get(address)
        if row is None or not row.is_writable:
            raise _read_only("coil", address, row.content if row else "reserved")


def _check(first: int, count: int, limit: int, what: str) -> None:
    if not (first >= 0 and count >= 1 and first + count <= limit):
        shown = str(first) if count == 1 else said("{first} to {first_2}", first=first, first_2=first + count - 1)
        raise ArgumentRangeError(
            said("there is no {what} {shown}; the addresses are 0 to {limit}", what=what, shown=shown, limit=limit - 1),
            value=first,
            limit=f"[0, {limit - 1}]",
        )


def _read_only(what: str, address: int, content: str) -> MirroredAddressError:
    return MirroredAddressError(
        said("{what} {address} ({content}) cannot be written", what=what, address=address, content=content),
        value=address,
    )
