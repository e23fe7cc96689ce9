"""Makes the request that sets a signal by name."""

from __future__ import annotations

from math import isfinite

from elitescript.errors import UsageError
from elitescript.messages.machine import WriteSignal
from elitescript.messages.signals import parse_signal_name


def signal_write(name: str, value: object) -> WriteSignal:
    """Return the request that sets one signal, with the value checked against its kind.

    Raises:
        UsageError: no such signal, or a value of another kind.
    """
    signal, index = parse_signal_name(name)
    if signal.kind == "bool":
        if value not in (True, False):
            raise UsageError(f"{name} takes True or False, not {value!r}")
        return WriteSignal(signal.name, index, bool(value))
    if not isinstance(value, (int, float)) or not _is_finite(value) or (signal.kind == "int" and int(value) != value):
        raise UsageError(f"{name} takes {'an int' if signal.kind == 'int' else 'a number'}, not {value!r}")
    return WriteSignal(signal.name, index, int(value) if signal.kind == "int" else float(value))


def _is_finite(value: float) -> bool:
    try:
        return isfinite(value)
    except OverflowError:
        return False  # an int beyond all floats
