"""Texts of programs, as a client finds them: by the path of their file, or by a number if no file has them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from elitescript.dap.messages import Arguments, Body
from elitescript.paths import PROGRAM_SUFFIX, real_path

FILE_URI: Final = "file://"


class Sources:
    """Knows which texts have a file here; the others get a number, from 1."""

    __slots__ = ("_first_names", "_labels", "_numbered", "_paths")

    def __init__(self) -> None:
        self._numbered: list[str] = []
        self._paths: dict[str, str] = {}
        self._first_names: dict[str, str] = {}
        self._labels: dict[str, tuple[str, str]] = {}

    def found(self, name: str, path: str) -> None:
        """Note the file of a text."""
        self._paths.pop(name, None)
        self._paths[name] = str(Path(path).absolute())

    def generated(self, name: str, task: str) -> None:
        """Note that a text was generated from a graphical program: its file holds something else."""
        self._paths.pop(name, None)
        self._labels[name] = f"{Path(task).name}{PROGRAM_SUFFIX}", f"generated from {Path(task).name}"

    def same(self, name: str, first: str) -> None:
        """Note that a text is one that has another name, too."""
        self._first_names[name] = first

    def shown(self, name: str) -> Body:
        """Return the `Source` of a text."""
        name = self._first_names.get(name, name)
        if path := self._paths.get(name):
            return {"name": Path(path).name, "path": path}
        if name not in self._numbered:
            self._numbered.append(name)
        label, origin = self._labels.get(name, (name, ""))
        body: Body = {"name": label, "sourceReference": self._numbered.index(name) + 1}
        return body | {"origin": origin} if origin else body

    def named(self, source: Arguments) -> str | None:
        """Return the name of the text that a `Source` of a client is; None for a file that is none of them."""
        if reference := source.number("sourceReference", 0):
            return self.numbered(reference)
        key = _key(source.text("path", ""))
        # A restart may name the same file in another way: the name that was found last is the one that runs.
        return next((name for name, path in reversed(self._paths.items()) if _key(path) == key), None)

    def numbered(self, reference: int) -> str | None:
        """Return the name of the text with a number; None if there is none."""
        return next(iter(self._numbered[reference - 1 : reference]), None)


def path_of(text: str) -> str:
    """Return the path that a client names; some write it as a URI, whatever they were asked for."""
    if not text.startswith(FILE_URI):
        return text
    from urllib.request import url2pathname

    return url2pathname(text.removeprefix(FILE_URI))


def is_same_path(path: str, other: str) -> bool:
    """Return whether two paths, or URIs, name the same file."""
    return _key(path) == _key(other) != ""


def _key(path: str) -> str:
    try:
        path = path_of(path)
        return os.path.normcase(real_path(path)) if path else ""
    except (OSError, ValueError, RuntimeError):
        return path
