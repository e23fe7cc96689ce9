"""A graphical program on this computer: the `.task` file, what stands beside it, and its script."""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Final

from elitescript.errors import ProgramError, UsageError
from elitescript.language.diagnostics import Diagnostic, diagnostic
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.models.model import RobotModel, load_model
from elitescript.program_tree import (
    Configuration,
    Generated,
    GlobalVariable,
    Task,
    TaskFileError,
    generated,
    place_of,
    read_configuration,
    read_task,
    read_variables,
)
from elitescript.program_tree.checking import tree_doubts
from elitescript.program_tree.script.writing import Problem
from elitescript.records import record, replace
from elitescript.said import said
from elitescript.untrusted.files import Kind, opened, read_bytes

_TASK: Final = Kind("task", 64 << 20)
_HEAD_BYTES: Final = 1 << 16
_ARM: Final = re.compile(r"<EliTask\b[^>]*?\srobotType\s*=\s*[\"']([^\"'<]*)")
_MARK: Final = "$ LINE"
_CONFIGURATION: Final = Kind("configuration", 64 << 20)


@record
class TaskProgram:
    """A graphical program with its script.

    Attributes:
        path: of the `.task` file.
        task: its tree.
        script: generated from it.
        missing: what would stand beside it and does not, as one note; empty: all is there.
        doubts: what is hardly meant in the tree.
        arm: name of the arm that it was made for; empty: the file does not say it.
    """

    path: Path
    task: Task
    script: Generated
    missing: str = ""
    doubts: tuple[Problem, ...] = ()
    arm: str = ""


def task_program(path: str | Path, task_dir: str | Path | None = None) -> TaskProgram:
    """Read a graphical program with the configuration beside it, and generate its script.

    The files of the configuration stand beside the task, else in the folder that the task names, below the task folder.

    Args:
        path: of the `.task` file.
        task_dir: the task folder; None: the folder of the file.

    Raises:
        UsageError: a file cannot be read, or is not what it should be; with line and column.
    """
    path = Path(path)
    home = Path(task_dir) if task_dir is not None else path.parent

    def read(name: str) -> bytes | None:
        for folder in (path.parent, home):
            try:
                if (folder / name).is_file():
                    return read_bytes(folder / name, _CONFIGURATION)
            except (OSError, ValueError):
                continue
        return None

    data = read_bytes(path, _TASK, is_stream_allowed=True)
    return replace(_program(str(path), data, read), path=path)


def _program(name: str, data: bytes, read: Callable[[str], bytes | None]) -> TaskProgram:
    """Return a graphical program; `read` returns a file of the task folder by its path there, None if there is none."""
    task = read_task(data, name)
    configuration: Configuration | None = None
    variables: tuple[GlobalVariable, ...] | None = None
    missing: list[str] = []
    if task.installation:
        for ending in ("", ".variables"):
            file = f"{task.installation}.configuration{ending}"
            content = None
            if _is_name(file):
                content = next(filter(None, (read(f"{folder}{file}") for folder in _folders(name, task))), None)
            if content is None:
                missing.append(file)
            elif ending:
                variables = read_variables(content, file)
            else:
                configuration = read_configuration(content, file)
    note = said("{files} is not beside the task", files=" or ".join(missing)) if missing else ""
    script = generated(task, configuration, variables)
    arm = _arm_of(task)
    doubts = tree_doubts(
        script.rows, configuration, None if arm is None else arm.arm, lambda path: _text(path, name, read)
    )
    return TaskProgram(Path(name), task, script, note, tuple(doubts), task.robot_type if arm is None else arm.name)


def arm_of_file(path: str | Path) -> str:
    """Return the name of the arm that a `.task` file names in its first tag; empty, if it names none that is known."""
    try:
        with opened(path) as file:
            head = file.read(_HEAD_BYTES)
    except UsageError:
        return ""
    found = _ARM.search(head.decode("utf-8", "replace"))
    arm = None if found is None else _arm_named(found[1])
    return "" if arm is None else arm.name


def _arm_of(task: Task) -> RobotModel | None:
    """Return the arm for which a task was made; None: it does not say it, or it is none of those that are known."""
    return _arm_named(task.robot_type)


def _arm_named(name: str) -> RobotModel | None:
    try:
        return load_model(name) if name.isalnum() else None
    except UsageError:
        return None


def _text(path: str, name: str, read: Callable[[str], bytes | None]) -> str | None:
    """Return the text of a file of a script node: beside the task, or in the task folder; None if there is none."""
    parts = [part for part in path.replace("\\", "/").split("/") if part not in ("", ".")]
    if not parts or ".." in parts or any(":" in part or "\0" in part for part in parts):
        return None
    beside = "" if Path(name).is_absolute() else name.rpartition("/")[0]
    for folder in dict.fromkeys((f"{beside}/" if beside else "", "")):
        data = read(f"{folder}{'/'.join(parts)}")
        if data is not None:
            return data.decode("utf-8", "replace")
    return None


def source_of_data(name: str, read: Callable[[str], bytes | None]) -> SourceFile:
    """Return the script of a graphical program of a task folder, with the node of each line.

    Args:
        name: of the `.task` file in that folder.
        read: returns a file of the folder; None if there is none.

    Raises:
        ProgramError: E004: it is no task, or a node of it cannot be generated.
    """
    return _runnable(name, lambda: _program(name, read(name) or b"", read))


