"""The one seam through which something counts the statements of programs: a debugger, or coverage.

A `Probe` is given to a robot (`VirtualRobot(probe=...)`, `Kernel(probe=...)`). It is asked for the options of each text
that the robot compiles, learns of each unit, and gives the hooks that a run finds among its built-ins. Without one
nothing is inserted and nothing is called.

`set_default` names a maker of probes for every robot of this process that is made without one; coverage uses it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final, Protocol, runtime_checkable

from elitescript.language.compiler import CompiledUnit
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile

if TYPE_CHECKING:
    from elitescript.errors import ScriptError
    from elitescript.messages.events import Event


class Probe(Protocol):
    """Counts statements of the programs of one robot."""

    def options(self, options: Options, source: SourceFile) -> Options:
        """Return the options to compile a text with: `probes` and `first_probe` may be other ones."""

    def compiled(self, unit: CompiledUnit) -> None:
        """Take note of a unit, before it runs. Its numbers begin at the `first_probe` that it was compiled with."""

    def hooks(self) -> dict[str, object]:
        """Return the hooks of a run, by the names of `language.hooks`: `STEPS` and `STEP`, or `HITS`."""


@runtime_checkable
class Witness(Protocol):
    """What a probe may do besides: take note of what happens to its robot."""

    def event(self, event: Event) -> None:
        """Take note of an event, but not of a change of a signal."""

    def refused(self, command: str, error: ScriptError) -> None:
        """Take note that a command has refused a call, which the program may catch."""

    def faults(self, places: Sequence[tuple[str, str, str]], faults: Sequence[tuple[str, str]]) -> None:
        """Take note of what beside the robot can have faults, and of the faults that it had.

        Args:
            places: place, its kind and the device there.
            faults: place and kind of each.
        """


_default: Final[list[Callable[[], Probe]]] = []
"""At most one maker. Of the process and not of a robot: coverage measures robots that tests make as they like."""


def set_default(maker: Callable[[], Probe] | None) -> Callable[[], Probe] | None:
    """Set what makes the probe of each robot of this process that is made without one; return what made it before.

    A unit runs in robots with the probe that it was compiled for, so a maker that always returns the same probe lets
    programs be compiled by one robot and run by another one.
    """
    before = _default[0] if _default else None
    _default[:] = [] if maker is None else [maker]
    return before


def default_probe() -> Probe | None:
    """Return the probe of a robot that is made without one."""
    return _default[0]() if _default else None


def witness(probe: object) -> Witness | None:
    """Return the probe of a robot if it takes note of more than statements."""
    return probe if isinstance(probe, Witness) else None


def probed(probe: Probe | None, options: Options, source: SourceFile) -> Options:
    """Return the options to compile a text of a robot with."""
    return options if probe is None else probe.options(options, source)


def noted(probe: Probe | None, unit: CompiledUnit) -> CompiledUnit:
    """Return a unit of which its robot's probe has taken note."""
    if probe is not None:
        probe.compiled(unit)
    return unit
