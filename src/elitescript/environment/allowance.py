"""What the programs of a robot may put into its task folder, and how much."""

from __future__ import annotations

from errno import ENOSPC
from pathlib import PurePosixPath
from typing import Final

from elitescript.errors import ScriptPermissionError
from elitescript.said import said

TASK_DIR_BYTES: Final = 100_000_000
"""Default limit, *assumed*: the manual names none, and a flash card of a controller has a few gigabytes."""
ENTRIES_MAX: Final = 10_000
"""Files and folders that programs may make."""
OPTION: Final = "--task-dir-limit"

_STARTED_NAMES: Final = frozenset(
    (
        *("makefile", "gnumakefile", "cmakelists.txt", "package.json", "dockerfile", "jenkinsfile", "justfile"),
        *("pyproject.toml", "setup.cfg", "tox.ini", "pytest.ini", "noxfile", "rakefile", "autorun.inf", "desktop.ini"),
    )
)
_STARTED_SUFFIXES: Final = frozenset(
    (
        *(".py", ".pyc", ".pyw", ".pyd", ".pyi", ".pth", ".so", ".dylib", ".dll", ".exe", ".com", ".scr", ".msi"),
        *(".sh", ".bash", ".zsh", ".fish", ".bat", ".cmd", ".ps1", ".psm1", ".vbs", ".js", ".mjs", ".cjs", ".lnk"),
        *(".desktop", ".app", ".command", ".service", ".mk", ".cmake", ".code-workspace"),
    )
)
"""Files that an interpreter, a shell, an editor or a build tool runs, or reads what to run from."""


def check_writable(name: str) -> None:
    """Let a program write, make or remove a file or folder that starts no program elsewhere.

    Its folder often is that of a project: a `conftest.py`, a hook of git or the device of a world file that it wrote
    there would later run with all rights of the user.

    Args:
        name: relative to the task folder, after links were followed.

    Raises:
        ScriptPermissionError: it is such a file, or inside a hidden folder.
    """
    for part in PurePosixPath(name.replace("\\", "/").casefold()).parts:
        # Windows leaves out dots and blanks at the end of a name, and reads what follows a colon as a stream of it.
        part = part.partition(":")[0].rstrip(". ") or part
        if part == "..":
            continue
        path = PurePosixPath(part)
        if part.startswith(".") or part in _STARTED_NAMES or path.suffix in _STARTED_SUFFIXES:
            kind = "hidden files" if part.startswith(".") else "files that other programs run"
            raise ScriptPermissionError(
                said("cannot write {name!r}: programs of robots write no {kind}", name=name, kind=kind), value=name
            )


class Allowance:
    """Counts what programs add to one task folder, and refuses what is too much.

    What they delete or cut off they may write again. A folder never holds more than it held at first and the limit.

    Args:
        bytes_max: bytes that programs may add.
    """

    __slots__ = ("_bytes", "_bytes_max", "_entries")

    def __init__(self, bytes_max: int = TASK_DIR_BYTES) -> None:
        self._bytes_max = bytes_max
        self._bytes = 0
        self._entries = 0

    def check_room(self, more: int, name: str) -> None:
        """Let a file grow by so many bytes.

        Raises:
            OSError: there is no room for them; the text holds what is used, the limit and the option that sets it.
        """
        if more > 0 and self._bytes + more > self._bytes_max:
            raise OSError(
                ENOSPC,
                f"No space left in the task folder: programs have written {shown_size(self._bytes)}, and "
                f"{shown_size(more)} more would exceed the limit of {shown_size(self._bytes_max)} ({OPTION} sets it)",
                name,
            )

    def check_entry(self, name: str) -> None:
        """Let a file or folder be made.

        Raises:
            OSError: there are too many.
        """
        if self._entries >= ENTRIES_MAX:
            raise OSError(
                ENOSPC,
                f"No space left in the task folder: programs have made {self._entries} files and folders, "
                "which is the limit",
                name,
            )

    def add(self, size: int, entries: int = 0) -> None:
        """Count bytes, files and folders that were added, or with negative numbers taken away."""
        self._bytes = max(self._bytes + size, 0)
        self._entries = max(self._entries + entries, 0)


def shown_size(size: int) -> str:
    """Return a number of bytes in words: `100 MB`."""
    for power, unit in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if size >= power:
            return f"{size / power:.4g} {unit}"
    return said("{size} bytes", size=size)
