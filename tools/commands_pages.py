"""The command reference: an index, and a page for each family of commands."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.page import CHAPTERS, chapters, kind_of, source_of
from elitescript.commands.definition.registry import Command, Param
from tools.markdown import NOTICE, cell

INDEX: Final = "commands/index.md"


def family_page_name(family: str) -> str:
    """Name the page of a family, relative to docs/reference."""
    return f"commands/{family.replace('_', '-')}.md"


def index_page() -> str:
    """Write what holds for all commands, and list them by chapter with links."""
    simulated = sum(command.is_simulated for command in CATALOGUE)
    by_chapter = chapters(CATALOGUE)
    lines = [
        "# Commands",
        "",
        NOTICE,
        *_how_many(len(CATALOGUE), simulated),
        "",
        "- Lengths are in m, angles in rad, times in s, unless a unit in brackets says otherwise.",
        "- A pose is `[x, y, z, Rx, Ry, Rz]`, roll-pitch-yaw about the fixed axes x, y, z.",
        "- Joints are `[base, shoulder, elbow, wrist1, wrist2, wrist3]`.",
        "- bool and int stand for each other, an int stands for a float. NaN, infinity, a wrong length and text for a",
        "  number are errors.",
        "- *documented*: in a manual; *observed*: in real programs or clients; *assumed*: decided here.",
        "",
        "| chapter | commands | simulated |",
        "|---|---:|---:|",
    ]
    for family, commands in by_chapter.items():
        count = sum(command.is_simulated for command in commands)
        lines.append(f"| [{CHAPTERS[family]}]({_file(family)}) | {len(commands)} | {count} |")
    lines += ["", "## All by name", "", "| command | what it does |", "|---|---|"]
    for command in sorted(CATALOGUE, key=lambda command: command.name.lower()):
        link = f"[`{command.name}`]({_file(command.family)}#{command.name.lower()})"
        lines.append(f"| {link} | {cell(' '.join(command.details.summary.split()))} |")
    return "\n".join(lines) + "\n"


def family_page(family: str) -> str:
    """Write every command of one family in full; the anchor of a command is its name."""
    commands = chapters(CATALOGUE)[family]
    lines = [
        f"# Commands: {CHAPTERS[family]}",
        "",
        NOTICE,
        "[All commands](index.md), and what holds for every one of them.",
        "",
        "| command | since | evidence |",
        "|---|---|---|",
    ]
    for command in commands:
        name = f"[`{cell(command.signature)}`](#{command.name.lower()})"
        evidence = command.evidence if command.is_simulated else f"{command.evidence}, not simulated"
        lines.append(f"| {name} | {command.since} | {evidence} |")
    for command in commands:
        lines += _command_section(command)
    return "\n".join(lines) + "\n"


def _file(family: str) -> str:
    return family_page_name(family).removeprefix("commands/")


def _how_many(commands: int, simulated: int) -> tuple[str, ...]:
    if simulated == commands:
        return (f"{commands} commands, all of them simulated.",)
    return (
        f"{commands} commands, {simulated} of them simulated. The others are known to the checker, check their",
        "arguments when they are called, and then raise `NotSimulatedError` with the reason.",
    )


def _command_section(command: Command) -> list[str]:
    details = command.details
    lines = ["", f"## {command.name}", "", f"`{command.signature}`", "", details.summary]
    if details.behaviour:
        lines += ["", details.behaviour]
    if command.params:
        lines += ["", *(_argument(param) for param in command.params)]
    if details.returns_text:
        lines += ["", f"Returns {kind_of(details.returns)}: {details.returns_text}"]
    if details.raises:
        lines += ["", *(f"- raises `{name}`: {text}" for name, text in details.raises.items())]
    facts = [source_of(command).capitalize()]
    for name in command.aliases:
        other = CATALOGUE.get(name)
        assert other is not None
        facts.append(f"also called `{name}` ({source_of(other)})")
    facts += [] if command.works_in_sec else ["not in secondary programs"]
    facts += [] if command.is_simulated else ["not simulated yet"]
    return [*lines, "", "; ".join(facts) + "."]


def _argument(param: Param) -> str:
    default = "" if param.is_required else f", default `{param.default_text}`"
    other = f" Also written {', '.join(f'`{spelling}`' for spelling in param.spellings)}." if param.spellings else ""
    return f"- `{param.name}` ({kind_of(param.quantity)}{default}): {param.text}{other}"


COMMAND_PAGES: Final[dict[str, Callable[[], str]]] = {
    INDEX: index_page,
    **{family_page_name(family): partial(family_page, family) for family in CHAPTERS},
}
"""What writes each page, by its name relative to docs/reference."""
