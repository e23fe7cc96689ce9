"""The page of the command line: every command with its arguments and options, from the parser itself."""

from __future__ import annotations

import argparse

from elitescript.cli import main
from tools.markdown import NOTICE


def command_line_page() -> str:
    """Write every command of the command line with its options."""
    _, subparsers = main._parser("")
    summaries = {choice.dest: choice.help or "" for choice in subparsers._choices_actions}
    lines = [
        "# Command line",
        "",
        NOTICE,
        "`elitescript COMMAND --help` prints the same.",
        "",
        "| command | what it does |",
        "|---|---|",
        *(f"| [`{name}`](#{name}) | {summaries[name]} |" for name in subparsers.choices),
    ]
    for name, command in subparsers.choices.items():
        lines += ["", f"## {name}", "", f"{command.description or summaries[name]}", ""]
        actions = [action for action in command._actions if action.help is not argparse.SUPPRESS]
        for action in actions:
            if not isinstance(action, argparse._HelpAction):
                lines.append(f"- {_names(action)}: {_help(action, command)}")
    return "\n".join(lines) + "\n"


def _names(action: argparse.Action) -> str:
    if not action.option_strings:
        return f"`{_value(action)}`"
    value = "" if action.nargs == 0 else f" {_value(action)}"
    return ", ".join(f"`{name}{value}`" for name in action.option_strings)


def _value(action: argparse.Action) -> str:
    if action.metavar is not None:
        return action.metavar if isinstance(action.metavar, str) else " ".join(action.metavar)
    if action.choices is not None:
        return "{" + ",".join(map(str, action.choices)) + "}"
    return action.dest.upper()


def _help(action: argparse.Action, command: argparse.ArgumentParser) -> str:
    values = {**vars(action), "prog": command.prog}
    return " ".join(((action.help or "") % values).split()).replace("*", "\\*")
