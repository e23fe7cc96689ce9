"""Makes the plan of a sweep from files: their texts go into it, so that no worker needs a disk."""

from __future__ import annotations

import ast
import re
from base64 import b64encode
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from elitescript.devices.scenario import python_files
from elitescript.environment.memory import FILES_BYTES_MAX, FILES_MAX
from elitescript.environment.program_file import source_of
from elitescript.errors import UsageError
from elitescript.kernel.arm import named_model
from elitescript.kernel.options import ROBOT_SECTION, UNTIL, accepted
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.paths import real_path, why_no_file
from elitescript.properties.parsing import function_place
from elitescript.sweep.chaos.profile import is_profile_file, profile_named, read_profile
from elitescript.sweep.failures.cases import is_case
from elitescript.sweep.plans.plan import Plan, Variation
from elitescript.sweep.plans.python_files import python_texts
from elitescript.sweep.plans.trees import tree_data
from elitescript.sweep.plans.variations import check_names, grid_size
from elitescript.sweep.results.page import REPLAYS
from elitescript.sweep.results.table_files import is_of_sweep
from elitescript.sweep.results.tables import columns
from elitescript.untrusted.files import PROFILE, TASK_FILE, read_bytes, read_text
from elitescript.world_file import arm_of_program, tables_of, world_text

RUNS: Final = 100
"""Runs of a sweep without a grid, unless it is said."""

RUNS_MAX: Final = 10**12
"""Runs of a sweep at most: those of a thousand processors in thirty years."""

_FILE_NAMES: Final = re.compile(r"\b(open|get_task_path|import|eval|exec|\w*file\w*|\w*micro\w*)\b")
"""Names of a program that reach its task folder."""


def runs_of(variations: Sequence[Variation], runs: int | None) -> int:
    """Return the number of runs: what is asked for, else every point of the grids once, else `RUNS`.

    Raises:
        UsageError: less than one, or more than anybody will see.
    """
    if runs is None:
        has_grid = any(row.kind == "grid" for row in variations)
        return grid_size(variations) if has_grid else RUNS
    if runs < 1:
        raise UsageError(f"--runs must be 1 or more, got {runs}")
    if runs > RUNS_MAX:
        raise UsageError(f"--runs must be {RUNS_MAX} at most, got {runs}")
    return runs


def make_plan(
    program: str | Path,
    *,
    world: str | Path | None = None,
    task_dir: str | Path | None = None,
    options: Mapping[str, Any] | None = None,
    settings: Iterable[str] = (),
    variations: Sequence[Variation] = (),
    seed: int = 0,
    until_s: float | None = None,
    ensure: Iterable[str] = (),
    measures: Mapping[str, str] | None = None,
    chaos: str = "",
    step_s: float | None = None,
    has_margins: bool = False,
    without_files: Collection[Path] = (),
    is_generated: bool = False,
) -> Plan:
    """Return the plan of a sweep.

    Args:
        program: a path, or a program text.
        world: path of the world file.
        task_dir: folder that every run gets a copy of, in memory; that of the program's file if None.
        options: of the robot, as JSON has them; the model may be the path of an own arm.
        settings: `NAME=VALUE` as of `--set`.
        variations: what is drawn.
        seed: of everything that is drawn.
        until_s: limit of virtual time, s.
        ensure: properties; `FILE.py:function` with a path from the working folder.
        measures: expressions by name; likewise.
        chaos: name of a profile, or the path of a profile file.
        step_s: time between two rows that properties over time see, s; each tick if None.
        has_margins: whether rows have the margin of each property.
        is_generated: of a graphical program, run the script that the pendant has written beside it.
        without_files: that are left out of the task folder: the results themselves; so are cases and replays.

    Raises:
        UsageError: a file cannot be read, is too large, or something makes no sense.
        ProgramError: the program is not UTF-8.
    """
    check_names(variations)
    if until_s is not None:
        accepted(UNTIL, until_s, "--until")
    source = source_of(program, task_dir, is_generated=is_generated)
    is_file = not source.name.startswith("<")
    path = Path(source.name)
    python: dict[str, str] = {}
    chosen = dict(options or {})
    text = ""
    if world is not None:
        text = world_text(Path(world))
        tables = tables_of(Path(world), text)
        python |= python_texts(Path(world).parent, python_files(tables))
        robot = tables.get(ROBOT_SECTION)
        if "model" not in chosen and isinstance(robot, dict) and isinstance(name := robot.get("model"), str):
            own = Path(world).parent / name
            chosen["model"] = str(own) if own.suffix == ".toml" else name
    if "model" not in chosen and is_file and (arm := arm_of_program(program, world)):
        chosen["model"] = arm
    if "model" in chosen:
        chosen |= named_model(chosen["model"])[1]
    ensure = tuple(_with_files(text, python) for text in ensure)
    measures = {name: _with_files(text, python) for name, text in (measures or {}).items()}
    folder = Path(task_dir) if task_dir is not None else real_path(path).parent if is_file else None
    files: dict[str, str] = {}
    if folder is not None and (task_dir is not None or _reaches_files(source)):
        files = _task_files(folder, {*map(Path.resolve, without_files)})
    plan = Plan(
        program=source.text,
        program_name=path.name if is_file else source.name,
        tree=tree_data(source),
        files=files,
        world=text,
        world_name=Path(world).name if world is not None else "",
        python=python,
        options=chosen,
        settings=tuple(settings),
        variations=tuple(variations),
        seed=seed,
        until_s=until_s,
        ensure=ensure,
        measures=measures,
        chaos=_profile_text(chaos),
        step_s=step_s,
        has_margins=has_margins,
    )
    columns(plan)
    return plan


