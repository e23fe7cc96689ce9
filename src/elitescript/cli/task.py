"""`elitescript task`: graphical programs as scripts, trees, data and differences; new ones."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Final

from elitescript.environment.program_file import source_of
from elitescript.environment.task_files import TaskProgram, script_body, task_program
from elitescript.errors import UsageError
from elitescript.paths import TASK_SUFFIX, is_task_name
from elitescript.program_tree import place_of, task_bytes
from elitescript.program_tree.listing import difference_text, differences, task_record, tree_text
from elitescript.program_tree.making import new_task, wrapped
from elitescript.program_tree.script.writing import identifier
from elitescript.shown import shown, shown_word

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

DIFFERENT: Final = 1
"""Exit code of --diff if the trees differ."""
NOT_GENERATED: Final = 3
"""Exit code if a node cannot be generated."""


def task(options: argparse.Namespace) -> int:
    """Print, make or compare graphical programs; return the exit code."""
    if options.new is not None:
        return _new(options)
    if options.file is None:
        raise UsageError("name a .task file, a .script file to wrap, or --new NAME")
    if not is_task_name(options.file):
        return _wrap(options)
    program = task_program(options.file, options.task_dir)
    if options.diff is not None:
        return _compare(program, task_program(options.diff, options.task_dir))
    if options.json:
        record = task_record(program.task, program.script.problems)
        _write(options, json.dumps({"file": str(program.path), **record}, ensure_ascii=False) + "\n")
    elif options.tree:
        _write(options, _lines(tree_text(program.task)))
    else:
        _write(options, program.script.text)
    return _report(program, is_quiet=options.tree or options.json)


def _report(program: TaskProgram, *, is_quiet: bool) -> int:
    """Print what is wrong with a task on the error output; return the exit code."""
    name = shown_word(str(program.path))
    for damage in program.task.damage:
        print(f"{name}:{damage.line}: note: {shown(damage.text)}", file=sys.stderr)
    if program.missing and not is_quiet:
        print(f"{name}: note: {shown(program.missing)}", file=sys.stderr)
    for problem in program.script.problems:
        if is_quiet and not problem.is_error:
            continue
        place = f" {shown(place_of(program.script.rows, problem.row))}:" if problem.row else ""
        kind = "error" if problem.is_error else "note"
        print(f"{name}:{place} {kind}: {shown(problem.text)}", file=sys.stderr)
        if problem.hint:
            print(f"    hint: {shown(problem.hint)}", file=sys.stderr)
    return NOT_GENERATED if program.script.errors else 0


def _compare(old: TaskProgram, new: TaskProgram) -> int:
    rows = differences(old.task, new.task)
    sys.stdout.write(_lines(difference_text(rows)))
    return DIFFERENT if rows else 0


def _new(options: argparse.Namespace) -> int:
    if options.output is None:
        raise UsageError("a new task needs -o FILE.task")
    options.outputs["output"].finish(task_bytes(new_task(options.new, _robot(options))).decode())
    return 0


def _wrap(options: argparse.Namespace) -> int:
    if options.output is None or not is_task_name(options.output):
        raise UsageError(f"{options.file} is no {TASK_SUFFIX} file; a script is wrapped into a task with -o FILE.task")
    source = source_of(Path(options.file))
    name, body, note = script_body(source)
    name = name or identifier(Path(options.file).stem)
    data = task_bytes(wrapped(name, _robot(options), body, Path(options.file).name))
    options.outputs["output"].finish(data.decode())
    if note:
        print(f"{shown_word(options.file)}: note: {shown(note)}", file=sys.stderr)
    return 0


def _robot(options: argparse.Namespace) -> str:
    from elitescript.models.model import load_model

    return load_model(options.robot).name


def _lines(text: str) -> str:
    """Return lines with texts of a file in them as they may be printed."""
    return "".join(f"{shown(line)}\n" for line in text.splitlines())


def _write(options: argparse.Namespace, text: str) -> None:
    if options.output is None:
        sys.stdout.write(text)
    else:
        options.outputs["output"].finish(text)
