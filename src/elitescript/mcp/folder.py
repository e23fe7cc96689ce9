"""The folder that a server was started for: every file that a call names is inside it."""

from __future__ import annotations

from pathlib import Path

from elitescript.errors import UsageError
from elitescript.paths import is_program_name, is_task_name, real_path
from elitescript.shown import encodable, with_bytes


class Folder:
    """A folder.

    Args:
        path: of it.

    Attributes:
        path: without links.

    Raises:
        UsageError: it is no folder.
    """

    __slots__ = ("path",)

    def __init__(self, path: str | Path) -> None:
        self.path = real_path(path)
        if not self.path.is_dir():
            raise UsageError(f"{path} is no folder")

    def file(self, name: str, *suffixes: str) -> Path:
        """Return the path of a file, without links.

        Args:
            name: relative to the folder, or absolute.
            suffixes: one of which it must have, in small or capital letters.

        Raises:
            UsageError: it is outside the folder, no ordinary file or of another kind.
        """
        try:
            found = (self.path / with_bytes(name)).resolve()
            is_inside = found.is_relative_to(self.path)
            if is_inside and found.suffix.lower() not in suffixes:
                raise UsageError(f"{name}: a file with the suffix {' or '.join(suffixes)} is needed")
            if is_inside and not found.is_file():
                raise UsageError(f"{name}: there is no such file in {self.path}")
        except (OSError, ValueError, RuntimeError) as error:
            raise UsageError(f"{name!r:.200} is no path: {error}") from None
        if not is_inside:
            raise UsageError(f"{name} is outside {self.path}: only files in this folder can be named")
        return found

    def programs(self, most: int) -> tuple[list[str], int]:
        """Return the programs inside, relative to the folder and by name, and how many there are in all.

        Hidden folders are left out. Bytes of names that are no UTF-8 are escapes such as `\\udce9`, which `file` knows.
        """
        found = sorted(
            encodable(str(path.relative_to(self.path)))
            for path in self.path.rglob("*.*")
            if (is_program_name(path.name) or is_task_name(path.name))
            and not any(part.startswith(".") for part in path.relative_to(self.path).parts)
        )
        return found[:most], len(found)
