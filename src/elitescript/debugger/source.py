"""What is debugged: something that makes the same run whenever it is begun, such as a program file with its robot.

A `DebugSession` goes back by beginning again. So a source may hold nothing that a run has changed: it makes a new robot
and new devices each time. `ProgramSource` is a program as `elitescript run` takes it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, Final, Protocol

from elitescript.controller.controller import Controller
from elitescript.debugger.connections import KeptChannels, KeptNetwork
from elitescript.devices.outside import OutsideChannels
from elitescript.devices.surroundings import Surroundings
from elitescript.environment.network_option import PYTHON, Way
from elitescript.environment.program_file import source_of
from elitescript.errors import ProgramError, ScriptError
from elitescript.language.compiler import CompiledUnit, compile_unit
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.options import Options
from elitescript.language.parser import Parsed, parse
from elitescript.language.probes import STEPS_PROBES
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_parsed
from elitescript.lint.outside import COMMANDS, FILE, RPC, SERIAL, outside_names
from elitescript.lint.program import AnalysedProgram
from elitescript.messages.events import DeviceNoted, Event
from elitescript.messages.signals import Value
from elitescript.paths import real_path
from elitescript.robot import VirtualRobot
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.probe import Probe

NETWORK: Final = "network"
"""Under this name a run says which peers it reaches."""

_OPENING: Final = re.compile(r"\bopen\s*\(")


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
        problems: what was found in it before it ran.
        may_fork: whether copies of a process may hold executions: not with real connections, which they would share.
        may_write: whether its programs may write files outside of the simulation.
    """

    def may_connect(self, text: str) -> bool:
        """Return whether a text that the user has run at a stop may make a real connection."""

    @property
    def requests(self) -> int:
        """How much its executions have asked of real connections, in this process."""

    def forget_requests(self, requests: int) -> None:
        """Forget what was asked since `requests` was so many: what has asked was taken back."""

    @property
    def may_fork(self) -> bool: ...

    @property
    def may_write(self) -> bool: ...

    @property
    def problems(self) -> tuple[Diagnostic, ...]: ...

    @property
    def name(self) -> str: ...

    @property
    def text(self) -> str: ...

    def begin(
        self,
        probe: Probe | None,
        *,
        on_event: Callable[[Event], None],
        after_tick: Callable[[], None],
        next_stop: Callable[[int], int | None],
    ) -> Execution:
        """Make a new execution that has not run yet.

        Args:
            probe: counts the statements of its programs; None for a run that nothing counts.
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
        source: its text with what is known of it, such as the nodes of a graphical program; None: that of the file.
        world: path of a world file, or a function that makes what is around the robot, for each execution anew.
        levels: signals at the start (`--set` of signals).
        schedule: time, s, name and value of signals that change later; see `VirtualRobot.at`.
        presets: program globals at the start (`--set` of globals).
        until_s: as `--until`.
        lines: serial ports, as `VirtualRobot` takes them.
        task_dir: folder of the program's files, or their contents by name; that of the program if None.
        network_by: how users set the option `network`.
        options: of the robot, by their names: `model`, `firmware`, `joints`, `seed`, ...

    Attributes:
        problems: what was found in the program.
        may_fork, may_write: see `Source`.

    Raises:
        ProgramError: the program does not compile, or is refused.
        ElitescriptError: the robot, the world or an option is wrong.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        text: str | None = None,
        source: SourceFile | None = None,
        world: str | Path | Callable[[], Surroundings] | None = None,
        levels: Mapping[str, Value] | None = None,
        schedule: Iterable[tuple[float, str, Value]] = (),
        presets: Mapping[str, object] | None = None,
        until_s: float | None = None,
        lines: Mapping[str, str] | None = None,
        task_dir: str | Path | Mapping[str, bytes] | None = None,
        network_by: Way = PYTHON,
        **options: Any,
    ) -> None:
        if source is None:
            source = source_of(Path(path)) if text is None else SourceFile(str(path), text)
        self.name, self.text = source.name, source.text
        self._source = source
        self._plain: CompiledUnit | None = None
        self._presets = dict(presets or {})
        self._until_s = until_s
        self._levels = dict(levels or {})
        self._schedule = tuple(schedule)
        if task_dir is None and text is None:
            task_dir = real_path(path).parent
        self._network: KeptNetwork | None = None
        self.may_write = _OPENING.search(self.text) is not None
        self._world = world
        self._network_by = network_by
        self._make = partial(VirtualRobot, task_dir=task_dir, lines=lines, **options)
        robot = self._robot()
        self._may_be_real = robot.may_be_real
        read = Options(strict=robot.options.strict, probes=STEPS_PROBES, ignored=robot.options.ignored)
        parsed = parse(source, read)
        self.may_fork = not (self._may_be_real and _leads_outside(parsed, robot))
        checked = check_parsed(parsed, robot.profile, presets=self._presets, arm=robot.model)
        self.problems = checked.problems
        if checked.unit is None or checked.is_refused:
            raise ProgramError(checked.problems)
        self._unit = checked.unit

    def _robot(self, **options: Any) -> VirtualRobot:
        world = self._world
        robot = self._make(world=world() if callable(world) else world, **options)
        robot.set_network_by(self._network_by)
        return robot

    def may_connect(self, text: str) -> bool:
        """See `Source.may_connect`."""
        return self._may_be_real and any(row.kind != FILE and name in text for name, row in COMMANDS.items())

    @property
    def requests(self) -> int:
        """See `Source.requests`."""
        return 0 if self._network is None else self._network.requests

    def forget_requests(self, requests: int) -> None:
        """See `Source.forget_requests`."""
        if self._network is not None:
            self._network.forget(requests)

    def begin(
        self,
        probe: Probe | None,
        *,
        on_event: Callable[[Event], None],
        after_tick: Callable[[], None],
        next_stop: Callable[[int], int | None],
    ) -> ProgramExecution:
        """See `Source.begin`."""
        robot = self._robot(on_event=on_event, probe=probe)
        robot.set_start(self._levels)
        for time_s, name, value in self._schedule:
            robot.at(time_s, name, value)
        if self._may_be_real:
            emit = robot.controller.emit
            robot.wrap_network(
                lambda channels: self._kept(channels, lambda text: emit(DeviceNoted(robot.tick, NETWORK, text)))
            )
        robot.next_stop = next_stop
        if probe is None:
            self._plain = self._plain or compile_unit(self._source, Options(strict=robot.options.strict))
            return ProgramExecution(robot, self._plain, self._presets, self._until_s, after_tick)
        probe.compiled(self._unit)
        return ProgramExecution(robot, self._unit, self._presets, self._until_s, after_tick)

    def _kept(self, channels: OutsideChannels, say: Callable[[str], None]) -> OutsideChannels:
        if self._network is None:
            self._network = KeptNetwork(channels)
        return KeptChannels(self._network, say)


def _leads_outside(parsed: Parsed, robot: VirtualRobot) -> bool:
    """Return whether a program may have a connection that does not end beside the robot or nowhere."""
    for named in outside_names(AnalysedProgram(parsed, robot.profile)):
        if named.kind == FILE:
            continue
        if named.name is None or (named.port is None and named.kind not in (RPC, SERIAL)):
            return True
        try:
            place = robot.place(named.kind, named.name, named.port or 0)
        except ScriptError:
            continue
        if place.is_reached and not place.is_beside:
            return True
    return False


class ProgramExecution:
    """One execution of a `ProgramSource`."""

    __slots__ = ("_after_tick", "_presets", "_robot", "_unit", "_until_s", "controller", "host")

    def __init__(
        self,
        robot: VirtualRobot,
        unit: CompiledUnit,
        presets: Mapping[str, object],
        until_s: float | None,
        after_tick: Callable[[], None],
    ) -> None:
        self._robot: VirtualRobot | None = robot
        self._unit = unit
        self._presets = presets
        self._until_s = until_s
        self._after_tick = after_tick
        self.controller = robot.controller
        self.host = robot.host

    def run(self) -> str:
        """See `Execution.run`."""
        robot, after_tick = self._robot, self._after_tick
        assert robot is not None
        robot.start(self._unit, presets=self._presets)
        return str(robot.run_started(until_s=self._until_s, watch=lambda robot: after_tick()).state)

    def close(self) -> None:
        """See `Execution.close`."""
        self.host.forget_threads()
        self._robot = None
