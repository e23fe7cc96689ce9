"""Finds values for MODBUS registers of which only the low 16 bits are sent."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import RegisterCut
from elitescript.said import said


class CutRegisters(Observer):
    """Tells of each signal and line once; a negative value that fits into 16 bits is a note."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[tuple[str, int, str]] = set()

    def see(self, seen: RegisterCut) -> Iterable[Finding]:
        """Tell what the device gets."""
        code = "N287" if -0x8000 <= seen.value < 0 else "W287"
        key = seen.signal, seen.line, code
        if key in self._told:
            return
        self._told.add(key)
        text = said(
            "{value} becomes {sent} in the register {signal!r}: only its low 16 bits are sent",
            value=seen.value,
            sent=seen.sent,
            signal=seen.signal,
        )
        hint = (
            "a device with signed registers reads it as it was meant"
            if code == "N287"
            else "a register holds 0 to 65535; split a larger value into two registers"
        )
        yield found(code, text, line=seen.line, thread=seen.thread, hint=hint)
