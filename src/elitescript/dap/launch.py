"""What a client launches: the arguments of `launch`, checked, as something that can be debugged."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, Final

from elitescript.dap.messages import WRONG_ARGUMENTS, Arguments, RequestError
from elitescript.debugger.api import Output
from elitescript.debugger.session import DebugSession
from elitescript.debugger.source import ProgramSource, Source
from elitescript.environment.start_values import check_presets, parse_settings
from elitescript.errors import did_you_mean
from elitescript.kernel.options import OPTIONS, accept
from elitescript.language.diagnostics import Diagnostic
from elitescript.messages.signals import SIGNALS, Value

RENAMED: Final = {"robot": "model"}
"""Arguments of `launch` that are called as on the command line."""
OWN: Final = ("program", "world", "set", "until", "taskDir", "stopOnEntry", "stopOnEnd", "noDebug", *RENAMED)


class Launch:
    """What is debugged, and how it begins.

    Args:
        arguments: of `launch`.

    Raises:
        RequestError: an argument that makes no sense.
        UsageError: likewise.

    Attributes:
        arguments: as they were given.
        program: path of the program, or name of its text.
        stop_on_entry: stop before the first statement.
        stops_on_end: stay when the program has ended, so that one can go back.
        no_debug: run it without stops.
        advice: arguments that are probably misspelt, in words.
        problems: what was found in the program when it was last read.
    """

    __slots__ = ("_source", "advice", "arguments", "no_debug", "problems", "program", "stop_on_entry", "stops_on_end")

    def __init__(self, arguments: Arguments) -> None:
        self.arguments = arguments
        self.program = arguments.text("program")
        if not self.program:
            arguments.refuse("program", "the path of a program", "")
        self.stop_on_entry = arguments.flag("stopOnEntry")
        self.no_debug = arguments.flag("noDebug")
        self.stops_on_end = arguments.flag("stopOnEnd") and not self.no_debug
        self.advice = _advice(arguments)
        self.problems: tuple[Diagnostic, ...] = ()
        self._source = _source(arguments, self.program)

    @property
    def text(self) -> str:
        """The program as it was read."""
        return self._source.text

    def session(self, on_output: Callable[[Output], None]) -> DebugSession:
        """Return a debugged run that has not begun.

        Raises:
            ProgramError: the program does not compile.
            ElitescriptError: the robot, the world or an option is wrong.
        """
        session = DebugSession(self._source, on_output, forks=os.name == "posix")
        self.problems = session.problems
        return session


def _source(arguments: Arguments, program: str) -> Source:
    options = _robot_options(arguments)
    levels, presets = _start_values(arguments)
    until_s = arguments.real("until") if arguments.has("until") else None
    if until_s is not None and until_s < 0.0:
        arguments.refuse("until", "0 s or more", until_s)
    source = ProgramSource(
        program,
        world=arguments.text("world") if arguments.has("world") else None,
        levels=levels,
        presets=presets,
        until_s=until_s,
        task_dir=arguments.text("taskDir") if arguments.has("taskDir") else None,
        **options,
    )
    check_presets(presets, source.text)
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
        levels: dict[str, Value] = {}
        presets: dict[str, Any] = {}
        for name, value in given.items():
            (levels if name.partition("[")[0] in SIGNALS or "[" in name else presets)[name] = value
        return levels, presets
    if given is not None and not isinstance(given, list):
        raise RequestError(WRONG_ARGUMENTS, "launch: set must be an object, or a list of texts such as 'count=3'")
    return parse_settings(arguments.texts("set"), "launch: set")


def _advice(arguments: Arguments) -> list[str]:
    """Say which arguments look misspelt. Editors add some of their own, so unknown ones are no error."""
    known = {*OWN, *_options()}
    unknown = sorted(name for name in arguments.data if name not in known and not name.startswith("__"))
    near = [(name, did_you_mean(name, known)) for name in unknown]
    return [f"launch: {name!r} is no argument{meant}" for name, meant in near if meant]
