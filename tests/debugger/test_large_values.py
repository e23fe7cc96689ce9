"""Values of any size are shown in part: how much is left out is said, and neither the answer nor the work is large."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from elitescript.debugger.values import child_named, children, count_children, shown

LARGE = 100_000


def _cyclic() -> list[Any]:
    found: list[Any] = [1]
    found += [found] * LARGE
    return found


VALUES: dict[str, Any] = {
    "list": list(range(LARGE)),
    "tuple": tuple(range(LARGE)),
    "set": set(range(LARGE)),
    "frozenset": frozenset(range(LARGE)),
    "dict": {f"k{n}": n for n in range(LARGE)},
    "bytes": bytes(LARGE),
    "bytearray": bytearray(LARGE),
    "str": "x" * LARGE,
    "str of escapes": "\x00" * LARGE,
    "int": 10**4000,
    "nested": [[0.5] * 1000] * 1000,
    "deeply nested": [[[["a" * 1000] * 100] * 100] * 100] * LARGE,
    "cyclic": _cyclic(),
    "dict of dicts": {n: dict.fromkeys(range(200), "y" * 5000) for n in range(300)},
    "dict of tuples": {(n,) * 2000: [n] * 2000 for n in range(300)},
    "slice": slice(list(range(LARGE)), None),
    "exception": ValueError([0] * LARGE),
}


def calls_of(function: Any) -> tuple[int, Any]:
    """Return how many calls of Python a function takes, and its result."""
    count = 0

    def note(frame: Any, event: str, argument: Any) -> None:
        nonlocal count
        count += event == "call"

    sys.setprofile(note)
    try:
        found = function()
    finally:
        sys.setprofile(None)
    return count, found


@pytest.mark.parametrize("name", VALUES)
def test_a_text_is_short_and_says_what_is_left_out(name: str) -> None:
    calls, text = calls_of(lambda: shown(VALUES[name]))
    assert len(text) < 2300 and calls < 20_000
    assert " more" in text and "…" in text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ([0] * 200, "[" + "0, " * 100 + "… 100 more]"),
        ([0.1] * LARGE, "[" + "0.1, " * 100 + "… 99,900 more]"),
        ((1,) * 101, "(" + "1, " * 100 + "… 1 more)"),
        ({n: n for n in range(102)}, "{" + "".join(f"{n}: {n}, " for n in range(100)) + "… 2 more}"),
        ([1] * 100, "[" + ", ".join(["1"] * 100) + "]"),
        ("x" * 2000, "'" + "x" * 2000 + "'"),
        ([["a" * 1990, "b" * 100]], "[['" + "a" * 1990 + "', 'bbb'… 97 more]]"),
        (slice(1, None, 2), "slice(1, None, 2)"),
        ([], "[]"),
        ({}, "{}"),
    ],
)
def test_texts(value: Any, text: str) -> None:
    found = shown(value)
    assert found == text or (value and isinstance(value[0], list) and found.startswith(text[:1990]))


@pytest.mark.parametrize("name", VALUES)
def test_children_come_in_parts_and_are_found_by_their_names(name: str) -> None:
    value = VALUES[name]
    named, indexed = count_children(value)
    assert not named
    if not indexed:
        assert name in ("str", "str of escapes", "int", "slice", "exception")
        return
    for start in (0, indexed // 2, indexed - 10, indexed, indexed + 5):
        calls, part = calls_of(lambda start=start: children(value, start, start + 10))  # type: ignore[misc]
        assert len(part) == max(0, min(10, indexed - start)) and calls < 20_000
    first, last = children(value, 0, 1)[0], children(value, indexed - 1, indexed)[0]
    assert child_named(value, first.name) == first
    if name != "dict of tuples":
        assert child_named(value, last.name) == last
    for wrong in (f"[{indexed}]", "[-1]", "[1", "", "nosuch", "[0x1]", "(" * 1000):
        assert child_named(value, wrong) is None


def test_keys_of_the_program_are_not_compared() -> None:
    asked = []

    class Key:
        def __eq__(self, other: object) -> bool:
            asked.append(other)
            return False

        def __hash__(self) -> int:
            return hash("a")

    value = {Key(): 1, "a": 2, True: 3, 1.5: 4, float("inf"): 5}
    asked.clear()
    assert child_named(value, "'a'") == ("'a'", 2, "['a']")
    assert child_named(value, "True") == ("True", 3, "[True]")
    assert child_named(value, "1") is None
    assert child_named(value, "inf") == ("inf", 5, "")
    assert child_named(value, "<Key>") == ("<Key>", 1, "")
    assert asked == []
