"""Which addresses a program reaches that runs in this process: the option `network` of a robot (`--network`).

- `none`: only what is beside the robot in its world, or in a test;
- `local`: this computer's loopback addresses as well;
- addresses, networks and names: `local`, and these;
- `all`: every address.

What is decided on is the address that is connected to, so that no other way to write it and no answer of a name server
gets around it. A query of a name is contact too: under `none` and `local` nothing is looked up, `localhost` stands for
the loopback addresses; otherwise the names that the option has, under `all` every name.
"""

from __future__ import annotations

import socket
from collections.abc import Iterable
from typing import Any, Final

from elitescript.environment.addresses import (
    ALL,
    HOST_MAX,
    LOCAL_HOST,
    LOOPBACK,
    NONE,
    address_of,
    embedded,
    is_loopback,
    parse_values,
    place_of,
    plain_name,
    special_kind,
    unmapped,
)
from elitescript.environment.network_option import COMMAND_LINE, Way
from elitescript.errors import UsageError
from elitescript.records import NamedTuple
from elitescript.said import said
from elitescript.shown import printable

OPTION: Final = "--network"
_SHOWN: Final = 80
"""Most characters of an address in a text."""

Rows = list[Any]
"""What `socket.getaddrinfo` returns."""


class Decision(NamedTuple):
    """What a program reaches of an address and port.

    Attributes:
        rows: where it may connect; empty if nowhere, or if the name must be looked up first.
        is_name: whether a name server may be asked for it.
        why_not: why it may not connect, with the option that would allow it; empty if it may.
        fix: part of the option's value that would allow it; empty if none is of use.
        reason: `why_not` without the address.
    """

    rows: Rows
    is_name: bool = False
    why_not: str = ""
    fix: str = ""
    reason: str = ""


class Reach:
    """Decides what programs of one robot reach outside of its world.

    Args:
        text: value of the option.
        is_closed: whether the option changes nothing: the world, or what runs the program, lets nothing else through.
        way: how users set the option.

    Raises:
        UsageError: it makes no sense.
    """

    __slots__ = ("_has_all", "_has_none", "_is_closed", "_kept", "_rules", "_way", "text")

    def __init__(self, text: str, *, is_closed: bool = False, way: Way = COMMAND_LINE) -> None:
        self._is_closed = is_closed
        self._way = way
        words, self._rules, parts = parse_values([text], OPTION)
        self._has_all = ALL in words
        self._has_none = NONE in words
        self._kept = [part for part in parts if part not in words]
        self.text = ",".join(parts)

    def decide(self, name: str, port: int) -> Decision:
        """Decide on an address that a program names; nothing is looked up."""
        if len(name) > HOST_MAX:
            # A name server is not asked for what cannot be a name.
            return self._refused(
                name,
                port,
                said("it has {count} characters, and a name {host_max} at most", count=len(name), host_max=HOST_MAX),
                "",
            )
        rows = _rows(LOOPBACK, port) if plain_name(name) == LOCAL_HOST else numeric(name, port)
        if rows:
            return self.among(rows, name, port)
        if self._has_all or any(rule.names(name, port) for rule in self._rules):
            return Decision([], is_name=True)
        subject = "a closed run" if self._is_closed else self.named
        return self._refused(name, port, said("it is a name, which {subject} does not look up", subject=subject), name)

    def among(self, rows: Rows, name: str, port: int) -> Decision:
        """Decide on what a name, or another way to write an address, stands for."""
        allowed = [row for row in rows if self._allows(name, row[4][0], port)]
        if allowed:
            # Most servers listen on IPv4 alone, whatever the computer likes better.
            return Decision(sorted(allowed, key=lambda row: row[0] != socket.AF_INET))
        first = str(rows[0][4][0])
        address = unmapped(address_of(first))
        kind = special_kind(embedded(address))
        if not kind:
            nothing = "not beside the robot" + ", and this run is closed" * self._is_closed
            kind = nothing if self._has_none else "neither beside the robot nor a loopback address"
        what = "it is" if plain_name(name) == first.lower() else said("it is {first},", first=first)
        return self._refused(name, port, f"{what} {kind}", str(address))

    def _refused(self, name: str, port: int, why: str, host: str) -> Decision:
        shown = printable(name if len(name) <= _SHOWN else f"{name[:_SHOWN]}...")
        fix = place_of(host, port) if self._can_allow(host, port) else ""
        hint = said("; `{allowing}` allows it", allowing=self.allowing([fix])) if fix else ""
        reason = said("{why}{hint}", why=why, hint=hint) if hint else why
        return Decision(
            [],
            why_not=said("not connected to {place}: {reason}", place=place_of(shown, port), reason=reason),
            fix=fix,
            reason=reason,
        )

    @property
    def named(self) -> str:
        """The option with its value, as users write it."""
        return self._way.named.format(self.text)

    def allowing(self, fixes: Iterable[str]) -> str:
        """Return the option, as users write it, with a value that allows what it does, and more."""
        return self._way.allowing.format(",".join([*self._kept, *fixes]))

    def _can_allow(self, host: str, port: int) -> bool:
        """Return whether a value of the option names a host; a text of a program may be anything."""
        if not host or self._is_closed > self._way.opens_closed:
            return False
        try:
            parse_values([place_of(host, port)], OPTION)
        except UsageError:
            return False
        return "," not in host

    def _allows(self, name: str, text: str, port: int) -> bool:
        if self._has_all:
            return True
        address = unmapped(address_of(text))
        if any(rule.has(address, port) for rule in self._rules):
            return True
        if is_loopback(address):
            return not self._has_none
        return any(rule.names(name, port) for rule in self._rules) and not special_kind(embedded(address))


def numeric(name: str, port: int) -> Rows:
    """Return what the number of an address stands for, in whatever way it is written; nothing for a name."""
    try:
        return socket.getaddrinfo(name, port, type=socket.SOCK_STREAM, flags=socket.AI_NUMERICHOST)
    except (OSError, ValueError, OverflowError):
        return []


def _rows(addresses: tuple[str, ...], port: int) -> Rows:
    return [row for address in addresses for row in numeric(address, port)]
