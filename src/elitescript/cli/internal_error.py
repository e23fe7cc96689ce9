"""What a defect of this program says of itself: one sentence with all that a report of it needs."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from traceback import extract_tb
from typing import Final

from elitescript import __version__
from elitescript.shown import printable

PLACES_MAX: Final = 12
"""Calls that are named, innermost first."""
_HOME: Final = f"{Path(__file__).parents[2]}{os.sep}"


def sentence(error: BaseException) -> str:
    """Return what a command says of an exception that it does not know, with the calls that have led to it."""
    if isinstance(error, MemoryError):
        return "there is not enough memory: raise the limit of the shell (`ulimit -v`) or of the computer"
    places = extract_tb(error.__traceback__)[: -PLACES_MAX - 1 : -1]
    calls = " from ".join(f"{place.filename.removeprefix(_HOME)}:{place.lineno}" for place in places)
    text = f"{type(error).__name__}: {error}".rstrip(": ")
    python = ".".join(map(str, sys.version_info[:3]))
    return printable(f"internal error, please report it: {text} ({calls}; elitescript {__version__}, Python {python})")