def source_of_task(path: str | Path, task_dir: str | Path | None = None) -> SourceFile:
    """Return the script of a graphical program, with the node of each line.

    Raises:
        UsageError: a file cannot be read.
        ProgramError: E004: it is no task, or a node of it cannot be generated.
    """
    return _runnable(str(path), lambda: task_program(path, task_dir))


def _runnable(name: str, make: Callable[[], TaskProgram]) -> SourceFile:
    try:
        program = make()
    except TaskFileError as error:
        raise ProgramError((diagnostic("E004", error.line, error.column, error.why),), name) from None
    source, errors = _source(program)
    if errors:
        raise ProgramError(errors, name)
    return source


def refused_task(path: str | Path, task_dir: str | Path | None = None) -> SourceFile:
    """Return the text in which the problems of a refused task are: its script, or its file."""
    try:
        return _source(task_program(path, task_dir))[0]
    except TaskFileError:
        return SourceFile.to_show(str(path), read_bytes(path, _TASK, is_stream_allowed=True))


def _source(program: TaskProgram) -> tuple[SourceFile, tuple[Diagnostic, ...]]:
    """Return the script of a task, and what keeps it from running."""
    script = program.script
    places = {row.number: place_of(script.rows, row.number) for row in script.rows}
    marks: dict[int, int] = {}
    statements: dict[int, int] = {}
    for line, (number, text) in enumerate(zip(script.line_rows, script.text.split("\n"), strict=False), 1):
        marks.setdefault(number, line)
        if not text.lstrip().startswith(_MARK):
            statements.setdefault(number, line)
    found = [
        diagnostic(
            problem.code or ("E004" if problem.is_error else "N225"),
            _line_of(problem, statements, marks),
            1,
            problem.text,
            hint=problem.hint,
        )
        for problem in (*script.problems, *program.doubts)
        if problem.row or problem.is_error
    ]
    missing = [problem for problem in script.problems if not problem.row and not problem.is_error]
    if program.missing:
        text = said("{missing}; {text}", missing=program.missing, text=missing[0].text) if missing else program.missing
        found.append(diagnostic("N225", 1, 1, text, hint=missing[0].hint if missing else ""))
    else:
        found += [diagnostic("N225", 1, 1, problem.text, hint=problem.hint) for problem in missing]
    notes = tuple(row for row in found if not row.is_error)
    lines = tuple(places.get(row, "") for row in script.line_rows)
    source = SourceFile(str(program.path), script.text, lines, notes, program.arm, script.unset)
    return source, tuple(row for row in found if row.is_error)


def _line_of(problem: Problem, statements: dict[int, int], marks: dict[int, int]) -> int:
    """Return the line of a problem: the first statement of its row, whose time a run knows; else its mark."""
    line = marks.get(problem.row, 1)
    return line if problem.is_error else statements.get(problem.row, line)


def script_body(source: SourceFile) -> tuple[str, str, str]:
    """Return what a script does as the text of a script node.

    Returns:
        The name of the program (that of its `def`; empty: it has none), the body of the `def` at the left margin with
        what stands in front of it, and a note on what changes; empty: nothing does.

    Raises:
        ProgramError: it has problems that keep it from running.
        UsageError: it is a secondary program.
    """
    parsed = parse(source)
    if parsed.has_errors:
        raise ProgramError(tuple(row for row in parsed.diagnostics if row.severity == "error"), source.name)
    if parsed.kind == "secondary":
        raise UsageError(said("{name}: a `sec` runs beside a program and cannot be one", name=source.name))
    units = [row for row in parsed.tree.body if isinstance(row, ast.FunctionDef)]
    note = ""
    if any(
        isinstance(row, ast.Constant) and isinstance(row.value, str) and row.end_lineno != row.lineno
        for row in ast.walk(parsed.tree)
    ):
        note = said("texts of several lines get the blanks that the pendant puts in front of each line")
    if parsed.kind != "program" or len(units) != 1:
        return "", source.text, note
    unit = units[0]
    last = max(
        (number for number, line in enumerate(source.lines, 1) if line.split("#")[0].rstrip() == "end"),
        default=len(source.lines) + 1,
    )
    first = unit.body[0].lineno
    while first - 1 > unit.lineno and (
        not source.line(first - 1).strip() or source.line(first - 1).lstrip().startswith("#")
    ):
        first -= 1
    body = textwrap.dedent("\n".join(source.lines[first - 1 : last - 1]))
    front = "\n".join(source.lines[: unit.lineno - 1]).strip("\n")
    defaults = "".join(
        f"{name.arg} = {ast.unparse(value)}\n" for name, value in zip(unit.args.args, unit.args.defaults, strict=True)
    )
    return unit.name, "\n".join(part for part in (front, f"{defaults}{body}") if part), note


def _folders(name: str, task: Task) -> tuple[str, str]:
    """Return the folders of the task folder in which a configuration may be: that of the task, and the one it names."""
    parts = [part for part in task.installation_directory.replace("\\", "/").split("/") if part not in ("", ".")]
    named = "" if ".." in parts else "".join(f"{part}/" for part in parts)
    beside = name.rpartition("/")[0]
    return "" if Path(name).is_absolute() or not beside else f"{beside}/", named


def _is_name(file: str) -> bool:
    """Return whether a task names a file, and no path."""
    return not any(sign in file for sign in "/\\\0")
