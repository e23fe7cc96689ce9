"""Runs the program of a recording on a simulated robot, with the inputs that were recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from elitescript.audit.inputs import Inputs, Schedule
from elitescript.audit.series import Mark, Series, simulated
from elitescript.audit.settings import SettingsTrace
from elitescript.controller.views.trace import Trace
from elitescript.controller.views.trace_rows import TraceRecorder
from elitescript.controller.views.trace_signals import TraceSignals
from elitescript.devices.device import Device
from elitescript.environment.program_file import source_of
from elitescript.errors import ScriptError, UsageError
from elitescript.language.text.source import SourceFile
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.models.model import RobotModel
from elitescript.paths import real_path, why_no_file
from elitescript.records import NamedTuple, record
from elitescript.robot import VirtualRobot, Watch
from elitescript.run import Run
from elitescript.untrusted.files import TASK_FILE, read_bytes
from elitescript.world_file import closed_world

if TYPE_CHECKING:
    from elitescript.devices.world import World

LONGER_S: Final = 1.0
"""How long the simulated run goes on behind the end of a recording that ends while the program runs."""
_LIMIT: Final = (2.0, 30.0)
"""A simulated run ends after so many times the recorded one and so many seconds more."""
_SETTLING_MAX_S: Final = 3600.0
"""Time of the controller before the program, up to which devices go through it (*assumed*)."""
TASK_FILES_BYTES: Final = 32 << 20
"""Files beside a program that a simulated run gets, in all (*assumed*)."""


@record
class Cell:
    """What is needed to simulate the robot of a recording.

    Attributes:
        source: text of the program.
        model: the arm, its name or the path of its file; None for that of the world file.
        world: path of the world file, or its name if there is a text; None if there is none.
        world_text: of a world file that a recording holds, which may name no Python file; None for that of the path.
        task_files: of the program's folder, by name.
        options: further options of the robot.
        presets: program globals that have a value before the program begins.
    """

    source: SourceFile
    model: str | RobotModel | None = None
    world: str | None = None
    world_text: str | None = None
    task_files: Mapping[str, bytes] | None = None
    options: Mapping[str, Any] | None = None
    presets: Mapping[str, object] | None = None

    def robot(self, **options: Any) -> VirtualRobot:
        """Return a new robot that reaches nothing of this computer."""
        return VirtualRobot(
            self.model,
            world=self._closed_world(),
            task_dir=dict(self.task_files or {}),
            **{**(self.options or {}), **options},
        )

    def driven(self) -> frozenset[str]:
        """Return the inputs of the robot that devices of the world set."""
        return frozenset(name for device in self._devices() for name in device.driven_inputs)

    def has_devices(self) -> bool:
        """Return whether there are devices, which may act before the program begins."""
        return bool(self._devices())

    def _devices(self) -> Sequence[Device]:
        return self._closed_world().devices

    def _closed_world(self) -> World:
        return closed_world(self.world, is_trusted=self.world_text is None, text=self.world_text)


class Simulated(NamedTuple):
    """A simulated run."""

    series: Series
    settings: SettingsTrace
    run: Run
    robot: VirtualRobot
    refused: tuple[str, ...]
    """What of the recorded state at the start the robot does not take, for people."""


def simulate(
    cell: Cell,
    inputs: Inputs,
    recorded: Series,
    marks: Sequence[Mark],
    signals: Sequence[str],
    *,
    by_lines: bool,
) -> Simulated:
    """Run the program with the inputs of a recorded run.

    Args:
        cell: program, arm and world.
        inputs: of the recorded run.
        recorded: that run.
        marks: its marks.
        signals: that are compared.
        by_lines: whether lines are among the marks.

    Raises:
        ProgramError: the program does not compile.
        UsageError: arm or world cannot be read.
    """
    trace = TraceRecorder(signals=TraceSignals(signals))
    robot, refused = started_robot(cell, inputs)
    place = robot.state.tcp_pose_target
    settings = SettingsTrace(robot)
    _, run = play(cell, inputs, recorded, marks, trace, by_lines=by_lines, robot=robot, watch=settings.watch)
    series = simulated(trace.rows, inputs.joints, place, is_open=run.state in ("time_limit", "stuck"))
    return Simulated(series, settings, run, robot, refused)


def play(
    cell: Cell,
    inputs: Inputs,
    recorded: Series,
    marks: Sequence[Mark],
    trace: Trace,
    *,
    by_lines: bool,
    robot: VirtualRobot | None = None,
    watch: Watch | None = None,
) -> tuple[VirtualRobot, Run]:
    """As `simulate`, with a trace of one's own; the robot, if given, is one of `started_robot`."""
    if robot is None:
        robot, _ = started_robot(cell, inputs)
    schedule = Schedule(inputs.arrivals, recorded, marks, by_lines=by_lines)
    schedule.begin(robot)

    def watch_all(robot: VirtualRobot) -> None:
        schedule.watch(robot)
        if recorded.is_open and schedule.is_over(robot, LONGER_S):
            robot.interrupt("time_limit")
        if watch is not None:
            watch(robot)

    factor, more_s = _LIMIT
    until_s = factor * recorded.t[-1] + more_s
    run = robot.run(robot.compile(cell.source), until_s=until_s, presets=cell.presets, trace=trace, watch=watch_all)
    return robot, run


def started_robot(cell: Cell, inputs: Inputs) -> tuple[VirtualRobot, tuple[str, ...]]:
    """Return a robot that stands as the recorded one did when its program began, and what it does not take of that."""
    options: dict[str, Any] = {"joints": inputs.joints}
    if inputs.speed is not None:
        options["speed"] = inputs.speed
    robot = cell.robot(**options)
    if inputs.begin_s <= _SETTLING_MAX_S and cell.has_devices():
        # What devices do by themselves counts from the start of the controller.
        robot.advance(seconds(round(inputs.begin_s * TICKS_PER_S)))
    refused: list[str] = []
    for name, level in inputs.levels.items():
        if robot.signals[name] != level:
            try:
                robot.set_start({name: level})
            except UsageError as error:
                refused.append(f"{name} at the start: {error}")
    for request in inputs.requests:
        try:
            robot.controller.request(request)
        except ScriptError as error:
            refused.append(f"at the start: {error}")
    return robot, tuple(refused)


def cell_of(
    program: str | Path | SourceFile,
    model: str | RobotModel | None = None,
    world: str | Path | None = None,
    options: Mapping[str, Any] | None = None,
    presets: Mapping[str, object] | None = None,
    world_text: str | None = None,
) -> Cell:
    """Return the cell of a program: its text, and the files of its folder that it names.

    Raises:
        UsageError: no such file.
    """
    source = program if isinstance(program, SourceFile) else source_of(program)
    name = None if world is None else str(world)
    return Cell(source, model, name, world_text, _task_files(source), options, presets)


def _task_files(source: SourceFile) -> dict[str, bytes]:
    """Return the files beside a program whose names stand in its text."""
    if source.name.startswith("<"):
        return {}
    folder = real_path(source.name).parent
    found: dict[str, bytes] = {}
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.name in source.text and not why_no_file(path):
            found[path.name] = read_bytes(path, TASK_FILE)
    if sum(map(len, found.values())) > TASK_FILES_BYTES:
        raise UsageError(f"the files of {folder} that the program names have more than {TASK_FILES_BYTES >> 20} MiB")
    return found
