"""Tables written by hand as text: how the tests read them."""

from __future__ import annotations

import re


def rows(text: str) -> list[tuple[str, ...]]:
    """Split a table into its rows, at two blanks or more; a cell of one `.` is empty."""
    lines = [line.strip() for line in text.strip().split("\n")]
    return [tuple("" if cell == "." else cell for cell in re.split(r"  +", line)) for line in lines if line]
