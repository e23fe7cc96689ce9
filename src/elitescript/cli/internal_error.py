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
_NO_THREAD: Final = "can't start new thread"
_NO_MAPPING: Final = "failed to map segment"
"""What the C library says of a module for which there is no memory."""
_HOME: Final = f"{Path(__file__).parents[2]}{os.sep}"


def sentence(error: BaseException) -> str:
    """Return what a command says of an exception that it does not know, with the calls that have led to it."""
    if str(error) == _NO_THREAD:
        return (
            "no thread can be started: raise the limits of the shell on memory and processes (`ulimit -v`, `ulimit -u`)"
        )
    if isinstance(error, MemoryError) or (isinstance(error, ImportError) and _NO_MAPPING in str(error)):
        return "there is not enough memory: raise the limit of the shell (`ulimit -v`) or of the computer"
    places = extract_tb(error.__traceback__)[: -PLACES_MAX - 1 : -1]
    calls = " from ".join(f"{place.filename.removeprefix(_HOME)}:{place.lineno}" for place in places)
    text = f"{type(error).__name__}: {error}".rstrip(": ")
    python = ".".join(map(str, sys.version_info[:3]))
    return printable(f"internal error, please report it: {text} ({calls}; elitescript {__version__}, Python {python})")
