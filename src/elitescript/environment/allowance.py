"""How much the programs of a robot may put into its task folder."""

from __future__ import annotations

from errno import ENOSPC
from typing import Final

TASK_DIR_BYTES: Final = 100_000_000
"""Default limit, *assumed*: the manual names none, and a flash card of a controller has a few gigabytes."""
ENTRIES_MAX: Final = 10_000
"""Files and folders that programs may make."""
OPTION: Final = "--task-dir-limit"


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
    return f"{size} bytes"
