"""The streams that reports write to."""

from __future__ import annotations

from typing import Protocol


class Writable(Protocol):
    """A stream for reports."""

    def write(self, text: str, /) -> object:
        """Write a text."""

    def flush(self) -> object:
        """Flush the stream."""