def _reaches_files(source: SourceFile) -> bool:
    """Return whether a program has a name that reaches its task folder; texts and comments do not count."""
    parsed = parse(source)
    if parsed.has_errors:
        return bool(_FILE_NAMES.search(source.text))
    for node in ast.walk(parsed.tree):
        name = node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
        if _FILE_NAMES.fullmatch(name) or isinstance(node, ast.Import | ast.ImportFrom):
            return True
    return False


def _with_files(expression: str, python: dict[str, str]) -> str:
    """Return a property as a plan has it; the file of `FILE.py:function` is put among the Python files, by its name.

    Raises:
        UsageError: the file cannot be read, or another one has its name already.
    """
    place = function_place(expression)
    if place is None:
        return expression
    path = Path(place[0])
    for name, text in python_texts(path.parent, [path.name]).items():
        if python.setdefault(name, text) != text:
            raise UsageError(f"{path.parent / name}: another file is called {name}; rename one of them")
    return f"{path.name}:{place[1]}"


def _profile_text(chaos: str) -> str:
    if not chaos or chaos.isidentifier():
        return chaos
    if not is_profile_file(chaos) and not why_no_file(chaos):
        profile_named(chaos)
    text = read_text(chaos, PROFILE)
    # What is wrong in it is said with the name of the file, which a plan does not have.
    read_profile(text, chaos)
    return text


def _is_left_out(folder: str) -> bool:
    """Return whether a folder is none that programs use: caches, and what sweeps have written."""
    return folder in _NOT_COPIED or folder.endswith(REPLAYS)


def _task_files(folder: Path, left_out: Collection[Path]) -> dict[str, str]:
    """Return the files of a task folder as Base64.

    Raises:
        UsageError: there is no such folder, or it is too large.
    """
    import os

    if not folder.is_dir():
        raise UsageError(f"the task folder {str(folder)!r} does not exist")
    found: dict[str, str] = {}
    size = 0
    for home, inner, names in os.walk(folder):
        inner[:] = sorted(name for name in inner if not name.startswith(".") and not _is_left_out(name))
        for name in sorted(names):
            path = Path(home, name)
            if (
                name.startswith(".")
                or is_case(name)
                or is_of_sweep(name)
                or path.is_symlink()
                or not path.is_file()
                or real_path(path) in left_out
            ):
                continue
            size += path.stat().st_size
            if len(found) == FILES_MAX or size > FILES_BYTES_MAX:
                raise UsageError(
                    f"the task folder {folder} holds more than {FILES_BYTES_MAX // 10**6} MB or {FILES_MAX} files, "
                    "which every run would get a copy of; name a smaller one with --task-dir"
                )
            found[path.relative_to(folder).as_posix()] = b64encode(read_bytes(path, TASK_FILE)).decode()
    return found


_NOT_COPIED: Final = ("node_modules", "__pycache__")
