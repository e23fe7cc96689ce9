"""Lockstep: time waits for the clients of the RTSI port.

A client takes part from the moment at which it starts its packages (`S`) and has set up an input recipe, until it
pauses, ends its connection or goes. Robot time then advances only while every such client has answered the last data
package that it got by an input package (`U`, of any of its recipes). So between two packages of a client lies exactly
one answer of that client; with a recipe of 125 Hz the robot makes two ticks for each answer. As fast as the clients
answer, as fast does time pass.

- Clients without input recipes listen only. Time does not ask them, but waits while one is behind, so that no package
  is left out.
- While nobody takes part, time passes as on the wall: power can be switched and programs loaded.
- Everything else (dashboard, primary port, sockets of programs) goes on, measured in robot time.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from elitescript.protocol.rtsi import RtsiConnection
from elitescript.services.tcp import Client


class Gate(NamedTuple):
    """Whether time may go on."""

    is_open: bool
    has_participants: bool
    waits_for: str
    """Origin of a client that time waits for; empty if there is none."""


_UNASKED = Gate(True, False, "")
_OPEN = Gate(True, True, "")


def gate(clients: Mapping[str, Client]) -> Gate:
    """Ask the clients of the RTSI port of one robot."""
    has_participants = False
    behind = ""
    for client in clients.values():
        connection = client.connection
        if not isinstance(connection, RtsiConnection) or not connection.is_streaming or client.is_leaving:
            continue
        if connection.has_inputs:
            has_participants = True
            if client.owes_input:
                return Gate(False, True, client.origin)
        if client.is_behind:
            behind = client.origin
    if not has_participants:
        return _UNASKED
    return Gate(False, True, behind) if behind else _OPEN
