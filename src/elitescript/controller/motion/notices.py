"""Emits warnings once for each line of a program, or once in it."""

from __future__ import annotations

from collections.abc import Callable

from elitescript.messages.events import Event, Warned


class Notices:
    """Emits each warning of the running program once.

    Args:
        on_event: receives the warnings.
    """

    __slots__ = ("_on_event", "said")

    def __init__(self, on_event: Callable[[Event], None]) -> None:
        self._on_event = on_event
        self.said: set[tuple[int, str]] = set()
        """Line (0 for the program as a whole) and kind."""

    def once(self, line: int, kind: str, warning: Warned) -> None:
        """Emit a warning, unless one of the kind was emitted for the line."""
        if (line, kind) not in self.said:
            self.said.add((line, kind))
            self._on_event(warning)
