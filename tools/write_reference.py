"""Write the reference pages in docs/reference from the tables and functions that they describe.

Run it after a change to a command, an error code, a signal or a port: `python tools/write_reference.py`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "src"))

from elitescript import errors
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.page import CHAPTERS, chapters, kind_of, source_of
from elitescript.commands.registry import Command, Param
from elitescript.messages.signals import SIGNALS, Signal
from tools.line_port_pages import dashboard_page, interpreter_page
from tools.markdown import NOTICE, cell

FOLDER: Final = Path(__file__).resolve().parent.parent / "docs" / "reference"
_GITHUB_PUNCTUATION: Final = str.maketrans("", "", ",.:()'\"`/")


def commands_page() -> str:
    """Support matrix and every command in full."""
    simulated = sum(command.is_simulated for command in CATALOGUE)
    by_chapter = chapters(CATALOGUE)
    lines = [
        "# Commands",
        "",
        NOTICE,
        f"{len(CATALOGUE)} commands, {simulated} of them simulated. The others are known to the checker, check their",
        "arguments when they are called, and then raise `NotSimulatedError` with the reason.",
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
        lines.append(f"| [{CHAPTERS[family]}](#{_anchor(CHAPTERS[family])}) | {len(commands)} | {count} |")
    for family, commands in by_chapter.items():
        lines += ["", f"## {CHAPTERS[family]}", "", "| command | since | evidence | simulated |", "|---|---|---|---|"]
        for command in commands:
            mark = "yes" if command.is_simulated else "no"
            name = f"[`{cell(command.signature)}`](#{_anchor(command.name)})"
            lines.append(f"| {name} | {command.since} | {command.evidence} | {mark} |")
        for command in commands:
            lines += _command_section(command)
    return "\n".join(lines) + "\n"


def _command_section(command: Command) -> list[str]:
    details = command.details
    lines = ["", f"### {command.name}", "", f"`{command.signature}`", "", details.summary]
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


def errors_page() -> str:
    """Codes and exception classes."""
    lines = [
        "# Errors",
        "",
        NOTICE,
        "## Codes",
        "",
        "E0xx and E1xx keep a program from starting, W2xx are warnings, E3xx contradict the command catalogue (`check`",
        "fails, `run` warns), R are alarms of a running program.",
        "",
        "| code | severity | title |",
        "|---|---|---|",
    ]
    lines += [f"| {row.code} | {row.severity} | {cell(row.title)} |" for row in errors.CODES.values()]
    lines += [
        "",
        "## Exceptions that commands raise",
        "",
        "Scripts catch them as the built-in exceptions that they are as well.",
        "",
        "| class | is also | usual code | when |",
        "|---|---|---|---|",
    ]
    for kind in vars(errors).values():
        if not (isinstance(kind, type) and issubclass(kind, errors.ScriptError) and kind is not errors.ScriptError):
            continue
        builtin = ", ".join(f"`{base.__name__}`" for base in kind.__bases__ if base.__module__ == "builtins")
        when = (kind.__doc__ or "").split("\n")[0]
        lines.append(f"| `{kind.__name__}` | {builtin} | {kind.default_code} | {cell(when)} |")
    return "\n".join(lines) + "\n"


def signals_page() -> str:
    """I/O points, registers and flags."""
    lines = [
        "# Signals",
        "",
        NOTICE,
        "The names that `--set`, `robot.signals` and the `end` event use. A family of one is written without an index,",
        "`tool_analog_in`; the others with one, `standard_digital_in[3]`.",
        "",
        "| name | type | indices | direction | range | meaning |",
        "|---|---|---|---|---|---|",
    ]
    for signal in SIGNALS.values():
        indices = "" if signal.size == 1 else f"0 to {signal.size - 1}"
        direction = "input" if signal.is_input else "output"
        lines.append(
            f"| `{signal.name}` | {signal.kind} | {indices} | {direction} | {_range(signal)} | {signal.summary} |"
        )
    return "\n".join(lines) + "\n"


def _range(signal: Signal) -> str:
    if signal.low is None or signal.high is None:
        return signal.unit
    return f"{signal.low:.10g} to {signal.high:.10g} {signal.unit}".rstrip()


def _anchor(title: str) -> str:
    return title.lower().translate(_GITHUB_PUNCTUATION).replace(" ", "-")


PAGES: Final[dict[str, Callable[[], str]]] = {
    "commands.md": commands_page,
    "dashboard.md": dashboard_page,
    "errors.md": errors_page,
    "interpreter.md": interpreter_page,
    "signals.md": signals_page,
}


def main() -> int:
    """Write all pages."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, page in PAGES.items():
        (FOLDER / name).write_text(page(), encoding="utf-8", newline="\n")
        print(FOLDER / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
