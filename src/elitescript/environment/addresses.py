"""The syntax in which users name what programs reach, for `--network` and `--allow-connect`, and kinds of addresses.

A value is a list, separated by commas: words such as `local` and `all`, numbers of addresses (`192.168.1.5`, `::1`),
networks (`192.168.1.0/24`) and names (`camera.local`), each perhaps with a port (`192.168.1.5:502`, `[fd00::5]:502`).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network
from typing import Final

from elitescript.errors import UsageError
from elitescript.records import record

ALL: Final = "all"
ANY: Final = "any"
"""Means the same as `ALL`."""
LOCAL: Final = "local"
NONE: Final = "none"
LOCAL_HOST: Final = "localhost"
LOOPBACK: Final = ("127.0.0.1", "::1")
"""What `LOCAL_HOST` stands for; it is not looked up."""
HOST_MAX: Final = 253
"""Characters of a host name (RFC 1035, section 2.3.4)."""

Address = IPv4Address | IPv6Address

_HOST: Final = re.compile(r"[A-Za-z0-9_.\-]+")
_NUMBERS: Final = re.compile(r"(0[xX][0-9A-Fa-f]+|[0-9]+)(\.(0[xX][0-9A-Fa-f]+|[0-9]+))*\.?")
"""What name services take for an address, not for a name: 127.1, 0x7f000001."""
_NAT64: Final = ip_network("64:ff9b::/96")
_THIS_NETWORK: Final = ip_network("0.0.0.0/8")
_BROADCAST: Final = ip_address("255.255.255.255")
_LOOPBACK: Final = (ip_network("127.0.0.0/8"), ip_network("::1/128"))


@record
class AddressRule:
    """Holds what one part of a value allows: networks, or the host of that name; one port of it, or all."""

    networks: tuple[IPv4Network | IPv6Network, ...]
    name: str
    port: int | None

    def has(self, address: Address, port: int) -> bool:
        """Return whether an address lies in its networks."""
        return self.port in (None, port) and any(address in network for network in self.networks)

    def names(self, name: str, port: int) -> bool:
        """Return whether a program has asked for its name."""
        return bool(self.name) and self.port in (None, port) and plain_name(name) == self.name


LOOPBACK_RULE: Final = AddressRule(_LOOPBACK, LOCAL_HOST, None)


def parse_values(
    texts: Iterable[str], option: str, more: Collection[str] = ()
) -> tuple[frozenset[str], tuple[AddressRule, ...], tuple[str, ...]]:
    """Return the words, the rules of addresses and all parts of values, each part once.

    Args:
        texts: values of the option.
        option: its name, for error texts.
        more: words that it takes besides `ALL`, `ANY`, `LOCAL` and `NONE`.

    Raises:
        UsageError: a part makes no sense, or `none` stands beside others.
    """
    parts: list[str] = []
    for text in texts:
        for part in text.split(","):
            if not part.strip():
                raise UsageError(f"{option} {text!r}: {_form(more)}")
            parts.append(part.strip())
    parts = list(dict.fromkeys(parts))
    known = {ALL, ANY, LOCAL, NONE, *more}
    words = frozenset(ALL if part == ANY else part for part in parts if part in known)
    if NONE in words and len(parts) > 1:
        raise UsageError(f"{option} {NONE}: it allows nothing, and cannot stand beside others")
    rules = tuple(_rule(part, option, more) for part in parts if part not in known)
    return words, rules, tuple(parts)


def _form(more: Collection[str]) -> str:
    words = (*(word for word in more if word != "default"), LOCAL, ALL)
    return f"write HOST[:PORT], a network such as 192.168.1.0/24, {', '.join(words)} or {NONE}"


def _rule(text: str, option: str, more: Collection[str]) -> AddressRule:
    host, port = _host_and_port(text, option)
    if plain_name(host) == LOCAL_HOST:
        return AddressRule(_LOOPBACK, LOCAL_HOST, port)
    if "%" in host:
        link = host[host.index("%") :]
        raise UsageError(f"{option} {text}: write the address without {link}: it holds on every link")
    try:
        return AddressRule((ip_network(host, strict=False),), "", port)
    except ValueError:
        pass
    if not _HOST.fullmatch(host) or _NUMBERS.fullmatch(host) or len(host) > HOST_MAX or "/" in text:
        raise UsageError(f"{option} {text}: {_form(more)}")
    return AddressRule((), plain_name(host), port)


def _host_and_port(text: str, option: str) -> tuple[str, int | None]:
    host, colon, number = text.rpartition(":")
    if not colon or (":" in host and not host.endswith("]")):
        return text.removeprefix("[").removesuffix("]"), None
    if not (number.isascii() and number.isdecimal() and 1 <= int(number[:6]) <= 65535):
        raise UsageError(f"{option} {text}: a port is a number from 1 to 65535")
    return host.removeprefix("[").removesuffix("]"), int(number)


def place_of(host: str, port: int) -> str:
    """Return an address and a port as a value names them."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def plain_name(name: str) -> str:
    """Return a name without the dot at its end, in small letters: names that are equal mean one host."""
    return name.rstrip(".").lower()


def address_of(text: str) -> Address:
    """Return the address that a name service has given, without its link."""
    return ip_address(text.partition("%")[0])


def unmapped(address: Address) -> Address:
    """Return the IPv4 address to which a connection to an IPv4-mapped address goes; any other one as it is."""
    return (address.ipv4_mapped or address) if isinstance(address, IPv6Address) else address


def embedded(address: Address) -> Address:
    """Return the IPv4 address that an IPv6 address stands for, also through a gateway; any other one as it is."""
    if isinstance(address, IPv6Address):
        if inner := address.ipv4_mapped or address.sixtofour:
            return inner
        if address in _NAT64:
            return IPv4Address(int(address) & 0xFFFF_FFFF)
    return address


def is_loopback(address: Address) -> bool:
    """Return whether a connection to an address cannot leave this computer, wherever it is made."""
    return any(unmapped(address) in network for network in _LOOPBACK)


def is_unspecified(address: Address) -> bool:
    """Return whether it is no address of a computer, such as 0.0.0.0; systems take it for their own."""
    return address.is_unspecified or address in _THIS_NETWORK


def special_kind(address: Address) -> str:
    """Return what an address is that is not one of a single computer; else empty."""
    if is_unspecified(address):
        return "no address of a computer"
    if address.is_link_local:
        return "a link-local address"
    if address.is_multicast:
        return "a multicast address"
    return "the broadcast address" if address == _BROADCAST else ""
