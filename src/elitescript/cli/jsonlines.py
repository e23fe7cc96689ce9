"""Strict JSON, one object per line."""

from __future__ import annotations

import json
from math import isfinite, isnan
from typing import Any, Final

_DEEPEST: Final = 50
"""Nesting beyond this is cut off: a list that contains itself must not end the run."""


def line(record: dict[str, Any]) -> str:
    """One record as a line without its line feed."""
    return json.dumps(plain(record), ensure_ascii=False, separators=(",", ":"), allow_nan=False)


def plain(value: Any, depth: int = 0) -> Any:
    """A value as JSON has it: NaN and infinities are strings, tuples are lists, other objects their repr."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return float(value) if isfinite(value) else _non_finite(value)
    if depth < _DEEPEST:
        if isinstance(value, (list, tuple)):
            return [plain(item, depth + 1) for item in value]
        if isinstance(value, dict) and all(isinstance(key, str) for key in value):
            return {key: plain(item, depth + 1) for key, item in value.items()}
    try:
        return {"repr": repr(value)}
    except Exception:
        return {"repr": f"<{type(value).__name__}>"}


def _non_finite(value: float) -> str:
    if isnan(value):
        return "NaN"
    return "Infinity" if value > 0 else "-Infinity"
