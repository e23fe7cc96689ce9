"""How test tools watch robots: the observer of every run of this process, and the folder of coverage records."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from contextlib import AbstractContextManager
    from typing import Any, Final, Protocol

    class RunObserver(Protocol):
        """Watches runs of `VirtualRobot`."""

        def started(self, robot: Any, run: Any, presets: Mapping[str, object], trace: Any) -> Any:
            """Note that a robot starts a program with these presets; return the trace that its rows go to, or None."""

        def limits(self, robot: Any, run: Any, until_s: float | None) -> AbstractContextManager[Any]:
            """Hold a run to limits while the context lasts, which gives the limit of robot time to use."""


COVERAGE_VARIABLE: Final = "ELITESCRIPT_COVERAGE"
"""Environment variable with the folder in which `run`, `plot`, `serve` and `replay` record what programs run."""


class Observation:
    """Holds the observer; None costs a run nothing."""

    __slots__ = ("observer",)

    def __init__(self) -> None:
        self.observer: RunObserver | None = None


OBSERVATION: Final = Observation()
"""That of this process, whatever thread makes a robot."""
