"""Where reports write."""

from __future__ import annotations

from typing import Protocol


class Writable(Protocol):
    """What a report needs of a stream."""

    def write(self, text: str, /) -> object:
        """Take a text."""

    def flush(self) -> object:
        """Have what was written appear."""
