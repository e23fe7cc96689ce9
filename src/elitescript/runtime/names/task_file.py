"""A whole file of the task folder, as commands ask for one."""

from __future__ import annotations

from typing import Final

from elitescript.errors import InvalidValueError, ScriptError
from elitescript.runtime.environment import Files, relative_name

_NAMES_SHOWN: Final = 3
"""File names that a message offers for one that does not exist."""


def content_of(files: Files, path: str, size_max: int) -> bytes:
    """Read a file.

    Args:
        files: the task folder.
        path: of the file, as scripts write it.
        size_max: the largest size, in bytes.

    Raises:
        InvalidValueError: there is no such file, it cannot be read or has more bytes than that.
        ScriptPermissionError: the path leads out of the task folder.
    """
    name = relative_name(path)
    try:
        kind = files.kind(name)
        if kind != "file":
            what = "is a folder" if kind else "does not exist"
            near = [other for other in files.names("") if other.startswith(name.rpartition(".")[0] or name)]
            hint = f"the task folder holds {', '.join(near[:_NAMES_SHOWN])}" if near and not kind else None
            raise InvalidValueError(f"the file {name!r} {what}", argument="file_name", value=path, hint=hint)
        size = files.size(name)
        if size <= size_max:
            with files.open(name, "rb", None, None) as file:
                return bytes(file.read(size_max))
    except OSError as error:
        if isinstance(error, ScriptError):
            raise
        text = f"the file {name!r} cannot be read: {error.strerror or error}"
        raise InvalidValueError(text, argument="file_name", value=path) from None
    raise InvalidValueError(
        f"the file {name!r} has {size} bytes; at most {size_max} are allowed",
        argument="file_name",
        value=size,
        limit=f"<= {size_max}",
        unit="bytes",
    )
