"""Finds connections that a program goes on using after the peer has closed them."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import PeerClosed
from elitescript.said import Said, said


class ClosedPeers(Observer):
    """Tells of each connection once."""

    __slots__ = ()

    def see(self, seen: PeerClosed) -> Iterable[Finding]:
        """Tell of the first use."""
        why = seen.reason or Said("by its peer")
        lost = Said("nothing was sent" if seen.done == "sent" else "nothing more can be read")
        text = said(
            "{kind} {channel!r} is closed ({why}): {lost}", kind=seen.kind, channel=seen.channel, why=why, lost=lost
        )
        hint = "look at the result, and open it anew with socket_close and socket_open"
        yield found("N281", text, line=seen.line, thread=seen.thread, hint=hint)
