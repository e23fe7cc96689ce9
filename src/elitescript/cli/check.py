"""`elitescript check`: every problem of a program, without running it."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Final

from elitescript.cli import jsonlines
from elitescript.commands.plausibility import ArmFacts
from elitescript.errors import ProgramError, UsageError
from elitescript.language.diagnostics import Diagnostic, Severity, render, to_json
from elitescript.language.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile

FOUND_ERRORS: Final = 3
"""Exit code when a program has an error."""


def check(options: argparse.Namespace) -> int:
    """Check the files of the command line; return the exit code."""
    errors = warnings = 0
    arm = _arm(options.robot, options.world)
    for name in options.files:
        source, problems = check_file(Path(name), options.firmware, options.strict, arm)
        for problem in problems:
            if options.json:
                print(jsonlines.line({"file": name, **to_json(problem)}))
            else:
                print(render(problem, source))
            errors += problem.severity is Severity.ERROR
            warnings += problem.severity is not Severity.ERROR
    if not options.json:
        files = f"{len(options.files)} file{'s' if len(options.files) != 1 else ''}"
        print(f"{files} checked: {_count(errors, 'error')}, {_count(warnings, 'warning')}", file=sys.stderr)
    return FOUND_ERRORS if errors else 0


def _arm(robot: str | None, world: str | None) -> ArmFacts | None:
    """What is known of the arm; None if nothing is, which spares loading a model.

    Raises:
        UsageError: no such arm, or a world file that makes no sense.
    """
    if robot is None and world is None:
        return None
    from elitescript.cli.arm_facts import arm_facts

    return arm_facts(robot, world)


def check_file(
    path: Path, firmware: str, strict: bool, arm: ArmFacts | None = None
) -> tuple[SourceFile, tuple[Diagnostic, ...]]:
    """The problems of one file, in the order of its lines.

    Args:
        path: of the file.
        firmware: that it is for.
        strict: what only this implementation accepts is an error.
        arm: that it is for; None leaves out what depends on it.

    Raises:
        UsageError: the file cannot be read.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror or error}") from error
    try:
        source = SourceFile.from_bytes(str(path), data)
    except ProgramError as error:
        return SourceFile(str(path), data.decode("utf-8", "replace")), error.problems
    return source, check_source(source, profile(firmware), strict=strict, arm=arm)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
