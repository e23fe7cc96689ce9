"""What is debugged: something that makes the same run whenever it is begun, such as a program file with its robot.

A `DebugSession` goes back by beginning again. So a source may hold nothing that a run has changed: it makes a new robot
and new devices each time. `ProgramSource` is a program as `elitescript run` takes it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

from elitescript.controller.controller import Controller
from elitescript.messages.events import Event
from elitescript.messages.signals import Value
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.probe import Probe


class Execution(Protocol):
    """One execution of a source, from its beginning.

    Attributes:
        controller: the machine.
        host: runs its programs.
    """

    @property
    def controller(self) -> Controller: ...

    @property
    def host(self) -> ScriptHost: ...

    def run(self) -> str:
        """Run to the end; return `finished`, `alarm`, `stopped`, `time_limit` or `stuck`.

        It may be left for good inside any call of the probe, of `on_event` or of `after_tick`.
        """

    def close(self) -> None:
        """Release what it holds; called once, also when `run` was left."""


class Source(Protocol):
    """Makes executions.

    Attributes:
        name: of the program's text: its path.
        text: the program.
    """

    @property
    def name(self) -> str: ...

    @property
    def text(self) -> str: ...

    def begin(
        self,
        probe: Probe,
        *,
        on_event: Callable[[Event], None],
        after_tick: Callable[[], None],
        next_stop: Callable[[int], int | None],
    ) -> Execution:
        """Make a new execution that has not run yet.

        Args:
            probe: counts the statements of its programs.
            on_event: receives each event when it happens, also changes of signals.
            after_tick: called after each tick that was run.
            next_stop: returns for a tick the next one that has to be run although nothing is due; None for none.

        Raises:
            ProgramError: the program does not compile.
            ElitescriptError: the robot, the world or an option is wrong.
        """


class ProgramSource:
    """A program file with a robot, as `elitescript run` takes it. Implements `Source`.

    Args:
        path: the program.
        text: its text, if that is not the one of the file.
        world: path of a world file.
        levels: signals at the start (`--set` of signals).
        presets: program globals at the start (`--set` of globals).
        until_s: as `--until`.
        lines: serial ports, as `VirtualRobot` takes them.
        task_dir: folder of the program's files; that of the program if None.
        options: of the robot, by their names: `model`, `firmware`, `joints`, `seed`, ...
    """

    def __init__(
        self,
        path: str | Path,
        *,
        text: str | None = None,
        world: str | Path | None = None,
        levels: Mapping[str, Value] | None = None,
        presets: Mapping[str, object] | None = None,
        until_s: float | None = None,
        lines: Mapping[str, str] | None = None,
        task_dir: str | Path | None = None,
        **options: Any,
    ) -> None: ...
