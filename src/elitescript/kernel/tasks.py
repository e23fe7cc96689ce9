"""The task that is loaded, its configuration, and program variables that are set from outside.

A task `NAME.task` is played by running the program beside it: `NAME.script`, as the pendant writes it, or else
`NAME.task.script` (*assumed*); a program `NAME.script` may be loaded by its own name too. The program of a task may
also come from a client, see `external_control`. Configurations are files of the task folder too, and nothing of them is
read (*assumed*).
"""

from __future__ import annotations

from ast import literal_eval
from collections.abc import Callable
from keyword import iskeyword
from typing import Final

from elitescript.controller.controller import Controller
from elitescript.errors import ProgramError, ScriptError
from elitescript.kernel.external_control import Fetch, sender_of
from elitescript.kernel.programs import PRESETS_MAX, Programs
from elitescript.language.text.source import SourceFile
from elitescript.language.text.units import MAX_UNIT_BYTES
from elitescript.messages.enums import TaskState
from elitescript.messages.events import TaskLoaded
from elitescript.messages.inputs import ChannelEvent, GetVariable, LoadConfiguration, LoadTask, PlayTask, SetVariable
from elitescript.messages.machine import ResumeTask
from elitescript.messages.snapshot import TaskPicture
from elitescript.protocol.outcomes import done, refused
from elitescript.runtime.alarms import without_addresses
from elitescript.runtime.environment import ProgramEnvironment, relative_name
from elitescript.runtime.host import ScriptHost

VALUE_MAX: Final = 4096
"""Characters of a value that are told."""

_NAMES_SHOWN: Final = 5
"""Programs of the task folder that a message names."""


