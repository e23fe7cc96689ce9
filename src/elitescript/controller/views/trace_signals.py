"""Gives the rows of a trace their signals: one mapping for all rows between two changes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Final

from elitescript.messages.signals import SIGNALS, Value, parse_signal_name, signal_name

ALL: Final = "all"

Image = Mapping[str, tuple[Value, ...]]
"""Levels by family; unchanged families are the identical tuples."""


class SignalRecord(dict[str, Value]):
    """Signals by name; any other signal that exists reads as its default."""

    def __missing__(self, name: str) -> Value:
        signal, _ = parse_signal_name(name)
        return signal.default


class SignalLevels(Mapping[str, Value]):
    """Levels of signals by name, immutable: rows of a trace share them.

    Args:
        levels: by name; belongs to this object from now on.
        has_defaults: whether any other signal that exists reads as its default.
    """

    __slots__ = ("_has_defaults", "_levels")

    def __init__(self, levels: dict[str, Value], *, has_defaults: bool = False) -> None:
        self._levels = levels
        self._has_defaults = has_defaults

    def __getitem__(self, name: str) -> Value:
        if self._has_defaults and name not in self._levels:
            return parse_signal_name(name)[0].default
        return self._levels[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._levels)

    def __len__(self) -> int:
        return len(self._levels)

    def __contains__(self, name: object) -> bool:
        return name in self._levels

    def __hash__(self) -> int:
        return hash(frozenset(self._levels.items()))

    def __repr__(self) -> str:
        return repr(self._levels)


NO_SIGNALS: Final = SignalLevels({})
"""Signals of rows without signals."""


class TraceSignals:
    """Selects the signals for the rows of a trace.

    Args:
        names: signals, or families such as `standard_digital_in`; `all` for every signal. If None, those that are not
            at their default; then any other reads as its default.

    Attributes:
        names: the signals in their order; empty if they are those that are not at their default.

    Raises:
        UsageError: there is no such signal.
    """

    __slots__ = ("_families", "_image", "_shown", "names")

    def __init__(self, names: str | Iterable[str] | None = None) -> None:
        self.names: tuple[str, ...] = () if names is None else _expanded(names)
        self._families: dict[str, list[tuple[int, str]]] = {}
        """Index and name of the points, by family."""
        for name in self.names or _expanded(ALL):
            row, index = parse_signal_name(name)
            self._families.setdefault(row.name, []).append((index, name))
        self._image: Image = {}
        self._shown = SignalLevels({}, has_defaults=not self.names)

    def of(self, image: Image) -> SignalLevels:
        """Return the signals of an image; the identical mapping as before if none of them has changed.

        Args:
            image: every family by name.
        """
        if image is self._image:
            return self._shown
        before, self._image = self._image, image
        changed = [name for name in self._families if image[name] is not before.get(name)]
        if not changed:
            return self._shown
        levels = dict(self._shown)
        for family in changed:
            default, values = SIGNALS[family].default, image[family]
            for index, name in self._families[family]:
                if self.names or values[index] != default:
                    levels[name] = values[index]
                else:
                    levels.pop(name, None)
        if levels != dict(self._shown):
            self._shown = SignalLevels(levels, has_defaults=not self.names)
        return self._shown


def _expanded(names: str | Iterable[str]) -> tuple[str, ...]:
    """Return the names of single signals, each once.

    Raises:
        UsageError: there is no such signal.
    """
    wanted = [name.strip() for name in names.split(",")] if isinstance(names, str) else list(names)
    found: dict[str, None] = {}
    for name in wanted:
        if name == ALL:
            rows = list(SIGNALS.values())
        elif name in SIGNALS:
            rows = [SIGNALS[name]]
        else:
            row, index = parse_signal_name(name)
            found[signal_name(row, index)] = None
            continue
        found.update(dict.fromkeys(signal_name(row, index) for row in rows for index in range(row.size)))
    return tuple(found)
