"""Values of a world file that are varied: a name such as `box.feeder.x` leads to a place in its tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.kernel.options import ROBOT_SECTION, SECTIONS
from elitescript.world_file import SIGNALS_SECTION, SOLID_SECTIONS, WORLD_SECTIONS

Path = tuple[str | int, ...]
"""Keys, and numbers of list elements from 0, as in `untrusted.toml_lines`."""

AXES: Final = ("x", "y", "z", "rx", "ry", "rz")
"""Elements of poses, points and sizes by name."""

_POSES: Final = ("pose", "pose_deg", "position", "point")
"""Keys that can be left out before the name of an axis."""

_TABLES: Final = (ROBOT_SECTION, *SECTIONS, SIGNALS_SECTION, "world", "tool")
"""Sections that are one table, which need not be in the file: its settings have defaults."""


def place_of(name: str, tables: Mapping[str, Any]) -> Path:
    """Return the place in a world file that a name leads to.

    Parts are separated by dots: the section; of a list of tables the `name` of one or its number from 0; keys; of a
    list of numbers the number of an element from 0, or `x`, `y`, `z`, `rx`, `ry`, `rz`, before which `pose` can be left
    out. A key that is not in the file is possible where its table is, or in a section that is one table.

    Raises:
        UsageError: there is no such place; the text names what there is.
    """
    section, *parts = name.split(".")
    known = (*_TABLES, *WORLD_SECTIONS, *SOLID_SECTIONS)
    if section not in known:
        near = did_you_mean(section, known)
        raise UsageError(f"--vary {name}: {section!r} is no section of a world file{near}; there are {_listed(known)}")
    if section not in tables and section not in _TABLES:
        raise UsageError(f"--vary {name}: the world file has no [[{section}]]; it has {_listed(tables) or 'nothing'}")
    if not parts:
        raise UsageError(
            f"--vary {name}: write what of {section}, such as {section}.{_listed(_inside(tables[section]))}"
        )
    place: Path = (section,)
    value: Any = tables.get(section, {})
    for number, part in enumerate(parts):
        step = _step(value, part, is_last=number == len(parts) - 1, called=f"--vary {name}")
        place += step
        for key in step:
            value = value.get(key) if isinstance(value, Mapping) else value[key]
    if isinstance(value, Mapping) or (isinstance(value, list) and value and isinstance(value[0], Mapping)):
        raise UsageError(f"--vary {name}: it is a table; write which of {_listed(_inside(value))}")
    return place


def _step(value: Any, part: str, *, is_last: bool, called: str) -> Path:
    """Return the step or the two steps into a value that a part of a name means."""
    if isinstance(value, Mapping):
        if part in value:
            return (part,)
        if part in AXES:
            for key in _POSES:
                if key in value:
                    return (key, AXES.index(part))
        if is_last:
            return (part,)
        raise UsageError(f"{called}: there is no {part!r}{did_you_mean(part, value)}; there are {_listed(value)}")
    if not isinstance(value, list):
        raise UsageError(f"{called}: there is nothing below {value!r}")
    if part.isdecimal() and int(part) < len(value):
        return (int(part),)
    named = [number for number, row in enumerate(value) if isinstance(row, Mapping) and row.get("name") == part]
    if len(named) > 1:
        raise UsageError(f"{called}: {len(named)} are called {part}; write one of {_listed(named)}")
    if named:
        return (named[0],)
    if part in AXES and AXES.index(part) < len(value) and not isinstance(value[0], Mapping):
        return (AXES.index(part),)
    raise UsageError(f"{called}: there is no {part!r}; there are {_listed(_inside(value))}")


def _inside(value: Any) -> list[str]:
    """Return the parts of a name that lead further into a value."""
    if isinstance(value, Mapping):
        return list(value)
    names = [row.get("name") for row in value if isinstance(row, Mapping)]
    return [str(name if name and names.count(name) == 1 else number) for number, name in enumerate(names)] or [
        str(number) for number in range(len(value))
    ]


def _listed(names: Any) -> str:
    return ", ".join(map(str, names))


def with_value(tables: Any, place: Path, value: Any) -> Any:
    """Return tables with another value at a place; what is not on the way to it is shared."""
    if not place:
        return value
    key, rest = place[0], place[1:]
    if isinstance(tables, list):
        changed = list(tables)
        changed[key] = with_value(tables[key], rest, value)  # type: ignore[index]
        return changed
    old = {} if tables is None else tables
    return {**old, key: with_value(old.get(key), rest, value)}
