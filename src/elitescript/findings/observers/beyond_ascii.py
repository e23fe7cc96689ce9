"""Finds texts that are sent with characters beyond ASCII."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import TextBeyondAscii
from elitescript.said import said


class BeyondAscii(Observer):
    """Tells of each channel once in what bytes such a character goes."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[str] = set()

    def see(self, seen: TextBeyondAscii) -> Iterable[Finding]:
        """Tell of the first character."""
        letter = next((letter for letter in seen.text if not letter.isascii()), "")
        if not letter or seen.channel in self._told:
            return
        self._told.add(seen.channel)
        data = letter.encode("utf-8", "replace")
        text = said(
            "{letter!r} in a text on {kind} {channel!r} is not ASCII: it goes as UTF-8, {hex}",
            letter=letter,
            kind=seen.kind,
            channel=seen.channel,
            hex=data.hex(" "),
        )
        hint = "does the receiver read UTF-8? socket_send_byte_list sends any bytes"
        yield found("N282", text, line=seen.line, thread=seen.thread, hint=hint)
