"""The paths of one call: no output is an input, none is another output, and each can be written.

They are compared before anything runs, by what they lead to: through links, and as the files that they are now.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.outputs.writing import why_no_page
from elitescript.paths import kind_of, real_path, stream_of
from elitescript.records import NamedTuple

FILE: Final = "file"
"""A file that is replaced; pipes, devices and streams of the shell are written straight."""
PAGE: Final = "page"
"""As a file; what is no page of ours is not replaced."""
ORDINARY: Final = "ordinary"
"""A file that is read again, so that it can be nothing else."""
REWRITTEN: Final = "rewritten"
"""A file that is read and changed in its place, which is what the call is for."""
MADE: Final = "made"
"""A file that is compared with others only: what makes its folder says whether it can be written."""
NEW: Final = "new"
"""A file that must not exist, or a device; whatever makes it checks that."""


class Read(NamedTuple):
    """A path that a call reads.

    Attributes:
        path: as it was given.
        called: by option and value, as `--world cell.toml`.
        noun: what it is, as `the world file`.
    """

    path: str | Path
    called: str
    noun: str


class Written(NamedTuple):
    """A path that a call writes.

    Attributes:
        path: as it was given.
        called: by option and value, as `--page out.html`.
        kind: `FILE` or another one of this module.
        beside: paths that the same output writes besides, such as the journal of a table.
    """

    path: str | Path
    called: str
    kind: str = FILE
    beside: tuple[Path, ...] = ()


def check_paths(reads: Iterable[Read], writes: Iterable[Written], *, is_forced: bool = False) -> None:
    """Refuse outputs that cannot be written, or would destroy an input or each other.

    Args:
        reads: every path that the call reads.
        writes: every path that it writes.
        is_forced: whether a file that is no page of ours may become a page.

    Raises:
        UsageError: the text names both options.
    """
    inputs = [(read, _identities(read.path)) for read in reads]
    outputs: list[tuple[Written, str, set[object]]] = []
    for written in writes:
        if written.kind not in (REWRITTEN, MADE) and (why := why_not_written(written.path, written.kind)):
            raise UsageError(f"{written.called}: {why}")
        for path in (written.path, *written.beside):
            called = written.called if path is written.path else f"{written.called}, which writes {path} too"
            identities = _identities(path)
            for read, known in inputs:
                if identities & known:
                    raise UsageError(f"{called}: this is {read.noun} ({read.called}); it would be lost")
            for other, shown, known in outputs:
                is_pair = other is not written and not other.kind == written.kind == REWRITTEN
                if is_pair and identities & known:
                    raise UsageError(f"{called}: {shown} would be written to the same file; give each its own")
            if path is written.path and written.kind != REWRITTEN:
                _check_streams(written, identities)
            outputs.append((written, called, identities))
        if written.kind == PAGE and not is_forced and (why := why_no_page(written.path)):
            raise UsageError(f"{written.called}: {why}; give it another name, or add --force")


def why_not_written(path: str | os.PathLike[str], kind: str = FILE) -> str:
    """Return why a file cannot be written to a path, as `it is a folder, not a file`; empty if it can.

    Args:
        path: links are followed.
        kind: see `Written`.
    """
    name = os.fspath(path)
    if not name:
        return "the name of the file is missing"
    if name.endswith(("/", os.sep)):
        return "this is the name of a folder"
    if stream_of(name) is not None:
        return "it is a stream of the shell, not a file" if kind == ORDINARY else ""
    real = real_path(name)
    try:
        mode = os.stat(name).st_mode  # noqa: PTH116
    except (FileNotFoundError, NotADirectoryError):
        if not real.parent.is_dir():
            # As it was given, unless a link leads elsewhere.
            folder = real.parent if os.path.islink(name) else Path(name).parent  # noqa: PTH114
            return f"there is no folder {folder}"
        return "" if os.access(real.parent, os.W_OK | os.X_OK) else "no file can be made in its folder"
    except (OSError, ValueError) as error:
        return getattr(error, "strerror", None) or str(error)
    if not stat.S_ISREG(mode):
        found = kind_of(mode)
        is_straight = kind != ORDINARY and found in ("a named pipe", "a device")
        return "" if is_straight else f"it is {found}, not a file"
    return "" if kind == NEW or os.access(name, os.W_OK) else "it is read-only"


def _identities(path: str | Path) -> set[object]:
    """Return what tells whether two paths are one: the path without links, and the file that is there.

    Devices such as `/dev/null` take what several write, and have no identity.
    """
    name = os.fspath(path)
    try:
        stream = stream_of(name)
        found = os.stat(name) if stream is None else os.fstat(stream)  # noqa: PTH116
    except (OSError, ValueError):
        return {str(real_path(name))} if "\0" not in name else set()
    if stat.S_ISCHR(found.st_mode) or stat.S_ISBLK(found.st_mode):
        return set()
    file = (found.st_dev, found.st_ino)
    return {file} if stream is not None else {str(real_path(name)), file}


def _check_streams(written: Written, identities: set[object]) -> None:
    """Refuse an output that is what the shell has redirected standard output or the error output to."""
    if stream_of(written.path) is not None:
        return
    for number, name in ((1, "standard output"), (2, "the error output")):
        try:
            found = os.fstat(number)
        except OSError:
            continue
        if stat.S_ISREG(found.st_mode) and (found.st_dev, found.st_ino) in identities:
            raise UsageError(f"{written.called}: {name} of this call goes to the same file; give each its own")
