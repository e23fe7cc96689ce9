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
from elitescript.kernel.compiling import PROGRESS_TICKS, tree_text
from elitescript.kernel.external_control import Fetch, sender_of
from elitescript.kernel.programs import PRESETS_MAX, Programs
from elitescript.language.compiler import CompiledUnit
from elitescript.language.limits import MAX_UNIT_BYTES
from elitescript.language.text.source import SourceFile
from elitescript.messages.enums import TaskState
from elitescript.messages.events import TaskLoaded, Warned
from elitescript.messages.inputs import ChannelEvent, GetVariable, LoadConfiguration, LoadTask, PlayTask, SetVariable
from elitescript.messages.machine import ResumeTask
from elitescript.messages.outcomes import Done, Outcome, Refused, ShownValue
from elitescript.messages.snapshot import TaskPicture
from elitescript.paths import PROGRAM_SUFFIX, is_program_name, is_task_name
from elitescript.runtime.environment import ProgramEnvironment, relative_name, without_addresses
from elitescript.runtime.host import ScriptHost
from elitescript.said import said

VALUE_MAX: Final = 4096
"""Characters of a value that are shown."""

ANSWER_TICKS: Final = PROGRESS_TICKS
"""A start that takes longer, because its program is being compiled, is answered as one that is under way; what comes of
it is in the log (*assumed*)."""

_HEAD_BYTES: Final = 4096
"""Of a task file, in which the outermost element of a graphical program stands."""
_NAMES_SHOWN: Final = 5
"""Programs of the task folder that a message names."""


class _Making:
    """A start that waits for its program to be compiled.

    Args:
        origin: of the request.
        tick: of the request.
        replies: gets the answer.
    """

    __slots__ = ("_is_answered", "_origin", "_replies", "tick")

    def __init__(self, origin: str, tick: int, replies: list[tuple[str, Outcome]]) -> None:
        self._origin = origin
        self._replies = replies
        self.tick = tick
        self._is_answered = False

    def answer(self, outcome: Outcome) -> bool:
        """Answer the request; return False if it has been answered."""
        if self._is_answered:
            return False
        self._is_answered = True
        self._replies.append((self._origin, outcome))
        return True


