"""What a client launches: the arguments of `launch`, checked, and the run that they describe."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from elitescript.dap.messages import WRONG_ARGUMENTS, Arguments, RequestError
from elitescript.dap.sources import Sources, path_of
from elitescript.debugger.api import BreakpointState, LineBreakpoint, Output, Place
from elitescript.debugger.session import DebugSession
from elitescript.debugger.source import ProgramSource
from elitescript.environment.network_option import LAUNCH
from elitescript.environment.start_values import check_presets, parse_settings, sorted_settings
from elitescript.errors import ProgramError, did_you_mean
from elitescript.kernel.options import OPTIONS, UNTIL, accept, accepted
from elitescript.messages.signals import Value
from elitescript.messages.timing import ticks_for
from elitescript.paths import is_task_name
from elitescript.world_file import arm_of_program

if TYPE_CHECKING:
    from elitescript.dap.journal_source import JournalSource
    from elitescript.dap.tasks import DebuggedTask

RENAMED: Final = {"robot": "model"}
"""Arguments of `launch` that are called as on the command line."""
JOURNAL_SUFFIX: Final = ".journal"
OWN: Final = ("program", "world", "set", "until", "taskDir", "stopOnEntry", "stopOnEnd", "noDebug", *RENAMED)


class Launched:
    """What is debugged, and how it begins.

    Implements `Debuggee`.

    Args:
        arguments: of `launch`.
        sources: takes note of its texts.
        on_output: receives what the run says.
        forks: whether this process may be copied, which makes going back in long programs fast.

    Raises:
        RequestError: an argument that makes no sense.
        ProgramError: the program does not compile.
        ElitescriptError: the robot, the world or an option is wrong.

    Attributes:
        arguments: as they were given.
        advice: arguments that are probably misspelt, in words.
        name: path of the program.
        no_debug: run it without stops.
        problems: what was found in the program.
        session: the run.
        start_method: `launch`.
        stop_on_entry: stop before the first statement.
        stops_on_end: stay when the program has ended, so that one can go back.
    """

    __slots__ = (
        "_source",
        "_sources",
        "_task",
        "_texts",
        "advice",
        "arguments",
        "name",
        "no_debug",
        "problems",
        "session",
        "start_method",
        "stop_on_entry",
        "stops_on_end",
    )

    def __init__(
        self, arguments: Arguments, sources: Sources, on_output: Callable[[Output], None], *, forks: bool
    ) -> None:
        program = path_of(arguments.text("program"))
        if not program:
            arguments.refuse("program", "the path of a program", "")
        self.arguments = arguments
        self.start_method = "launch"
        self.stop_on_entry = arguments.flag("stopOnEntry")
        self.no_debug = arguments.flag("noDebug")
        self.stops_on_end = arguments.flag("stopOnEnd") and not self.no_debug
        self.advice = _advice(arguments)
        self._task = _task(arguments, program)
        self._source = _source(arguments, program, self._task)
        self._sources = sources
        self.name = self._source.name
        self.problems = self._source.problems
        if isinstance(self._source, ProgramSource):
            self._texts = {self.name: self._source.text}
            if self._task is None:
                sources.found(self.name, self.name)
            else:
                sources.generated(self.name, self.name)
        else:
            self._texts = self._source.texts
            for name, first in self._source.first_names.items():
                sources.same(name, first)
        self.session = DebugSession(self._source, on_output, forks=forks, keeps_end=self.stops_on_end)

    def texts(self) -> list[str]:
        """Return the names of its texts."""
        return list(self._texts)

    def text_of(self, name: str) -> str:
        """Return a text by its name."""
        return self._texts[name]

    def set_lines(self, source: Arguments, requests: Sequence[LineBreakpoint]) -> tuple[BreakpointState, ...] | None:
        """Replace the breakpoints of a text of the run; None for any other one."""
        if self._task is not None and self._task.is_file(source):
            return self._task.set_lines(
                requests, lambda moved: self.session.set_breakpoints(moved, text=self.name, group="file")
            )
        name = self._sources.named(source)
        return self.session.set_breakpoints(requests, text=name) if name in self._texts else None

    def node(self, name: str, line: int) -> str:
        """See `Debuggee.node`."""
        return self._task.node(line) if self._task is not None and name == self.name else ""

    def located(self, source: Arguments, line: int) -> tuple[str, int] | None:
        """See `Debuggee.located`."""
        if self._task is not None and self._task.is_file(source):
            return self.name, self._task.places.script_line(line)
        name = self._sources.named(source)
        return None if name is None else (name, line)

    def places(self, source: Arguments, line: int, end_line: int) -> tuple[Place, ...]:
        """Return the statements that begin in lines of a text of the run, the last line included."""
        if self._task is not None and self._task.is_file(source):
            return self._task.locations(line, end_line)
        name = self._sources.named(source)
        return self.session.breakpoint_locations(line, end_line, text=name) if name in self._texts else ()


def _task(arguments: Arguments, program: str) -> DebuggedTask | None:
    """Return a graphical program that can run; None for other programs.

    Raises:
        ProgramError: it cannot run.
    """
    if not is_task_name(program):
        return None
    # Few sessions debug a graphical program, and what reads one takes time to import.
    from elitescript.dap.tasks import DebuggedTask

    task = DebuggedTask(program, arguments.text("taskDir") if arguments.has("taskDir") else None)
    if task.errors:
        raise ProgramError(task.errors, program)
    return task


def _source(arguments: Arguments, program: str, task: DebuggedTask | None) -> ProgramSource | JournalSource:
    until_s = accepted(UNTIL, arguments.data["until"], "launch: until") if arguments.has("until") else None
    if program.endswith(JOURNAL_SUFFIX):
        # Few sessions debug a journal, and what reads one takes time to import.
        from elitescript.dap.journal_source import JournalSource

        if given := [name for name in (*_options(), *RENAMED, "set", "world", "taskDir") if arguments.has(name)]:
            raise RequestError(WRONG_ARGUMENTS, f"launch: {given[0]} is in the journal")
        return JournalSource(Path(program), None if until_s is None else ticks_for(until_s))
    options = _robot_options(arguments)
    levels, presets = _start_values(arguments)
    world = arguments.text("world") if arguments.has("world") else None
    if task is not None and "model" not in options and (arm := arm_of_program(program, world)):
        options["model"] = arm
    source = ProgramSource(
        program,
        source=None if task is None else task.task.source,
        world=world,
        levels=levels,
        presets=presets,
        until_s=until_s,
        task_dir=arguments.text("taskDir") if arguments.has("taskDir") else None,
        network_by=LAUNCH,
        **options,
    )
    check_presets(presets, source.text, "launch: set")
    return source


def _robot_options(arguments: Arguments) -> dict[str, Any]:
    """Return the options of the robot that are given: all of the command line's, by their names."""
    found = {}
    for name in _options():
        called = next((word for word, option in RENAMED.items() if option == name), name)
        if arguments.has(called):
            found[name] = accept(name, arguments.data[called], f"launch: {called}")
    return found


def _options() -> list[str]:
    return [name for name, option in OPTIONS.items() if "run" in option.commands]


def _start_values(arguments: Arguments) -> tuple[dict[str, Value], dict[str, Any]]:
    """Return signals and program globals at the start: an object, or texts `NAME=VALUE` as on the command line."""
    given = arguments.data.get("set")
    if isinstance(given, dict):
        return sorted_settings(given, "launch: set")
    if given is not None and not isinstance(given, list):
        raise RequestError(WRONG_ARGUMENTS, "launch: set must be an object, or a list of texts such as 'count=3'")
    return parse_settings(arguments.texts("set"), "launch: set")


def _advice(arguments: Arguments) -> list[str]:
    """Say which arguments look misspelt. Editors add some of their own, so unknown ones are no error."""
    known = {*OWN, *_options()}
    unknown = sorted(name for name in arguments.data if name not in known and not name.startswith("__"))
    near = [(name, did_you_mean(name, known)) for name in unknown]
    return [f"launch: {name!r} is no argument{meant}" for name, meant in near if meant]
