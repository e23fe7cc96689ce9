"""The source of a page that writes programs: every text is checked, and run in virtual time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from elitescript import __version__
from elitescript.conversation.describe import LIVE_ABILITIES, hello, scene
from elitescript.conversation.messages import ToSource
from elitescript.errors import UsageError
from elitescript.kernel.options import DEFAULTS
from elitescript.models.model import load_model


class LiveSource:
    """The live runs of one page.

    Args:
        title: of the page.
        given: options of the robot on the command line.
        urdf: name of the user's own description of the arm; empty without one.
    """

    def __init__(self, title: str, given: Mapping[str, Any], urdf: str = "") -> None:
        self._title = title
        self._given = given
        self._urdf = urdf
        self._send: Callable[[Mapping[str, Any] | bytes], None] = lambda message: None

    async def start(self, send: Callable[[Mapping[str, Any] | bytes], None]) -> None:
        """Send `hello` and `scene`."""
        self._send = send
        send(hello("live", f"elitescript {__version__}", LIVE_ABILITIES, self._title))
        send(scene(load_model(self._given.get("model", DEFAULTS["model"])), urdf=self._urdf))

    async def take(self, message: ToSource) -> None:
        """Do what the page asks for."""
        raise UsageError("programs are not run yet")

    async def close(self) -> None:
        """End everything that was begun for this page."""
