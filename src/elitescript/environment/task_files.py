"""A graphical program on this computer: the `.task` file, what stands beside it, and its script."""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Callable
from functools import cache
from html import unescape
from pathlib import Path
from typing import Final

from elitescript.errors import ProgramError, UsageError
from elitescript.language.diagnostics import Diagnostic, diagnostic
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile, TreeFacts
from elitescript.models.model import RobotModel, load_model
from elitescript.paths import PROGRAM_SUFFIX
from elitescript.program_tree import (
    Configuration,
    Generated,
    GlobalVariable,
    Row,
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
from elitescript.untrusted.files import PROGRAM, Kind, opened, read_bytes

TASK: Final = Kind("task", 64 << 20)
"""Graphical programs."""
_HEAD_BYTES: Final = 1 << 16
_FIRST_TAG: Final = re.compile(r"<EliTask\b((?:[^>\"']|\"[^\"]*\"|'[^']*')*)>")
_ATTRIBUTE: Final = re.compile(r"([\w.:-]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
_ARM: Final = re.compile(r"<EliTask\b[^>]*?\srobotType\s*=\s*[\"']([^\"'<]*)")
_MARK: Final = "$ LINE"
_LINE_MARK: Final = re.compile(r"\$ LINE: \((\d{1,9}), \"((?:[^\"\\]|\\.)*)\"")
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
    return _program_at(Path(path), task_dir, read_bytes(path, TASK, is_stream_allowed=True), [])


def _program_at(path: Path, task_dir: str | Path | None, data: bytes, looked_at: list[Path]) -> TaskProgram:
    """Return the graphical program of a file; `looked_at` gets the paths at which files beside it may be."""
    home = Path(task_dir) if task_dir is not None else path.parent

    def read(name: str) -> bytes | None:
        for folder in (path.parent, home):
            looked_at.append(folder / name)
            try:
                if (folder / name).is_file():
                    return read_bytes(folder / name, _CONFIGURATION)
            except (OSError, ValueError):
                continue
        return None

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
                folders = _folders(name, task.installation_directory)
                content = next(filter(None, (read(f"{folder}{file}") for folder in folders)), None)
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


@record
class OpenedTask:
    """A graphical program as tools show it, whether it can run or not.

    Attributes:
        source: its script with the node of each line; the file as it is if it is no task.
        errors: what keeps it from running, in lines of `source`.
        program: the tree and its script; None if the file is no task, or one beside it is not what it should be.
        paths: of the files that it is made of, and of those that it would be made of if they were there.
    """

    source: SourceFile
    errors: tuple[Diagnostic, ...]
    program: TaskProgram | None
    paths: tuple[Path, ...]


def opened_task(path: str | Path, task_dir: str | Path | None = None, data: bytes | None = None) -> OpenedTask:
    """Return a graphical program to show it.

    Args:
        path: of the `.task` file.
        task_dir: the task folder; None: the folder of the file.
        data: the content, if that is not the one of the file.

    Raises:
        UsageError: a file cannot be read.
    """
    path = Path(path)
    data = read_bytes(path, TASK) if data is None else data
    looked_at: list[Path] = []
    try:
        program = _program_at(path, task_dir, data, looked_at)
    except TaskFileError as error:
        found, paths = SourceFile.to_show(str(path), data), (path, *looked_at)
        return OpenedTask(found, (_refusal(error, str(path)),), None, paths)
    source, errors = _source(program)
    return OpenedTask(source, errors, program, (path, *looked_at))


def _refusal(error: TaskFileError, name: str) -> Diagnostic:
    """Return what is wrong with a task of a name; what is wrong with a file beside it has its own place in the text."""
    if error.name != name:
        return diagnostic("E004", 1, 1, str(error))
    return diagnostic("E004", max(1, error.line), max(1, error.column), error.why)


def script_of_data(name: str, read: Callable[[str], bytes | None]) -> tuple[SourceFile, tuple[Diagnostic, ...]]:
    """Return the script of a graphical program of a task folder, with the node of each line, and what keeps it from
    running.

    Args:
        name: of the `.task` file in that folder.
        read: returns a file of the folder; None if there is none.
    """
    try:
        return _source(_program(name, read(name) or b"", read))
    except TaskFileError as error:
        return SourceFile(name, ""), (_refusal(error, name),)


def files_beside(name: str, data: bytes) -> tuple[str, ...]:
    """Return where the configuration of a graphical program of a task folder may be, and its variables.

    Args:
        name: of the `.task` file in that folder.
        data: its content; the first tag is looked at.
    """
    found = _FIRST_TAG.search(data[:_HEAD_BYTES].decode("utf-8", "replace"))
    given = {key: unescape(one or two) for key, one, two in _ATTRIBUTE.findall(found[1])} if found is not None else {}
    installation = given.get("installationName", "")
    if not installation or not _is_name(installation):
        return ()
    folders = _folders(name, given.get("installationDirectory", ""))
    endings = (".configuration", ".configuration.variables")
    return tuple(dict.fromkeys(f"{folder}{installation}{ending}" for ending in endings for folder in folders))


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
        raise ProgramError((_refusal(error, name),), name) from None
    source, errors = _source(program)
    if errors:
        raise ProgramError(errors, name)
    return source


def pendant_source(path: str | Path, task_dir: str | Path | None = None) -> SourceFile:
    """Return the script that the pendant has written beside a graphical program, with the node of each line.

    The nodes are those of its line marks; the tree, if it can be read, says in which node each of them stands.

    Raises:
        UsageError: there is no such script, or it cannot be read.
        ProgramError: it is not UTF-8.
    """
    path = Path(path)
    script = path.with_name(f"{path.name}{PROGRAM_SUFFIX}")
    if not script.is_file():
        raise UsageError(
            said("--generated: {script}, which the pendant writes beside a task, is not there", script=script)
        )
    source = SourceFile.from_bytes(str(script), read_bytes(script, PROGRAM))
    try:
        program = task_program(path, task_dir)
    except (UsageError, TaskFileError):
        return replace(source, places=_marked_places(source, ()), tree=TreeFacts())
    tree = TreeFacts(program.arm, (), program.script.installation, program.script.variables)
    return replace(source, places=_marked_places(source, program.script.rows), tree=tree)


def _marked_places(source: SourceFile, rows: tuple[Row, ...]) -> tuple[str, ...]:
    """Return the node of each line by the marks of a script: that of the nearest mark that is not indented further."""
    places: list[str] = []
    marks: list[tuple[int, str]] = []
    for line in source.lines:
        text = line.lstrip()
        indent = len(line) - len(text)
        if text:
            while marks and marks[-1][0] > indent:
                marks.pop()
        if found := _LINE_MARK.match(text):
            number, mark = int(found[1]), found[2].replace('\\"', '"')
            is_known = 0 < number <= len(rows) and rows[number - 1].mark == mark
            while marks and marks[-1][0] >= indent:
                marks.pop()
            marks.append((indent, place_of(rows, number) if is_known else f"{number} {mark}"))
        places.append(marks[-1][1] if marks else "")
    return tuple(places)


def refused_task(path: str | Path, task_dir: str | Path | None = None) -> SourceFile:
    """Return the text in which the problems of a refused task are: its script, or its file."""
    try:
        return _source(task_program(path, task_dir))[0]
    except TaskFileError:
        return SourceFile.to_show(str(path), read_bytes(path, TASK, is_stream_allowed=True))


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
    file_line = _file_lines(program)
    tree = TreeFacts(program.arm, script.unset, script.installation, script.variables, file_line)
    source = SourceFile(str(program.path), script.text, lines, notes, tree)
    return source, tuple(row for row in found if row.is_error)


def _file_lines(program: TaskProgram) -> Callable[[int], int]:
    """Return what gives the line of the file in which the node of a line of the script begins; the first for none."""
    script, task = program.script, program.task

    @cache
    def lines() -> dict[int, int]:
        return dict(
            zip((row.number for row in script.rows), task.lines_of([row.node for row in script.rows]), strict=True)
        )

    def file_line(line: int) -> int:
        row = script.line_rows[line - 1] if 0 < line <= len(script.line_rows) else 0
        return lines().get(row, 0) or 1

    return file_line


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


def _folders(name: str, directory: str) -> tuple[str, str]:
    """Return the folders of the task folder in which a configuration may be: that of the task, and the one it names."""
    parts = [part for part in directory.replace("\\", "/").split("/") if part not in ("", ".")]
    named = "" if ".." in parts else "".join(f"{part}/" for part in parts)
    beside = name.rpartition("/")[0]
    return "" if Path(name).is_absolute() or not beside else f"{beside}/", named


def _is_name(file: str) -> bool:
    """Return whether a task names a file, and no path."""
    return not any(sign in file for sign in "/\\\0")
