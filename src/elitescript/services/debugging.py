"""Robots to whose programs a debugger can attach: all that are served, and their replays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from elitescript.kernel.debugging import Debugging, Reply
from elitescript.runtime.probe import default_probe

if TYPE_CHECKING:
    from elitescript.controller.controller import Controller
    from elitescript.debugger.living import LivingDebugger
    from elitescript.runtime.host import ScriptHost


def debugging() -> Debugging | None:
    """Return what lets a debugger attach to a robot; None in a process that measures coverage."""
    return Debugging(_debugger) if default_probe() is None else None


def _debugger(controller: Controller, host: ScriptHost, reply: Reply) -> LivingDebugger:
    # Imported when the first debugger comes: most robots never have one.
    from elitescript.debugger.living import LivingDebugger

    return LivingDebugger(controller, host, reply)
