"""The changelog is read by users: one line for each change, below a heading of a known name, newest version first."""

from __future__ import annotations

import re
from pathlib import Path

import elitescript

TEXT = (Path(__file__).resolve().parent.parent / "CHANGELOG.md").read_text(encoding="utf-8")
VERSIONS = re.split(r"^## ", TEXT, flags=re.MULTILINE)[1:]
KINDS = ("Added", "Changed", "Deprecated", "Removed", "Fixed", "Security")
LINE_MAX = 240
"""Characters; what needs more belongs on a page."""


def test_every_change_is_one_short_line_below_a_known_heading() -> None:
    for version in VERSIONS:
        _, *parts = re.split(r"^### ", version, flags=re.MULTILINE)
        for part in parts:
            kind, *lines = part.splitlines()
            assert kind in KINDS
            for line in filter(None, lines):
                assert line.startswith("- "), f"a change is one line: {line}"
                assert len(line) <= LINE_MAX, f"{len(line)} characters, at most {LINE_MAX}: {line}"


def test_no_change_stands_there_twice() -> None:
    changes = re.findall(r"^- .*", TEXT, re.MULTILINE)
    assert len(changes) == len(set(changes))


def test_the_version_of_the_package_is_the_newest_one_with_a_date() -> None:
    assert VERSIONS[0].startswith("[Unreleased]\n")
    found = re.match(r"\[(\S+)\] - \d{4}-\d\d-\d\d\n", VERSIONS[1])
    assert found is not None
    assert found[1] == elitescript.__version__
