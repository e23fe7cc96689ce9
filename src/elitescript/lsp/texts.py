"""The texts that the client has open, the folders of the workspace, and the settings of each."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Final

from lsprotocol import types
from pygls.uris import to_fs_path

from elitescript.assist.document import Document, Settings
from elitescript.language.diagnostics import Edit
from elitescript.lsp.positions import Positions
from elitescript.lsp.settings import ClientSettings, document_settings, read_settings
from elitescript.paths import is_task_name
from elitescript.records import NamedTuple

_ALL: Final = ""
"""In place of the URI of a folder: texts that are in none."""


class _Applied(NamedTuple):
    """Settings of a folder, and what follows from them for its texts."""

    client: ClientSettings
    texts: Settings


class Texts:
    """Holds the open texts, each as the newest version that the client has sent.

    Attributes:
        open: the texts, by URI.
        folders: paths of the folders of the workspace, by URI; those that are no files are left out.
        generation: counts the changes of settings.
        replaced: called with each version of a text in whose place another one is open, or none.
    """

    __slots__ = ("_applied", "_given", "folders", "generation", "open", "replaced")

    def __init__(self) -> None:
        self.open: dict[str, Document] = {}
        self.folders: dict[str, Path] = {}
        self.generation = 0
        self.replaced: Callable[[Document], None] = lambda document: None
        self._given: dict[str, object] = {}
        """What the client has sent, by the URI of the folder; that of an empty one is for all others."""
        self._applied = {_ALL: _Applied(ClientSettings(), Settings())}

    # ---------------------------------------------------------------- texts

    def put(self, item: types.TextDocumentItem) -> Document:
        """Take a text that was opened."""
        document = self.made(item.uri, item.text, item.version)
        self._put(item.uri, document)
        return document

    def _put(self, uri: str, document: Document) -> None:
        before = self.open.get(uri)
        self.open[uri] = document
        if before is not None and before is not document:
            self.replaced(before)

    def change(self, uri: str, version: int, changes: Iterable[Any], encoding: str) -> Document | None:
        """Make changes in a text, one after the other; return it, or None if it is not open."""
        document = self.open.get(uri)
        if document is None:
            return None
        for change in changes:
            place = getattr(change, "range", None)
            if place is None:
                document = self.made(uri, change.text, version)
            else:
                span = Positions(document, encoding).span(place)
                document = document.edited([Edit(*span, change.text)], version)
        if document.version != version:
            document = document.edited([], version)
        self._put(uri, document)
        return document

    def close(self, uri: str) -> None:
        """Forget a text that was closed."""
        if (document := self.open.pop(uri, None)) is not None:
            self.replaced(document)

    def made(self, uri: str, text: str, version: int = 0) -> Document:
        """Return a text with the settings of its folder."""
        return Document(name_of(uri), text, version, self.settings(uri).texts)

    # ---------------------------------------------------------------- folders and settings

    def add_folder(self, uri: str) -> None:
        """Add a folder of the workspace; its settings are read by the next `set_settings` or `read_settings`."""
        if (path := path_of(uri)) is not None:
            self.folders[uri] = path

    def remove_folder(self, uri: str) -> None:
        """Remove a folder of the workspace."""
        self.folders.pop(uri, None)
        self._given.pop(uri, None)

    def folder_of(self, uri: str) -> str | None:
        """Return the URI of the innermost folder that a text is in; None if it is in none."""
        path = path_of(uri)
        if path is None:
            return None
        around = [(len(folder.parts), name) for name, folder in self.folders.items() if path.is_relative_to(folder)]
        return max(around)[1] if around else None

    def settings(self, uri: str) -> _Applied:
        """Return the settings for a text."""
        return self._applied.get(self.folder_of(uri) or _ALL) or self._applied[_ALL]

    def set_settings(self, given: object, folder: str = _ALL) -> list[str]:
        """Take what the client has sent for a folder, or for all; return what is wrong with the settings."""
        if folder == _ALL:
            self._given = {}
        self._given[folder] = given
        return self.read_settings()

    def read_settings(self) -> list[str]:
        """Read the settings of all folders, with the files that they name; return what is wrong with them.

        The texts of `open` are those of before until `renew`.
        """
        first = next(iter(self.folders.values()), None)
        wrong: dict[str, None] = {}
        self._applied = {}
        for uri, path in {_ALL: first, **self.folders}.items():
            client, mistakes = read_settings(self._given.get(uri, self._given.get(_ALL)), path)
            texts, more = document_settings(client)
            self._applied[uri] = _Applied(client, texts)
            wrong |= dict.fromkeys(mistakes + more)
        return list(wrong)

    def renew(self) -> bool:
        """Give the open texts the settings that hold now; return whether that has changed any."""
        is_changed = False
        for uri, document in list(self.open.items()):
            settings = self.settings(uri).texts
            if settings != document.settings:
                self._put(uri, Document(document.name, document.text, document.version, settings))
                is_changed = True
        self.generation += 1
        return is_changed


def path_of(uri: str) -> Path | None:
    """Return the path of a file; None if the URI is none of a file of this computer."""
    if not uri.startswith("file:"):
        return None
    path = to_fs_path(uri)
    return Path(path) if path else None


def is_tree(document: Document) -> bool:
    """Return whether a text is the file of a graphical program."""
    return is_task_name(document.name)


def name_of(uri: str) -> str:
    """Return the name of a text for messages: its path, or its URI."""
    path = path_of(uri)
    return uri if path is None else str(path)
