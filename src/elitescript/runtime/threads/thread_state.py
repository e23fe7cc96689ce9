"""Where script threads are, in plain words."""

from __future__ import annotations

from typing import NamedTuple

from elitescript.language.modules import COPIED
from elitescript.messages.timing import seconds
from elitescript.runtime.threads.strand import Strand


class ThreadState(NamedTuple):
    """Where a script thread is."""

    name: str
    line: int
    waits_for: str
    """In plain words; empty while it runs."""

    @property
    def doing(self) -> str:
        """What it does, as half a sentence."""
        return f"waiting for {self.waits_for}" if self.waits_for else "running"


def state_of(strand: Strand) -> ThreadState:
    """Where a strand is and what it waits for."""
    return ThreadState(strand.name, strand.line, _wait_of(strand))


def _wait_of(strand: Strand) -> str:
    """What a strand waits for, with the call of the standard library in which it does."""
    reason = strand.waits_for
    if not reason:
        return ""
    if strand.until is not None:
        reason = f"{reason}, until {seconds(strand.until):.3f} s"
    frame = strand.called_from_script()
    if frame is not None and frame.f_globals.get("__name__") in COPIED:
        return f"{reason} in {frame.f_globals['__name__']}.{frame.f_code.co_qualname}()"
    return reason
