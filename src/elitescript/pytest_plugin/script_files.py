"""Tests in the language itself: each function `test_...` of a file is one, in a fresh robot."""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Iterator
from typing import Any, Final

import pytest

from elitescript.environment.network_option import COMMENT
from elitescript.environment.program_file import source_of
from elitescript.errors import ElitescriptError, ProgramError, UsageError
from elitescript.kernel.options import OPTIONS, Network, Number, Switch, VersionText, Whole, accept
from elitescript.language.compiler import CompiledUnit, compile_parsed
from elitescript.language.options import DEFAULT, PROGRAM, SCRIPT, SECONDARY, Options
from elitescript.language.parser import Parsed, parse
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Alarm, Event
from elitescript.pytest_plugin.limits import LIMIT, ini_name, limit, limits_of
from elitescript.pytest_plugin.limits import SETTINGS as LIMITS
from elitescript.pytest_plugin.marker import ROBOT, WORLD, check_setting, robot_arguments
from elitescript.pytest_plugin.script_program import PREFIX, RETURNED, make_test, tests_of, why_not_called
from elitescript.records import replace
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.shown import continued, shown, shown_word

UNTIL: Final = "until"
"""Setting of a test script alone: limit of robot time, s."""

HEADER: Final = "elitescript:"
_HEADER: Final = re.compile(rf"\s*#\s*{HEADER}(.*)")


class ScriptFile(pytest.File):
    """A file with tests in the language."""

    def collect(self) -> Iterator[ScriptTest]:
        try:
            source = source_of(self.path)
            self.settings = header_settings(source)
            parsed = read_tests(source, DEFAULT)
            if parsed.kind == SECONDARY:
                return
            if parsed.has_errors:
                raise ProgramError(tuple(problem for problem in parsed.diagnostics if problem.is_error))
            for function in tests_of(parsed):
                if why := why_not_called(function):
                    raise UsageError(f"line {function.lineno}: {why}")
                yield ScriptTest.from_parent(self, name=function.name, line=function.lineno)
        except ProgramError as error:
            raise self.CollectError("\n".join(shown(f"{self.path}:{one}") for one in error.problems)) from error
        except ElitescriptError as error:
            raise self.CollectError(shown(f"{self.path}: {error}")) from error


class ScriptTest(pytest.Item):
    """One function `test_...`."""

    def __init__(self, *, line: int, **more: Any) -> None:
        super().__init__(**more)
        self.funcargs: dict[str, Any] = {}
        """Of no fixture; plugins look for it."""
        self.shows_programs = True
        """Whether reports are texts of programs; the plugin looks for it."""
        self._line = line

    def runtest(self) -> None:
        """Run the statements of the file in a fresh robot, then the function."""
        assert isinstance(self.parent, ScriptFile)
        settings = dict(self.parent.settings)
        until_s = settings.pop(UNTIL, None)
        if until_s is None:
            until_s = limits_of(self.config, settings).robot_s
        stack: list[tuple[int, str]] = []
        source = source_of(self.path)

        def note(event: Event) -> None:
            if isinstance(event, Alarm) and not stack:
                # The outermost line is the call that `make_test` has added.
                stack.extend([*_stack(sys.exception(), source.name)][1:])

        robot = VirtualRobot(on_event=note, **robot_arguments(settings, self.path.parent))
        robot.set_network_by(COMMENT)
        robot.reports_signals = False
        run = robot.run(self._unit(source, robot), until_s=until_s)
        if run.state != "finished" or RETURNED not in run.globals:
            raise ScriptFailure(self.name, run, tuple(stack))

    def _unit(self, source: SourceFile, robot: VirtualRobot) -> CompiledUnit:
        kind = read_tests(source, DEFAULT).options.kind
        parsed = parse(source, robot.text_options(source, kind))
        make_test(parsed, self.name)
        return compile_parsed(parsed)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return what the report shows: the script's own lines."""
        error = excinfo.value
        if isinstance(error, ScriptFailure):
            return error.report()
        if isinstance(error, ElitescriptError):
            return continued(f"{self.path}: {error}")
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Any, int, str]:
        return shown_word(str(self.path)), self._line - 1, self.name


