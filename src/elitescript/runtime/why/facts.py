"""What is known beside the threads of a program: what signals did, what may set them, what peers have said."""

from __future__ import annotations


class Facts:
    """Knows nothing; `devices.facts` knows the record of a run and its world."""

    __slots__ = ()

    def history(self, name: str) -> str:
        """Return since when a signal has its level, such as `has not changed`; empty if that is not known."""
        return ""

    def setters(self, name: str) -> list[str] | None:
        """Return what may set a signal besides the program, as sentences without subject; None if not all is known."""
        return None

    def sent(self, kind: str, channel: str) -> str:
        """Return what was sent on a channel last and not answered, and what its peer says of that; empty if unknown."""
        return ""
