"""What all generated pages share."""

from __future__ import annotations

from typing import Final

COMMAND: Final = "python tools/write_reference.py"
_GITHUB_PUNCTUATION: Final = str.maketrans("", "", ",.:()'\"`/")
NOTICE: Final = f"<!-- Written by `{COMMAND}`; do not edit. -->\n"


def cell(text: str) -> str:
    """Text for a cell of a table."""
    return text.replace("|", "\\|")


def code(text: str) -> str:
    """Program text for a cell of a table."""
    return f"`{cell(text)}`" if text else "none"


def anchor(title: str) -> str:
    return title.lower().translate(_GITHUB_PUNCTUATION).replace(" ", "-")
