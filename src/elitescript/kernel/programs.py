"""Programs that come from outside: compiled, refused with their place, or started in the place of the running one."""

from __future__ import annotations

import ast
from typing import Any, Final

from elitescript.controller.controller import Controller
from elitescript.errors import ProgramError, ScriptError
from elitescript.kernel.nonsense import Nonsense
from elitescript.language.compiler import CompiledUnit, compile_task
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.options import LINE, SECONDARY, Options
from elitescript.language.source import SourceFile
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.inputs import RunUnit
from elitescript.runtime.bindings import is_known
from elitescript.runtime.host import SECONDARY_WARNING, ScriptHost

PROBLEMS_MAX: Final = 20
"""Further problems of one text that go to the log."""
PRESETS_MAX: Final = 1000
"""Variables that may wait for the next program."""


class Programs:
    """Compiles and starts programs.

    Args:
        controller: the machine.
        host: runs them.
        is_strict: refuse what a Python 3 controller refuses.

    Attributes:
        presets: values that program globals have before a program begins.
    """

    __slots__ = ("_controller", "_host", "_is_strict", "_nonsense", "presets")

    def __init__(self, controller: Controller, host: ScriptHost, *, is_strict: bool) -> None:
        self._controller = controller
        self._host = host
        self._is_strict = is_strict
        self._nonsense = Nonsense(self._warn)
        self.presets: dict[str, object] = {}

    def go_on(self) -> None:
        """A tick begins."""
        self._nonsense.go_on(self._controller.tick)

    def run(self, unit: RunUnit) -> None:
        """Run a unit: a program or a line replaces what runs, a secondary program runs beside it.

        What does not compile, and a line that calls what does not exist, is reported and leaves the running program
        alone.
        """
        try:
            compiled = self.compiled(f"<{unit.origin}>", unit.text, unit.kind)
        except ProgramError as error:
            if unit.kind != LINE or self._nonsense.is_told(unit.origin, self._controller.tick):
                self.report(error, unit.kind, unit.origin)
            return
        if unit.kind == SECONDARY:
            try:
                self._host.start_secondary(compiled)
            except ScriptError as error:
                self._warn(f"{SECONDARY_WARNING}{error}")
            return
        if unit.kind == LINE and (name := self._missing_name(unit.text)):
            if self._nonsense.is_told(unit.origin, self._controller.tick):
                text = f"name {name!r} is not defined"
                self._alarm("R100", "NameError", text, 1, 1, unit.origin, unit.text.split("\n", 1)[0])
            return
        self.start(compiled, compiled.name)

    def compiled(self, name: str, text: str, kind: str | None) -> CompiledUnit:
        """Compile a text; its warnings go to the log.

        Raises:
            ProgramError: it does not compile.
        """
        unit = compile_task(SourceFile(name, text), Options(strict=self._is_strict, kind=kind))
        for problem in unit.diagnostics[:PROBLEMS_MAX]:
            self._warn(_told(problem), problem.line)
        return unit

    def start(self, unit: CompiledUnit, name: str) -> None:
        """Start a program in the place of the running one, in this tick."""
        self._host.end_now(self._controller.tick)
        self._controller.task_started(name)
        self._host.start(unit, dict(self.presets))

    def report(self, error: ProgramError, kind: str | None, origin: str) -> None:
        """Say why a text does not compile: the first error as an alarm, the others of a program in the log.

        Args:
            error: why.
            kind: of the unit; None for a task.
            origin: who sent it; stands in the place of the thread.
        """
        problems = sorted(error.problems, key=lambda problem: not problem.is_error)
        first: Any = problems[0]
        if kind == SECONDARY:
            self._warn(f"{SECONDARY_WARNING}SyntaxError: {first.text}", first.line)
        else:
            hint = {"hint": first.hint} if first.hint else {}
            self._alarm(first.code, "SyntaxError", first.text, first.line, first.column, origin, "", hint)
        for problem in () if kind == LINE else problems[1 : PROBLEMS_MAX + 1]:
            self._warn(_told(problem), problem.line)

    def _missing_name(self, text: str) -> str:
        """The name that a line calls, if there is nothing of that name."""
        try:
            body = ast.parse(text.strip()).body
        except SyntaxError:
            return ""
        first = body[0].value if body and isinstance(body[0], ast.Expr) else None
        if isinstance(first, ast.Call) and isinstance(first.func, ast.Name) and not is_known(first.func.id):
            return first.func.id
        return ""

    def _warn(self, text: str, line: int = 0) -> None:
        self._controller.emit(Warned(self._controller.tick, text, "", line))

    def _alarm(
        self,
        code: str,
        class_name: str,
        text: str,
        line: int,
        column: int,
        origin: str,
        source_line: str,
        details: dict[str, Any] | None = None,
    ) -> None:
        tick = self._controller.tick
        self._controller.emit(Alarm(tick, code, class_name, text, line, column, origin, source_line, details or {}))


def _told(problem: Diagnostic) -> str:
    """A problem without its line, which the warning names itself, and without the word `warning`."""
    word = "error " if problem.is_error else ""
    return f"column {problem.column}: {word}{problem.code}: {problem.text}"
