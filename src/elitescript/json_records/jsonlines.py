"""Strict JSON, one object per line."""

from __future__ import annotations

from math import isfinite, isnan
from typing import Any, Final

from elitescript.runtime.environment import without_addresses

_VALUES_MAX: Final = 100_000
"""Limit of the values of one record, because a list can contain itself many times over."""

_DIGITS_MAX: Final = 4000
"""Digits of an integer that Python converts to text by default."""

_CUT_OFF: Final = {"repr": "..."}


def line(record: dict[str, Any]) -> str:
    """Return one record as a line without its line feed."""
    # Not at the top: reports for people need none of it.
    import json

    value = plain(record)
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    if text.isascii() or _is_encodable(text):
        return text
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


def plain(value: Any) -> Any:
    """Return a value as JSON has it: NaN and infinities are strings, tuples are lists, other objects their repr."""
    return _Plain().of(value)


class _Plain:
    """Converts one value; counts its parts, and tracks the containers around the present one."""

    def __init__(self) -> None:
        self._left = _VALUES_MAX
        self._inside: set[int] = set()

    def of(self, value: Any) -> Any:
        self._left -= 1
        if value is None or value is True or value is False:
            return value
        if isinstance(value, str):
            return without_addresses(str.__str__(value))
        if isinstance(value, int):
            return _whole(int(value))
        if isinstance(value, float):
            return float(value) if isfinite(value) else _non_finite(value)
        if isinstance(value, (list, tuple, dict)):
            return self._container(value)
        return _shown(value)

    def _container(self, value: list[Any] | tuple[Any, ...] | dict[Any, Any]) -> Any:
        if self._left <= 0 or id(value) in self._inside:
            return _CUT_OFF
        self._inside.add(id(value))
        try:
            if isinstance(value, dict):
                if not all(isinstance(key, str) for key in value):
                    return _shown(value)
                return {str.__str__(key): self.of(item) for key, item in dict.items(value)}
            return [self.of(item) for item in value]
        except RecursionError:
            return _CUT_OFF
        finally:
            self._inside.discard(id(value))


def _shown(value: Any) -> dict[str, str]:
    # The repr of an object of the script is script code: it may raise anything, the end of its thread included.
    try:
        return {"repr": without_addresses(repr(value))}
    except KeyboardInterrupt:
        raise
    except BaseException:
        return {"repr": f"<{type(value).__name__}>"}


def _whole(value: int) -> Any:
    return value if value.bit_length() < 3 * _DIGITS_MAX else {"repr": f"<an int of {value.bit_length()} bits>"}


def _non_finite(value: float) -> str:
    if isnan(value):
        return "NaN"
    return "Infinity" if value > 0 else "-Infinity"


def _is_encodable(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True
