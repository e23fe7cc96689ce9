"""Addresses at which the robots of one `serve` listen: one for all, or one for each."""

from __future__ import annotations

from ipaddress import AddressValueError, IPv4Address
from typing import Final

from elitescript.errors import UsageError

LOOPBACK: Final = frozenset({"127.0.0.1", "localhost", "::1", "ip6-localhost"})


def is_loopback(host: str) -> bool:
    """Return whether only this computer reaches a server at this address, or at those of this range."""
    return host in LOOPBACK or (host.startswith("127.") and host.count(".") == 3)


def range_of(text: str) -> tuple[str, ...]:
    """Return the addresses of a range `A.B.C.D-E`, the last numbers from D to E; none for any other text.

    Raises:
        UsageError: it is like a range and is none.
    """
    first, dash, last = text.partition("-")
    if not dash:
        return ()
    try:
        address = IPv4Address(first)
    except AddressValueError:
        return ()  # a name with a hyphen
    low = int(address) % 256
    if not (last.isascii() and last.isdecimal() and len(last) <= 3 and low <= int(last) <= 255):
        raise UsageError(f"--host {text}: write a range as 127.0.0.11-13, the last number from {low} to 255")
    return tuple(str(address + step) for step in range(int(last) - low + 1))


def hosts_of(text: str, robots: int) -> tuple[str, ...]:
    """Return where each robot listens: all at one address, or each at its own of a range.

    Raises:
        UsageError: a range that is none, or that has not one address for each robot.
    """
    hosts = range_of(text)
    if not hosts:
        return (text,) * robots
    if len(hosts) != robots:
        addresses = "1 address" if len(hosts) == 1 else f"{len(hosts)} addresses"
        wanted = "1 robot" if robots == 1 else f"{robots} robots"
        raise UsageError(f"--host {text}: {addresses} for {wanted}; each robot has one, so give --robots {len(hosts)}")
    return hosts
