"""Describes commands as text: one in full, or all as a list."""

from __future__ import annotations

from textwrap import wrap
from typing import Any, Final

from elitescript.commands.definition.quantities import Quantity
from elitescript.commands.definition.registry import Catalogue, Command

CHAPTERS: Final[dict[str, str]] = {
    "motion": "Motion",
    "math": "Math and kinematics",
    "force": "Force control",
    "io": "Inputs and outputs",
    "registers": "Registers",
    "serial": "Serial ports",
    "modbus_rtu": "MODBUS-RTU",
    "modbus": "MODBUS TCP",
    "socket": "TCP sockets",
    "rpc": "Remote procedure calls",
    "thread": "Threads",
    "task": "Task and interpreter mode",
    "message": "Messages",
    "string": "Strings",
    "system": "System",
    "observed": "Seen in real programs, in no manual",
}
"""Family of a command and its title, in the order of the manual."""

_WIDTH: Final = 100
_INDENT: Final = "    "


def kind_of(quantity: Quantity) -> str:
    """Return the type, unit and range of a value, as the lists of arguments print them."""
    limits = [part for part in quantity.limit.split(", ") if part and not part.endswith(" elements")]
    return ", ".join([quantity.type_name, *limits]) + (f" [{quantity.unit}]" if quantity.unit else "")


def source_of(command: Command) -> str:
    """Return the release that brought the command, and the evidence for it."""
    text = f"since {command.since}, {command.evidence}"
    if not command.manual or command.alias_of:
        return text
    release, _, section = command.manual.rpartition(": ")
    return f"{text}, manual {release or '2.10'} section {section}"


def chapters(catalogue: Catalogue) -> dict[str, list[Command]]:
    """Return the commands of each family, by name."""
    found: dict[str, list[Command]] = {family: [] for family in CHAPTERS}
    for command in sorted(catalogue, key=lambda command: command.name):
        found[command.family].append(command)
    return found


def describe(command: Command) -> str:
    """Return everything about one command, for the terminal."""
    details = command.details
    lines = [command.signature, "", *_paragraphs(details.summary)]
    if details.behaviour:
        lines += ["", *_paragraphs(details.behaviour)]
    if command.params:
        lines += ["", "Arguments:"]
        for param in command.params:
            default = "" if param.is_required else f", default {param.default_text}"
            lines += _entry(f"{param.name} ({kind_of(param.quantity)}{default})", param.text)
            if param.spellings:
                lines.append(f"{_INDENT}{_INDENT}Also written {', '.join(param.spellings)}.")
    if details.returns_text:
        lines += ["", "Returns:", *_entry(kind_of(details.returns), details.returns_text)]
    if details.raises:
        lines += ["", "Raises:"]
        for name, text in details.raises.items():
            lines += _entry(name, text)
    lines += ["", *notes(command)]
    return "\n".join(lines)


def index(catalogue: Catalogue) -> str:
    """Return all commands by chapter, one a line, for the terminal."""
    lines = []
    for family, commands in chapters(catalogue).items():
        lines += [f"{CHAPTERS[family]} ({len(commands)})", *(_row(command) for command in commands), ""]
    simulated = sum(command.is_simulated for command in catalogue)
    lines.append(f"{len(catalogue)} commands, {simulated} simulated; (-) marks those that are not yet")
    return "\n".join(lines)


def matches(catalogue: Catalogue, word: str) -> list[Command]:
    """Return commands that a word finds: by name first, then by parameters, then by their texts.

    Args:
        catalogue: all commands.
        word: letters, in any case; several words must all be found.
    """
    words = word.lower().split()
    ranked = []
    for command in catalogue:
        details = command.details
        names = " ".join((command.name, *command.aliases)).lower()
        params = " ".join(text for param in command.params for text in (param.name, *param.spellings)).lower()
        texts = (details.summary, details.behaviour, details.returns_text, *(param.text for param in command.params))
        places = (names, params, " ".join(texts).lower())
        ranks = [next((rank for rank, place in enumerate(places) if part in place), None) for part in words]
        if ranks and None not in ranks:
            ranked.append((max(rank for rank in ranks if rank is not None), command.name, command))
    return [command for _, _, command in sorted(ranked, key=lambda item: item[:2])]


def row_of(command: Command) -> str:
    """Return one command in a line: name and what it does."""
    mark = "" if command.is_simulated else "(not simulated) "
    return f"{command.name:<36} {mark}{' '.join(command.details.summary.split())}"


def record(command: Command) -> dict[str, Any]:
    """Return all that is known of a command, as plain values."""
    details = command.details
    return {
        "name": command.name,
        "signature": command.signature,
        "family": command.family,
        "since": command.since,
        "evidence": command.evidence,
        "manual": command.manual,
        "alias_of": command.alias_of or None,
        "aliases": list(command.aliases),
        "simulated": command.is_simulated,
        "in_secondary": command.works_in_sec,
        "summary": " ".join(details.summary.split()),
        "description": details.behaviour,
        "parameters": [
            {
                "name": param.name,
                "type": param.quantity.type_name,
                "unit": param.quantity.unit,
                "range": param.quantity.limit,
                "required": param.is_required,
                "default": None if param.is_required else param.default_text,
                "spellings": list(param.spellings),
                "description": param.text,
            }
            for param in command.params
        ],
        "returns": {"type": kind_of(details.returns), "description": details.returns_text}
        if details.returns_text
        else None,
        "raises": dict(details.raises),
    }


def _row(command: Command) -> str:
    mark = "   " if command.is_simulated else "(-)"
    since = "" if command.since == "2.10" else f"  since {command.since}"
    return f"  {mark} {command.signature}{since}"


def notes(command: Command) -> list[str]:
    """Return what is to be known besides: release, evidence, other names, limits; one sentence each."""
    notes = [source_of(command).capitalize() + "."]
    if command.alias_of:
        notes.append(f"Another name of {command.alias_of}.")
    if command.aliases:
        notes.append(f"Also called {', '.join(command.aliases)}.")
    if not command.works_in_sec:
        notes.append("Not in secondary programs.")
    if not command.is_simulated:
        notes.append("Not simulated yet: a call checks its arguments and then raises NotSimulatedError.")
    return notes


def _paragraphs(text: str) -> list[str]:
    lines: list[str] = []
    for paragraph in text.split("\n\n"):
        lines += [*([""] if lines else []), *wrap(" ".join(paragraph.split()), _WIDTH)]
    return lines


def _entry(head: str, text: str) -> list[str]:
    body = _INDENT + _INDENT
    return [
        *wrap(head, _WIDTH, initial_indent=_INDENT, subsequent_indent=body, break_on_hyphens=False),
        *wrap(text, _WIDTH, initial_indent=body, subsequent_indent=body),
    ]
