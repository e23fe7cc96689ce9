"""Programs that come from outside: compiled, refused with their place, or started in the place of the running one."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.commands.definition.plausibility import ArmFacts
from elitescript.controller.controller import Controller
from elitescript.controller.views.warning_limit import MOST
from elitescript.errors import ProgramError, ScriptError
from elitescript.kernel.compiling import (
    TEXTS_MAX,
    Job,
    LongTexts,
    Waiting,
    Workshop,
    compiled_job,
    source_of_tree,
)
from elitescript.kernel.debugging import Debugging
from elitescript.kernel.unit_order import WAITING_MAX, UnitOrder
from elitescript.language.compiler import CompiledUnit
from elitescript.language.diagnostics import Diagnostic, diagnostic, line_kept
from elitescript.language.limits import LONG_TEXT, SymbolCount, excess_at_once
from elitescript.language.options import LINE, SECONDARY, Options
from elitescript.language.text.lexer import name_pattern
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import CheckResult
from elitescript.lint.registry import all_rules
from elitescript.messages.events import Alarm, TextMessage, Warned
from elitescript.messages.inputs import Compiled, Do, RunUnit
from elitescript.messages.profile import Profile
from elitescript.protocol.bursts import BurstLimiter
from elitescript.protocol.lines import shown
from elitescript.records import replace
from elitescript.runtime.environment import ProgramEnvironment
from elitescript.runtime.host import SECONDARY_WARNING, ScriptHost
from elitescript.runtime.names.bindings import is_known
from elitescript.runtime.probe import Probe, noted, probed
from elitescript.said import Said, counted, said

PROBLEMS_MAX: Final = 20
"""Further problems of one text that go to the log."""
LINES_SHOWN: Final = 10
"""Of equal findings."""
TOLD_MAX: Final = 100
"""Texts whose findings are remembered as logged."""
PRESETS_MAX: Final = 1000
"""Variables that may wait for the next program."""
_NAME_MAX: Final = 100


class Programs:
    """Compiles and starts programs.

    Args:
        controller: the machine.
        host: runs them.
        profile: the firmware.
        arm: for which programs are checked.
        environment: everything outside them.
        is_strict: refuse what a Python 3 controller refuses, and what `check` calls an error.
        ignored: codes of findings that are left out.
        probe: counts their statements.
        workshop: where long texts are compiled; here and at once if None.

    Attributes:
        presets: values that program globals have before a program begins.
        reported: code and line of what was found in the newest program before it began.
    """

    __slots__ = (
        "_arm",
        "_begun",
        "_controller",
        "_count",
        "_count_of_jobs",
        "_environment",
        "_host",
        "_ignored",
        "_invalid_lines",
        "_is_strict",
        "_long_texts",
        "_order",
        "_present",
        "_probe",
        "_profile",
        "_told",
        "presets",
        "reported",
    )

    def __init__(
        self,
        controller: Controller,
        host: ScriptHost,
        profile: Profile,
        arm: ArmFacts,
        environment: ProgramEnvironment,
        *,
        is_strict: bool,
        ignored: frozenset[str],
        probe: Probe | None,
        workshop: Workshop | None = None,
    ) -> None:
        all_rules()  # loaded now: the first program does not wait for them
        self._controller = controller
        self._count = 0
        """Secondary programs so far."""
        self._count_of_jobs = self._present = 0
        """Texts so far, and the one whose program begins now."""
        self._long_texts = None if workshop is None else LongTexts(workshop, self._tell_of_long_text)
        self._host = host
        self._profile = profile
        self._arm = arm
        self._environment = environment
        self.reported: frozenset[tuple[str, int]] = frozenset()
        self._is_strict = is_strict
        self._ignored = ignored
        self._probe = probe
        self._invalid_lines = BurstLimiter(
            self._warn, "line", "that are no script. Does that client speak another protocol?"
        )
        self.presets: dict[str, object] = {}
        self._order = UnitOrder()
        self._told: set[int] = set()
        """Hashes of texts whose findings the log has had."""
        self._begun = ""
        """What the program that runs or ran last is, in words."""

    @property
    def is_waiting(self) -> bool:
        """Whether units wait or are being compiled, or invalid lines are to be reported in one of the next ticks."""
        if self._long_texts is not None and self._long_texts.is_waiting:
            return True
        return self._invalid_lines.is_counting or self._order.is_waiting

    @property
    def _may_start(self) -> bool:
        """Whether the state of the safety system lets a program start."""
        return not self._controller.safety.refusal("start_task")

    def go_on(self, do: Callable[[Do], None]) -> None:
        """Begin a tick: what waits comes before the inputs of the tick.

        Args:
            do: carries out a request that has waited.
        """
        tick = self._controller.tick
        self._invalid_lines.go_on(tick)
        if self._order.is_waiting and (why := self._controller.safety.refusal("start_task")):
            self.drop(why)
        if self._long_texts is not None and self._long_texts.is_waiting:
            self._long_texts.go_on(tick, self._may_start)
        while (item := self._order.take(tick)) is not None:
            if isinstance(item, RunUnit):
                self._run(item)
            else:
                do(item)

    def take(self, unit: RunUnit) -> None:
        """Run a unit, now or once the one that has begun in this tick has had its share of it."""
        if not self.has_queued(unit):
            self._run(unit)

    def has_queued(self, item: RunUnit | Do) -> bool:
        """Let an input wait if it must; return whether it does. Without room for it, it is lost and a warning."""
        if not self._order.must_wait(item, self._controller.tick):
            return False
        if not self._order.put(item):
            what = (
                _words(item.text, item.origin)
                if isinstance(item, RunUnit)
                else said("a command of {origin}", origin=item.origin)
            )
            self._warn(
                said(
                    "{what} is lost: {waiting_max} programs, lines and commands wait already, or too much text",
                    what=what,
                    waiting_max=WAITING_MAX,
                )
            )
        return True

    def drop(self, why: str) -> None:
        """Drop the units that wait or are being compiled, and say which ones.

        What has begun in this tick and will not run is one of them.
        """
        if self._long_texts is not None and self._long_texts.is_waiting:
            self._long_texts.give_up(why)
        lost = [_words(unit.text, unit.origin) for unit in self._order.clear()]
        if self._begun and self._host.is_running and not self._host.has_begun:
            lost.insert(0, self._begun)
        for words in lost[:PROBLEMS_MAX]:
            self._warn(said("{words} did not run: {why}", words=words, why=why))
        if more := len(lost[PROBLEMS_MAX:]):
            self._warn(said("{more} more programs and lines did not run: {why}", more=more, why=why))

    def _run(self, unit: RunUnit) -> None:
        """Run a unit: a program or a line replaces what runs, a secondary program runs beside it.

        What does not compile, and a line that calls what does not exist, is reported and leaves the running program
        alone.
        """

        def take(compiled: CompiledUnit | ProgramError) -> None:
            if isinstance(compiled, ProgramError):
                if unit.kind != LINE or self._invalid_lines.is_reported(unit.origin, self._controller.tick):
                    self.report(compiled, unit.kind, unit.origin)
            else:
                self._begin(unit, compiled)

        self.compile(self._name_of(unit), unit.text, unit.kind, unit.origin, take)

    def _begin(self, unit: RunUnit, compiled: CompiledUnit) -> None:
        if unit.kind == SECONDARY:
            try:
                self._host.start_secondary(compiled)
            except ScriptError as error:
                self._warn_secondary(str(error))
            return
        if unit.kind == LINE and (name := self._missing_name(unit.text)):
            if self._invalid_lines.is_reported(unit.origin, self._controller.tick):
                text = said("name {name!r} is not defined", name=name)
                self._alarm("R100", "NameError", text, 1, 1, unit.origin, line_kept(unit.text.split("\n", 1)[0], 1))
            return
        self.start(compiled, compiled.name, _words(unit.text, unit.origin))
        self._order.begins(unit, self._controller.tick)

    def _name_of(self, unit: RunUnit) -> str:
        """Return a name for a text, which no other one has that may run at the same time: places are found by it."""
        if unit.kind != SECONDARY:
            return f"<{unit.origin}>"
        self._count += 1
        return f"<{unit.origin} sec {self._count}>"

    def compile(
        self,
        name: str,
        text: str,
        kind: str | None,
        origin: str,
        take: Callable[[CompiledUnit | ProgramError], None],
        abandon: Callable[[str], None] = lambda why: None,
        *,
        is_tree: bool = False,
    ) -> bool:
        """Check and compile a text; what `check` finds goes to the log. A line runs at once, and is only compiled.

        Args:
            name: of the text, as places show it.
            text: it.
            kind: what it must be; None to determine it.
            origin: client that has sent it.
            take: gets the program, or why there is none: before this call returns, or in a later tick for a long text.
            abandon: called with the reason, after a line in the log, if that tick does not come.
            is_tree: the text is that of a graphical program, as `kernel.compiling.tree_text` has returned it.

        Returns:
            Whether `take` was called.
        """
        # A debugger that may come numbers statements, whatever the text; splitting a long one takes time.
        source = SourceFile(name, "" if is_tree or isinstance(self._probe, Debugging) else text)
        if is_tree and self._probe is not None and not isinstance(self._probe, Debugging):
            # What counts statements knows a program by its text.
            source, _ = source_of_tree(name, text)
        options = probed(self._probe, Options(strict=self._is_strict, kind=kind), source)
        self._count_of_jobs += 1
        presets = tuple(self.presets)
        job = Job(
            self._count_of_jobs,
            name,
            text,
            kind,
            self._is_strict,
            options.probes,
            options.first_probe,
            presets,
            is_tree,
        )
        if self._long_texts is None or len(text) < LONG_TEXT:
            take(self._outcome(job, compiled_job(job, self._profile, self._arm, self._ignored)))
            return True
        if not is_tree and (excess := excess_at_once(text)) is not None:
            take(self._outcome(job, CheckResult(None, (excess,), job.is_strict)))
            return True
        if self._long_texts.is_full:
            take(_failure(said("{texts_max} programs are being compiled already", texts_max=TEXTS_MAX)))
            return True
        if isinstance(self._probe, Debugging):
            self._probe.reserve(len(text))
        label = said(
            "{program} {label}from {origin}",
            program=Said("the secondary program") if kind == SECONDARY else Said("the program"),
            label=_label(text),
            origin=origin,
        )
        waiting = Waiting(
            job,
            label,
            self._controller.tick,
            self._may_start,
            lambda result: take(_failure(result) if isinstance(result, str) else self._outcome(job, result)),
            abandon,
            SymbolCount("" if is_tree else text),
        )
        self._long_texts.put(waiting)
        return False

    def come_back(self, item: Compiled) -> None:
        """Take a text that was compiled elsewhere."""
        if self._long_texts is not None:
            self._long_texts.come_back(item.number, item.failure)

    def forget(self, why: str) -> None:
        """Give up the programs that are being compiled, and forget all variables."""
        self.presets.clear()
        if self._long_texts is not None:
            self._long_texts.give_up_all(why)

    def _outcome(self, job: Job, checked: CheckResult) -> CompiledUnit | ProgramError:
        """Return the program; or why there is none: it does not compile, or strictness refuses it."""
        self._present = job.number
        if checked.unit is None or checked.is_refused:
            return ProgramError(checked.problems)
        if job.kind == LINE:
            self._tell(checked.problems)
            return noted(self._probe, checked.unit)
        if self._is_new(job.text):
            self._tell(checked.problems, place=checked.unit.source.place)
        self.reported = frozenset((problem.code, problem.line) for problem in checked.problems)
        return noted(self._probe, checked.unit)

    def _is_new(self, text: str) -> bool:
        """Note a text; return whether the log has not had what was found in it. Drivers send theirs again and again."""
        key = hash(text)
        if key in self._told:
            return False
        if len(self._told) >= TOLD_MAX:
            self._told.clear()
        self._told.add(key)
        return True

    def start(self, unit: CompiledUnit, name: str, words: str) -> None:
        """Start a program in the place of the running one, in this tick.

        Args:
            unit: the program.
            name: of the task.
            words: what the program is and where it comes from, for what is said of the one that it replaces.
        """
        if self._long_texts is not None and self._long_texts.is_waiting:
            self._long_texts.give_up("another program was started", lambda item: item.job.number < self._present)
        task = self._controller.task
        if self._host.is_running and not self._host.has_begun:
            self._warn(
                said("{begun} did not run: {words} came before its first statement", begun=self._begun, words=words)
            )
        task.successor = words
        try:
            self._host.end_now(self._controller.tick)
        finally:
            task.successor = ""
        self._begun = words
        self._controller.task_started(name)
        self._host.start(unit, dict(self.presets), world=self._environment)

    def report(self, error: ProgramError, kind: str | None, origin: str) -> None:
        """Report why a text does not compile: the first error as an alarm, the others of a program in the log.

        Args:
            error: why.
            kind: of the unit; None for a task.
            origin: of the text; stands in the place of the thread.
        """
        problems = sorted(error.problems, key=lambda problem: not problem.keeps_from_starting)
        if self._is_strict:
            problems.sort(key=lambda problem: not problem.is_error)
        first: Any = problems[0]
        if kind == SECONDARY:
            self._warn_secondary(said("SyntaxError: {text}", text=first.text), first.line, first.hint)
        else:
            hint = {"hint": first.hint} if first.hint else {}
            self._alarm(first.code, "SyntaxError", first.text, first.line, first.column, origin, "", hint)
        if kind != LINE:
            self._tell(problems[1:], kind)

    def _tell(
        self,
        problems: Sequence[Diagnostic],
        kind: str | None = None,
        place: Callable[[int], str] = lambda line: "",
    ) -> None:
        """Put findings into the log, in the words of `check`; errors of a secondary program as its first one.

        At most `PROBLEMS_MAX` are shown, of one kind of warning as many as a run shows, and equal ones once, with the
        lines of the others.
        """
        problems = _merged(problems)
        counts: Counter[str] = Counter()
        shown = 0
        for problem in problems:
            counts[problem.code] += not problem.is_error
            if shown == PROBLEMS_MAX or counts[problem.code] > MOST:
                continue
            shown += 1
            if kind == SECONDARY and problem.is_error:
                self._warn_secondary(said("SyntaxError: {text}", text=problem.text), problem.line)
            else:
                self._controller.emit(_as_event(problem, self._controller.tick, place(problem.line)))
        if more := len(problems) - shown:
            self._warn(
                said(
                    "{findings}: `elitescript check` shows all of them",
                    findings=counted(more, "more finding", "more findings"),
                )
            )

    def _missing_name(self, text: str) -> str:
        """Return the name that a line calls if there is nothing of that name; else empty, as for a long line."""
        if len(text) >= LONG_TEXT:
            return ""
        try:
            body = ast.parse(text.strip()).body
        except SyntaxError:
            return ""
        first = body[0].value if body and isinstance(body[0], ast.Expr) else None
        if isinstance(first, ast.Call) and isinstance(first.func, ast.Name) and not is_known(first.func.id):
            return first.func.id
        return ""

    def _tell_of_long_text(self, text: str, is_warning: bool) -> None:
        tick = self._controller.tick
        self._controller.emit(Warned(tick, text) if is_warning else TextMessage(tick, text, "", 0))

    def _warn(self, text: str) -> None:
        self._controller.emit(Warned(self._controller.tick, text))

    def _warn_secondary(self, text: str, line: int = 0, hint: str = "") -> None:
        tick, text = self._controller.tick, SECONDARY_WARNING + text
        self._controller.emit(Warned(tick, text, "", line, hint=hint, is_exception=True))

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


def _as_event(problem: Diagnostic, tick: int, node: str) -> Warned:
    return Warned(
        tick,
        said("{node}: {text}", node=node, text=problem.text) if node else problem.text,
        line=problem.line,
        code=problem.code,
        hint=problem.hint,
        column=problem.column,
        severity=str(problem.severity),
    )


def _failure(text: str) -> ProgramError:
    return ProgramError((diagnostic("E001", 1, 1, text),))


def _label(text: str) -> str:
    """Return the name of a program, with a blank behind it; empty if it has none."""
    found = re.match(rf"\s*(?:def|sec)[ \t]+({name_pattern(text)})", text)
    return f"`{found[1][:_NAME_MAX]}` " if found else ""


def _words(text: str, origin: str) -> str:
    """Return what a unit is and whose, such as `def p64():` of primary#2."""
    return said("`{text}` of {origin}", text=shown(text.strip().partition(chr(10))[0].rstrip()), origin=origin)


def _merged(problems: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return warnings of one code and text as the first of them, which names the lines of the others."""
    alike: dict[object, list[Diagnostic]] = {}
    for number, problem in enumerate(problems):
        alike.setdefault(number if problem.is_error else (problem.code, problem.text), []).append(problem)
    return [_with_lines(first, [other.line for other in others]) for first, *others in alike.values()]


def _with_lines(problem: Diagnostic, lines: list[int]) -> Diagnostic:
    """Return a finding that names the further lines of which it is true."""
    if not lines:
        return problem
    found = ", ".join(map(str, lines[:LINES_SHOWN]))
    more = said(" and {count} more", count=len(lines) - LINES_SHOWN) if len(lines) > LINES_SHOWN else ""
    return replace(
        problem,
        text=said(
            "{text} (also in lines {found}{more})" if len(lines) > 1 else "{text} (also in line {found}{more})",
            text=problem.text,
            found=found,
            more=more,
        ),
    )
