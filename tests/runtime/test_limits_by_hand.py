"""Limits of running programs against a table written by hand: how much work, how long, how many.

Documented is that `socket_open` tries for two seconds. All others are assumed: the real controller's are not known.
"""

from __future__ import annotations

from importlib import import_module

import pytest

from tests.tables import rows

LIMITS = """
threads.scheduler          WORK_PER_TICK         2000    checkpoints of a thread in a tick
threads.scheduler          WORK_PER_ACTIVATION   20      checkpoints
threads.scheduler          WORK_PER_EVENT        20      checkpoints
threads.scheduler          WORK_PER_REFUSAL      20      checkpoints
threads.scheduler          WORK_PER_REFUSED_MOVE  200    checkpoints
threads.scheduler          STARTS_PER_TICK       1000    threads
connections.sockets        CONNECT_TICKS         500     ticks, 2 s
connections.sockets        CONNECTIONS_MAX       64      names
connections.serial_lines   OPEN_TICKS            500     ticks, 2 s
secondary                  QUEUE_MAX             64      secondary programs
queries                    QUEUE_MAX             1000    calls
queries                    VALUE_MAX             65536   characters
interpreter                STATEMENTS_PER_TICK   50      statements
connections.rpc            CALLS_MAX             32      calls at once
files                OPEN_FILES_MAX        256     files
threads.strand             SCRIPT_DEPTH          1000    calls
"""


@pytest.mark.parametrize(("module", "name", "value", "unit"), rows(LIMITS))
def test_limit(module: str, name: str, value: str, unit: str) -> None:
    assert getattr(import_module(f"elitescript.runtime.{module}"), name) == int(value), unit
