"""Differences between the firmwares of the controller. The commands of each are not here: a command has its `since`."""

from __future__ import annotations

from functools import cache
from typing import Final

from elitescript.errors import UsageError
from elitescript.records import record

Release = tuple[int, int]


@record
class Profile:
    """What is particular to one firmware."""

    name: str
    release: Release
    thread_limit: int
    """Most script threads at a time (15 in manual 2.10; 20 from a field message of newer firmware, *observed*)."""
    servoj_t_s: float
    """Default control time of `servoj`."""
    is_servoj_gain_used: bool
    interpreter_queue_limit: int

    @property
    def version(self) -> tuple[int, int, int, int]:
        """Version that the controller reports: major, minor, bug fix, build; the last two are *assumed*."""
        return (*self.release, 0, 0)


PROFILES: Final[dict[str, Profile]] = {
    "2.10": Profile("2.10", (2, 10), 15, 0.010, False, 2000),
    "2.14": Profile("2.14", (2, 14), 20, 0.004, True, 8500),
}
DEFAULT_FIRMWARE: Final = "2.14"


def profile(name: str = DEFAULT_FIRMWARE) -> Profile:
    """Return the profile of a firmware.

    Raises:
        UsageError: there is none of that name.
    """
    if name not in PROFILES:
        raise UsageError(f"firmware {name!r} is not known; choose one of {', '.join(PROFILES)}")
    return PROFILES[name]


@cache
def release_of(text: str) -> Release:
    """Return `"2.14"` as a pair that can be compared."""
    major, _, minor = text.partition(".")
    return int(major), int(minor)
