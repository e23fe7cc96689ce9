"""The front end as it is built from `web/` by `make studio`, and the finder of its files."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from elitescript.errors import UsageError

STUDIO: Final = "studio.html"
"""Page of the studio; it loads `studio.js` and `studio.css`."""

RECORDED: Final = "recorded.html"
"""Page of one recorded run: one file with style and code, and a place for the recording."""

SWEEP: Final = "sweep.html"
"""Page of a sweep: likewise, with a place for its data."""

MARK: Final = '<meta name="generator" content="elitescript">'
"""In the head of every page that this package writes, built or plain."""

NOT_BUILT: Final = "the studio's page is not built: in a working copy, run `make studio`; an installed package has it"

_BUILT: Final = Path(__file__).parent / "built"


def is_built() -> bool:
    """Return whether the front end is there."""
    return (_BUILT / STUDIO).is_file()


def built(name: str) -> bytes:
    """Return the contents of a built file.

    Args:
        name: such as `studio.js`; a plain file name.

    Raises:
        UsageError: the front end is not built, or has no such file.
    """
    if not is_built():
        raise UsageError(NOT_BUILT)
    path = _BUILT / name
    if Path(name).name != name or not path.is_file():
        raise UsageError(f"the studio's page has no file {name!r}")
    return path.read_bytes()


def names() -> tuple[str, ...]:
    """Return the names of all built files, in alphabetical order; empty if the front end is not built."""
    return tuple(sorted(path.name for path in _BUILT.iterdir())) if is_built() else ()
