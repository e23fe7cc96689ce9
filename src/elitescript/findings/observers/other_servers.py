"""Finds names of connections that are opened for another server while they stand."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import OtherServer
from elitescript.said import said


class OtherServers(Observer):
    """Tells of each name and server once."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()

    def see(self, seen: OtherServer) -> Iterable[Finding]:
        """Tell which server gets what is sent."""
        if (seen.channel, seen.wanted) in self._told:
            return
        self._told.add((seen.channel, seen.wanted))
        text = said(
            "{kind} {channel!r} is open to {place} and stays so: {wanted} is not opened, and what is "
            "sent goes to {place}",
            kind=seen.kind,
            channel=seen.channel,
            place=seen.place,
            wanted=seen.wanted,
        )
        hint = "give each server a name of its own, the third argument, or close the name first"
        yield found("W247", text, line=seen.line, thread=seen.thread, hint=hint)
