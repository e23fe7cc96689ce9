"""Reads what a world file has about solids: things beside the robot, and what is on the flange.

`[[box]]`, `[[cylinder]]` and `[[sphere]]` are things, which stand in the base frame. `[tool]` has lists of the same
solids in the flange frame, `[[tool.box]]` and so on, and `[tool.payload]` those of what the tool holds. Solids of one
name are one thing. Lengths are m; a pose is that of the centre as scripts write it, angles in rad, or as `pose_deg`
with angles in degrees.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from math import isfinite, radians
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.kinematics.transforms import transform_from_pose
from elitescript.messages.motion import Six
from elitescript.models.model import LINK_NAMES
from elitescript.records import NamedTuple
from elitescript.solids.shapes import BASE, FLANGE, Part, pose_of

LINKS: Final = ("base", *[name.replace("_", " ").replace("upperarm", "upper arm") for name in LINK_NAMES])
"""Names of the links 0 to 6 in reports of contacts; the flange belongs to the last one."""

ARM: Final = "arm"
"""Stands for all links in `ignore`."""

KINDS: Final[dict[str, tuple[str, ...]]] = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
}
"""Kinds of solids and the keys of their sizes, m."""

SECTIONS: Final = (*KINDS, "tool")
"""Sections of a world file that are read here."""

FARTHEST_M: Final = 20.0
"""Beyond this a length is in millimetres."""

KEYS: Final[dict[str, str]] = {
    "name": "for messages; solids of one name are one thing.",
    "size": "x, y and z of a box, m.",
    "radius": "of a cylinder or a sphere, m.",
    "length": "of a cylinder, along z, m.",
    "pose": "of the middle: `[x, y, z]`, or with roll, pitch and yaw as scripts write a pose; m, rad. Things stand in "
    "the base frame, solids of the tool in the flange frame.",
    "pose_deg": "the same with angles in degrees.",
    "color": 'as `"#ffcc00"`.',
    "ignore": "names of what it may touch: other things, tool or payload, `arm`, or links: "
    + ", ".join(f"`{name}`" for name in LINKS)
    + ".",
}
"""What the keys of a solid are; those of sizes belong to their kinds."""

_COMMON: Final = ("name", "pose", "pose_deg", "color", "ignore")


class Cell(NamedTuple):
    """Solids beside the robot and on its flange."""

    parts: tuple[Part, ...]
    """Things in the base frame, role `thing`; on the flange `tool` and `payload`. Each has a name."""
    ignored: frozenset[frozenset[str]]
    """Pairs of names that may touch: of things, tool, payload and links."""


def read_cell(tables: Mapping[str, Any]) -> Cell:
    """Return the solids of the sections of a world file.

    Args:
        tables: the sections of `SECTIONS` that the file has.

    Raises:
        UsageError: something makes no sense. The text begins with its place, such as `[[box]] 2: size:`.
    """
    reader = _Reader()
    for section, table in tables.items():
        if section in KINDS:
            reader.solids(section, section, table, BASE, "thing", {})
        else:
            reader.tool(table)
    return reader.cell()


class _Reader:
    """Collects solids, and what may touch what."""

    def __init__(self) -> None:
        self._parts: list[Part] = []
        self._roles: dict[str, str] = {}
        self._ignored: list[tuple[str, str, str]] = []
        """Place in the file, name and what it may touch."""

    def tool(self, table: object) -> None:
        """Read `[tool]`."""
        table = self._holder("tool", table, ("payload",))
        self._held("tool", table, "tool", {"name": "tool"})
        if "payload" in table:
            payload = self._holder("tool.payload", table["payload"], ())
            self._held("tool.payload", payload, "payload", {"name": "payload"})

    @staticmethod
    def _holder(place: str, table: object, more: tuple[str, ...]) -> Mapping[str, Any]:
        if not isinstance(table, Mapping):
            raise UsageError(f"[{place}] must be a table: write [{place}] on a line of its own, its keys below")
        known = ("name", "color", "ignore", *KINDS, *more)
        for key in table:
            if key not in known:
                raise UsageError(
                    f"[{place}] {key}: is not known; there are {', '.join(known)}{did_you_mean(key, known)}"
                )
        if not any(table.get(kind) for kind in KINDS) and "payload" not in table:
            raise UsageError(f"[{place}] has no solid: write [[{place}.box]] with its size below")
        return table

    def _held(self, place: str, table: Mapping[str, Any], role: str, defaults: dict[str, Any]) -> None:
        defaults = {**defaults, **{key: table[key] for key in ("name", "color", "ignore") if key in table}}
        self._check(f"[{place}]", defaults)
        for kind in KINDS:
            if kind in table:
                self.solids(f"{place}.{kind}", kind, table[kind], FLANGE, role, defaults)

    def solids(self, place: str, kind: str, rows: object, link: int, role: str, defaults: Mapping[str, Any]) -> None:
        """Read a list of solids of one kind."""
        if not isinstance(rows, list) or not all(isinstance(row, Mapping) for row in rows):
            raise UsageError(f"[[{place}]] must be a list of tables: write [[{place}]] on a line of its own")
        for number, row in enumerate(rows, 1):
            where = f"[[{place}]] {number}:"
            known = (*_COMMON, *KINDS[kind])
            for key in row:
                if key not in known:
                    near = did_you_mean(key, known)
                    raise UsageError(f"{where} {key}: is not known; there are {', '.join(known)}{near}")
            settings = {"name": f"{kind} {number}", **defaults, **row}
            self._check(where, settings)
            name = settings["name"]
            if self._roles.setdefault(name, role) != role:
                raise UsageError(f"{where} name: {name!r} is the name of a {self._roles[name]} already")
            self._ignored += [(f"{where} ignore:", name, other) for other in settings.get("ignore", ())]
            size = tuple(_sizes(where, kind, row))
            self._parts.append(Part(link, kind, size, _pose(where, row), role, name, settings.get("color", "")))

    @staticmethod
    def _check(where: str, settings: Mapping[str, Any]) -> None:
        """Check name, colour and what is ignored."""
        name, color, ignore = settings["name"], settings.get("color", ""), settings.get("ignore", [])
        if not isinstance(name, str) or not name or not name.isprintable():
            raise UsageError(f"{where} name: must be a text, got {name!r:.60}")
        if name in (*LINKS, ARM):
            raise UsageError(f"{where} name: {name!r} is a part of the arm")
        if not isinstance(color, str) or (color and not re.fullmatch("#[0-9a-fA-F]{6}", color)):
            raise UsageError(f'{where} color: must be as "#ffcc00", got {color!r:.60}')
        if not isinstance(ignore, list) or not all(isinstance(other, str) for other in ignore):
            raise UsageError(f'{where} ignore: must be a list of names, such as ["gripper"], got {ignore!r:.60}')

    def cell(self) -> Cell:
        """Return what was read."""
        known = (*self._roles, *LINKS, ARM)
        pairs = set()
        for where, name, other in self._ignored:
            if other not in known:
                shown = ", ".join(its for its in known if its != name)
                raise UsageError(f"{where} {other!r} is not known; there are {shown}{did_you_mean(other, known)}")
            pairs |= {frozenset((name, its)) for its in (LINKS if other == ARM else (other,))}
        return Cell(tuple(self._parts), frozenset(pairs))


def _sizes(where: str, kind: str, row: Mapping[str, Any]) -> Iterator[float]:
    for key in KINDS[kind]:
        if key not in row:
            raise UsageError(f"{where} {key}: missing; lengths are m")
        count = 3 if key == "size" else 0
        numbers = _numbers(where, key, row[key], (count,)) if count else [_number(where, key, row[key])]
        for number in numbers:
            if not 0.0 < number <= FARTHEST_M:
                raise UsageError(f"{where} {key}: must be > 0 and at most {FARTHEST_M:g} m, got {number:g} (in metres)")
            yield number


def _pose(where: str, row: Mapping[str, Any]) -> Six:
    """Return the pose of a row, with a rotation vector."""
    if "pose" in row and "pose_deg" in row:
        raise UsageError(f"{where} pose_deg: the pose is given twice, in rad and in degrees")
    key = "pose_deg" if "pose_deg" in row else "pose"
    x, y, z, *angles = _numbers(where, key, row.get(key, [0.0, 0.0, 0.0]), (3, 6))
    for number in (x, y, z):
        if abs(number) > FARTHEST_M:
            raise UsageError(f"{where} {key}: must be within {FARTHEST_M:g} m, got {number:g} (in metres)")
    rx, ry, rz = angles or (0.0, 0.0, 0.0)
    if key == "pose_deg":
        rx, ry, rz = radians(rx), radians(ry), radians(rz)
    return pose_of(transform_from_pose((x, y, z, rx, ry, rz)))


def _numbers(where: str, key: str, value: object, counts: tuple[int, ...]) -> list[float]:
    if not isinstance(value, list) or len(value) not in counts:
        needed = " or ".join(map(str, counts))
        raise UsageError(f"{where} {key}: needs {needed} numbers in brackets, got {value!r:.60}")
    return [_number(where, key, number) for number in value]


def _number(where: str, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise UsageError(f"{where} {key}: needs a finite number, got {value!r:.60}")
    return float(value)
