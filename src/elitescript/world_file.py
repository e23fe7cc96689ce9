"""A world file: options of a robot, levels of its signals at the start, and what is beside it, as TOML.

The section `[robot]` holds options by their names; `[safety]`, `[contact]` and `[plant]` are options by themselves,
read by `from_table` of their classes. Both raise `UsageError` with a message that begins with the place, as
`[safety] tcp_speed must be ...`; file and line are put before it here. `[signals]` holds levels at the start, by the
names of `--set`. What is beside the robot, `[[tcp]]`, `[[wire]]` and so on, is read by `devices.scenario`; solids of
things and of the tool, `[[box]]` and so on, by `solids.cell`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from elitescript.devices.surroundings import REAL, VIRTUAL, RobotSettings
from elitescript.errors import UsageError, did_you_mean
from elitescript.kernel.options import ROBOT_SECTION, SECTIONS, options_of_table
from elitescript.messages.signals import Value
from elitescript.paths import is_task_name
from elitescript.untrusted.files import WORLD, read_text
from elitescript.untrusted.toml_lines import Path as TomlPath
from elitescript.untrusted.toml_lines import lines_of, nearest
from elitescript.untrusted.toml_text import toml_tables

if TYPE_CHECKING:
    from elitescript.assist.document import Settings
    from elitescript.devices.world import World

SIGNALS_SECTION: Final = "signals"

WORLD_SECTIONS: Final = ("world", "tcp", "rpc", "modbus", "serial", "device", "wire", "schedule", "parts", "fault")
"""Sections of what is beside the robot; all but `[world]` are lists of tables."""


SOLID_SECTIONS: Final = ("box", "cylinder", "sphere", "tool")
"""Sections of solids; `[tool]` is a table, the others are lists of tables."""


class WorldFile(RobotSettings):
    """Holds the content of a world file.

    Attributes:
        world: what is beside the robot; None if nothing is.
        beside: the sections about that, as they stand in the file.
    """

    __slots__ = ("beside", "world")

    def __init__(self) -> None:
        super().__init__()
        self.world: World | None = None
        self.beside: dict[str, Any] = {}


def load_world_file(
    path: str | Path, *, network: str = "", is_trusted: bool = True, with_world: bool = True
) -> WorldFile:
    """Read a world file.

    Args:
        path: of the file.
        network: where connections lead that no device of it takes, if it does not have that; see `devices.scenario`.
        is_trusted: whether it may name Python files and the network of this computer.
        with_world: read what is beside the robot; without it nothing of it is made, nor checked.

    Raises:
        UsageError: no such file, no TOML, an unknown section or key, or a value that makes no sense; the text names
            file and, where it is known, line.
    """
    file = Path(path)
    text = world_text(file)
    return read_tables(file, text, tables_of(file, text), network=network, is_trusted=is_trusted, with_world=with_world)


def world_text(file: Path) -> str:
    """Return the text of a world file.

    Raises:
        UsageError: no such file, one that is no world file by its size, or not UTF-8.
    """
    return read_text(file, WORLD, is_stream_allowed=True)


def tables_of(file: Path, text: str) -> dict[str, Any]:
    """Return the tables of the text of a world file, not checked yet.

    Args:
        file: for messages.
        text: its content.

    Raises:
        UsageError: no TOML, or beyond the bounds; the text names file and line.
    """
    return toml_tables(text, str(file), WORLD.noun)


def names_arm(world: str | Path) -> bool:
    """Return whether a world file says which arm the robot is.

    Raises:
        UsageError: it cannot be read.
    """
    robot = tables_of(Path(world), world_text(Path(world))).get(ROBOT_SECTION)
    return isinstance(robot, dict) and "model" in robot


def arm_of_program(program: str | Path, world: str | Path | None) -> str:
    """Return the arm of a graphical program, which a robot has that is told no other; empty: it is told one, or none.

    Args:
        program: path of the program.
        world: path of the world file, which may name an arm; None: there is none.

    Raises:
        UsageError: the world file cannot be read.
    """
    if not is_task_name(Path(program).name):
        return ""
    if world is not None and names_arm(world):
        return ""
    # Imported late: few programs are graphical.
    from elitescript.environment.task_files import arm_of_file

    return arm_of_file(program)


def read_tables(
    file: Path,
    text: str,
    tables: Mapping[str, Any],
    *,
    network: str = "",
    is_trusted: bool = True,
    with_world: bool = True,
    modules: Mapping[str, Any] | None = None,
) -> WorldFile:
    """Read the tables of a world file.

    Args:
        file: where it is, for messages, and for what it names.
        text: its content, for the lines of messages.
        tables: what `tables_of` has returned for it, perhaps with other values.
        network: see `load_world_file`; so are the next two.
        is_trusted: see there.
        with_world: see there.
        modules: Python files that have been imported, by their names in the tables; those that are not in it are read.

    Raises:
        UsageError: an unknown section or key, or a value that makes no sense; the text names file and line.
    """
    found = WorldFile()
    beside = found.beside
    solids: dict[str, Any] = {}
    for section, table in tables.items():
        try:
            if section in WORLD_SECTIONS:
                beside[section] = table
            elif section in SOLID_SECTIONS:
                solids[section] = table
            else:
                _read_section(found, section, table, file.parent)
        except UsageError as error:
            raise _located(file, text, section, table, error) from error
    if solids:
        # Imported late: few worlds have solids.
        from elitescript.solids.cell import read_cell

        try:
            found.cell = read_cell(solids)
        except UsageError as error:
            section = _place_in(str(error))[0].partition(".")[0]
            raise _located(file, text, section, tables.get(section), error) from error
    if beside and with_world:
        from elitescript.devices.scenario import build_world

        try:
            found.world = build_world(beside, file.parent, network=network, is_trusted=is_trusted, modules=modules)
        except UsageError as error:
            section = _place_in(str(error))[0]
            raise _located(file, text, section, tables.get(section), error) from error
        found.world.settings = found
    return found


def closed_world(
    path: str | Path | None, *, is_trusted: bool = False, may_connect: bool = False, text: str | None = None
) -> World:
    """Return what is around a robot whose programs reach nothing of this computer.

    Args:
        path: of a world file, whose options and levels are in `World.settings`; there is nothing around without one.
        is_trusted: whether the file may name Python files.
        may_connect: whether what is no device of it may be reached after all.
        text: of the file; it is read if None. An arm of its own that it names is the caller's to give.

    Raises:
        UsageError: an invalid world file, or one that names what it may not.
    """
    from elitescript.devices.world import World

    network = REAL if may_connect else VIRTUAL
    file = None
    if path:
        if text is None:
            file = load_world_file(path, network=network, is_trusted=is_trusted)
        else:
            tables = _without_arm_file(tables_of(Path(path), text))
            file = read_tables(Path(path), text, tables, network=network, is_trusted=is_trusted)
        if file.world is not None:
            if file.world.leads_to == REAL and not may_connect:
                raise UsageError(f"{path}: [world] network: {REAL!r} is not allowed here")
            return file.world
    world = World(network=network)
    world.settings = file
    return world


def _without_arm_file(tables: dict[str, Any]) -> dict[str, Any]:
    """Return the tables of a world file without the name of an arm file, which stands beside it elsewhere."""
    from elitescript.models.model import is_model_file

    robot = tables.get(ROBOT_SECTION)
    if not isinstance(robot, dict) or not is_model_file(str(robot.get("model", ""))):
        return tables
    return {**tables, ROBOT_SECTION: {name: value for name, value in robot.items() if name != "model"}}


def files_read(path: str | Path) -> list[Path]:
    """Return a world file, and the files of its arm and of Python that it names.

    Raises:
        UsageError: an invalid world file.
    """
    from elitescript.devices.scenario import python_files
    from elitescript.models.model import is_model_file

    file = load_world_file(path, with_world=False)
    names = python_files(file.beside)
    if is_model_file(model := file.options.get("model", "")):
        names.append(model)
    return [Path(path), *(Path(path).parent / name for name in names)]


def _located(file: Path, text: str, section: str, table: object, error: UsageError) -> UsageError:
    lines = lines_of(text)

    def line(found: re.Match[str]) -> str:
        return f"see line {nearest(lines, (found[1], int(found[2]) - 1))}"

    words = re.sub(r"see \[\[(\w+)\]\] (\d+)", line, str(error))
    return UsageError(f"{file}:{line_of(text, section, table, str(error))}: {words}")


def _read_section(found: WorldFile, section: str, table: object, folder: Path) -> None:
    known = (*SECTIONS, ROBOT_SECTION, SIGNALS_SECTION)
    if section not in known:
        shown = [f"[{name}]" for name in (*known, WORLD_SECTIONS[0])]
        shown += [f"[[{name}]]" for name in (*WORLD_SECTIONS[1:], *SOLID_SECTIONS[:-1])]
        shown.append(f"[{SOLID_SECTIONS[-1]}]")
        near = did_you_mean(section, (*known, *WORLD_SECTIONS, *SOLID_SECTIONS))
        raise UsageError(f"[{section}] is not known; there are {', '.join(shown)}{near}")
    if not isinstance(table, Mapping):
        raise UsageError(f"[{section}] must be a table: write [{section}] on a line of its own, its keys below")
    if section == SIGNALS_SECTION:
        found.signals = _signals(table)
    elif section == ROBOT_SECTION:
        found.options |= _robot(table, folder)
    else:
        found.options[section] = SECTIONS[section].from_table(table)


def _robot(table: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    from elitescript.models.model import is_model_file, load_model

    options = options_of_table(table)
    if "model" in options:
        if is_model_file(options["model"]):
            options["model"] = str(folder / options["model"])
        try:
            load_model(options["model"])
        except UsageError as error:
            raise UsageError(f"[{ROBOT_SECTION}] model: {error}") from error
    return options


def _signals(table: Mapping[str, Any]) -> dict[str, Value]:
    from elitescript.controller.signals.by_name import signal_write

    for name, value in table.items():
        try:
            signal_write(name, value)
        except UsageError as error:
            raise UsageError(f"[{SIGNALS_SECTION}] {name}: {error}") from error
    return dict(table)


def line_of(text: str, section: str, table: object, message: str) -> int:
    """Return the line, from 1, that a message is about; the nearest one that is known.

    The message names a table as `[section]`, `[section.part]` or `[[section.part]] 2:` and then a key, perhaps followed
    by `row 3:` and further keys; if it does not, the key of the section that it names first counts, and without one
    the section itself.
    """
    lines = lines_of(text)
    place, number, words = _place_in(message)
    if not place.startswith(section):
        place, number = section, 1
        named = [name for name in table if name in message] if isinstance(table, Mapping) else []
        words = [min(named, key=lambda name: (message.find(name), -len(name)), default="")]
    path: TomlPath = (section,)
    for part in place[len(section) :].strip(".").split("."):
        if part:
            path = (*path, part)
    path = (*path, number - 1) if (*path, number - 1) in lines else path
    for before, word in zip(["", *words], words, strict=False):
        key = word.partition("[")[0]
        index = word[len(key) + 1 : -1]
        for step in ((*path, word), (*path, key, int(index) if index.isdecimal() else index), (*path, key)):
            if step in lines:
                path = step
                break
        else:
            if before == "row" and word.isdecimal() and (*path, int(word) - 1) in lines:
                path = (*path, int(word) - 1)
            elif word != "row":
                break
    row = re.search(r"\(row (\d+)\)$", message)
    return nearest(lines, (*path, int(row[1]) - 1) if row else path)


def _place_in(message: str) -> tuple[str, int, list[str]]:
    """Return table, its number in a list of tables, and the words that may be keys."""
    place, bracket, rest = message.lstrip("[").partition("]")
    if not message.startswith("[") or not bracket:
        return "", 1, []
    words = [word.rstrip(":").strip("\"'") for word in rest.lstrip("]").split()[:8]]
    number = 1
    if message.startswith("[[") and words and words[0].isdecimal():
        number = int(words.pop(0))
    return place, number, words


# ---------------------------------------------------------------- for editors


def text_settings(given: Mapping[str, Any], world: str | Path | None) -> tuple[Settings, list[str]]:
    """Return what texts are written for, and what is wrong with the world file, whose options are then left out.

    Args:
        given: options of the robot, which go before those of the world file; without a `model` in either, texts are
            for any arm.
        world: path of the world file; None without one.

    Raises:
        UsageError: an option that makes no sense.
    """
    from elitescript.assist.document import Settings
    from elitescript.kernel.arm_facts import arm_facts
    from elitescript.kernel.options import robot_options
    from elitescript.messages.profile import profile

    from_file: dict[str, Any] = {}
    names: dict[str, tuple[str, ...]] = {}
    wrong: list[str] = []
    if world is not None:
        try:
            file = load_world_file(world, with_world=False)
            from_file, names = file.options, _names_beside(file.beside)
        except UsageError as error:
            wrong.append(str(error))
    robot = robot_options(given, from_file)
    arm = arm_facts(robot) if "model" in given or "model" in from_file else None
    return Settings(profile(robot.firmware), robot.strict, arm, names=names), wrong


def _names_beside(beside: Mapping[str, Any]) -> dict[str, tuple[str, ...]]:
    """Return the names that strings of programs may hold, by kind, from the sections of a world file."""
    rows = [row for table in beside.values() if isinstance(table, list) for row in table if isinstance(row, Mapping)]
    addresses = [row.get("address") for row in rows]
    return {"address": tuple(dict.fromkeys(name for name in addresses if isinstance(name, str) and name))}
