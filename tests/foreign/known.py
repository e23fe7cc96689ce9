"""Reads the differences that are known, each with its reason: known.toml."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import Final, NamedTuple

FILE: Final = Path(__file__).parent / "known.toml"
KINDS: Final = ("value", "wording", "syntax", "no end")


class Known(NamedTuple):
    """One row.

    Attributes:
        tests: the tests that differ; those of one row are one test that stands in several classes.
        kind: `value`, `wording`, `syntax` or `no end`.
        decided: whether the language or the policy means it; else it is only not worth the effort.
        reason: in words.
    """

    tests: tuple[str, ...]
    kind: str
    decided: bool
    reason: str


def load_known(text: str | None = None, version: str | None = None) -> tuple[Known, ...]:
    """Return the rows that hold for this version of Python.

    Raises:
        ValueError: a row lacks something, or a test stands in two.
    """
    version = version or f"{sys.version_info[0]}.{sys.version_info[1]}"
    rows = tomllib.loads(FILE.read_text(encoding="utf-8") if text is None else text).get("known", [])
    found: list[Known] = []
    seen: set[str] = set()
    for row in rows:
        if set(row) - {"python"} != {"tests", "kind", "decided", "reason"}:
            raise ValueError(f"a row needs tests, kind, decided and reason: {row}")
        if row["kind"] not in KINDS or not row["tests"] or len(row["reason"].split()) < 3:
            raise ValueError(f"a row needs tests, one of the kinds {', '.join(KINDS)}, and a reason in words: {row}")
        if version not in row.get("python", [version]):
            continue
        twice = seen & set(row["tests"])
        if twice:
            raise ValueError(f"two rows have {sorted(twice)[0]}")
        seen |= set(row["tests"])
        found.append(Known(tuple(row["tests"]), row["kind"], row["decided"], row["reason"]))
    return tuple(found)
