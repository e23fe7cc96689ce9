"""Jobs of child processes of an executor: what they do with numbers is chosen so that some of them go wrong."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Mapping
from pathlib import Path
from threading import Event
from typing import Any

from elitescript.errors import UsageError


def squares(description: Mapping[str, Any]) -> Callable[[Any], Any]:
    """Return what squares a number.

    The description says what else happens: `kills` are numbers that end the process each time, `kills_once` those that
    do it the first time, of which `folder` remembers; `hangs` are numbers that never come back.
    """
    if "refuses" in description:
        raise UsageError(description["refuses"])

    def work(order: Any) -> Any:
        number = order["of"] if isinstance(order, dict) else order
        if number in description.get("hangs", ()):
            Event().wait()
        mark = Path(description.get("folder", ""), f"killed-{number}")
        if number in description.get("kills", ()) or (
            number in description.get("kills_once", ()) and not mark.exists()
        ):
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        if number in description.get("fails", ()):
            raise RuntimeError(f"number {number} fails")
        print("what a job prints does not get among the messages")
        return number * number

    return work
