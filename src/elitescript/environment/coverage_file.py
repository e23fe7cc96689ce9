"""The file that a process records its coverage in, mapped into memory: it is whole however the process ends."""

from __future__ import annotations

import mmap
import os
import tempfile
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.observer import COVERAGE_VARIABLE

SUFFIX: Final = ".coverage"


def open_coverage_file(folder: str | Path, size: int) -> int:
    """Return the descriptor of a new file of zeros, which belongs to one process.

    Args:
        folder: of all records.
        size: in bytes; most systems keep only what is written.

    Raises:
        UsageError: the file cannot be made.
    """
    try:
        descriptor, _ = tempfile.mkstemp(SUFFIX, f"{os.getpid()}-", folder)
        os.ftruncate(descriptor, size)
    except OSError as error:
        raise UsageError(f"{COVERAGE_VARIABLE}={folder}: {error.strerror or error}") from error
    return descriptor


def mapped(descriptor: int) -> mmap.mmap:
    """Return the content of a file as bytes that are written where they change; its descriptor is closed."""
    try:
        return mmap.mmap(descriptor, 0)
    finally:
        os.close(descriptor)


def content_of(path: Path) -> memoryview:
    """Return the content of a record; what is not written in it is not read."""
    return memoryview(mapped(os.open(path, os.O_RDWR | getattr(os, "O_BINARY", 0))))


def records_in(folder: str | Path) -> list[Path]:
    """Return the files of all processes."""
    return sorted(Path(folder).glob(f"*{SUFFIX}"))
