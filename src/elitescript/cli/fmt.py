"""`elitescript fmt`: lays out programs; what runs stays the same."""

from __future__ import annotations

import sys
from typing import Final

from elitescript.assist.formatting import Formatted, formatted
from elitescript.cli.check import FOUND_ERRORS, NOT_FOUND
from elitescript.cli.output.check_formats import CheckedFile, CheckReport
from elitescript.cli.output.screen import progress_on
from elitescript.cli.program_texts import ProgramText, program_texts, rewrite, write_out
from elitescript.errors import ProgramError, UsageError
from elitescript.language.text.source import SourceFile
from elitescript.paths import is_task_name
from elitescript.shown import shown, shown_word

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

WOULD_CHANGE: Final = 1
"""Exit code of --check when a file is not laid out."""


def fmt(options: argparse.Namespace) -> int:
    """Lay out the files of the command line; return the exit code."""
    if not options.files:
        raise UsageError("name files or folders, or - for standard input")
    changed = kept = refused = left = unsafe = trees = 0
    is_missing = False
    report = CheckReport(sys.stderr)
    progress = progress_on(sys.stderr)
    for number, text in enumerate(program_texts(options.files, "fmt")):
        if progress is not None:
            progress.note(f"{number} files formatted; {text.name}")
        if text.data is None:
            refused += 1
            is_missing |= text.is_named
            print(f"elitescript fmt: {shown_word(text.name)}: {shown(text.why_not)}", file=sys.stderr)
            continue
        if text.path is not None and is_task_name(text.path.name):
            trees += 1
            continue
        result = _formatted(text.name, text.data, is_pendant=options.pendant)
        if result.changed_line:
            unsafe += 1
            what = f"left as it is: line {result.changed_line} would run in another way; please report this mistake"
            print(f"elitescript fmt: {shown_word(text.name)}: {what}", file=sys.stderr)
        if result.problems:
            refused += 1
            report.file(CheckedFile(text.name, SourceFile(text.name, result.text), result.problems))
        data = text.data if result.problems else result.text.encode("utf-8")
        left += result.is_left
        is_changed = data != text.data
        changed += is_changed
        kept += not (is_changed or result.problems or result.is_left or result.changed_line)
        if options.diff:
            if is_changed:
                sys.stdout.write(_difference(text, result.text))
        elif options.check:
            if is_changed:
                print(f"{shown_word(text.name)}: not formatted", file=sys.stderr)
        elif text.path is None:
            write_out(data)
        elif is_changed:
            rewrite(text.path, data)
    print(_summary(changed, kept, left, trees, refused, unsafe, is_dry=options.check or options.diff), file=sys.stderr)
    if is_missing:
        return NOT_FOUND
    if refused or unsafe:
        return FOUND_ERRORS
    return WOULD_CHANGE if options.check and changed else 0


def _formatted(name: str, data: bytes, *, is_pendant: bool) -> Formatted:
    try:
        SourceFile.from_bytes(name, data)
    except ProgramError as error:
        return Formatted(SourceFile.to_show(name, data).text, error.problems)
    return formatted(data.decode("utf-8"), name, pendant=is_pendant)


def _difference(text: ProgramText, new: str) -> str:
    """Return what changes, as a unified diff. `patch` can apply it unless characters of the text had to be escaped."""
    from difflib import unified_diff

    assert text.data is not None
    old = text.data.decode("utf-8").split("\n")
    name = shown_word(text.name)
    rows = unified_diff(_rows(old), _rows(new.split("\n")), name, name)
    return "".join(row if row.endswith("\n") else f"{row}\n\\ No newline at end of file\n" for row in rows)


def _rows(pieces: list[str]) -> list[str]:
    return [*(f"{piece}\n" for piece in pieces[:-1]), *([pieces[-1]] if pieces[-1] else [])]


def _summary(changed: int, kept: int, left: int, trees: int, refused: int, unsafe: int, *, is_dry: bool) -> str:
    parts = [
        f"{_count(changed)} {'would be ' if is_dry else ''}formatted",
        f"{kept} unchanged",
    ]
    if left:
        parts.append(f"{_count(left)} of the pendant left as {'it is' if left == 1 else 'they are'} (see --pendant)")
    if unsafe:
        parts.append(f"{_count(unsafe)} left because a line would run in another way")
    if trees:
        parts.append(f"{_count(trees)} with a tree left: their scripts are generated")
    if refused:
        parts.append(f"{_count(refused)} cannot be read")
    return ", ".join(parts)


def _count(number: int) -> str:
    return f"{number} file" if number == 1 else f"{number} files"
