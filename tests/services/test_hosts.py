"""Addresses of the robots of one `serve`."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.services.hosts import hosts_of, is_loopback


@pytest.mark.parametrize(
    ("text", "robots", "hosts"),
    [
        ("127.0.0.1", 2, ("127.0.0.1", "127.0.0.1")),
        ("127.0.0.11-13", 3, ("127.0.0.11", "127.0.0.12", "127.0.0.13")),
        ("127.0.0.11-11", 1, ("127.0.0.11",)),
        ("192.168.1.254-255", 2, ("192.168.1.254", "192.168.1.255")),
        ("cell-3.local", 2, ("cell-3.local", "cell-3.local")),
        ("::1", 1, ("::1",)),
    ],
)
def test_each_robot_has_its_address(text: str, robots: int, hosts: tuple[str, ...]) -> None:
    assert hosts_of(text, robots) == hosts


@pytest.mark.parametrize(
    ("text", "robots", "words"),
    [
        ("127.0.0.11-13", 2, "--host 127.0.0.11-13: 3 addresses for 2 robots; each robot has one, so give --robots 3"),
        ("127.0.0.11-11", 2, "1 address for 2 robots"),
        ("127.0.0.11-13", 1, "3 addresses for 1 robot;"),
        ("127.0.0.13-11", 3, "write a range as 127.0.0.11-13, the last number from 13 to 255"),
        ("127.0.0.250-256", 7, "the last number from 250 to 255"),
        ("127.0.0.1-", 1, "write a range"),
        ("127.0.0.1-127.0.0.3", 3, "write a range"),
    ],
)
def test_what_is_no_range_for_these_robots_is_refused(text: str, robots: int, words: str) -> None:
    with pytest.raises(UsageError) as caught:
        hosts_of(text, robots)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("text", "is_own"), [("127.0.0.11-13", True), ("127.0.0.1", True), ("192.168.1.11-13", False), ("0.0.0.0", False)]
)
def test_a_range_of_loopback_addresses_is_for_this_computer_alone(text: str, is_own: bool) -> None:
    assert is_loopback(text) == is_own
