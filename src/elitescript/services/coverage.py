"""Counts what all programs of this process run, in a file of its own."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from threading import Lock
from weakref import ref

from elitescript.coverage.probe import CoverageProbe
from elitescript.coverage.recording import BLOCK_BYTES, Recorder
from elitescript.environment.coverage_file import mapped, open_coverage_file
from elitescript.runtime.probe import Probe, default_probe, set_default


def count_programs(folder: str) -> Callable[[], Probe] | None:
    """Count, from now on, what the programs of robots in this process run; return what made their probes before.

    Args:
        folder: in which the file is made.

    Raises:
        UsageError: the file cannot be made.
    """
    before = count_programs_in(coverage_descriptor(folder))
    if hasattr(os, "register_at_fork"):
        probe = default_probe()
        assert isinstance(probe, CoverageProbe)
        os.register_at_fork(after_in_child=partial(_count_apart, ref(probe), folder))
    return before


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


def _count_apart(counting: ref[CoverageProbe], folder: str) -> None:
    """Count in a file of its own in a process that was forked: two cannot give away room of one."""
    probe = counting()
    if probe is not None and Path(folder).is_dir():
        block = memoryview(mapped(coverage_descriptor(folder)))
        probe.recorder = probe.recorder.copied(block, Lock())
