"""Finds data that a program has left unread on a channel when it ends."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import ChannelLeft
from elitescript.said import counted, said

SHOWN: Final = 40
"""Most bytes of the data that a finding shows."""


class UnreadData(Observer):
    """Tells what is left by a program that has finished, if it is more than a line end."""

    __slots__ = ("_left",)

    def __init__(self) -> None:
        self._left: list[ChannelLeft] = []

    def see(self, seen: ChannelLeft) -> Iterable[Finding]:
        """Keep what is left: how the program ends is not known yet."""
        if seen.data.strip(b"\r\n\0 "):
            self._left.append(seen)
        return ()

    def end(self, ending: str) -> Iterable[Finding]:
        """Tell of each channel."""
        for left in self._left if ending == "finished" else ():
            size = len(left.data)
            shown = left.data[:SHOWN].decode("utf-8", "backslashreplace")
            text = said(
                "{bytes} on {kind} {channel!r} were not read when the program ended: {data}",
                bytes=counted(size, "byte", "bytes"),
                kind=left.kind,
                channel=left.channel,
                data=f"{shown!r} …" if size > SHOWN else repr(shown),
            )
            hint = "read until the answer is complete, or close the channel when it is not needed any more"
            yield found("N280", text, line=left.line, thread=left.thread, hint=hint)
