"""Texts of programs, as a client finds them: by path, or by a number if no file has them."""

from __future__ import annotations

import os
from pathlib import Path

from elitescript.dap.messages import Arguments, Body


class Sources:
    """Gives texts without a file a number, from 1."""

    __slots__ = ("_texts",)

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}

    def add(self, name: str, text: str) -> None:
        """Note a text without a file."""
        self._texts[name] = text

    def shown(self, name: str) -> Body:
        """Return the `Source` of a text."""
        if name in self._texts:
            return {"name": name, "sourceReference": list(self._texts).index(name) + 1}
        return {"name": Path(name).name, "path": str(Path(name).absolute())}

    def text(self, reference: int) -> str | None:
        """Return a text by its number; None if there is none."""
        return dict(enumerate(self._texts.values(), 1)).get(reference)

    def is_named(self, source: Arguments, name: str) -> bool:
        """Return whether a `Source` of a client is the text of this name."""
        if reference := source.number("sourceReference", 0):
            return list(self._texts)[reference - 1 : reference] == [name]
        path = source.text("path", "")
        if not path or name in self._texts:
            return bool(path) and path == name
        return _key(path) == _key(name)


def _key(path: str) -> str:
    try:
        return os.path.normcase(Path(path).resolve())
    except (OSError, ValueError, RuntimeError):
        return path
