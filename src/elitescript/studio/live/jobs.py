"""What is run: a text with everything that determines its run, as data that goes to another process."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from elitescript.conversation.messages import SignalInput
from elitescript.environment.memory import FolderCopy, folder_contents
from elitescript.environment.network_option import STUDIO, WORLD_FILE
from elitescript.language.text.source import SourceFile, TreeFacts
from elitescript.messages.signals import Value
from elitescript.models.model import is_model_file
from elitescript.paths import is_program_name, is_task_name
from elitescript.records import field, fields_of, record
from elitescript.robot import VirtualRobot
from elitescript.world_file import closed_world, files_read

if TYPE_CHECKING:
    from elitescript.devices.world import World


@record
class Job:
    """A text and the robot that runs it.

    Attributes:
        name: of the text.
        text: the program.
        folder: its task folder, of which the program gets a copy; empty for none.
        robot: options of the robot by their names: `model`, `firmware`, `joints`, `seed`, ...
        world: path of a world file; empty for none.
        is_trusted: whether the world file may name Python files.
        may_connect: whether connections may leave the simulation.
        levels: signals before the program begins.
        presets: program globals that have a value before it begins.
        inputs: signals that change at a time.
        places, arm, unset: of the script of a graphical program, as `SourceFile` has them.
    """

    name: str
    text: str
    folder: str = ""
    robot: Mapping[str, Any] = field(default_factory=dict)
    world: str = ""
    is_trusted: bool = False
    may_connect: bool = False
    levels: Mapping[str, Value] = field(default_factory=dict)
    presets: Mapping[str, Any] = field(default_factory=dict)
    inputs: tuple[SignalInput, ...] = ()
    places: tuple[str, ...] = ()
    arm: str = ""
    unset: tuple[str, ...] = ()

    @property
    def source(self) -> SourceFile:
        """The text under the name that it has in tracebacks."""
        tree = TreeFacts(self.arm, self.unset) if self.places else None
        return SourceFile(code_name(self.name), self.text, self.places, tree=tree)


def job_data(job: Job) -> dict[str, Any]:
    """Return a job as JSON has it."""
    return {name: getattr(job, name) for name in fields_of(Job)} | {"inputs": [list(item) for item in job.inputs]}


def job_of(data: Mapping[str, Any]) -> Job:
    """Return the job of such data."""
    inputs = tuple(SignalInput(*item) for item in data["inputs"])
    return Job(**{**data, "inputs": inputs, "places": tuple(data["places"]), "unset": tuple(data["unset"])})


def files_of(job: Job) -> list[Path]:
    """Return the files that a robot of a job is made of, without those of its task folder.

    Raises:
        UsageError: an invalid world file.
    """
    model = str(job.robot.get("model", ""))
    return [*([Path(model)] if is_model_file(model) else []), *(files_read(job.world) if job.world else [])]


def code_name(name: str) -> str:
    """Return the name of a text in tracebacks, which must not be that of a file of Python."""
    return name if is_program_name(name) or is_task_name(name) else f"{name}.script"


def _reach(job: Job, world: World) -> dict[str, str]:
    """Return the option for what a job reaches that may connect: what the world file says, else every address."""
    in_file = {} if world.settings is None else world.settings.options
    return {"network": "all"} if job.may_connect and "network" not in in_file else {}


class PreparedJob:
    """What a job needs of this computer, read once: robots of it can be made when nothing can be read any more.

    Args:
        job: what is run.

    Raises:
        ElitescriptError: robot, world or an option makes no sense.
    """

    __slots__ = ("_files", "job", "levels", "schedule")

    def __init__(self, job: Job) -> None:
        self.job = job
        self._files = folder_contents(Path(job.folder)) if job.folder else FolderCopy()
        self.levels = {**job.levels, **{item.name: item.value for item in job.inputs if item.at_s == 0.0}}
        """Signals at the start."""
        self.schedule = tuple((item.at_s, item.name, item.value) for item in job.inputs if item.at_s > 0.0)
        """Signals that change later: time, name and level."""

    @property
    def files(self) -> Mapping[str, bytes]:
        """Contents of the task folder."""
        return self._files

    @property
    def left_out(self) -> str:
        """A sentence about files of the folder that the program does not get; empty if it gets all."""
        return self._files.left_out

    def robot(self) -> VirtualRobot:
        """Return a new robot, with its world and its inputs."""
        job = self.job
        world = closed_world(job.world or None, is_trusted=job.is_trusted, may_connect=job.may_connect)
        robot = VirtualRobot(world=world, task_dir=self._files, **{**_reach(job, world), **job.robot})
        robot.set_network_by(WORLD_FILE if job.may_connect else STUDIO)
        robot.reports_signals = False
        robot.set_start(self.levels)
        for at_s, name, value in self.schedule:
            robot.at(at_s, name, value)
        return robot
