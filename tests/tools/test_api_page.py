"""The API page shows every public name, with its signature and what its docstring says."""

from __future__ import annotations

import importlib

import pytest

from tools import api_page

DOC = """Does a thing.

It goes on.

Args:
    first: a number,
        in m.
    second, third: two more.

Raises:
    UsageError: too far.

Example:
    A short one.

    >>> thing(1)
    2
"""


def test_sections_of_a_docstring_become_lists_and_fences() -> None:
    lines = api_page.markdown(DOC.rstrip())
    assert lines[:5] == ["Does a thing.", "", "It goes on.", "", "**Arguments**"]
    assert "- `first`: a number," in lines
    assert "  in m." in lines
    assert "- `second`, `third`: two more." in lines
    assert "- `UsageError`: too far." in lines
    assert lines[-6:] == ["A short one.", "", "```pycon", ">>> thing(1)", "2", "```"]


def test_a_page_named_in_a_docstring_is_a_link() -> None:
    assert api_page.markdown("See `docs/how-to/devices.md`.") == ["See [how-to/devices](../how-to/devices.md)."]
    assert api_page.markdown("See `docs/reference/events.md`.") == ["See [reference/events](events.md)."]


def test_a_signature_keeps_marks_defaults_and_result() -> None:
    def thing(first: float, *rest: int, name: str = "x") -> bool: ...

    def other(first: float, *, name: str = "x") -> None: ...

    assert api_page.signature(thing) == "(first: float, *rest: int, name: str = 'x') -> bool"
    assert api_page.signature(other) == "(first: float, *, name: str = 'x') -> None"


def test_a_member_that_is_gone_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(api_page.MEMBERS, "int", "bit_length vanished")
    with pytest.raises(AttributeError, match="vanished"):
        api_page.members(int)


def test_every_public_name_has_a_section() -> None:
    page = api_page.api_page().splitlines()
    for module in ("elitescript", "elitescript.testing.world"):
        for name in importlib.import_module(module).__all__:
            assert name.startswith("__") or f"### {name}" in page


def test_everything_shown_says_what_it_does() -> None:
    for module in api_page.PUBLIC:
        for name in api_page.names(module):
            item = getattr(importlib.import_module(module), name)
            assert item.__doc__, name
            if isinstance(item, type):
                assert [member.name for member in api_page.members(item) if not member.doc] == [], name
