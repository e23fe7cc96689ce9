"""Values of the command line: `--set`, `--joints`, `--epoch`, sizes in bytes."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from math import isfinite
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.motion import Six
from elitescript.messages.signals import SIGNALS, Value

_WORDS: Final = {"true": True, "on": True, "high": True, "false": False, "off": False, "low": False}


def parse_settings(texts: list[str], option: str = "--set") -> tuple[dict[str, Value], dict[str, Any]]:
    """Split `NAME=VALUE` settings into signals and program globals.

    A name of the signal table (with an index in brackets, where the family has several) is a signal; any other
    identifier is a global of the program. `option` is the option or verb before them, for messages.

    Raises:
        UsageError: not of this form, or a value that is no literal.
    """
    signals: dict[str, Value] = {}
    presets: dict[str, Any] = {}
    for text in texts:
        name, equals, value_text = text.partition("=")
        name = name.strip()
        if not equals:
            raise UsageError(f"{option} {text}: write NAME=VALUE")
        value = _literal(value_text.strip(), f"{option} {text}")
        if name.partition("[")[0] in SIGNALS or "[" in name:
            signals[name] = value
        elif name.isidentifier():
            presets[name] = value
        else:
            raise UsageError(f"{option} {text}: {name!r} is neither a signal nor a name")
    return signals, presets


def check_presets(presets: Iterable[str], program: str) -> None:
    """Refuse a global that looks like a misspelt signal and is in no line of the program.

    Raises:
        UsageError: there is one; the text names the signal.
    """
    for name in presets:
        near = did_you_mean(name, SIGNALS)
        if near and name not in program:
            raise UsageError(f"--set {name}: there is no such signal, and the program has no such global{near}")


def parse_joints(text: str) -> Six:
    """Return six joint positions in rad, separated by commas.

    Raises:
        UsageError: not six numbers.
    """
    try:
        a, b, c, d, e, f = (float(part) for part in text.strip("[] ").split(","))
    except ValueError:
        raise UsageError(f"--joints {text}: write six numbers in rad, separated by commas") from None
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


def _literal(text: str, setting: str) -> Any:
    if text.lower() in _WORDS:
        return _WORDS[text.lower()]
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        raise UsageError(f"{setting}: {text!r} is no literal; write true, 3, 0.5, 'text' or [1, 2]") from None
