"""`elitescript check`: every problem of a program, without running it."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Final

from elitescript.cli import jsonlines
from elitescript.errors import ProgramError, UsageError
from elitescript.language.diagnostics import Diagnostic, Severity, render, to_json
from elitescript.language.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.paths import why_no_file
from elitescript.messages.profile import profile

FOUND_ERRORS: Final = 3
"""Exit code when a program has an error."""


def check(options: argparse.Namespace) -> int:
    """Check the files of the command line; return the exit code."""
    errors = warnings = 0
    for name in options.files:
        source, problems = check_file(Path(name), options.firmware, options.strict)
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


def check_file(path: Path, firmware: str, strict: bool) -> tuple[SourceFile, tuple[Diagnostic, ...]]:
    """The problems of one file, in the order of its lines.

    Raises:
        UsageError: the file cannot be read.
    """
    if why := why_no_file(path, is_stream_allowed=True):
        raise UsageError(f"cannot read {path}: it {why}")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror or error}") from error
    try:
        source = SourceFile.from_bytes(str(path), data)
    except ProgramError as error:
        return SourceFile(str(path), data.decode("utf-8", "replace")), error.problems
    return source, check_source(source, profile(firmware), strict=strict)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
