"""Which addresses the programs of a served robot reach: the serving process connects for them, and could reach all.

What is decided on is the address that is connected to, after names were looked up, so that no name, no other way to
write an address and no answer of a name server gets around it. Without rules of the user, programs reach every address
except:

- link-local ones, where the services of clouds give away keys (169.254.169.254);
- the ports of the robots of this `serve`: a program would be its own operator;
- what is no address of one computer: unspecified, multicast, broadcast.
"""

from __future__ import annotations

import socket
from collections.abc import Iterable
from ipaddress import IPv4Address, ip_address
from typing import Final

from elitescript.environment.addresses import (
    ALL,
    LOCAL,
    LOCAL_HOST,
    LOOPBACK_RULE,
    NONE,
    Address,
    address_of,
    embedded,
    is_loopback,
    is_unspecified,
    parse_values,
    special_kind,
)

OPTION: Final = "--allow-connect"
DEFAULT: Final = "default"
OWN_PORTS: Final = "own-ports"
DEFAULT_TEXT: Final = "every address except link-local ones and the ports of this serve's robots"
DEFAULT_WITH_OWN_TEXT: Final = "every address except link-local ones"
LOCAL_TEXT: Final = "this computer"


def policy_values(given: Iterable[str], network: str | None) -> list[str]:
    """Return values of `--allow-connect`: those that are given, else what `[robot] network` of a world file means.

    Args:
        given: on the command line.
        network: of the world file; None if it has none.
    """
    values = list(given)
    if values or network is None:
        return values
    return [network] if network in (NONE, LOCAL, ALL) else [network, LOCAL]


class ConnectPolicy:
    """Decides which connections programs may open.

    Args:
        texts: values of `--allow-connect`; without one that names addresses, what `DEFAULT_TEXT` says.

    Attributes:
        own_ports: of the robots that are served.

    Raises:
        UsageError: a value makes no sense.
    """

    __slots__ = ("_has_all", "_has_default", "_has_own", "_rules", "own_ports", "text")

    def __init__(self, texts: Iterable[str] = ()) -> None:
        words, rules, values = parse_values(texts, OPTION, (OWN_PORTS, DEFAULT))
        self._rules = (*rules, LOOPBACK_RULE) if LOCAL in words else rules
        self._has_all = ALL in words
        self._has_own = OWN_PORTS in words
        self._has_default = DEFAULT in words or not (self._rules or words - {OWN_PORTS})
        self.own_ports: set[int] = set()
        self.text = self._shown(values)
        """What programs reach, in words."""

    def refusal(self, name: str, address: str, port: int) -> str:
        """Return why a program may not connect; empty if it may.

        Args:
            name: what the program asked for.
            address: what that was resolved to.
            port: of the server.
        """
        if self._has_all:
            return ""
        found = embedded(address_of(address))
        rules = [rule for rule in self._rules if rule.has(found, port) or rule.names(name, port)]
        if port in self.own_ports and _is_of_this_computer(found):
            if self._has_own or any(rule.port is not None for rule in rules):
                return ""
            return f"port {port} of this computer is the robot's own; `serve {OPTION} {OWN_PORTS}` allows it"
        if any(rule.has(found, port) for rule in rules):
            return ""
        if not (rules or self._has_default):
            return f"{found}:{port} is not among what programs may reach ({self.text}); see `serve {OPTION}`"
        if kind := special_kind(found):
            return f"{found} is {kind}; `serve {OPTION} {found}` allows it"
        return ""

    def looks_up(self, name: str, port: int) -> bool:
        """Return whether a name server may be asked for a name: a query is contact too."""
        if self._has_all or self._has_default or any(rule.names(name, port) for rule in self._rules):
            return True
        # A name may stand for an address of a network that is allowed, but loopback addresses have one name.
        return any(rule.networks and rule.name != LOCAL_HOST for rule in self._rules)

    def _shown(self, values: tuple[str, ...]) -> str:
        if self._has_all:
            return "every address"
        if self._has_default and self._has_own and not self._rules:
            return DEFAULT_WITH_OWN_TEXT
        parts = [DEFAULT_TEXT] * self._has_default
        parts += [LOCAL_TEXT if value == LOCAL else value for value in values if value not in (DEFAULT, OWN_PORTS)]
        return " and ".join(parts + ["the ports of this serve's robots"] * self._has_own)


def _is_of_this_computer(address: Address) -> bool:
    """Return whether a connection to an address ends on this computer."""
    if is_loopback(address) or is_unspecified(address):
        return True
    family = socket.AF_INET if isinstance(address, IPv4Address) else socket.AF_INET6
    try:
        # Nothing is sent: the system chooses the address from which it would be, which is its own.
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.connect((str(address), 9))
            return bool(ip_address(probe.getsockname()[0].partition("%")[0]) == address)
    except OSError:
        return False
