"""The devices, wires and faults of a world file.

`KINDS` has what each section makes. Every row of a section is a table of settings; with `class = "cell.py:Camera"`
it is a device of that class, from a Python file beside the world file, which is trusted as any Python file is.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from elitescript.devices.channels.faults import Fault, check_together, fault_from
from elitescript.devices.device import Device, TakenError
from elitescript.devices.surroundings import REAL
from elitescript.devices.world import World, place_in
from elitescript.errors import UsageError, did_you_mean
from elitescript.records import NamedTuple

WORLD_KEYS: Final = ("seed", "network")


class Section(NamedTuple):
    """One row: a section of the file."""

    declared: str
    """`module:class` of what a row makes; empty if only `class` has it."""
    base: str = ""
    """`module:class` that a class of the user's must be made of; empty if there can be none."""
    is_reachable: bool = False
    """Whether it is something that programs connect to."""


_KINDS: Final = "elitescript.devices.kinds"

FAULT: Final = "elitescript.devices.channels.faults:Fault"

KINDS: Final[dict[str, Section]] = {
    "tcp": Section(f"{_KINDS}.replies:DeclaredTcp", f"{_KINDS}.tcp:TcpServer", True),
    "rpc": Section(f"{_KINDS}.replies:DeclaredRpc", f"{_KINDS}.xmlrpc:XmlRpcServer", True),
    "modbus": Section(f"{_KINDS}.replies:DeclaredModbus", f"{_KINDS}.modbus:ModbusDevice", True),
    "serial": Section(f"{_KINDS}.replies:DeclaredSerial", f"{_KINDS}.serial:LineDevice", True),
    "device": Section("", "elitescript.devices.device:Device"),
    "wire": Section(f"{_KINDS}.wiring:Wire"),
    "schedule": Section(f"{_KINDS}.wiring:Schedule"),
    "parts": Section(f"{_KINDS}.parts:Parts"),
    "fault": Section(FAULT),
}
"""Sections whose rows are devices, wires or faults."""

CLASS_KEY: Final = "class"


def build_world(
    tables: Mapping[str, Any],
    folder: Path,
    *,
    network: str = "",
    is_trusted: bool = True,
    modules: Mapping[str, Any] | None = None,
) -> World:
    """Make the world that a file declares.

    Args:
        tables: its sections, as far as they are about a world.
        folder: where the file is.
        network: default of `network` in `[world]`.
        is_trusted: whether it may name Python files, which are run, and, if that is not its default, the network of
            this computer.
        modules: Python files that have been imported, by their names in the tables; the others are read.

    Raises:
        UsageError: something makes no sense. The text begins with its place, such as `[[tcp]] 2: port:`.
    """
    options = tables.get("world", {})
    try:
        world = _empty_world(options, network)
        if world.leads_to == REAL and not is_trusted and network != REAL:
            raise UsageError(f"network: {REAL!r} is not allowed here")
    except UsageError as error:
        raise UsageError(f"[world] {error}") from None
    files: dict[Path, Any] = {folder / name: module for name, module in (modules or {}).items()}
    faults: list[Fault] = []
    places: dict[object, str] = {}
    """Of devices, and of the names that the file gives them."""
    for section, rows in tables.items():
        if section == "world":
            continue
        if not isinstance(rows, list) or not all(isinstance(row, Mapping) for row in rows):
            raise UsageError(f"[[{section}]] must be a list of tables: write [[{section}]] on a line of its own")
        for number, row in enumerate(rows, 1):
            try:
                if CLASS_KEY in row and not is_trusted:
                    raise UsageError(f"{CLASS_KEY}: a Python file is not allowed here")
                made = _made(section, number, row, folder, files)
                if isinstance(made, Fault):
                    faults.append(made)
                else:
                    name = row.get("name")
                    if name and name in places:
                        raise UsageError(f"name: {name!r} is the name of another one already, see {places[name]}")
                    world.add(made)
                    places[made] = f"[[{section}]] {number}"
                    if name:
                        places[name] = places[made]
            except TakenError as error:
                raise UsageError(f"[[{section}]] {number}: {error}, see {places.get(error.other, '')}") from error
            except UsageError as error:
                raise UsageError(f"[[{section}]] {number}: {error}") from error
    for number, fault in enumerate(faults, 1):
        try:
            faults[number - 1] = world.check_fault(fault)
        except UsageError as error:
            raise UsageError(f"[[fault]] {number}: {error}") from None
    try:
        check_together(faults)
    except UsageError as error:
        raise UsageError(f"[[fault]] {error}") from None
    for fault in faults:
        world.add_fault(fault)
    return world


