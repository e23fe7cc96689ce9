"""Which addresses the programs of a served robot reach: the serving process connects for them, and could reach all.

What is decided on is the address that is connected to, after names were looked up, so that no name, no other way to
write an address and no answer of a name server gets around it. Without rules of the user, programs reach every address
except:

- link-local ones, where the services of clouds give away keys (169.254.169.254);
- the ports of the robots of this `serve`: a program would be its own operator;
- what is no address of one computer: unspecified, multicast, broadcast.
"""

from __future__ import annotations

import re
import socket
from collections.abc import Iterable
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network
from typing import Final

from elitescript.errors import UsageError
from elitescript.records import record

OPTION: Final = "--allow-connect"
ANY: Final = "any"
NONE: Final = "none"
DEFAULT: Final = "default"
OWN_PORTS: Final = "own-ports"
DEFAULT_TEXT: Final = "every address except link-local ones and the ports of this serve's robots"
DEFAULT_WITH_OWN_TEXT: Final = "every address except link-local ones"
HOST_MAX: Final = 253
"""Characters of a host name (RFC 1035, section 2.3.4)."""

_HOST: Final = re.compile(r"[A-Za-z0-9_.\-]+")
_NUMBERS: Final = re.compile(r"(0[xX][0-9A-Fa-f]+|[0-9]+)(\.(0[xX][0-9A-Fa-f]+|[0-9]+))*\.?")
"""What name services take for an address, not for a name: 127.1, 0x7f000001."""
_NAT64: Final = ip_network("64:ff9b::/96")
_THIS_NETWORK: Final = ip_network("0.0.0.0/8")
_BROADCAST: Final = ip_address("255.255.255.255")
_LOCAL_HOST: Final = "localhost"

Address = IPv4Address | IPv6Address


@record
class _Rule:
    """Holds what one option allows: networks, or the host of that name; one port of it, or all."""

    networks: tuple[IPv4Network | IPv6Network, ...]
    name: str
    port: int | None

    def has(self, address: Address, port: int) -> bool:
        """Return whether an address lies in its networks."""
        return self.port in (None, port) and any(address in network for network in self.networks)

    def names(self, name: str, port: int) -> bool:
        """Return whether a program has asked for its name."""
        return bool(self.name) and self.port in (None, port) and name.rstrip(".").lower() == self.name


class ConnectPolicy:
    """Decides which connections programs may open.

    Args:
        texts: values of `--allow-connect`; without one that names addresses, what `DEFAULT_TEXT` says.

    Attributes:
        own_ports: of the robots that are served.

    Raises:
        UsageError: a value makes no sense.
    """

    __slots__ = ("_has_any", "_has_default", "_has_own", "_rules", "own_ports", "text")

    def __init__(self, texts: Iterable[str] = ()) -> None:
        values = [text.strip() for text in texts]
        words = {value for value in values if value in (ANY, NONE, DEFAULT, OWN_PORTS)}
        if NONE in words and len(values) > 1:
            raise UsageError(f"{OPTION} {NONE} allows nothing; it cannot stand beside others")
        self._rules = tuple(_rule(value) for value in values if value not in words)
        self._has_any = ANY in words
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
        if self._has_any:
            return ""
        found = _plain(ip_address(address.partition("%")[0]))
        rules = [rule for rule in self._rules if rule.has(found, port) or rule.names(name, port)]
        if port in self.own_ports and _is_of_this_computer(found):
            if self._has_own or any(rule.port is not None for rule in rules):
                return ""
            return f"port {port} of this computer is the robot's own; `serve {OPTION} {OWN_PORTS}` allows it"
        if any(rule.has(found, port) for rule in rules):
            return ""
        if not (rules or self._has_default):
            return f"{found}:{port} is not among what programs may reach ({self.text}); see `serve {OPTION}`"
        if kind := _special(found):
            return f"{found} is {kind}; `serve {OPTION} {found}` allows it"
        return ""

    def _shown(self, values: list[str]) -> str:
        if self._has_any:
            return "every address"
        if self._has_default and self._has_own and not self._rules:
            return DEFAULT_WITH_OWN_TEXT
        parts = [DEFAULT_TEXT] * self._has_default + [value for value in values if value not in (DEFAULT, OWN_PORTS)]
        return " and ".join(parts + ["the ports of this serve's robots"] * self._has_own)


def _rule(text: str) -> _Rule:
    host, port = _host_and_port(text)
    if host.lower() == _LOCAL_HOST:
        return _Rule((ip_network("127.0.0.0/8"), ip_network("::1/128")), _LOCAL_HOST, port)
    try:
        return _Rule((ip_network(host, strict=False),), "", port)
    except ValueError:
        pass
    if not _HOST.fullmatch(host) or _NUMBERS.fullmatch(host) or len(host) > HOST_MAX or "/" in text:
        raise UsageError(
            f"{OPTION} {text}: write HOST[:PORT], a network such as 192.168.1.0/24, {OWN_PORTS}, {ANY} or {NONE}"
        )
    return _Rule((), host.rstrip(".").lower(), port)


def _host_and_port(text: str) -> tuple[str, int | None]:
    host, colon, number = text.rpartition(":")
    if not colon or (":" in host and not host.endswith("]")):
        return text.removeprefix("[").removesuffix("]"), None
    if not (number.isascii() and number.isdecimal() and 1 <= int(number[:6]) <= 65535):
        raise UsageError(f"{OPTION} {text}: a port is a number from 1 to 65535")
    return host.removeprefix("[").removesuffix("]"), int(number)


def _plain(address: Address) -> Address:
    """Return the IPv4 address that an IPv6 address stands for; any other address as it is."""
    if isinstance(address, IPv6Address):
        if inner := address.ipv4_mapped or address.sixtofour:
            return inner
        if address in _NAT64:
            return IPv4Address(int(address) & 0xFFFF_FFFF)
    return address


def _special(address: Address) -> str:
    """Return what an address is that is not one of a single computer; else empty."""
    if address.is_unspecified or address in _THIS_NETWORK:
        return "no address of a computer"
    if address.is_link_local:
        return "a link-local address"
    if address.is_multicast:
        return "a multicast address"
    return "the broadcast address" if address == _BROADCAST else ""


def _is_of_this_computer(address: Address) -> bool:
    """Return whether a connection to an address ends on this computer."""
    if address.is_loopback or address.is_unspecified or address in _THIS_NETWORK:
        return True
    family = socket.AF_INET if isinstance(address, IPv4Address) else socket.AF_INET6
    try:
        # Nothing is sent: the system chooses the address from which it would be, which is its own.
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.connect((str(address), 9))
            return bool(ip_address(probe.getsockname()[0].partition("%")[0]) == address)
    except OSError:
        return False
