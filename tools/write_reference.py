"""Write the reference pages in docs/reference from the tables and functions that they describe.

Run it after a change to a command, an error code or a signal: `python tools/write_reference.py`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "src"))

from elitescript import errors
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.page import CHAPTERS, chapters, kind_of, source_of
from elitescript.commands.registry import Command, Param
from elitescript.messages.signals import SIGNALS, Signal
from elitescript.protocol import primary
from elitescript.protocol.binary import Field
from elitescript.protocol.primary_commands import COMMANDS
from elitescript.protocol.primary_messages import HEAD, KINDS, MAX_TEXT_BYTES, MessageKind
from elitescript.protocol.primary_packets import STATE_SIZE, SUB_MESSAGES, SubMessage

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


def _range(signal: Signal) -> str:
    if signal.low is None or signal.high is None:
        return signal.unit
    return f"{signal.low:.10g} to {signal.high:.10g} {signal.unit}".rstrip()


def primary_page() -> str:
    """Ports, messages and commands of the primary port and its relatives."""
    lines = [
        "# Primary port",
        "",
        _NOTICE,
        "Robot state and messages go out, programs and plain commands come in. Numbers are big-endian. `@` is the",
        "offset in bytes from the first byte of the message or sub-message, its head included.",
        "",
        "*documented*: in the vendor's client code or pages; *observed*: in other public clients; *assumed*: decided",
        "here.",
        "",
        "## Ports",
        "",
        "| port | name | states in a second | messages | programs | evidence | what it does |",
        "|---:|---|---:|---|---|---|---|",
    ]
    for port in primary.PORTS:
        does = " | ".join("yes" if what else "no" for what in (port.sends_messages, port.takes_programs))
        lines.append(f"| {port.number} | {port.name} | {port.rate} | {does} | {port.evidence} | {port.summary} |")
    lines += [
        "",
        "The first state comes at once, the others on ticks that all clients share. Robot messages leave at least",
        f"{primary.SPACING_TICKS} ticks apart; {primary.MAX_WAITING} may wait for a client, then texts are lost before",
        "errors.",
        "",
        "## Robot state",
        "",
        f"A head of 5 bytes (length, type 16), then {len(SUB_MESSAGES)} sub-messages in this order; {STATE_SIZE} bytes",
        "together.",
        "",
        "| sub-message | type | bytes | evidence for the type |",
        "|---|---:|---:|---|",
    ]
    lines += [
        f"| [{part.name}](#{_anchor(part.name)}) | {part.number} | {part.size} | {part.evidence} |"
        for part in SUB_MESSAGES
    ]
    for part in SUB_MESSAGES:
        lines += _sub_message_section(part)
    lines += [
        "",
        "## Robot messages",
        "",
        "Type 20. All begin with the same head. The last text of a message goes to its end, is cut at",
        f"{MAX_TEXT_BYTES} bytes, and has a zero byte behind it (*assumed*); a text before it has its length in front,",
        "one byte.",
        "",
        *_field_table(HEAD, 0),
    ]
    for kind in KINDS:
        lines += _message_section(kind)
    lines += [
        "",
        "## What comes in",
        "",
        "A text stream. `def name():` to `end` at the start of a line is a program and replaces the one that runs;",
        "`sec name():` to `end` runs beside it; any other line is a program of its own or one of the plain commands",
        "below. Nothing is answered but what goes wrong. An `end` or a line without a line feed counts after",
        f"{primary.SILENCE_TICKS} ticks without a byte, or when the client closes; a program that is still open then",
        f"is refused. At most {primary.MAX_UNITS_PER_TICK} units of a client run in one tick. In local control",
        "everything is refused (*assumed*). A refusal is a script exception for the client and a line of the log.",
        "",
        "| plain command | what the vendor's client watches afterwards |",
        "|---|---|",
    ]
    for command in COMMANDS:
        argument = " F" if command.takes_fraction else ""
        lines.append(f"| `{command.words}{argument}` | {command.confirmation} |")
    return "\n".join([*lines, "", "F is a fraction from 0 to 1, such as 0.50."]) + "\n"


def _sub_message_section(part: SubMessage) -> list[str]:
    lines = ["", f"### {part.name.capitalize()}", "", f"Type {part.number}, {part.size} bytes."]
    if part.repeats > 1:
        record = (part.size - 5) // part.repeats
        lines += ["", f"{part.repeats} records of {record} bytes, one for each joint; offsets are those of the first."]
    return [*lines, "", *_field_table([row.field for row in part.rows], part.offsets()[0])]


def _message_section(kind: MessageKind) -> list[str]:
    own = kind.fields.fields[len(HEAD) :]
    lines = [
        "",
        f"### {kind.name.capitalize()}",
        "",
        f"Kind {kind.number}, {kind.evidence}. Sent for: {kind.summary}.",
        "",
    ]
    if own:
        lines += [*_field_table(own, kind.fields.offsets()[len(HEAD)]), ""]
    return [*lines, f"Then: {', '.join(kind.texts)}."]


def _field_table(fields: Sequence[Field], first: int) -> list[str]:
    lines = ["| @ | type | field | unit | evidence | |", "|---:|---|---|---|---|---|"]
    at = first
    for field in fields:
        cells = (at, field.type.name, field.name, field.unit, field.evidence, _cell(field.summary))
        lines.append("| " + " | ".join(map(str, cells)) + " |")
        at += field.type.size
    return lines


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _anchor(title: str) -> str:
    return title.lower().translate(_GITHUB_PUNCTUATION).replace(" ", "-")


PAGES: Final[dict[str, Callable[[], str]]] = {
    "commands.md": commands_page,
    "errors.md": errors_page,
    "primary.md": primary_page,
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
