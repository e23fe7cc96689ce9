"""The user's own description of the arm: a URDF file and the meshes in its folder, as the page loads them."""

from __future__ import annotations

from base64 import b64encode
from pathlib import Path
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.paths import real_path
from elitescript.untrusted.files import MESH, read_bytes
from elitescript.untrusted.plain_text import EncodingError, plain_text

SUFFIXES: Final = frozenset((".stl", ".dae", ".png", ".jpg", ".jpeg"))
"""What a description consists of besides the URDF; nothing else is given away."""

_PACKAGE: Final = "package://"
_MANIFEST: Final = "package.xml"
"""Is in the uppermost folder of a package of ROS."""


class Meshes:
    """A URDF file and what it names.

    Args:
        path: of the URDF.

    Raises:
        UsageError: there is no such file, or it is too large or not UTF-8.
    """

    __slots__ = ("_folder", "_path", "name")

    def __init__(self, path: Path) -> None:
        self._path = real_path(path)
        self.name = self._path.name
        folders = self._path.parents
        self._folder = next((folder for folder in folders if (folder / _MANIFEST).is_file()), folders[0])
        """The folder of the file, or that of the package which it belongs to."""
        self.urdf()

    def urdf(self) -> dict[str, Any]:
        """Return the text of the URDF."""
        try:
            text = plain_text(read_bytes(self._path, MESH))
        except EncodingError as error:
            raise UsageError(f"--urdf {self._path}:{error.line}: it is not UTF-8: {error.why}") from None
        return {"name": self.name, "text": text}

    def file(self, name: str) -> dict[str, Any]:
        """Return a mesh or a picture, its bytes in base 64.

        Args:
            name: as the URDF or a mesh has it: relative to the URDF, or `package://PACKAGE/...`.

        Raises:
            UsageError: it is outside the folder, of another kind, too large, or not there.
        """
        if name.startswith(_PACKAGE):
            found = self._folder / name.removeprefix(_PACKAGE).partition("/")[2]
        else:
            found = self._path.parent / name
        try:
            path = found.resolve()
        except (OSError, ValueError, RuntimeError) as error:
            raise UsageError(f"{name!r:.200} is no path: {error}") from None
        if not path.is_relative_to(self._folder):
            raise UsageError(f"{name!r:.200} is outside {self._folder}")
        if path.suffix.lower() not in SUFFIXES:
            raise UsageError(f"{name!r:.200}: only {', '.join(sorted(SUFFIXES))} are loaded")
        return {"name": name, "base64": b64encode(read_bytes(path, MESH)).decode()}
