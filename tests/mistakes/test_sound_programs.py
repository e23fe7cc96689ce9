"""Rules that follow values say nothing in sound programs: those of the specification, and those of the pages."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from tests.specification.pages import parse_page
from tools.pages import read_page

ROOT = Path(__file__).resolve().parents[2]
OF_VALUES = re.compile(r"W22[345]|W23[89]|W24\d|W27[6-9]|N228|W25\d|W26\d")

MEANT = {
    ("scope.md", "N228"): "which function a name stands for",
    ("structure.md", "N228"): "what an `end` that is missing does",
    ("commands.md", "W278"): "what an index behind the end does",
    ("threads.md", "W238"): "what a lock does that nothing releases",
    ("blends.md", "W250"): "what a negative radius does",
    ("modbus_tcp.md", "W249"): "what a write to an input does",
    ("python.md", "W265"): "what an index behind the end does",
}
"""Findings in cases about the mistake itself, beside those that a block or an expectation names."""


def of_specification() -> Iterator[tuple[str, str, set[str]]]:
    """Yield the programs of the specification, with the codes that they expect."""
    for path in sorted((ROOT / "tests" / "spec").glob("*.md")):
        if path.name != "README.md":
            for case in parse_page(path.read_text(encoding="utf-8")):
                facts = [fact.value for expectation in case.expectations for fact in expectation.facts]
                codes = {code for value in facts for code in re.findall(r"[WE]\d{3}", value)}
                for text in case.texts:
                    if not {"interpreter", "query", "stream"} & set(text.words):
                        yield f"{path.name}:{text.line}", text.text, codes


def of_pages() -> Iterator[tuple[str, str, set[str]]]:
    """Yield the programs of the pages of docs, with the code that a block names."""
    for path in sorted((ROOT / "docs").rglob("*.md")):
        if path.parent.name == "reference":
            continue
        for block in read_page(path.read_text(encoding="utf-8")).blocks:
            if block.language == "elitescript":
                yield f"{path.relative_to(ROOT)}:{block.line}", block.text, {block.words.get("error", "")}


def test_they_have_no_findings_that_they_do_not_name():
    found = set()
    count = 0
    for name, text, codes in (*of_specification(), *of_pages()):
        count += 1
        for problem in check_source(SourceFile(name, text), profile(DEFAULT_FIRMWARE)):
            is_named = problem.code in codes or (name.partition(":")[0], problem.code) in MEANT
            if OF_VALUES.fullmatch(problem.code) and not is_named:
                found.add((name, problem.line, problem.code, problem.text))
    assert found == set()
    assert count > 300
