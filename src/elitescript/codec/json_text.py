"""Encoded messages as one line of ASCII JSON, and back."""

from __future__ import annotations

import json
from math import isfinite
from typing import Any, Final

from elitescript.codec.values import CodecError, float_word
from elitescript.shown import encodable_json
from elitescript.untrusted.json_text import JsonError, json_value

TEXT_MAX: Final = 32 * 1024 * 1024
"""Characters of a JSON text."""

_JSON: Final = json.JSONEncoder(allow_nan=False, check_circular=False, separators=(",", ":"))


def to_text(data: Any) -> str:
    """Return encoded data as one line of ASCII JSON; halves of surrogate pairs are escapes within its texts."""
    try:
        text = _JSON.encode(data)
    except ValueError:
        text = _JSON.encode(_without_non_finite(data))
    return encodable_json(text)


def from_text(text: str | bytes, limit: int = TEXT_MAX) -> Any:
    """Return the data of a JSON text.

    Raises:
        CodecError: longer than `limit`, or no JSON.
    """
    if len(text) > limit:
        raise CodecError(f"a message of {len(text)} characters; at most {limit} are read")
    try:
        # Shapes bound the nesting of what they read.
        return json_value(text, depth_max=None)
    except JsonError as error:
        raise CodecError(f"no JSON: {str(error)[:80]}") from None


def _without_non_finite(data: Any) -> Any:
    """Replace each float that JSON does not have by its word."""
    if type(data) is float and not isfinite(data):
        return float_word(data)
    if type(data) is list:
        return [_without_non_finite(item) for item in data]
    if type(data) is dict:
        return {key: _without_non_finite(item) for key, item in data.items()}
    return data
