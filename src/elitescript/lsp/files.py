"""The programs of the workspace that are not open: found once, read when they are needed, bounded."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Final

from pygls.uris import from_fs_path

from elitescript.assist.document import Document, Settings
from elitescript.language.text.source import SourceFile
from elitescript.paths import is_program_name
from elitescript.records import NamedTuple
from elitescript.untrusted.files import PROGRAM, UnreadableError, read_bytes

FILES_MAX: Final = 1000
"""Programs that are looked at; those beyond are left out."""
FOLDERS_MAX: Final = 5000
"""Folders that are searched."""
FILE_BYTES_MAX: Final = 1_000_000
_FILE: Final = PROGRAM._replace(bytes_max=FILE_BYTES_MAX)

_SKIPPED: Final = frozenset(("node_modules", "__pycache__", "venv", "site-packages"))
"""Names of folders that are not searched, besides those that begin with a dot."""


class _Read(NamedTuple):
    """A file that was read, and what its directory entry said then."""

    modified_ns: int
    size: int
    document: Document


class WorkspaceFiles:
    """Finds the programs of folders. Called in the thread of slow requests only.

    What is found stays until `forget`.
    """

    __slots__ = ("_found", "_read")

    def __init__(self) -> None:
        self._found: dict[Path, tuple[Path, ...]] = {}
        self._read: dict[Path, _Read] = {}

    def forget(self) -> None:
        """Search again at the next call: files were made or removed."""
        self._found = {}

    def documents(self, folders: Mapping[Path, Settings]) -> Iterator[tuple[str, Document]]:
        """Yield URI and text of the programs below folders, each once.

        Args:
            folders: those of the workspace, with the settings of their texts.
        """
        seen: set[Path] = set()
        for folder, settings in folders.items():
            if folder not in self._found:
                self._found[folder] = tuple(_programs(folder))
            for path in self._found[folder]:
                if path not in seen:
                    seen.add(path)
                    if (document := self._document(path, settings)) is not None:
                        yield from_fs_path(str(path)) or "", document
        for path in self._read.keys() - seen:
            del self._read[path]

    def _document(self, path: Path, settings: Settings) -> Document | None:
        try:
            state = path.stat()
            kept = self._read.get(path)
            if kept is not None and kept[:2] == (state.st_mtime_ns, state.st_size):
                if kept.document.settings != settings:
                    kept = kept._replace(document=Document(str(path), kept.document.text, settings=settings))
                    self._read[path] = kept
                return kept.document
            text = SourceFile.to_show(str(path), read_bytes(path, _FILE)).text
        except (OSError, UnreadableError):
            # It was removed since it was found, or is not ours to read: then there is nothing to say about it.
            self._read.pop(path, None)
            return None
        document = Document(str(path), text, settings=settings)
        self._read[path] = _Read(state.st_mtime_ns, state.st_size, document)
        return document


def _programs(folder: Path) -> Iterator[Path]:
    """Yield the programs of a folder and its subfolders, by name, within the limits; links are not followed."""
    files = 0
    for home, inner, names in islice(os.walk(folder), FOLDERS_MAX):
        inner[:] = sorted(name for name in inner if not name.startswith(".") and name not in _SKIPPED)
        for name in sorted(names):
            if is_program_name(name) and not name.startswith("."):
                files += 1
                if files > FILES_MAX:
                    return
                yield Path(home, name)
