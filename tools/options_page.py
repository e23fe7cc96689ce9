"""Written from the options of a robot: their reference page, and the types of the keywords of `VirtualRobot`."""

from __future__ import annotations

from dataclasses import fields
from textwrap import fill
from typing import Any, Final

from elitescript.kernel.option_signature import described
from elitescript.kernel.options import IN_VIRTUAL_TIME, KEYWORDS, OPTIONS, ROBOT_SECTION, RobotOptions, Section, Switch
from tools.markdown import COMMAND, NOTICE, cell

_TYPES: Final = {
    "Six": "elitescript.messages.motion",
    "ContactConfig": "elitescript.controller.force.contact",
    "SafetyLimits": "elitescript.controller.safety.limits",
    "PlantConfig": "elitescript.messages.plant",
}
"""Where the types that annotations name come from."""


def options_page() -> str:
    """Every option: what it means, where it is set, its default."""
    lines = [
        "# Options of a robot",
        "",
        NOTICE,
        "What a robot is made with. Every option is a keyword of `VirtualRobot` (`model` is its first argument), and",
        f"a key of the section `[{ROBOT_SECTION}]` of a world file or, at the end of the table, a section of its own.",
        "Many are options of the command line as well; those of `serve` are of all its robots.",
        "",
        "The command line, or a keyword, counts more than the world file, and that more than the default. A section",
        "that a keyword and the world file both give is refused.",
        "",
        "```toml",
        f"[{ROBOT_SECTION}]",
        'model = "CS63"            # or a file beside this one, "my_arm.toml"',
        'firmware = "2.14"',
        "joints = [0.0, -1.57, -1.57, -1.57, 1.57, 0.0]",
        "speed = 0.5",
        "```",
        "",
        "| option | command line | value | default | meaning |",
        "|---|---|---|---|---|",
    ]
    sections = []
    for row in fields(RobotOptions):
        option = OPTIONS[row.name]
        if option.kind is None:
            continue
        default = option.default_text or _shown(row.default)
        if row.name in IN_VIRTUAL_TIME:
            default += f"; of `VirtualRobot`, {_shown(IN_VIRTUAL_TIME[row.name])}"
        if isinstance(option.kind, Section):
            sections.append(
                f"| `[{row.name}]` | | {cell(str(option.kind))} of Python, a section of a world file | {cell(default)} "
                f"| {cell(option.text)} |"
            )
            continue
        lines.append(
            f"| `{row.name}` | {_flag(row.name)} | {cell(str(option.kind))} | {cell(default)} | {cell(option.text)} |"
        )
    return "\n".join(lines + sections) + "\n"


def _flag(name: str) -> str:
    option = OPTIONS[name]
    if not option.flag:
        return ""
    metavar = "" if isinstance(option.kind, Switch) or not option.metavar else f" {option.metavar}"
    return f"`{cell(option.flag + metavar)}` of {', '.join(f'`{command}`' for command in option.commands)}"


def _shown(default: Any) -> str:
    if default is None:
        return "nothing"
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    return f'`"{default}"`' if isinstance(default, str) else f"`{default:g}`"


def keywords_module() -> str:
    """The module with the types of the keywords."""
    rows = [row for row in fields(RobotOptions) if row.name in KEYWORDS]
    words = {word for row in rows for word in str(row.type).replace("|", " ").split()}
    imports = sorted(f"    from {home} import {name}" for name, home in _TYPES.items() if name in words)
    lines = [
        f'"""Types of the options that `VirtualRobot` takes. Written by `{COMMAND}`; do not edit."""',
        "",
        "from __future__ import annotations",
        "",
        "from typing import TYPE_CHECKING, TypedDict",
        "",
        "if TYPE_CHECKING:",
        *imports,
        "",
        "",
        "class RobotKeywords(TypedDict, total=False):",
        '    """Options by their names; those of `RobotOptions` that users set."""',
        "",
    ]
    for row in rows:
        lines += [
            f"    {row.name}: {row.type}",
            fill(f'    """{described(row.name)}"""', 118, subsequent_indent="    "),
        ]
    return "\n".join(lines) + "\n"
