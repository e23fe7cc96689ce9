"""Counts what all programs of this process run, in a file of its own."""

from __future__ import annotations

import os
from collections.abc import Callable
from threading import Lock

from elitescript.coverage.probe import CoverageProbe
from elitescript.coverage.recording import BLOCK_BYTES, Recorder
from elitescript.environment.coverage_file import mapped, open_coverage_file
from elitescript.runtime.probe import Probe, set_default


def count_programs(folder: str) -> Callable[[], Probe] | None:
    """Count, from now on, what the programs of robots in this process run; return what made their probes before.

    Args:
        folder: in which the file is made.

    Raises:
        UsageError: the file cannot be made.
    """
    return count_programs_in(coverage_descriptor(folder))


def coverage_descriptor(folder: str) -> int:
    """Return the descriptor of a new file for `count_programs_in`, which another process may inherit.

    Raises:
        UsageError: the file cannot be made.
    """
    return open_coverage_file(folder, BLOCK_BYTES)


def count_programs_in(descriptor: int) -> Callable[[], Probe] | None:
    """Do as `count_programs`, in a file that is open."""
    probe = CoverageProbe(Recorder(memoryview(mapped(descriptor)), Lock()), os.path.abspath)
    return set_default(lambda: probe)
