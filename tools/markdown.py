"""What all generated pages share."""

from __future__ import annotations

from typing import Final

COMMAND: Final = "python tools/write_reference.py"
NOTICE: Final = f"<!-- Written by `{COMMAND}`; do not edit. -->\n"


def cell(text: str) -> str:
    """Text for a cell of a table."""
    return text.replace("|", "\\|")


def code(text: str) -> str:
    """Program text for a cell of a table."""
    return f"`{cell(text)}`" if text else "none"