class Tasks:
    """What is loaded.

    Args:
        controller: the machine.
        host: runs programs.
        programs: starts them.
        environment: the task folder, and the network to clients that have the program of a task.
        configuration: path of the configuration that is loaded at the start.
    """

    __slots__ = (
        "_channels",
        "_configuration",
        "_controller",
        "_fetch",
        "_files",
        "_host",
        "_initial",
        "_loaded",
        "_picture",
        "_programs",
    )

    def __init__(
        self,
        controller: Controller,
        host: ScriptHost,
        programs: Programs,
        environment: ProgramEnvironment,
        configuration: str,
    ) -> None:
        self._controller = controller
        self._host = host
        self._programs = programs
        self._files = environment.files
        self._channels = environment.channels
        self._fetch: Fetch | None = None
        self._loaded = ""
        self._initial = self._configuration = configuration
        self._picture: TaskPicture | None = None

    @property
    def is_waiting(self) -> bool:
        """Whether a program is on its way from a client."""
        return self._fetch is not None

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
        self._abandon("the controller was started anew")

    def answer(self, item: LoadTask | LoadConfiguration | PlayTask | SetVariable | GetVariable) -> str:
        """Do what is asked; return the text of the reply, empty if `due` has it later."""
        return self._guarded(lambda: self._answer(item), item.origin)

    def stop(self) -> None:
        """The task is to stop: a program that is on its way does not start."""
        self._abandon("the task was stopped")

    def _abandon(self, why: str) -> None:
        """A program that is on its way is not wanted any more; who has asked for it hears so in this tick."""
        if self._fetch is not None:
            self._fetch.abandon(why)

    def channel_event(self, event: ChannelEvent) -> bool:
        """Take an event of a channel; whether it was for a task."""
        if self._fetch is None or self._fetch.channel != event.channel:
            return False
        self._fetch.event(event, self._controller.tick)
        return True

    def due(self) -> tuple[str, str] | None:
        """Start the program that has come from a client; return origin and text of the reply, None if there is none."""
        fetch = self._fetch
        if fetch is None:
            return None
        text = self._guarded(lambda: self._start_fetched(fetch), fetch.origin)
        if not text:
            return None
        fetch.close()
        self._fetch = None
        return fetch.origin, text

    def _answer(self, item: LoadTask | LoadConfiguration | PlayTask | SetVariable | GetVariable) -> str:
        if isinstance(item, LoadTask):
            return self._load_task(item.path)
        if isinstance(item, LoadConfiguration):
            return self._load_configuration(item.path)
        if isinstance(item, PlayTask):
            return self._play(item.origin)
        if isinstance(item, SetVariable):
            return self._set_variable(item.name, item.value)
        return self._get_variable(item.name)

    def _guarded(self, work: Callable[[], str], origin: str) -> str:
        try:
            return work()
        except ProgramError as error:
            self._programs.report(error, None, origin)
            return refused(f"the program does not compile: {error.problems[0]}")
        except ScriptError as error:
            return refused(f"{error}; {error.hint}" if error.hint else str(error))
        except OSError as error:
            return refused(error.strerror or str(error))

    def _load_task(self, path: str) -> str:
        if self._controller.task.is_running:
            return refused("a task is running; stop it first")
        if sender_of(self._files, relative_name(path)) is None:
            self._program_of(path)
        self._abandon("another task was loaded")
        self._loaded, self._picture = path, None
        self._controller.emit(TaskLoaded(self._controller.tick, path))
        return done()

    def _program_of(self, path: str) -> str:
        """Name of the file that holds the program of a task.

        Raises:
            FileNotFoundError: there is none.
        """
        name = relative_name(path)
        stem = name.removesuffix(".task")
        candidates = (name,) if name.endswith(".script") else (f"{stem}.script", f"{stem}.task.script")
        for candidate in candidates:
            if self._files.kind(candidate) == "file":
                return candidate
        what = "has no program" if self._files.kind(name) == "file" else "does not exist"
        missing = f"neither {' nor '.join(candidates)} is" if len(candidates) > 1 else f"{candidates[0]} is not"
        raise FileNotFoundError(2, f"the task {what}: {missing} in the task folder{self._tasks_there()}", path)

    def _tasks_there(self) -> str:
        """Return what a message adds about the programs that the task folder holds; empty if there are none."""
        names = [name for name in self._files.names("") if name.endswith(".script")]
        shown = ", ".join(names[:_NAMES_SHOWN])
        more = f" and {len(names) - _NAMES_SHOWN} more" if len(names) > _NAMES_SHOWN else ""
        return f"; it holds {shown}{more}" if names else ""

    def _load_configuration(self, path: str) -> str:
        if self._files.kind(relative_name(path)) != "file":
            return refused("there is no such file in the task folder")
        self._configuration, self._picture = path, None
        return done()

    def _play(self, origin: str) -> str:
        controller = self._controller
        if controller.task_state is TaskState.PAUSED:
            controller.request(ResumeTask())
            return done()
        if controller.task_state is TaskState.PLAYING:
            return refused("a task is running; stop it first")
        if not self._loaded:
            return refused("no task is loaded")
        if self._fetch is not None:
            return refused("the program of the task is on its way")
        controller.safety.require("start_task")
        controller.power.require_ready()
        if (sender := sender_of(self._files, relative_name(self._loaded))) is not None:
            self._fetch = Fetch(self._channels, sender, origin, controller.tick)
            return ""
        name = self._program_of(self._loaded)
        if self._files.size(name) > MAX_UNIT_BYTES:
            return refused(f"{name} is longer than {MAX_UNIT_BYTES} bytes")
        with self._files.open(name, "rb", None, None) as file:
            return self._start(name, bytes(file.read(MAX_UNIT_BYTES)))

    def _start(self, name: str, data: bytes) -> str:
        unit = self._programs.compiled(name, SourceFile.from_bytes(name, data).text, None)
        self._programs.start(
            unit, unit.name or relative_name(self._loaded).removesuffix(".task").removesuffix(".script")
        )
        return done()

    def _start_fetched(self, fetch: Fetch) -> str:
        """What keeps a task from starting ends the waiting too: nothing starts by itself after an emergency stop."""
        controller = self._controller
        data = fetch.result(controller.tick)
        if controller.task.is_running:
            return refused("another program has been started meanwhile")
        controller.safety.require("start_task")
        controller.power.require_ready()
        return "" if data is None else self._start(str(fetch.sender), data)

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
