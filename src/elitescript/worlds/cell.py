"""The world around a robot as a TOML file: safety limits, devices, wires, and whatever else a test sets up as a whole.

`SECTIONS` says who reads which section: a class with `from_table`, which gets the section's table and raises
`UsageError` for what makes no sense. Its message begins with the place, as `[safety] tcp_speed must be ...`; file and
line are put before it here. The section `[signals]` holds levels at the start, by the names of `--set`. What is beside
the robot, `[[tcp]]`, `[[wire]]` and so on, is read by `virtual.scenario`.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import UsageError
from elitescript.messages.paths import why_no_file
from elitescript.messages.signals import Value

if TYPE_CHECKING:
    from elitescript.worlds.virtual.world import World

SECTIONS: Final[dict[str, str]] = {
    "safety": "elitescript.controller.safety_limits:SafetyLimits",
    "contact": "elitescript.controller.contact:ContactConfig",
    "plant": "elitescript.messages.plant:PlantConfig",
}
"""Section, which is also the keyword of `VirtualRobot`, and `module:class` of what reads it."""

SIGNALS_SECTION: Final = "signals"

WORLD_SECTIONS: Final = ("world", "tcp", "rpc", "modbus", "serial", "device", "wire", "schedule", "parts", "fault")
"""Sections of what is beside the robot; all but `[world]` are lists of tables."""


class Cell:
    """What a world file says.

    Attributes:
        configurations: by section, what its owner made of it; sections that are not in the file are missing.
        signals: levels at the start.
        world: what is beside the robot; None if nothing is.
    """

    __slots__ = ("configurations", "signals", "world")

    def __init__(self, configurations: dict[str, Any] | None = None, signals: dict[str, Value] | None = None) -> None:
        self.configurations: dict[str, Any] = configurations or {}
        self.signals: dict[str, Value] = signals or {}
        self.world: World | None = None

    def take(self, section: str, given: Any) -> Any:
        """What the caller has given for a section, else what the file says; None if neither does.

        Raises:
            UsageError: both do.
        """
        found = self.configurations.get(section)
        if given is not None and found is not None:
            raise UsageError(f"{section} is given by the world file too; give it in one of both")
        return found if given is None else given


def load_cell(path: str | Path, *, network: str = "") -> Cell:
    """Read a world file.

    Args:
        path: of the file.
        network: where connections lead that no device of it takes, if it does not say so; see `virtual.scenario`.

    Raises:
        UsageError: no such file, no TOML, an unknown section or key, or a value that makes no sense; the text names
            file and, where it is known, line.
    """
    import tomllib

    file = Path(path)
    if why := why_no_file(file, is_stream_allowed=True):
        raise UsageError(f"world file {file} {why}")
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise UsageError(f"world file {file}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise UsageError(f"world file {file} is not UTF-8: {error.reason} at byte {error.start}") from error
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        hint = '; names with an index stand in quotes: "standard_digital_in[3]" = true' if _has_bare_index(text) else ""
        raise UsageError(f"world file {file} is not TOML: {error}{hint}") from error
    cell = Cell()
    beside: dict[str, Any] = {}
    for section, table in tables.items():
        try:
            if section in WORLD_SECTIONS:
                beside[section] = table
            else:
                _read_section(cell, section, table)
        except UsageError as error:
            raise _located(file, text, section, table, error) from error
    if beside:
        from elitescript.worlds.virtual.scenario import build_world

        try:
            cell.world = build_world(beside, file.parent, network=network)
        except UsageError as error:
            section = _place_in(str(error))[0]
            raise _located(file, text, section, tables.get(section), error) from error
        cell.world.cell = cell
    return cell


def _located(file: Path, text: str, section: str, table: object, error: UsageError) -> UsageError:
    line = line_of(text, section, table, str(error))
    return UsageError(f"{file}:{line}: {error}" if line else f"{file}: {error}")


def _read_section(cell: Cell, section: str, table: object) -> None:
    if section != SIGNALS_SECTION and section not in SECTIONS:
        known = [f"[{name}]" for name in (*SECTIONS, SIGNALS_SECTION, WORLD_SECTIONS[0])]
        known += [f"[[{name}]]" for name in WORLD_SECTIONS[1:]]
        raise UsageError(f"[{section}] is not known; there are {', '.join(known)}")
    if not isinstance(table, Mapping):
        raise UsageError(f"[{section}] must be a table: write [{section}] on a line of its own, its keys below")
    if section == SIGNALS_SECTION:
        cell.signals = _signals(table)
        return
    module, _, name = SECTIONS[section].partition(":")
    cell.configurations[section] = getattr(import_module(module), name).from_table(table)


def _signals(table: Mapping[str, Any]) -> dict[str, Value]:
    from elitescript.controller.signal_view import signal_write

    for name, value in table.items():
        try:
            signal_write(name, value)
        except UsageError as error:
            raise UsageError(f"[{SIGNALS_SECTION}] {name}: {error}") from error
    return dict(table)


def line_of(text: str, section: str, table: object, message: str) -> int:
    """The line, from 1, that a message is about; 0 if it does not tell.

    The message names a table as `[section]`, `[section.part]` or `[[section.part]] 2:` and then a key; if it does not,
    the key of the section that it names first counts, and without one the section itself.
    """
    place, number, key = _place_in(message)
    if not place.startswith(section):
        place, number = section, 1
        named = [name for name in table if name in message] if isinstance(table, Mapping) else []
        key = min(named, key=lambda name: (message.find(name), -len(name)), default="")
    line = _line_in(text, place, number, key)
    if not line and "." in place:
        # A table within a line of its parent.
        parent, _, child = place.rpartition(".")
        line = _line_in(text, parent, 1, child)
    return line or _line_in(text, "", 1, section)


def _line_in(text: str, place: str, number: int, key: str) -> int:
    """Line of a key in the table of that name, or in that one of several; of its header if the key is not there."""
    current, counts, start = "", {"": 1}, 0
    for line, content in enumerate(text.splitlines(), 1):
        stripped = content.strip()
        if stripped.startswith("["):
            current = stripped.partition("#")[0].strip().strip("[]").replace('"', "").replace(" ", "")
            counts[current] = counts.get(current, 0) + 1
            if current == place and counts[current] == number:
                start = line
        elif key and current == place and counts[current] == number:
            name = stripped.partition("=")[0].strip().strip("\"'")
            if name in (key, key.partition("[")[0]) or name.startswith(f"{key}."):
                return line
    return start


def _place_in(message: str) -> tuple[str, int, str]:
    """Table, its number in a list of tables, and key."""
    place, bracket, rest = message.lstrip("[").partition("]")
    if not message.startswith("[") or not bracket:
        return "", 1, ""
    words = rest.lstrip("]").split()
    number = 1
    if message.startswith("[[") and words and words[0].rstrip(":").isdecimal():
        number = int(words.pop(0).rstrip(":"))
    return place, number, words[0].rstrip(":") if words else ""


def _has_bare_index(text: str) -> bool:
    """Whether a line begins like `standard_digital_in[3] =`."""
    for line in text.split("\n"):
        name, bracket, rest = line.partition("=")[0].strip().partition("[")
        if bracket and name.isidentifier() and rest[:-1].isdecimal() and rest.endswith("]"):
            return True
    return False
