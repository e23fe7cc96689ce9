"""Parses JSON that others wrote: nesting and digits have bounds, and refusals are in words of JSON."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Callable
from math import isfinite
from typing import Any, Final

from elitescript.untrusted.plain_text import EncodingError, plain_text, without_mark

DEPTH_MAX: Final = 100
"""Lists and objects within each other. Code that walks the values may recurse so deep."""

_NESTING: Final = r'"(?:[^"\\]++|\\.)*+"|[\[\]{}]'


class JsonError(ValueError):
    """A text is no JSON, or beyond the bounds.

    Args:
        why: without the place.
        at: where, in characters from 0; for bytes that are not UTF-8, in bytes.
        line: where, from 1.
    """

    def __init__(self, why: str, at: int = 0, line: int = 1) -> None:
        super().__init__(why)
        self.why = why
        self.at = at
        self.line = line


def json_value(
    data: str | bytes,
    *,
    depth_max: int | None = DEPTH_MAX,
    parse_constant: Callable[[str], Any] | None = None,
    parse_float: Callable[[str], float] | None = None,
    object_pairs_hook: Callable[[list[tuple[str, Any]]], Any] | None = None,
) -> Any:
    """Return the value of a text of JSON.

    Args:
        data: the text; bytes are UTF-8.
        depth_max: of lists and objects within each other; None if what walks the value has a bound of its own.
        parse_constant: makes values of `NaN`, `Infinity` and `-Infinity`, which JSON does not have; floats if None.
        parse_float: makes numbers with a point or an exponent; floats if None.
        object_pairs_hook: makes objects of their names and values; dictionaries if None.

    Raises:
        JsonError: it is none, is nested deeper, or has a number with more digits than Python reads.
    """
    try:
        text = without_mark(data) if isinstance(data, str) else plain_text(bytes(data))
    except EncodingError as error:
        raise JsonError(f"not UTF-8: {error.why}", error.at, error.line) from None
    if depth_max is not None and text.count("[") + text.count("{") > depth_max:
        _check_depth(text, depth_max)
    try:
        return json.loads(
            text, parse_constant=parse_constant, parse_float=parse_float, object_pairs_hook=object_pairs_hook
        )
    except json.JSONDecodeError as error:
        raise JsonError(f"{error.msg}: line {error.lineno} column {error.colno}", error.pos, error.lineno) from None
    except JsonError:
        raise
    except ValueError as error:
        if "integer string conversion" not in str(error):
            raise JsonError(str(error)) from None
        # Python 3.11 says how its own limit is raised, which no reader of a file can do.
        number = max(re.finditer(r"[0-9]+", text), key=lambda found: len(found[0]))
        line = text.count("\n", 0, number.start()) + 1
        raise JsonError(f"a number of {len(number[0])} digits in line {line}", number.start(), line) from None
    except RecursionError:
        raise JsonError("nested too deeply") from None


def json_object(data: str | bytes) -> dict[str, Any]:
    """Return the object of a request in JSON, of which every name is given once and every number is finite.

    Raises:
        JsonError: see `json_value`; it is no object, or means more than one thing.
    """
    found = json_value(data, parse_constant=_no_constant, parse_float=_finite, object_pairs_hook=_object)
    if not isinstance(found, dict):
        raise JsonError("a request is a JSON object")
    return found


def _no_constant(word: str) -> Any:
    raise JsonError(f"{word} is no number of JSON")


def _finite(digits: str) -> float:
    value = float(digits)
    if not isfinite(value):
        raise JsonError(f"{digits[:40]} is larger than every number of a computer")
    return value


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) != len(pairs):
        ((twice, _),) = Counter(name for name, _ in pairs).most_common(1)
        raise JsonError(f"{twice[:40]!r} is given twice")
    return data


def _check_depth(text: str, depth_max: int) -> None:
    depth = 0
    for token in re.finditer(_NESTING, text, re.DOTALL):
        sign = token[0]
        if sign in ("[", "{"):
            depth += 1
            if depth > depth_max:
                line = text.count("\n", 0, token.start()) + 1
                raise JsonError(f"nested more than {depth_max} deep in line {line}", token.start(), line)
        elif sign in ("]", "}"):
            depth -= 1
