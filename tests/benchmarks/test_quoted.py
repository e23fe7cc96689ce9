"""The list of measured figures that pages quote is complete, and finds each line."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.__main__ import MODULES
from benchmarks.quoted import NO_FIGURE, QUOTES, Quote, print_quotes
from benchmarks.table import Row

ROOT = Path(__file__).resolve().parent.parent.parent
PAGES = [ROOT / "README.md", ROOT / "README.zh.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("quote", QUOTES, ids=lambda quote: f"{Path(quote.page).stem} {quote.words}")
def test_a_quoted_line_stands_once_in_its_page(quote: Quote) -> None:
    assert quote.words in quote.line
    assert quote.module in MODULES


def test_every_line_that_names_a_benchmark_is_in_the_list() -> None:
    known = {(quote.page, quote.words) for quote in QUOTES} | set(NO_FIGURE)
    unknown = [
        f"{page.relative_to(ROOT)}: {line[:60]}"
        for page in PAGES
        for line in page.read_text(encoding="utf-8").splitlines()
        if "python -m benchmarks" in line and not any(page == ROOT / where and words in line for where, words in known)
    ]
    assert unknown == []


def test_a_line_is_printed_with_its_rows_and_a_missing_row_is_a_failure(capsys: pytest.CaptureFixture[str]) -> None:
    rows = [Row(quote.row, "ms", cpu_s=0.25) for quote in QUOTES]
    assert print_quotes(rows) == 0
    printed = capsys.readouterr().out
    assert "docs/explanation/speed.md: | start to exit, one-line program |" in printed
    assert "250 ms" in printed
    assert print_quotes([row for row in rows if row.what != "import serial"]) == 1