class ScriptFailure(Exception):
    """A test in the language has failed.

    Args:
        test: its name.
        run: of the test.
        stack: line and function of each call that led to the alarm, the outermost first.
    """

    def __init__(self, test: str, run: Run, stack: tuple[tuple[int, str], ...]) -> None:
        super().__init__(test)
        self.test = test
        self.run = run
        self.stack = stack

    def report(self) -> str:
        """Return the lines of the script that led to the failure, marked as pytest marks those of Python."""
        run, source = self.run, self.run.unit.source
        out, file = [], shown_word(source.name)
        for line, name in self.stack[:-1]:
            out += [f"{file}:{line}: in {name}", f"    {source.line(line).strip()}"]
        if not run.alarms:
            return "\n".join([*out, *(f"E   {text}" for text in self._ending())])
        alarm = run.alarms[-1]
        name = self.stack[-1][1] if self.stack else alarm.thread
        out += [f"{file}:{alarm.line}: in {shown_word(name)}", f">   {source.line(alarm.line).strip()}"]
        texts = alarm.text.split("\n")
        if alarm.class_name != "AssertionError":
            texts[0] = f"{alarm.code} {alarm.class_name}: {texts[0]}"
        texts += [f"hint: {alarm.details['hint']}"] if alarm.details.get("hint") else []
        return "\n".join([*out, *(f"E   {text}" for text in texts)])

    def _ending(self) -> list[str]:
        run = self.run
        if run.state == "time_limit":
            where = [f"{shown_word(row.name)}: line {row.line}, {continued(row.doing)}" for row in run.threads]
            others = f"another limit: `# {HEADER} {UNTIL}=SECONDS`, or {ini_name(LIMIT)} in the ini file"
            return [f"still running after {run.time_s:g} s of robot time; {others}", *where]
        if run.state == "finished":
            return [f"the file has returned before {self.test} was called"]
        return [f"the program has ended before {self.test} returned: {run.state}"]


def read_tests(source: SourceFile, options: Options) -> Parsed:
    """Return a file of tests; one that holds a single test is no program of that name."""
    parsed = parse(source, options)
    if parsed.kind == PROGRAM and parsed.name.startswith(PREFIX):
        return parse(source, replace(options, kind=SCRIPT))
    return parsed


def _stack(error: BaseException | None, file: str) -> Iterator[tuple[int, str]]:
    """Return the lines of a text through which an exception went, and their functions, the outermost first."""
    trace = None if error is None else error.__traceback__
    while trace is not None:
        code = trace.tb_frame.f_code
        if code.co_filename == file:
            yield trace.tb_lineno or 0, code.co_name
        trace = trace.tb_next


def header_settings(source: SourceFile) -> dict[str, Any]:
    """Return the settings in the comments before the first statement: `# elitescript: robot=CS612 world=cell.toml`.

    Raises:
        UsageError: not of this form, or no such setting; the text names the line.
    """
    settings: dict[str, Any] = {}
    for number, text in enumerate(source.lines, 1):
        if text.strip() and not text.lstrip().startswith("#"):
            break
        if (found := _HEADER.match(text)) is None:
            continue
        try:
            for word in shlex.split(found[1]):
                name, equals, value = word.partition("=")
                if not equals:
                    raise UsageError(f"write NAME=VALUE, not {word!r}")
                check_setting(name, "a test script", (UNTIL,))
                settings[name] = _value(name, value)
        except (UsageError, ValueError) as error:
            raise UsageError(f"line {number}: {error}") from error
    return settings


def _value(name: str, text: str) -> Any:
    if name in (ROBOT, WORLD):
        return text
    kind = Number(0.0, unit="s") if name == UNTIL or name in LIMITS else OPTIONS[name].kind
    try:
        if name in LIMITS:
            limit(number := float(text), name)
            return number
        if isinstance(kind, Number):
            return kind.accept(float(text))
        if isinstance(kind, Whole):
            return int(text)
    except ValueError:
        raise UsageError(f"{name} must be {kind}, got {text!r}") from None
    if isinstance(kind, Switch):
        if text not in ("true", "false"):
            raise UsageError(f"{name} must be {kind}, got {text!r}")
        return text == "true"
    if name == "joints":
        return [float(part) for part in text.strip("[]").split(",")]
    if isinstance(kind, Network | VersionText):
        return accept(name, text, name)
    if not hasattr(kind, "choices"):
        raise UsageError(f"{name} cannot be given here; write it into the file of world=")
    return text
