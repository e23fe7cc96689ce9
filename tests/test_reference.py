"""The pages in docs/reference say what the code says."""

from __future__ import annotations

import pytest

from elitescript.models.datafile import MODEL_FOLDER, written_out
from tools import model_tables, write_reference


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


def test_the_modules_of_models_are_those_of_their_files() -> None:
    written = {path: path.read_text(encoding="utf-8") for path in model_tables.FOLDER.glob("*_toml.py")}
    assert written == model_tables.model_tables(), "run `make reference`"


def test_a_module_of_a_model_gives_the_bits_of_its_file() -> None:
    for path in sorted(MODEL_FOLDER.glob("*.toml")):
        # The texts differ where a number is whole in one of both, or has another last bit.
        assert repr(written_out(path.name)) == repr(model_tables.document(path))
        assert written_out(path.name) is not written_out(path.name)
