"""Write the reference pages in docs/reference from the tables and functions that they describe.

Run it after a change to a command, an error code, a signal or a variable of a port: `python tools/write_reference.py`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "src"))

from elitescript import errors
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.page import CHAPTERS, chapters, kind_of, source_of
from elitescript.commands.registry import Command, Param
from elitescript.messages.signals import SIGNALS, Signal
from elitescript.protocol import rtsi, rtsi_recipes
from elitescript.protocol.rtsi_inputs import INPUT_ROWS, InputVariable
from elitescript.protocol.rtsi_variables import OUTPUT_ROWS, OutputVariable

FOLDER: Final = Path(__file__).resolve().parent.parent / "docs" / "reference"
COMMAND: Final = "python tools/write_reference.py"

_NOTICE: Final = f"<!-- Written by `{COMMAND}`; do not edit. -->\n"
_GITHUB_PUNCTUATION: Final = str.maketrans("", "", ",.:()'\"`/")


def commands_page() -> str:
    """Support matrix and every command in full."""
    simulated = sum(command.is_simulated for command in CATALOGUE)
    by_chapter = chapters(CATALOGUE)
    lines = [
        "# Commands",
        "",
        _NOTICE,
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
            name = f"[`{_cell(command.signature)}`](#{_anchor(command.name)})"
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
        _NOTICE,
        "## Codes",
        "",
        "E0xx and E1xx keep a program from starting, W2xx are warnings, E3xx contradict the command catalogue (`check`",
        "fails, `run` warns), R are alarms of a running program.",
        "",
        "| code | severity | title |",
        "|---|---|---|",
    ]
    lines += [f"| {row.code} | {row.severity} | {_cell(row.title)} |" for row in errors.CODES.values()]
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
        lines.append(f"| `{kind.__name__}` | {builtin} | {kind.default_code} | {_cell(when)} |")
    return "\n".join(lines) + "\n"


def signals_page() -> str:
    """I/O points, registers and flags."""
    lines = [
        "# Signals",
        "",
        _NOTICE,
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


def rtsi_page() -> str:
    """Commands, types and variables of the RTSI port."""
    low, high = rtsi_recipes.FREQUENCY_MIN_HZ, rtsi_recipes.FREQUENCY_MAX_HZ
    types = {row.type.name: row.type.size for row in (*OUTPUT_ROWS, *INPUT_ROWS)}
    lines = [
        "# RTSI",
        "",
        _NOTICE,
        "Port 30004: typed variables both ways. Integers and floats are big-endian.",
        "",
        "*vendor's client*, *third-party client*: it sends or reads exactly this; *documented*: in a page of the",
        "vendor; *assumed*: decided here.",
        "",
        "## Messages",
        "",
        "A message is a u16, its size with this head, a u8, the letter of its command, and up to",
        f"{rtsi.MESSAGE_MAX - 3} bytes. Names and types are separated by commas.",
        "",
        "| command | name | client sends | controller sends |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| `{row.letter}` ({ord(row.letter)}) | {row.name} | {row.question} | {row.answer} |" for row in rtsi.COMMANDS
    ]
    lines += [
        "",
        f"- Recipes have numbers 1 to {rtsi.RECIPES_MAX}, apart for outputs and inputs. A set-up that fails has number",
        f"  0 (*assumed*). `{rtsi.NOT_FOUND}` stands in place of the type of a variable that there is not,",
        f"  `{rtsi.IN_USE}` of an input that another client has claimed. Inputs are free again when the connection of",
        "  their client ends.",
        f"- A client has {rtsi.VARIABLES_MAX} variables at most in all its recipes of one direction (*assumed*).",
        f"- Frequencies are {low:g} to {high:g} Hz; others are clamped, and a text message says so (*assumed*).",
        "- The first package of each recipe follows the start at once; n ticks later a recipe of f Hz has sent",
        "  floor(n f / 250) more. Values are those of the tick.",
        "- Inputs count while data flows and while it is paused, in local control too (*assumed*).",
        "- What cannot be obeyed is ignored and answered with a text message, at most once a second for each kind: a",
        "  package of a wrong size or of no recipe, a value out of range, an unknown command. A size below 3 ends the",
        "  connection (*assumed*).",
        "",
        "## Types",
        "",
        "| type | bytes |",
        "|---|---:|",
        *(f"| {name} | {size} |" for name, size in sorted(types.items())),
    ]
    for title, rows in (("Output variables", OUTPUT_ROWS), ("Input variables", INPUT_ROWS)):
        head = "| name | type | unit | meaning | evidence |"
        lines += ["", f"## {title}", "", head, "|---|---|---|---|---|", *(_variable(row) for row in rows)]
    return "\n".join(lines) + "\n"


def _variable(row: OutputVariable | InputVariable) -> str:
    name = f"`{row.name.replace('#', 'N')}`"
    if "#" in row.name:
        name += f", N = {row.indices[0]} to {row.indices[-1]}"
    return f"| {name} | {row.type.name} | {row.unit} | {_cell(row.summary)} | {row.evidence} |"


def _range(signal: Signal) -> str:
    if signal.low is None or signal.high is None:
        return signal.unit
    return f"{signal.low:.10g} to {signal.high:.10g} {signal.unit}".rstrip()


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _anchor(title: str) -> str:
    return title.lower().translate(_GITHUB_PUNCTUATION).replace(" ", "-")


PAGES: Final[dict[str, Callable[[], str]]] = {
    "commands.md": commands_page,
    "errors.md": errors_page,
    "rtsi.md": rtsi_page,
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
