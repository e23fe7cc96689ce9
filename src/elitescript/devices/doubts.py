"""Looks for what is possible and hardly meant in the settings of devices and faults."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.messages.signals import SIGNALS, parse_signal_name, signal_name
from elitescript.records import NamedTuple
from elitescript.said import said

_DELAYS: Final = {"latency_s": 20.0, "jitter_s": 20.0, "delay_s": 20.0, "settle_s": 20.0}
"""Least time in s that hardly any connection takes, by the setting."""
_DURATIONS: Final = {"after_s": 100.0, "pulse_s": 100.0, "duration_s": 100.0, "picked_after_s": 100.0}
"""Least time in s that few machines take; some do."""
_SIGNAL_KEYS: Final = ("then", "signal")
"""Settings that name a signal which the world sets."""
_WRITTEN_BY_CLIENTS: Final = ("general_register", "general_coil")


class Doubt(NamedTuple):
    """What is hardly meant.

    Attributes:
        severity: `warning` or `note`.
        text: what it is.
        hint: what to write.
    """

    severity: str
    text: str
    hint: str


def doubts_of(title: str, settings: Mapping[str, Any]) -> Iterator[Doubt]:
    """Yield the doubts about the settings of one device or fault.

    Args:
        title: what messages call it.
        settings: by name; rows in them, such as replies, are looked at too.
    """
    for name, value in settings.items():
        if name in _SIGNAL_KEYS and isinstance(value, str):
            yield from _set_output(title, name, value)
        elif name in _DELAYS or name in _DURATIONS:
            yield from _milliseconds(title, name, value)
        elif isinstance(value, Mapping):
            yield from _of_rows(title, value.values())
        elif isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
            yield from _of_rows(title, value)


def _of_rows(title: str, rows: Iterable[Any]) -> Iterator[Doubt]:
    for row in rows:
        if isinstance(row, Mapping):
            for name in (*_DELAYS, *_DURATIONS):
                yield from _milliseconds(title, name, row.get(name))


def _milliseconds(title: str, name: str, value: object) -> Iterator[Doubt]:
    limit = _DELAYS.get(name) or _DURATIONS[name]
    if isinstance(value, int | float) and value >= limit:
        text = said("{device}: {name} is {value:g}, in seconds", device=title, name=name, value=value)
        hint = said("{value:g} ms are {name} = {in_s:g}", value=value, name=name, in_s=value / 1000)
        yield Doubt("warning" if name in _DELAYS else "note", text, hint)


def _set_output(title: str, name: str, value: str) -> Iterator[Doubt]:
    try:
        row, index = parse_signal_name(value)
    except UsageError:
        return
    if row.is_input or row.name in _WRITTEN_BY_CLIENTS:
        return
    other = row.name.replace("_out", "_in") if "_out" in row.name else row.name.replace("output_", "input_")
    meant = signal_name(SIGNALS[other], index) if other in SIGNALS and other != row.name else ""
    text = said("{device}: {name} is {signal}, which the robot sets", device=title, name=name, signal=value)
    hint = said("name an input: is {signal} meant?", signal=meant) if meant else "name an input of the robot"
    yield Doubt("warning", text, hint)


def doubts_of_held(holders: Iterable[tuple[str, str]]) -> Iterator[Doubt]:
    """Yield the doubts about signals whose level two devices determine.

    Args:
        holders: title of the device and name of the signal.
    """
    first: dict[str, str] = {}
    for title, name in holders:
        try:
            signal = signal_name(*parse_signal_name(name))
        except UsageError:
            continue
        if signal in first:
            text = said(
                "{device}: {signal} follows another wire already, {other}",
                device=title,
                signal=signal,
                other=first[signal],
            )
            yield Doubt("warning", text, 'the last change of either wins; join both in one wire: when = "a or b"')
        first.setdefault(signal, title)