def _empty_world(options: object, network: str) -> World:
    if not isinstance(options, Mapping):
        raise UsageError("must be a table")
    for key in options:
        if key not in WORLD_KEYS:
            near = did_you_mean(key, WORLD_KEYS)
            raise UsageError(f"{key}: is not known; there are {', '.join(WORLD_KEYS)}{near}")
    return World(seed=options.get("seed", 0), network=options.get("network", network))


def _made(section: str, number: int, row: Mapping[str, Any], folder: Path, files: dict[Path, Any]) -> Any:
    """Return what one row declares."""
    kind = KINDS[section]
    settings = dict(row)
    named = settings.pop(CLASS_KEY, None)
    if named is not None:
        if not kind.base:
            raise UsageError(f"{CLASS_KEY}: is not possible here")
        found: Any = _named_class(named, folder, files, _loaded(kind.base))
    elif not kind.declared:
        raise UsageError(f'{CLASS_KEY}: name one, such as "cell.py:Button"')
    else:
        found = _loaded(kind.declared)
    if kind.declared == FAULT:
        return fault_from(settings)
    if not isinstance(row.get("name", ""), str):
        raise UsageError(f"name: must be a text, got {row['name']!r:.60}")
    if named is None and kind.is_reachable:
        settings.setdefault("name", f"{section} {number}")
    try:
        return found(**settings)
    except UsageError:
        raise
    except Exception as error:
        if named is None:
            raise UsageError(f"the settings do not go together: {type(error).__name__}: {error}") from error
        place = _python_place(error)
        where = f" ({place})" if place else ""
        text = f"{named} cannot be made: {type(error).__name__}: {error}{where}"
        raise UsageError(f"{CLASS_KEY}: {text}") from error


def python_files(tables: Mapping[str, Any]) -> list[str]:
    """Return the Python files that the rows of all sections name, relative to the file that declares them."""
    rows = [row for table in tables.values() if isinstance(table, list) for row in table if isinstance(row, Mapping)]
    named = [row.get(CLASS_KEY) for row in rows]
    return [name.rpartition(":")[0] for name in named if isinstance(name, str)]


def _loaded(name: str) -> Any:
    module, _, attribute = name.partition(":")
    return getattr(import_module(module), attribute)


def _named_class(named: object, folder: Path, files: dict[Path, Any], base: type[Device]) -> type[Device]:
    """Return a class of a Python file beside the world file."""
    file_name, colon, name = named.rpartition(":") if isinstance(named, str) else ("", "", "")
    if not colon or not file_name.endswith(".py"):
        raise UsageError(f'{CLASS_KEY}: write file and class, such as "cell.py:Camera", not {named!r}')
    path = folder / file_name
    if path not in files:
        files[path] = _imported(path)
    found = getattr(files[path], name, None)
    if not isinstance(found, type):
        raise UsageError(f"{CLASS_KEY}: {file_name} has no class {name}")
    if not issubclass(found, base):
        raise UsageError(f"{CLASS_KEY}: {name} must be made of {base.__name__}: class {name}({base.__name__})")
    return found


def _imported(path: Path) -> Any:
    from importlib.util import module_from_spec, spec_from_file_location

    spec = spec_from_file_location(f"elitescript_world_{path.stem}", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise UsageError(f"{CLASS_KEY}: there is no file {path}")
    module = module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses of the file look for their own module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        place = _python_place(error) or path
        text = error.msg if isinstance(error, SyntaxError) else str(error)
        raise UsageError(f"{CLASS_KEY}: {place}: {type(error).__name__}: {text}") from error
    return module


def _python_place(error: Exception) -> str:
    """Return the file and line of a mistake in a Python file, as `cell.py:12`; empty if it is not in one."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}:{error.lineno}"
    return place_in(error)
