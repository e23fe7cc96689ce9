"""The figures and tables in docs/explanation/motion.md show what the code does."""

from __future__ import annotations

import re

import pytest

from tools import draw_motion

NUMBER = re.compile(r"-?\d+\.?\d*")
TABLE_TOLERANCE = 1.5e-3
"""A unit of the last digit: mathematical libraries differ in the last bit, which may turn a rounding."""
FIGURE_TOLERANCE_PX = 0.15

PAGE_TEXT = draw_motion.PAGE.read_text(encoding="utf-8")


def is_same(written: str, wanted: str, tolerance: float) -> bool:
    """Whether two texts differ in nothing but the last digits of numbers."""
    if NUMBER.sub("#", written) != NUMBER.sub("#", wanted):
        return False
    pairs = zip(NUMBER.findall(written), NUMBER.findall(wanted), strict=True)
    return all(abs(float(a) - float(b)) <= tolerance for a, b in pairs)


@pytest.mark.parametrize("name", draw_motion.BLOCKS)
def test_table_is_up_to_date(name: str) -> None:
    written = draw_motion.found_block(PAGE_TEXT, name).group()
    wanted = draw_motion.block(name, draw_motion.BLOCKS[name]())
    # Not `==` in the assertion: the difference would be the whole table.
    is_up_to_date = is_same(written, wanted, TABLE_TOLERANCE)
    assert is_up_to_date, f"table {name!r} is out of date; run `{draw_motion.COMMAND}` and look at the difference"


@pytest.mark.parametrize("name", draw_motion.FIGURES)
def test_figure_is_up_to_date(name: str) -> None:
    path = draw_motion.FOLDER / name
    written = path.read_text(encoding="utf-8") if path.exists() else ""
    is_up_to_date = is_same(written, draw_motion.FIGURES[name](), FIGURE_TOLERANCE_PX)
    assert is_up_to_date, f"{name} is out of date; run `{draw_motion.COMMAND}` and look at the difference"


def test_every_figure_is_shown_and_there() -> None:
    shown = set(re.findall(r"\]\(figures/([\w.-]+)\)", PAGE_TEXT))
    assert shown == set(draw_motion.FIGURES)
    assert {path.name for path in draw_motion.FOLDER.iterdir()} == set(draw_motion.FIGURES)


def test_every_link_of_the_page_leads_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", PAGE_TEXT):
        assert (draw_motion.PAGE.parent / target).exists(), target


def test_a_page_without_the_marks_is_reported() -> None:
    with pytest.raises(ValueError, match="no block 'servo'"):
        draw_motion.found_block("text", "servo")


@pytest.mark.parametrize(
    ("written", "wanted", "same"),
    [
        ("| 0.112 | a |", "| 0.113 | a |", True),
        ("| 0.112 | a |", "| 0.115 | a |", False),
        ("| 0.112 | a |", "| 0.112 | b |", False),
        ("| 0.112 |", "| 0.112 | 1 |", False),
    ],
)
def test_what_counts_as_a_difference(written: str, wanted: str, same: bool) -> None:
    assert is_same(written, wanted, TABLE_TOLERANCE) is same
