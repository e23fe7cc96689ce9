"""Options of a robot on the command line, from `kernel.options`."""

from __future__ import annotations

import os
from typing import Any, Final

from elitescript.cli.plain_call import OMITTED, PlainCall
from elitescript.cli.settings import parse_epoch, parse_joints
from elitescript.kernel.options import DEFAULTS, OPTIONS, Joints, Number, Option, Switch, Text, Time, Whole, accept
from elitescript.paths import file_above, is_task_name

PROJECT: Final = "pyproject.toml"

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def add_options(parser: argparse.ArgumentParser | PlainCall, command: str, **changed: dict[str, Any]) -> None:
    """Add the options of a robot that a command has.

    Args:
        parser: of the command.
        command: its name.
        **changed: by option, arguments of `add_argument` that differ for this command.
    """
    for name, option in OPTIONS.items():
        if command in option.commands:
            # Only given options are in the result: a world file may have the others.
            settings = {"dest": name, "default": OMITTED, "help": help_text(name), **_form(name, option)}
            if name == "model":
                settings["reads"] = "arm"
            parser.add_argument(option.flag, **{**settings, **changed.get(name, {})})


def help_text(name: str) -> str:
    """Return the help text of an option, with its default."""
    option, default = OPTIONS[name], DEFAULTS[name]
    if isinstance(option.kind, Switch):
        return option.text
    if option.default_text:
        return f"{option.text} (default: {option.default_text})"
    return f"{option.text} (default {default if isinstance(default, str) else f'{default:g}'})"


def _form(name: str, option: Option) -> dict[str, Any]:
    kind = option.kind
    if isinstance(kind, Switch):
        return {"action": "store_const", "const": not DEFAULTS[name]}
    if isinstance(kind, Text) and kind.choices:
        return {"choices": list(kind.choices)}
    form: dict[str, Any] = {"metavar": option.metavar}
    if isinstance(kind, Whole):
        form["type"] = int
    elif isinstance(kind, Number) and not isinstance(kind, Time):
        form["type"] = float
    return form


def options_from(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the options of a robot that the command line gives.

    Raises:
        UsageError: an invalid value; the text names the flag.
    """
    given: dict[str, Any] = {}
    for name, option in OPTIONS.items():
        if option.flag and name in arguments:
            value = getattr(arguments, name)
            if isinstance(option.kind, Joints):
                value = parse_joints(value)
            elif isinstance(option.kind, Time):
                value = parse_epoch(value)
            given[name] = accept(name, value, option.flag)
    if "ignore" not in given and getattr(arguments, "command", "") in OPTIONS["ignore"].commands:
        project = file_above(_folder_of(arguments), PROJECT)
        if project is not None and (codes := _ignored_in(project)):
            given["ignore"] = accept("ignore", codes, "pyproject.toml: [tool.elitescript] ignore")
    is_run = "model" not in given and getattr(arguments, "command", "") in _ARM_OF_TASK
    if is_run and is_task_name(arguments.file or ""):
        # Imported late: few programs are graphical.
        from elitescript.world_file import arm_of_program

        if arm := arm_of_program(arguments.file, arguments.world):
            given["model"] = arm
    return given


_ARM_OF_TASK: Final = ("run", "plot")
"""Commands that run a graphical program on the arm for which it was made, if no other is named."""


def _ignored_in(project: str) -> str:
    # Imported late: few programs are in a project of Python.
    from elitescript.environment.project import project_ignore

    return project_ignore(project)


def _folder_of(arguments: argparse.Namespace) -> str:
    """Return the folder of the program of a call; of several, the working directory."""
    files = getattr(arguments, "files", None) or [getattr(arguments, "file", None)]
    if len(files) != 1 or not files[0]:
        return os.curdir
    file: str = files[0]
    return file if os.path.isdir(file) else os.path.dirname(file)  # noqa: PTH112, PTH120 - see project.py
