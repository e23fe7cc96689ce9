"""Values of the command line: `--joints`, `--epoch`, sizes in bytes."""

from __future__ import annotations

from math import isfinite
from typing import Final

from elitescript.errors import UsageError
from elitescript.messages.motion import Six


def parse_joints(text: str) -> Six:
    """Return six joint positions in rad, separated by commas.

    Raises:
        UsageError: not six numbers.
    """
    return parse_six("--joints", text, "rad")


def parse_six(option: str, text: str, units: str) -> Six:
    """Return six numbers, separated by commas, of an option of the command line.

    Raises:
        UsageError: not six numbers.
    """
    try:
        a, b, c, d, e, f = (float(part) for part in text.strip("[] ").split(","))
    except ValueError:
        raise UsageError(f"{option} {text}: write six numbers in {units}, separated by commas") from None
    return (a, b, c, d, e, f)


def parse_epoch(text: str) -> float:
    """Return a time as seconds since 1970, from such a number or ISO 8601 (UTC without a zone).

    Raises:
        UsageError: neither form.
    """
    from datetime import UTC, datetime

    try:
        seconds = float(text)
    except ValueError:
        pass
    else:
        if not isfinite(seconds):
            raise UsageError(f"--epoch {text}: not a time")
        return seconds
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise UsageError(f"--epoch {text}: write seconds since 1970, or a time such as 2024-01-01T00:00:00Z") from None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


_UNITS: Final = {"": 1, "b": 1, "kb": 10**3, "mb": 10**6, "gb": 10**9, "kib": 1 << 10, "mib": 1 << 20, "gib": 1 << 30}


def parse_size(text: str, option: str) -> int:
    """Return a number of bytes, with a unit or without: `5000`, `100MB`, `1.5 GiB`.

    Raises:
        UsageError: not of this form.
    """
    number = text.strip().rstrip("BbKkMmGgi")
    factor = _UNITS.get(text.strip()[len(number) :].lower())
    try:
        size = float(number) * (factor or 0)
        if factor and isfinite(size) and size >= 0:
            return int(size)
    except ValueError:
        pass
    raise UsageError(f"{option} {text}: write a number of bytes such as 5000, 100MB or 2GiB")
