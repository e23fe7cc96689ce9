"""The one seam through which something counts the statements of programs: a debugger, or coverage.

A `Probe` is given to a robot (`VirtualRobot(probe=...)`, `Kernel(probe=...)`). It is asked for the options of each text
that the robot compiles, learns of each unit, and gives the hooks that a run finds among its built-ins. Without one
nothing is inserted and nothing is called.

`set_default` names a maker of probes for every robot of this process that is made without one; coverage uses it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol

from elitescript.language.compiler import CompiledUnit
from elitescript.language.options import Options


class Probe(Protocol):
    """Counts statements of the programs of one robot."""

    def options(self, options: Options) -> Options:
        """Return the options to compile a text with: `probes` and `first_probe` may be other ones."""

    def compiled(self, unit: CompiledUnit) -> None:
        """Take note of a unit, before it runs. Its numbers begin at the `first_probe` that it was compiled with."""

    def hooks(self) -> dict[str, object]:
        """Return the hooks of a run, by the names of `language.hooks`: `STEPS` and `STEP`, or `HITS`."""


_default: Final[list[Callable[[], Probe]]] = []
"""At most one maker. Of the process and not of a robot: coverage measures robots that tests make as they like."""


def set_default(maker: Callable[[], Probe] | None) -> None:
    """Set what makes the probe of each robot of this process that is made without one; None for no probe.

    A unit runs in robots with the probe that it was compiled for, so a maker that always returns the same probe lets
    programs be compiled by one robot and run by another one.
    """
    _default[:] = [] if maker is None else [maker]


def default_probe() -> Probe | None:
    """Return the probe of a robot that is made without one."""
    return _default[0]() if _default else None


def probed(probe: Probe | None, options: Options) -> Options:
    """Return the options to compile a text of a robot with."""
    return options if probe is None else probe.options(options)


def noted(probe: Probe | None, unit: CompiledUnit) -> CompiledUnit:
    """Return a unit of which its robot's probe has taken note."""
    if probe is not None:
        probe.compiled(unit)
    return unit
