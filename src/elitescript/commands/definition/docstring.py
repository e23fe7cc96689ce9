"""Splits a command's docstring: summary, behaviour, arguments, result, errors."""

from __future__ import annotations

from elitescript.records import NamedTuple


class Docstring(NamedTuple):
    """The parts, without indentation."""

    summary: str
    behaviour: str
    args: dict[str, str]
    returns: str
    raises: dict[str, str]
    """Class of the error, and when it comes."""


_SECTIONS = ("Args:", "Returns:", "Raises:")


def read_docstring(text: str) -> Docstring:
    """Split a docstring in the Google form; unknown sections stay part of the behaviour."""
    lines = [line.rstrip() for line in text.strip().split("\n")]
    margin = min((len(line) - len(line.lstrip()) for line in lines[1:] if line.strip()), default=0)
    lines = [lines[0], *(line[margin:] for line in lines[1:])]
    parts: dict[str, list[str]] = {"": [], **{section: [] for section in _SECTIONS}}
    section = ""
    for line in lines[1:]:
        if line in _SECTIONS:
            section = line
        else:
            if section and line and not line.startswith(" "):
                section = ""
            parts[section].append(line)
    return Docstring(
        summary=lines[0].strip(),
        behaviour="\n".join(parts[""]).strip(),
        args=_entries(parts["Args:"]),
        returns=" ".join(line.strip() for line in parts["Returns:"] if line.strip()),
        raises=_entries(parts["Raises:"]),
    )


def _entries(lines: list[str]) -> dict[str, str]:
    entries: dict[str, str] = {}
    name = ""
    for line in lines:
        if not line.strip():
            continue
        if not line.startswith("     "):
            name, _, rest = line.strip().partition(":")
            entries[name] = rest.strip()
        else:
            entries[name] = f"{entries[name]} {line.strip()}"
    return entries
