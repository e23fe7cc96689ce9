"""The conversation with one page: its file, its texts, and what answers it."""

from __future__ import annotations

import json
from typing import Any

from elitescript import __version__
from elitescript.errors import UsageError
from elitescript.studio.files import Found, Programs, read
from elitescript.studio.outbox import Outbox


class Session:
    """One page.

    Args:
        programs: that it may open.
        outbox: what it is sent.
    """

    def __init__(self, programs: Programs, outbox: Outbox) -> None:
        self._programs = programs
        self._outbox = outbox
        self._name = ""
        self._known = Found("", "")

    async def begin(self) -> None:
        """Send what a page begins with."""
        self._outbox.put(
            {
                "type": "hello",
                "protocol": 1,
                "product": f"elitescript {__version__}",
                "mode": "live",
                "abilities": ["edit", "save", "services"],
                "title": self._programs.title,
                "programs": self._programs.names(),
            }
        )
        self._open(self._programs.first())

    async def take(self, text: str | bytes) -> None:
        """Take one message of the page."""
        message: dict[str, Any] = json.loads(text)
        if message["type"] == "open":
            try:
                self._open(message["name"])
            except UsageError as error:
                self._outbox.put({"type": "refused", "ask": message["ask"], "text": str(error)})

    async def close(self) -> None:
        """End everything that goes on for the page."""

    def _open(self, name: str) -> None:
        found = read(self._programs.path(name))
        self._name, self._known = name, found
        record = {"type": "file", "name": name, "text": found.text, "digest": found.digest}
        self._outbox.put(record if found.digest else {**record, "is_new": True})
