"""A text in, all its problems out."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from elitescript.errors import ProgramError
from elitescript.language.compiler import compile_parsed
from elitescript.language.diagnostics import Diagnostic, Severity, diagnostic, in_order
from elitescript.language.options import Options
from elitescript.language.parser import Parsed, parse
from elitescript.language.source import SourceFile
from elitescript.lint.program import Program
from elitescript.lint.registry import Finding, Rule, Span, all_rules
from elitescript.lint.suppression import without_suppressed
from elitescript.messages.profile import Profile

_ANY_SYNTAX = "E001"
_BESIDE_SYNTAX = ("E104", "E105", "E107", "E115")
"""Errors in lines that could be read: they are about something else than a syntax error there."""


def check_source(
    source: SourceFile, profile: Profile, *, strict: bool = False, presets: Collection[str] = ()
) -> tuple[Diagnostic, ...]:
    """All problems of a text, in its order: what keeps it from starting, and what the rules find.

    Never raises, whatever the text. Findings against the command catalogue (E3xx) do not keep a program from
    starting; who runs it shows them as warnings.

    Args:
        source: the text.
        profile: the firmware that it is for.
        strict: what only this implementation accepts is an error, and what cannot be meant.
        presets: names of globals that have a value before the program begins.
    """
    parsed = parse(source, Options(strict=strict))
    problems = [] if not parsed.is_complete else _findings(parsed, profile, strict, presets)
    problems += _compile_problems(parsed)
    return in_order(_merged(without_suppressed(problems, parsed.source)))


def _findings(parsed: Parsed, profile: Profile, strict: bool, presets: Collection[str]) -> list[Diagnostic]:
    program = Program(parsed, profile, is_strict=strict, presets=presets)
    found = []
    for rule in all_rules():
        if not (rule.needs_all_lines and parsed.has_errors):
            found += [_located(finding, rule, program) for finding in rule.check(program)]
    return found


def _compile_problems(parsed: Parsed) -> tuple[Diagnostic, ...]:
    # Compiling uses up the tree, so the rules have looked at it before.
    try:
        return compile_parsed(parsed).diagnostics
    except ProgramError as error:
        return error.problems


def _located(finding: Finding, rule: Rule, program: Program) -> Diagnostic:
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
        severity=Severity.ERROR if finding.is_error or (rule.is_structural and program.is_strict) else None,
    )


def _merged(problems: Iterable[Diagnostic]) -> list[Diagnostic]:
    """One problem where several say the same: in one place the most specific, of each code the first."""
    places: dict[tuple[int, int], dict[str, Diagnostic]] = {}
    refused_lines = set()
    for problem in problems:
        places.setdefault((problem.line, problem.column), {}).setdefault(problem.code, problem)
        if problem.is_error and problem.code.startswith("E1") and problem.code not in _BESIDE_SYNTAX:
            refused_lines.add(problem.line)
    lesser = {rule.code: rule.instead_of for rule in all_rules()}
    kept = []
    for found in places.values():
        dropped = {code for other in found for code in lesser.get(other, ())}
        for code, problem in found.items():
            if code not in dropped and not (code == _ANY_SYNTAX and problem.line in refused_lines):
                kept.append(problem)
    return kept
