"""What the studio remembers in the user's folder: texts that were never saved, and the settings of the page.

A draft is a file of one conversation, named after its program too: two pages on one program do not overwrite each
other's text, in whichever process they are. The end of this process at any moment leaves the text before or the newest
(`outputs.writing`); only the user can read them.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from secrets import token_hex
from time import time
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.outputs.writing import BESIDE, write_file
from elitescript.records import NamedTuple
from elitescript.untrusted.files import Kind, read_bytes
from elitescript.untrusted.json_text import JsonError, json_value

DRAFTS_MAX: Final = 8
"""Drafts of one program; the oldest go."""

DRAFT_BYTES_MAX: Final = 32 << 20
"""Largest draft that is read; a character of a text takes up to 12 bytes."""

UNFINISHED_S: Final = 60.0
"""Age from which on a file that was not put in its place never will be, s."""

SETTINGS_BYTES_MAX: Final = 64 << 10
"""Size of the settings of the page as JSON; larger ones are not kept."""


class Draft(NamedTuple):
    """A text that was never saved.

    Attributes:
        text: with LF as line ends.
        seen: digest of the file when the text was made of it; empty if there was none.
        at: date and time in UTC, ISO 8601.
        owner: the conversation that it belongs to.
    """

    text: str
    seen: str
    at: str
    owner: str


def state_folder() -> Path:
    """Return the folder in which this user's programs keep their state, with the name of this one added."""
    home = Path.home()
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = home / "Library" / "Application Support"
    else:
        given = os.environ.get("XDG_STATE_HOME", "")
        # The specification says that a relative path counts as none.
        base = Path(given) if Path(given).is_absolute() else home / ".local" / "state"
    return base / "elitescript" / "studio"


class Memory:
    """The files.

    Args:
        folder: that they are in; made when something is written.
    """

    __slots__ = ("_folder",)

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    # ---------------------------------------------------------------- drafts

    def drafts(self, program: Path) -> list[Draft]:
        """Return the drafts of a program, the newest first."""
        found = [draft for path in self._files(program) if (draft := _draft(_read(path, DRAFT_BYTES_MAX)))]
        return sorted(found, key=lambda draft: draft.at, reverse=True)

    def keep(self, program: Path, text: str, seen: str, owner: str) -> None:
        """Keep the draft of a conversation, in place of its earlier one.

        Raises:
            OSError: it cannot be written.
        """
        # The path is for people that look for a text of theirs.
        _write(self._file(program, owner), {"path": str(program), **Draft(text, seen, _now(), owner)._asdict()})
        for draft in self.drafts(program)[DRAFTS_MAX:]:
            self.drop(program, draft.owner)
        self._sweep()

    def _sweep(self) -> None:
        """Remove what processes that were killed in the middle of a write have left."""
        for path in (self._folder / "drafts").glob(f".*{BESIDE}"):
            with suppress(OSError):
                if time() - path.stat().st_mtime > UNFINISHED_S:
                    path.unlink()

    def drop(self, program: Path, *owners: str) -> None:
        """Remove the drafts of some conversations.

        Raises:
            OSError: they cannot be removed.
        """
        for owner in owners:
            self._file(program, owner).unlink(missing_ok=True)

    def _file(self, program: Path, owner: str) -> Path:
        return self._folder / "drafts" / f"{_name(program)}-{owner}.json"

    def _files(self, program: Path) -> list[Path]:
        return list((self._folder / "drafts").glob(f"{_name(program)}-*.json"))

    # ---------------------------------------------------------------- settings

    def settings(self) -> dict[str, Any]:
        """Return the settings of the page; empty if there are none."""
        return _read(self._folder / "settings.json", 2 * SETTINGS_BYTES_MAX)

    def keep_settings(self, values: Mapping[str, Any]) -> None:
        """Keep the settings of the page, in place of the earlier ones.

        Raises:
            ValueError: they are too large.
            OSError: they cannot be written.
        """
        if (size := len(json.dumps(values))) > SETTINGS_BYTES_MAX:
            raise ValueError(f"the settings have {size} bytes; at most {SETTINGS_BYTES_MAX} are kept")
        _write(self._folder / "settings.json", dict(values))


def new_owner() -> str:
    """Return a name for a conversation that no other has."""
    return token_hex(8)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def _name(program: Path) -> str:
    return sha256(os.fsencode(program)).hexdigest()[:32]


def _draft(row: Mapping[str, Any]) -> Draft | None:
    values = [value for name in Draft._fields if isinstance(value := row.get(name), str)]
    return Draft(*values) if len(values) == len(Draft._fields) else None


def _read(path: Path, size_max: int) -> dict[str, Any]:
    """Return the object in a file; empty if there is none that makes sense."""
    try:
        found = json_value(read_bytes(path, Kind("file of the studio", size_max)))
    except (UsageError, JsonError):
        return {}
    return found if isinstance(found, dict) else {}


def _write(path: Path, data: dict[str, Any]) -> None:
    path.parent.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    path.parent.mkdir(mode=0o700, exist_ok=True)
    # ASCII: a text may hold half a character, which no UTF-8 has.
    write_file(path, json.dumps(data).encode("ascii"), mode=0o600)
