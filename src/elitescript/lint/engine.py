"""Checks a text with all rules."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterable, Iterator

from elitescript.commands.definition.plausibility import ArmFacts
from elitescript.errors import CODES, ProgramError
from elitescript.language.compiler import CompiledUnit, compile_parsed, problems_in
from elitescript.language.diagnostics import Diagnostic, Severity, diagnostic, in_order
from elitescript.language.garbage import without_collection
from elitescript.language.options import Options
from elitescript.language.parser import Parsed, parse
from elitescript.language.text.source import SourceFile
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, Rule, loaded_rules, rules_for
from elitescript.lint.suppression import without_suppressed
from elitescript.messages.profile import Profile
from elitescript.records import NamedTuple, replace
from elitescript.said import said

_ANY_SYNTAX = "E001"
OTHER_ARM = "W229"
_BESIDE_SYNTAX = ("E104", "E105", "E107", "E115")
"""Errors in lines that could be read: not syntax errors."""


class CheckResult(NamedTuple):
    """A text that was checked.

    Attributes:
        unit: the program, ready to run; None if it does not compile.
        problems: all findings, in the order of the text.
        is_strict: every error refuses the program, also one that it could catch.
    """

    unit: CompiledUnit | None
    problems: tuple[Diagnostic, ...]
    is_strict: bool

    @property
    def is_refused(self) -> bool:
        """Whether the program does not start."""
        if self.unit is None:
            return True
        return any(problem.is_error if self.is_strict else problem.keeps_from_starting for problem in self.problems)


def check_source(
    source: SourceFile,
    profile: Profile,
    *,
    strict: bool = False,
    presets: Collection[str] = (),
    arm: ArmFacts | None = None,
    ignored: frozenset[str] = frozenset(),
) -> tuple[Diagnostic, ...]:
    """Return all problems of a text, in its order: what keeps it from starting, and what the rules find.

    Never raises, whatever the text.

    Args:
        source: the text.
        profile: the firmware that it is for.
        strict: make an error of what only this implementation accepts, and of what cannot be meant.
        presets: names of globals that have a value before the program begins.
        arm: the arm that it is for, a `RobotModel`; None leaves out what depends on it.
        ignored: codes of findings to leave out.
    """
    options = Options(strict=strict, ignored=ignored)
    return compile_checked(source, profile, options, presets=presets, arm=arm).problems


@without_collection
def compile_checked(
    source: SourceFile,
    profile: Profile,
    options: Options,
    *,
    presets: Collection[str] = (),
    arm: ArmFacts | None = None,
    report_first: Callable[[tuple[Diagnostic, ...]], object] | None = None,
) -> CheckResult:
    """Check and compile a text, which is read once for both.

    Never raises, whatever the text.

    Args:
        source: the text.
        profile: the firmware that it is for.
        options: how it is read.
        presets: names of globals that have a value before the program begins.
        arm: the arm that it is for; None leaves out what depends on it.
        report_first: called with the findings that need no values of expressions, before the others are looked for.
    """
    return check_parsed(parse(source, options), profile, presets=presets, arm=arm, report_first=report_first)


@without_collection
def check_parsed(
    parsed: Parsed,
    profile: Profile,
    *,
    presets: Collection[str] = (),
    arm: ArmFacts | None = None,
    report_first: Callable[[tuple[Diagnostic, ...]], object] | None = None,
) -> CheckResult:
    """Check and compile a text that was read; see `compile_checked`. Uses up the tree."""
    options = parsed.options
    problems = _known_before(parsed.source, arm)
    census = None
    if parsed.is_complete:
        program = AnalysedProgram(parsed, profile, is_strict=options.strict, presets=presets, arm=arm)
        known: dict[str, list[Finding]] = {}
        if report_first is not None:
            quick = _findings(program, _quick_rules(program), known)
            report_first(_reported([*problems, *quick, *parsed.diagnostics], parsed.source, options.ignored))
        problems += _findings(program, _rules(program), known)
        census = program.census
        program.release()
    unit = None
    # Compiling uses up the tree, so the rules come first.
    try:
        unit = compile_parsed(parsed, census)
    except ProgramError as error:
        problems += error.problems
    else:
        problems += unit.diagnostics
    found = _reported(problems, parsed.source, options.ignored)
    return CheckResult(None if unit is None else replace(unit, findings=found), found, options.strict)


class WrittenProgram:
    """Finds the problems of a text that is being written: first those for which no expression is evaluated.

    Args:
        program: the text, analysed; its tree is left as it is.
    """

    __slots__ = ("_found", "_program", "_refusals")

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program
        self._found: dict[str, list[Finding]] = {}
        """What rules have found, by their codes."""
        self._refusals: tuple[Diagnostic, ...] | None = None
        """What the compiler has found."""

    @without_collection
    def quick_problems(self) -> tuple[Diagnostic, ...]:
        """Return the problems that are found without the values of expressions.

        Raises:
            Outdated: the text has changed meanwhile.
        """
        return self._reported(_findings(self._program, _quick_rules(self._program), self._found))

    @without_collection
    def problems(self) -> tuple[Diagnostic, ...]:
        """Return all problems, as `check_source`.

        Raises:
            Outdated: the text has changed meanwhile.
        """
        return self._reported(_findings(self._program, _rules(self._program), self._found))

    def _reported(self, found: list[Diagnostic]) -> tuple[Diagnostic, ...]:
        program, parsed = self._program, self._program.parsed
        if self._refusals is None:
            program.stop_if_outdated()
            self._refusals = problems_in(parsed, program.census)
        known = _known_before(parsed.source, program.arm)
        return _reported([*known, *found, *self._refusals], parsed.source, parsed.options.ignored)


def _known_before(source: SourceFile, arm: ArmFacts | None) -> list[Diagnostic]:
    """Return what is known of a text besides what stands in it: of the tree from which it was generated."""
    made_for = "" if source.tree is None else source.tree.arm
    if not made_for or arm is None or made_for.lower() == arm.name.lower():
        return [*source.notes]
    text = said("the graphical program was made for a {made_for}, and this is a {arm}", made_for=made_for, arm=arm.name)
    hint = said("--robot {made_for} runs it on that arm", made_for=made_for)
    return [diagnostic(OTHER_ARM, 1, 1, text, hint=hint), *source.notes]


def _rules(program: AnalysedProgram) -> Iterator[Rule]:
    """Yield the rules that can find anything in a program; between two of them it may be outdated."""
    if program.parsed.is_complete:
        for rule in rules_for(program.source.text):
            if not (rule.needs_all_lines and program.parsed.has_errors):
                program.stop_if_outdated()
                yield rule


def _quick_rules(program: AnalysedProgram) -> Iterator[Rule]:
    """Yield those that need no values of expressions."""
    return (rule for rule in _rules(program) if not rule.needs_values)


def _findings(program: AnalysedProgram, rules: Iterable[Rule], known: dict[str, list[Finding]]) -> list[Diagnostic]:
    """Return what rules find; `known` gets it by their codes, and what is in it already is not looked for again."""
    found: list[Diagnostic] = []
    for rule in rules:
        findings = known.get(rule.code)
        if findings is None:
            try:
                findings = list(rule.check(program))
            except RecursionError:
                # Expressions nested deeper than it can follow: it says nothing of such a text.
                findings = []
            known[rule.code] = findings
        lines = {program.span(finding.where).line for finding in findings if isinstance(finding.where, ast.AST)}
        for finding in findings:
            passed = _passed(finding, program)
            if passed is None:
                found.append(_located(finding, rule, program))
            elif passed.lineno not in lines:
                found.append(_located(_with_origin(finding, passed), rule, program))
    return found


def _passed(finding: Finding, program: AnalysedProgram) -> ast.Call | None:
    """Return the call to which the value of a finding is passed from elsewhere; None if it is about no such value."""
    if not isinstance(finding.where, ast.expr) or "passed_values" not in program.__dict__:
        return None
    written = program.passed_values.origins.get(finding.where)
    return written if written is not None and program.span(finding.where).line != written.lineno else None


def _with_origin(finding: Finding, call: ast.Call) -> Finding:
    """Return a finding that says where the value goes."""
    where = said("it gets there in line {line}", line=call.lineno)
    hint = said("{hint}; {where}", hint=finding.hint, where=where) if finding.hint else where
    return finding._replace(hint=hint)


def _reported(problems: list[Diagnostic], source: SourceFile, ignored: frozenset[str]) -> tuple[Diagnostic, ...]:
    return in_order(_merged(without_suppressed(problems, source, ignored)))


def _located(finding: Finding, rule: Rule, program: AnalysedProgram) -> Diagnostic:
    where = finding.where
    span = where if isinstance(where, Span) else program.span(where)
    return diagnostic(
        rule.code,
        span.line,
        span.column,
        finding.text,
        end_line=span.end_line,
        end_column=span.end_column,
        hint=finding.hint,
        fix=finding.fix,
        severity=Severity.ERROR if program.is_strict and CODES[rule.code].is_tolerated else None,
    )


def _merged(problems: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Drop duplicates: keep in each place the most specific problem, and the first of each code."""
    places: dict[tuple[int, int], dict[str, Diagnostic]] = {}
    refused_lines = set()
    for problem in problems:
        places.setdefault((problem.line, problem.column), {}).setdefault(problem.code, problem)
        if problem.is_error and problem.code.startswith("E1") and problem.code not in _BESIDE_SYNTAX:
            refused_lines.add(problem.line)
    lesser = {rule.code: rule.instead_of for rule in loaded_rules()}
    kept = []
    for found in places.values():
        dropped = {code for other in found for code in lesser.get(other, ())}
        for code, problem in found.items():
            if code not in dropped and not (code == _ANY_SYNTAX and problem.line in refused_lines):
                kept.append(problem)
    return kept
