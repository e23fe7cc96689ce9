"""What one page sees of a controller: messages of `web/src/source/messages.ts` in mode "connected"."""

from __future__ import annotations

from typing import Any, Protocol

from elitescript.studio.connected.target import Target


class Listener(Protocol):
    """Takes what a source says; neither method blocks."""

    def message(self, message: dict[str, Any]) -> None:
        """Take a message."""

    def rows(self, frame: bytes) -> None:
        """Take a frame of rows."""


class ConnectedController:
    """The connections to one controller, shared by all pages.

    Args:
        target: which controller, and whether it may be commanded.
    """

    def __init__(self, target: Target) -> None:
        self.target = target

    async def open(self) -> None:
        """Begin to connect; a controller that is not there is tried again and again."""

    async def close(self) -> None:
        """Stop what was begun here, and hang up."""

    def source(self) -> ConnectedSource:
        """Return the source of one more page."""
        return ConnectedSource(self)


class ConnectedSource:
    """What one page talks to.

    Args:
        controller: the connections.
    """

    def __init__(self, controller: ConnectedController) -> None:
        self._controller = controller

    async def start(self, listener: Listener) -> None:
        """Send `hello`, `scene` and what is known; then every change."""

    async def message(self, message: dict[str, Any]) -> None:
        """Do what the page asks for, or refuse it in words."""

    async def close(self) -> None:
        """Stop what the page has begun: jogging, hand guiding."""
