"""Encoded messages as one line of ASCII JSON, and back."""

from __future__ import annotations

import json
from math import isfinite
from typing import Any, Final

from elitescript.codec.values import CodecError, float_word

TEXT_MAX: Final = 32 * 1024 * 1024
"""Characters of a JSON text."""
DIGITS_MAX: Final = 100
"""Characters of a number in a request."""
DEPTH_MAX: Final = 20
"""Lists and objects around a value of a request."""

_JSON: Final = json.JSONEncoder(allow_nan=False, check_circular=False, separators=(",", ":"))


def to_text(data: Any) -> str:
    """Return encoded data as one line of ASCII JSON."""
    try:
        return _JSON.encode(data)
    except ValueError:
        return _JSON.encode(_without_non_finite(data))


def from_text(text: str | bytes, limit: int = TEXT_MAX) -> Any:
    """Return the data of a JSON text.

    Raises:
        CodecError: longer than `limit`, or no JSON.
    """
    if len(text) > limit:
        raise CodecError(f"a message of {len(text)} characters; at most {limit} are read")
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise CodecError(f"no JSON: {str(error)[:80]}") from None


def request_from(text: bytes, limit: int) -> dict[str, Any]:
    """Return the object of a request from outside, in which every value has one meaning.

    Raises:
        CodecError: longer than `limit`, no JSON object, or one with a name twice, a number that is not finite or very
            long, or lists in lists without end.
    """
    if len(text) > limit:
        raise CodecError(f"a request has {limit} bytes at most")
    try:
        data = json.loads(
            text.decode("utf-8"),
            parse_int=_int,
            parse_float=_float,
            parse_constant=_constant,
            object_pairs_hook=_object,
        )
    except RecursionError:
        raise CodecError(_TOO_DEEP) from None
    except UnicodeDecodeError as error:
        raise CodecError(f"a request is UTF-8, not so at byte {error.start}") from None
    except json.JSONDecodeError as error:
        raise CodecError(f"a request is a JSON object in one line: {error.msg} at character {error.pos}") from None
    if not isinstance(data, dict):
        raise CodecError("a request is a JSON object")
    _check_depth(data)
    return data


_TOO_DEEP: Final = f"lists and objects of a request are {DEPTH_MAX} deep at most"


def _int(digits: str) -> int:
    if len(digits) > DIGITS_MAX:
        raise CodecError(f"a number of {len(digits)} characters; a request has numbers of {DIGITS_MAX} at most")
    return int(digits)


def _float(digits: str) -> float:
    if len(digits) > DIGITS_MAX:
        raise CodecError(f"a number of {len(digits)} characters; a request has numbers of {DIGITS_MAX} at most")
    value = float(digits)
    if not isfinite(value):
        raise CodecError(f"{digits} is larger than every number of the robot")
    return value


def _constant(word: str) -> Any:
    raise CodecError(f"{word} is no number of JSON")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) != len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise CodecError(f"{twice[:40]!r} is given twice")
    return data


def _check_depth(data: Any) -> None:
    level = [data]
    for _ in range(DEPTH_MAX):
        level = [
            value
            for holder in level
            for value in (holder.values() if isinstance(holder, dict) else holder)
            if isinstance(value, dict | list)
        ]
        if not level:
            return
    raise CodecError(_TOO_DEEP)


def _without_non_finite(data: Any) -> Any:
    """Replace each float that JSON does not have by its word."""
    if type(data) is float and not isfinite(data):
        return float_word(data)
    if type(data) is list:
        return [_without_non_finite(item) for item in data]
    if type(data) is dict:
        return {key: _without_non_finite(item) for key, item in data.items()}
    return data
