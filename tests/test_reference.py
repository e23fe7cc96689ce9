"""The pages in docs/reference say what the code says."""

from __future__ import annotations

import pytest

from tools import write_reference


@pytest.mark.parametrize("name", write_reference.PAGES)
def test_reference_page_is_up_to_date(name: str) -> None:
    path = write_reference.FOLDER / name
    written = path.read_text(encoding="utf-8") if path.exists() else ""
    # A plain comparison, not `==` in the assertion: the difference would be the whole page.
    is_same = written == write_reference.PAGES[name]()
    assert is_same, f"docs/reference/{name} is out of date; run `make reference` and look at the difference"


def test_the_types_of_keywords_are_up_to_date() -> None:
    is_same = write_reference.MODULE.read_text(encoding="utf-8") == write_reference.keywords_module()
    assert is_same, f"{write_reference.MODULE.name} is out of date; run `make reference` and look at the difference"
