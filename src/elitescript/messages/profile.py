"""Differences between the firmwares of the controller. The commands of each are not here: a command has its `since`."""

from __future__ import annotations

from functools import cache
from typing import Final

from elitescript.errors import UsageError
from elitescript.records import record, replace

Release = tuple[int, int]
Version = tuple[int, int, int, int]
"""Major, minor, bug fix, build."""

PUBLISHED: Final[Version] = (2, 15, 0, 0)
"""Version that public clients take: the vendor's SDK asks for 2.14.5 in the line 2.14, its main branch for 2.15.0."""


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
    version: Version
    """What the controller reports, unless an option says otherwise."""
    python: tuple[int, int, int]
    """`sys.version_info` of programs (*assumed*: manual 2.10 needs 3.6 at least)."""
    are_powers_whole: bool = True
    """Whether `pow` of two whole numbers is whole, as `pow(2, 3)` is 8 in manual 2.10; else a float (*assumed*: the
    manual shortens what it prints, also `sin(3.1415926)` to 0, so that its `sqrt(4)`, 2, is no whole number)."""


PROFILES: Final[dict[str, Profile]] = {
    "2.10": Profile("2.10", (2, 10), 15, 0.010, False, 2000, (2, 10, 0, 0), (3, 6, 9)),
    "2.14": Profile("2.14", (2, 14), 20, 0.004, True, 8500, PUBLISHED, (3, 8, 10)),
}
DEFAULT_FIRMWARE: Final = "2.14"

BRACKETED: Final = "bracketed"
PLAIN: Final = "plain"
QUERY_FORMS: Final = (BRACKETED, PLAIN)
"""Forms of the replies of the query port, see `protocol.query`; which firmware has which is not known."""

PART_MAX: Final = 255
"""Largest part of a version: the primary port sends major and minor as bytes."""


def profile(name: str = DEFAULT_FIRMWARE, version: str = "") -> Profile:
    """Return the profile of a firmware.

    Args:
        name: of the firmware.
        version: that the controller reports, as `version_text` writes it; that of the profile if empty.

    Raises:
        UsageError: there is none of that name.
    """
    if name not in PROFILES:
        raise UsageError(f"firmware {name!r} is not known; choose one of {', '.join(PROFILES)}")
    return replace(PROFILES[name], version=version_of(version)) if version else PROFILES[name]


def version_text(version: Version) -> str:
    """Return a version as the controller writes it, such as `2.15.0.0`."""
    return ".".join(map(str, version))


def version_of(text: str) -> Version:
    """Return the version that a text names; parts at the end that are missing are 0.

    Raises:
        UsageError: it is no version.
    """
    parts = text.split(".")
    if not (2 <= len(parts) <= 4 and all(map(_is_part, parts))):
        raise UsageError(
            f"must be a version such as {version_text(PUBLISHED)}, each part up to {PART_MAX}; got {text!r}"
        )
    major, minor, bug_fix, build = (*map(int, parts), 0, 0)[:4]
    return major, minor, bug_fix, build


@cache
def release_of(text: str) -> Release:
    """Return `"2.14"` as a pair that can be compared."""
    major, _, minor = text.partition(".")
    return int(major), int(minor)


def _is_part(text: str) -> bool:
    return text.isascii() and text.isdecimal() and len(text) <= len(str(PART_MAX)) and int(text) <= PART_MAX
