"""The task that is loaded, its configuration, and program variables that are set from outside.

A task `NAME.task` is played by running the program beside it: `NAME.script`, as the pendant writes it, or else
`NAME.task.script` (*assumed*). Configurations are files of the task folder too, and nothing of them is read
(*assumed*).
"""

from __future__ import annotations

from ast import literal_eval
from keyword import iskeyword
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.errors import ProgramError, ScriptError
from elitescript.kernel.programs import PRESETS_MAX, Programs
from elitescript.language.source import SourceFile
from elitescript.language.units import MAX_UNIT_BYTES
from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import GetVariable, LoadConfiguration, LoadTask, PlayTask, SetVariable
from elitescript.messages.machine import ResumeTask
from elitescript.messages.snapshot import TaskPicture
from elitescript.protocol.outcomes import done, refused
from elitescript.runtime.alarms import without_addresses
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.world import Files, relative_name

VALUE_MAX: Final = 4096
"""Characters of a value that are told."""


class Tasks:
    """What is loaded.

    Args:
        controller: the machine.
        host: runs programs.
        programs: starts them.
        files: the task folder.
        configuration: path of the configuration that is loaded at the start.
    """

    __slots__ = ("_configuration", "_controller", "_files", "_host", "_initial", "_loaded", "_picture", "_programs")

    def __init__(
        self, controller: Controller, host: ScriptHost, programs: Programs, files: Files, configuration: str
    ) -> None:
        self._controller = controller
        self._host = host
        self._programs = programs
        self._files = files
        self._loaded = ""
        self._initial = self._configuration = configuration
        self._picture: TaskPicture | None = None

    @property
    def picture(self) -> TaskPicture:
        """The task as the dashboard shows it."""
        task = self._controller.task
        running = task.name if task.is_running else ""
        if self._picture is None or self._picture.running != running:
            self._picture = TaskPicture(
                self._loaded, running, self._configuration, is_saved=True, is_configuration_modified=False
            )
        return self._picture

    def forget(self) -> None:
        """Nothing is loaded, and no variable has a value."""
        self._loaded, self._configuration, self._picture = "", self._initial, None
        self._programs.presets.clear()

    def answer(self, item: LoadTask | LoadConfiguration | PlayTask | SetVariable | GetVariable) -> str:
        """Do what is asked; return the text of the reply."""
        try:
            if isinstance(item, LoadTask):
                return self._load_task(item.path)
            if isinstance(item, LoadConfiguration):
                return self._load_configuration(item.path)
            if isinstance(item, PlayTask):
                return self._play()
            if isinstance(item, SetVariable):
                return self._set_variable(item.name, item.value)
            return self._get_variable(item.name)
        except ProgramError as error:
            self._programs.report(error, None, item.origin)
            return refused(f"the program does not compile: {error.problems[0]}")
        except ScriptError as error:
            return refused(f"{error}; {error.hint}" if error.hint else str(error))
        except OSError as error:
            return refused(error.strerror or str(error))

    def _load_task(self, path: str) -> str:
        if self._controller.task.is_running:
            return refused("a task is running; stop it first")
        self._program_of(path)
        self._loaded, self._picture = path, None
        return done()

    def _program_of(self, path: str) -> str:
        """Name of the file that holds the program of a task.

        Raises:
            FileNotFoundError: there is none.
        """
        name = relative_name(path)
        stem = name.removesuffix(".task")
        candidates = (f"{stem}.script", f"{stem}.task.script")
        for candidate in candidates:
            if self._files.kind(candidate) == "file":
                return candidate
        what = "has no program" if self._files.kind(name) == "file" else "does not exist"
        raise FileNotFoundError(2, f"the task {what}: neither {' nor '.join(candidates)} is in the task folder", path)

    def _load_configuration(self, path: str) -> str:
        if self._files.kind(relative_name(path)) != "file":
            return refused("there is no such file in the task folder")
        self._configuration, self._picture = path, None
        return done()

    def _play(self) -> str:
        controller = self._controller
        if controller.task_state is TaskState.PAUSED:
            controller.request(ResumeTask())
            return done()
        if controller.task_state is TaskState.PLAYING:
            return refused("a task is running; stop it first")
        if not self._loaded:
            return refused("no task is loaded")
        controller.safety.require("start_task")
        controller.power.require_ready()
        name = self._program_of(self._loaded)
        if self._files.size(name) > MAX_UNIT_BYTES:
            return refused(f"{name} is longer than {MAX_UNIT_BYTES} bytes")
        with self._files.open(name, "rb", None, None) as file:
            source = SourceFile.from_bytes(name, bytes(file.read(MAX_UNIT_BYTES)))
        unit = self._programs.compiled(name, source.text, None)
        self._programs.start(unit, unit.name or relative_name(self._loaded).removesuffix(".task"))
        return done()

    def _set_variable(self, name: str, value: str) -> str:
        if self._controller.task.is_running:
            return refused("a task is running; use a secondary program")
        if not name.isidentifier() or iskeyword(name) or name.startswith("__"):
            return refused("it cannot be the name of a variable")
        try:
            literal = literal_eval(value)
        except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
            return refused("its value must be a literal, such as 1.5, True, 'text' or [1, 2]")
        presets = self._programs.presets
        if name not in presets and len(presets) >= PRESETS_MAX:
            return refused(f"{PRESETS_MAX} variables wait already")
        presets[name] = literal
        return done()

    def _get_variable(self, name: str) -> str:
        values = {**self._host.monitor(), **({} if self._controller.task.is_running else self._programs.presets)}
        if name not in values:
            return refused("there is no such variable")
        try:
            text = without_addresses(repr(values[name]))
        except BaseException as error:
            # A class of the program may do anything here, and no thread runs that could be stopped for it.
            if isinstance(error, KeyboardInterrupt):
                raise
            return refused("its value cannot be shown")
        return done(text if len(text) <= VALUE_MAX else f"{text[:VALUE_MAX]}...")
