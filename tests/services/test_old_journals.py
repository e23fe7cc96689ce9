"""Journals of earlier formats: a session that was written down then comes out the same today.

`journals/format-2.journal` has a task with a connection, faults of connections and inputs, Modbus writes, variables,
queries, interpreter mode and a restart.
"""

from __future__ import annotations

import platform
from pathlib import Path

import pytest

from elitescript.services.journal.replay import Replay
from elitescript.services.journal.writer import JournalReader

FOLDER = Path(__file__).with_name("journals")
TICKS = 800


@pytest.mark.skipif(
    (platform.system(), platform.machine()) != ("Linux", "x86_64"), reason="other C libraries give other last bits"
)
def test_format_2_comes_out_the_same():
    reader = JournalReader(FOLDER / "format-2.journal")
    session = Replay(reader)
    outputs = list(session.outputs())
    assert session.difference is None
    assert session.checked_ticks == TICKS
    assert reader.note == ""
    assert sum(len(output.replies) for output in outputs) == 39
