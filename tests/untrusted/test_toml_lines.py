"""Lines of keys in TOML."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from elitescript.untrusted.toml_lines import lines_of, nearest

TEXT = '''# a comment [x]
plain = 1
dotted.inner = { a = 1, "b c" = [2,
  3] }

[table."quoted.name"]
text = """
[not] = "a header"
"""   # after it
raw = \'\'\'
x = 1\'\'\'\'

[[list]]
at = [
  [0, true],   # ]
  # [9]
  [1, false],
]
[list.sub]
here = '#'
[[list]]
name = "two"
'''
# By hand: the line on which each stands.
LINES = {
    ("plain",): 2,
    ("dotted",): 3,
    ("dotted", "inner"): 3,
    ("dotted", "inner", "a"): 3,
    ("dotted", "inner", "b c"): 3,
    ("dotted", "inner", "b c", 0): 3,
    ("dotted", "inner", "b c", 1): 4,
    ("table",): 6,
    ("table", "quoted.name"): 6,
    ("table", "quoted.name", "text"): 7,
    ("table", "quoted.name", "raw"): 10,
    ("list",): 13,
    ("list", 0): 13,
    ("list", 0, "at"): 14,
    ("list", 0, "at", 0): 15,
    ("list", 0, "at", 0, 0): 15,
    ("list", 0, "at", 0, 1): 15,
    ("list", 0, "at", 1): 17,
    ("list", 0, "at", 1, 0): 17,
    ("list", 0, "at", 1, 1): 17,
    ("list", 0, "sub"): 19,
    ("list", 0, "sub", "here"): 20,
    ("list", 1): 21,
    ("list", 1, "name"): 22,
}


def test_every_key_has_its_line() -> None:
    tomllib.loads(TEXT)
    assert lines_of(TEXT) == LINES
    assert lines_of(TEXT.replace("\n", "\r\n")) == LINES


def test_what_is_missing_has_the_line_of_the_nearest_above() -> None:
    assert nearest(LINES, ("list", 1, "nothing", 3)) == 21
    assert nearest(LINES, ("nothing",)) == 1


def paths(value: Any, path: tuple[str | int, ...] = ()) -> set[tuple[str | int, ...]]:
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return ({path} if path else set()).union(*(paths(item, (*path, key)) for key, item in items))


ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "path",
    sorted([*ROOT.glob("examples/*.toml"), *ROOT.glob("src/**/*.toml"), *ROOT.glob("*.toml")]),
    ids=lambda path: path.name,
)
def test_every_value_of_every_file_of_ours_is_found(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert set(lines_of(text)) == paths(tomllib.loads(text))