class Tasks:
    """Loads and starts tasks, and sets variables.

    Args:
        controller: the machine.
        host: runs programs.
        programs: starts them.
        environment: the task folder, and the network to clients that have the program of a task.
        configuration: path of the configuration that is loaded at the start.
        reads_trees: whether a task is run from the tree in its file.
    """

    __slots__ = (
        "_channels",
        "_configuration",
        "_controller",
        "_fetch",
        "_files",
        "_host",
        "_initial",
        "_late",
        "_loaded",
        "_making",
        "_programs",
        "_reads_trees",
        "_shown",
    )

    def __init__(
        self,
        controller: Controller,
        host: ScriptHost,
        programs: Programs,
        environment: ProgramEnvironment,
        configuration: str,
        *,
        reads_trees: bool = True,
    ) -> None:
        self._controller = controller
        self._reads_trees = reads_trees
        self._host = host
        self._programs = programs
        self._files = environment.files
        self._channels = environment.channels
        self._fetch: Fetch | None = None
        self._making: _Making | None = None
        self._late: list[tuple[str, Outcome]] = []
        """Replies that are due."""
        self._loaded = ""
        self._initial = self._configuration = configuration
        self._shown: TaskPicture | None = None

    @property
    def is_waiting(self) -> bool:
        """Whether a program is on its way from a client, or is being compiled, or there is a late reply."""
        return self._fetch is not None or self._making is not None or bool(self._late)

    @property
    def shown(self) -> TaskPicture:
        """The task as the dashboard shows it."""
        task = self._controller.task
        running = task.name if task.is_running else ""
        if self._shown is None or self._shown.running != running:
            self._shown = TaskPicture(
                self._loaded, running, self._configuration, is_saved=True, is_configuration_modified=False
            )
        return self._shown

    def forget(self) -> None:
        """Forget the loaded task and all variables."""
        self._loaded, self._configuration, self._shown = "", self._initial, None
        self._programs.forget("the controller was started anew")
        self._abandon("the controller was started anew")

    def answer(self, item: LoadTask | LoadConfiguration | PlayTask | SetVariable | GetVariable) -> Outcome | None:
        """Do what is asked and return the outcome; None if `due` returns it later."""
        return self._guarded(lambda: self._answer(item), item.origin)

    def stop(self) -> None:
        """Stop: a program that is on its way does not start."""
        self._abandon("the task was stopped")

    def _abandon(self, why: str) -> None:
        """Give up a program that is on its way; its client gets the refusal in this tick."""
        if self._fetch is not None:
            self._fetch.abandon(why)

    def channel_event(self, event: ChannelEvent) -> bool:
        """Take an event of a channel; return whether it was for a task."""
        if self._fetch is None or self._fetch.channel != event.channel:
            return False
        self._fetch.event(event, self._controller.tick)
        return True

    def due(self) -> list[tuple[str, Outcome]]:
        """Start the program that has come from a client; return the replies that are due, each with its origin."""
        if (fetch := self._fetch) is not None:
            outcome = self._guarded(lambda: self._start_fetched(fetch), fetch.origin)
            if outcome is not None or self._making is not None:
                fetch.close()
                self._fetch = None
            if outcome is not None:
                self._late.append((fetch.origin, outcome))
        if (making := self._making) is not None and self._controller.tick - making.tick >= ANSWER_TICKS:
            making.answer(Done())
        late = list(self._late)
        self._late.clear()
        return late

    def _answer(self, item: LoadTask | LoadConfiguration | PlayTask | SetVariable | GetVariable) -> Outcome | None:
        if isinstance(item, LoadTask):
            return self._load_task(item.path)
        if isinstance(item, LoadConfiguration):
            return self._load_configuration(item.path)
        if isinstance(item, PlayTask):
            return self._play(item.origin)
        if isinstance(item, SetVariable):
            return self._set_variable(item.name, item.value)
        return self._get_variable(item.name)

    def _guarded(self, work: Callable[[], Outcome | None], origin: str) -> Outcome | None:
        try:
            return work()
        except ProgramError as error:
            self._programs.report(error, None, origin)
            return Refused(said("the program does not compile: {problems}", problems=error.problems[0]))
        except ScriptError as error:
            return Refused(f"{error}; {error.hint}" if error.hint else str(error))
        except OSError as error:
            return Refused(error.strerror or str(error))

    def _load_task(self, path: str) -> Outcome:
        if self._controller.task.is_running:
            return Refused("a task is running; stop it first")
        if self._making is not None:
            return Refused("the program of the task is being compiled; stop it first")
        if sender_of(self._files, relative_name(path)) is None:
            self._program_of(path)
        self._abandon("another task was loaded")
        self._loaded, self._shown = path, None
        self._controller.emit(TaskLoaded(self._controller.tick, path))
        return Done()

    def _program_of(self, path: str) -> str:
        """Return the name of the file that holds the program of a task.

        Raises:
            FileNotFoundError: there is none.
        """
        name = relative_name(path)
        if self._is_tree(name):
            return name
        stem = name.removesuffix(".task")
        candidates = (name,) if is_program_name(name) else (f"{stem}.script", f"{stem}.task.script")
        for candidate in candidates:
            if found := self._found(candidate):
                return found
        what = "has no program" if self._files.kind(name) == "file" else "does not exist"
        missing = (
            said("neither {candidates} is", candidates=" nor ".join(candidates))
            if len(candidates) > 1
            else said("{candidates} is not", candidates=candidates[0])
        )
        raise FileNotFoundError(
            2,
            said(
                "the task {what}: {missing} in the task folder{tasks_there}",
                what=what,
                missing=missing,
                tasks_there=self._tasks_there(),
            ),
            path,
        )

    def _is_tree(self, name: str) -> bool:
        """Return whether a file is a graphical program: XML, where older tasks here hold a line, or nothing."""
        if not self._reads_trees or not is_task_name(name) or self._files.kind(name) != "file":
            return False
        with self._files.open(name, "rb", None, None) as file:
            return b"<EliTask" in bytes(file.read(_HEAD_BYTES))

    def _text_of_tree(self, name: str) -> str:
        """Return a graphical program of the task folder and its configuration, as they are compiled."""
        # Imported late: few tasks are trees.
        from elitescript.environment.task_files import files_beside

        files = {name: self._content(name)}
        for path in files_beside(name, files[name]):
            if self._files.kind(path) == "file" and self._files.size(path) <= MAX_UNIT_BYTES:
                files[path] = self._content(path)
        return tree_text(files)

    def _content(self, name: str) -> bytes:
        with self._files.open(name, "rb", None, None) as file:
            return bytes(file.read(MAX_UNIT_BYTES))

    def _found(self, candidate: str) -> str:
        """Return the name of a program, whose suffix may be in other letters there; empty if there is none."""
        if self._files.kind(candidate) == "file":
            return candidate
        folder, slash, name = candidate.rpartition("/")
        stem = name[: -len(PROGRAM_SUFFIX)]
        for other in self._files.names(folder) if not slash or self._files.kind(folder) == "folder" else ():
            if other.startswith(stem) and other[len(stem) :].lower() == PROGRAM_SUFFIX:
                return f"{folder}{slash}{other}"
        return ""

    def _tasks_there(self) -> str:
        """Return what a message adds about the programs that the task folder holds; empty if there are none."""
        names = [name for name in self._files.names("") if is_program_name(name) or self._is_tree(name)]
        shown = ", ".join(names[:_NAMES_SHOWN])
        more = said(" and {count} more", count=len(names) - _NAMES_SHOWN) if len(names) > _NAMES_SHOWN else ""
        return said("; it holds {shown}{more}", shown=shown, more=more) if names else ""

    def _load_configuration(self, path: str) -> Outcome:
        if self._files.kind(relative_name(path)) != "file":
            return Refused("there is no such file in the task folder")
        self._configuration, self._shown = path, None
        return Done()

    def _play(self, origin: str) -> Outcome | None:
        controller = self._controller
        if controller.task_state is TaskState.PAUSED:
            controller.request(ResumeTask())
            return Done()
        if controller.task_state is TaskState.PLAYING:
            return Refused("a task is running; stop it first")
        if not self._loaded:
            return Refused("no task is loaded")
        if self._fetch is not None:
            return Refused("the program of the task is on its way")
        if self._making is not None:
            return Refused("the program of the task is being compiled")
        controller.safety.require("start_task")
        controller.power.require_ready()
        if (sender := sender_of(self._files, relative_name(self._loaded))) is not None:
            self._fetch = Fetch(self._channels, sender, origin, controller.tick)
            return None
        name = self._program_of(self._loaded)
        if self._files.size(name) > MAX_UNIT_BYTES:
            return Refused(
                said("{name} is longer than {max_unit_bytes} bytes", name=name, max_unit_bytes=MAX_UNIT_BYTES)
            )
        if self._is_tree(name):
            return self._start(name, self._text_of_tree(name), origin, is_tree=True)
        return self._start(name, SourceFile.from_bytes(name, self._content(name)).text, origin)

    def _start(self, name: str, text: str, origin: str, *, is_tree: bool = False) -> Outcome | None:
        """Start a program; return the outcome, None if it must be compiled first.

        Raises:
            ProgramError: it does not compile.
        """
        making = _Making(origin, self._controller.tick, self._late)
        made: list[CompiledUnit | ProgramError] = []

        def take(compiled: CompiledUnit | ProgramError) -> None:
            made.append(compiled)
            if self._making is making:
                self._making = None
                outcome = self._guarded(lambda: self._begin_made(compiled), origin) or Done()
                if not making.answer(outcome) and isinstance(outcome, Refused) and isinstance(compiled, CompiledUnit):
                    text = said("{name} does not begin: {reason}", name=name, reason=outcome.reason)
                    self._controller.emit(Warned(self._controller.tick, text))

        def abandon(why: str) -> None:
            if self._making is making:
                self._making = None
                making.answer(Refused(said("{why} before its program was compiled", why=why)))

        if self._programs.compile(name, text, None, f"{origin}: {name}", take, abandon, is_tree=is_tree):
            return self._begin(made[0])
        self._making = making
        return None

    def _begin(self, compiled: CompiledUnit | ProgramError) -> Outcome:
        if isinstance(compiled, ProgramError):
            raise compiled
        stem = relative_name(self._loaded).removesuffix(".task")
        stem = stem[: -len(PROGRAM_SUFFIX)] if is_program_name(stem) else stem
        self._programs.start(compiled, compiled.name or stem, said("the task {loaded}", loaded=self._loaded))
        return Done()

    def _begin_made(self, compiled: CompiledUnit | ProgramError) -> Outcome:
        """Start a program that was compiled meanwhile, if nothing keeps the task from starting now."""
        if self._controller.task.is_running:
            return Refused("another program has been started meanwhile")
        self._controller.safety.require("start_task")
        self._controller.power.require_ready()
        return self._begin(compiled)

    def _start_fetched(self, fetch: Fetch) -> Outcome | None:
        """Start a program that has come.

        What keeps a task from starting ends the waiting too: nothing starts by itself after an emergency stop.
        """
        controller = self._controller
        data = fetch.result(controller.tick)
        if controller.task.is_running:
            return Refused("another program has been started meanwhile")
        controller.safety.require("start_task")
        controller.power.require_ready()
        if data is None:
            return None
        name = str(fetch.sender)
        return self._start(name, SourceFile.from_bytes(name, data).text, fetch.origin)

    def _set_variable(self, name: str, value: str) -> Outcome:
        if self._controller.task.is_running:
            return Refused("a task is running; use a secondary program")
        if not name.isidentifier() or iskeyword(name) or name.startswith("__"):
            return Refused("it cannot be the name of a variable")
        try:
            literal = literal_eval(value)
        except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
            return Refused("its value must be a literal, such as 1.5, True, 'text' or [1, 2]")
        presets = self._programs.presets
        if name not in presets and len(presets) >= PRESETS_MAX:
            return Refused(said("{presets_max} variables wait already", presets_max=PRESETS_MAX))
        presets[name] = literal
        return Done()

    def _get_variable(self, name: str) -> Outcome:
        values = {**self._host.monitor(), **({} if self._controller.task.is_running else self._programs.presets)}
        if name not in values:
            return Refused("there is no such variable")
        try:
            text = without_addresses(repr(values[name]))
        except BaseException as error:
            # A class of the program may do anything here, and no thread runs that could be stopped for it.
            if isinstance(error, KeyboardInterrupt):
                raise
            return Refused("its value cannot be shown")
        return ShownValue(text if len(text) <= VALUE_MAX else f"{text[:VALUE_MAX]}...")
