"""Points that are known both as joints and as pose: in the text of a program, in CSV and JSON files."""

from __future__ import annotations

import ast
import csv
import io
import re
from collections.abc import Iterator, Sequence
from decimal import Decimal
from math import isfinite
from typing import Any, Final, TypeGuard

from elitescript.errors import UsageError
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.messages.motion import Six
from elitescript.records import NamedTuple, record
from elitescript.untrusted.json_text import JsonError, json_value

JOINT_ENDS: Final = ("_joints", "_joint", "_qnear", "_j", "_q")
POSE_ENDS: Final = ("_position", "_pose", "_tcp", "_p")
"""Endings by which names of one point differ: `pick_q` and `pick_p`."""

POINTS_MAX: Final = 20_000
"""Points of all files that are fitted: more take minutes and say no more."""
JOINTS_MAX_RAD: Final = 12.7
"""No joint turns further than two turns: such a list is no list of joints."""


ARITHMETIC: Final = 2.0**-49
"""Step, m or rad, below which all digits are given: what is left is the rounding of forward kinematics itself."""


class Point(NamedTuple):
    """One point: joints in rad, pose of the TCP in m and rad, base frame."""

    q: Six
    pose: Six
    line: int
    """In the file, from 1."""
    name: str
    tcp: Six | None = None
    """Offset of the TCP at which the pose was taken; None if it is not known."""
    is_of_program: bool = False
    """Whether the joints may be a hint to inverse kinematics alone: then another pose can have the same."""


@record
class Points:
    """Points of a file.

    Attributes:
        points: in the order of the text, each once.
        tcp_words: where the TCP offset comes from.
        q_step: unit of the last digit of the joints, rad.
        position_step: of the positions, m.
        angle_step: of the orientations, rad.
    """

    points: tuple[Point, ...]
    tcp_words: str
    q_step: float
    position_step: float
    angle_step: float


NO_TCP: Final[Six] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def points_of_program(text: str, name: str, tcp: Six | None = None) -> Points:
    """Return the points of a program: `get_inverse_kin(pose, qnear=joints)`, names such as `pick_q` and `pick_p`,
    and moves to joints with the pose in a comment of the same line.

    Args:
        text: of the program.
        name: of its file.
        tcp: offset of the TCP, if it is known better than from `set_tcp` of the program.
    """
    parsed = parse(SourceFile(name, text))
    reader = _ProgramReader(parsed.tree)
    found: list[Point] = []
    seen: set[tuple[Six, Six]] = set()
    for point in sorted((*reader.points(), *_points_in_comments(text)), key=lambda point: point.line):
        if (point.q, point.pose) not in seen:
            seen.add((point.q, point.pose))
            offset = reader.tcp_at(point.line) if tcp is None else tcp
            found.append(point._replace(tcp=offset, is_of_program=True))
    words = "the TCP offset is the one that was given" if tcp is not None else reader.tcp_words
    return _points(found, words)


def _points(found: Sequence[Point], words: str) -> Points:
    position_step = _step(x for point in found for x in point.pose[:3])
    return Points(
        points=tuple(found),
        tcp_words=words,
        # Joints with far fewer digits than positions are round numbers that were commanded, not rounded ones.
        q_step=min(_step(x for point in found for x in point.q), 10.0 * position_step),
        position_step=position_step,
        angle_step=_step(x for point in found for x in point.pose[3:]),
    )


def _step(numbers: Iterator[float]) -> float:
    """Return the unit of the last digit with which numbers are written: the finest of all of them."""
    digits = max((-int(Decimal(repr(number)).as_tuple().exponent) for number in numbers), default=0)
    return max(10.0 ** -max(digits, 0), ARITHMETIC)


class _ProgramReader:
    """Reads points and TCP offsets from a syntax tree."""

    __slots__ = ("_lists", "_tcps", "_tree")

    def __init__(self, tree: ast.Module) -> None:
        self._tree = tree
        self._lists: dict[str, list[tuple[int, Six]]] = {}
        self._tcps: list[tuple[int, Six | None]] = []
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign) and (values := _six(node.value)) is not None:
                for target in node.targets:
                    if isinstance(target, ast.Name):
                        self._lists.setdefault(target.id, []).append((node.lineno, values))
            elif isinstance(node, ast.Call) and _called(node) == "set_tcp" and node.args:
                self._tcps.append((node.lineno, self._value(node.args[0])))
        self._tcps.sort(key=lambda row: row[0])

    def tcp_at(self, line: int) -> Six | None:
        """Return the TCP offset that the program has set above a line; the first one if it is set below alone."""
        if not self._tcps:
            return NO_TCP
        above = [tcp for row, tcp in self._tcps if row <= line]
        return above[-1] if above else self._tcps[0][1]

    @property
    def tcp_words(self) -> str:
        if not self._tcps:
            return (
                "the program sets no TCP, so poses are taken as those of the flange: an offset along its z axis that "
                "the installation sets is part of d6"
            )
        lines = ", ".join(str(line) for line, _ in self._tcps[:3])
        if any(tcp is None for _, tcp in self._tcps):
            return f"set_tcp of line {lines} is no list of numbers: points below it are left out; give --tcp"
        return f"the TCP offset is that of set_tcp in line {lines}"

    def points(self) -> Iterator[Point]:
        for node in ast.walk(self._tree):
            if isinstance(node, ast.Call) and _called(node) == "get_inverse_kin" and node.args:
                near = node.args[1] if len(node.args) > 1 else None
                for keyword in node.keywords:
                    if keyword.arg == "qnear":
                        near = keyword.value
                pose, q = self._value(node.args[0]), None if near is None else self._value(near)
                if pose is not None and q is not None:
                    yield _point(q, pose, node.lineno, f"line {node.lineno}")
        yield from self._named()

    def _named(self) -> Iterator[Point]:
        for name, rows in self._lists.items():
            for end in JOINT_ENDS:
                if not name.endswith(end):
                    continue
                for pose_end in POSE_ENDS:
                    poses = self._lists.get(name.removesuffix(end) + pose_end, [])
                    # Values of the same name belong together in the order of the text.
                    for (line, q), (_, pose) in zip(rows, poses, strict=False):
                        yield _point(q, pose, line, name.removesuffix(end))
                break

    def _value(self, node: ast.expr) -> Six | None:
        """Return six numbers: a list, a name that is given one list, or a call around one."""
        if (values := _six(node)) is not None:
            return values
        if isinstance(node, ast.Name):
            rows = self._lists.get(node.id, [])
            return rows[0][1] if len({values for _, values in rows}) == 1 else None
        if isinstance(node, ast.Call) and len(node.args) == 1 and not node.keywords:
            return self._value(node.args[0])
        return None


def _called(node: ast.Call) -> str:
    return node.func.id if isinstance(node.func, ast.Name) else ""


def _six(node: ast.expr) -> Six | None:
    if not isinstance(node, ast.List | ast.Tuple) or len(node.elts) != 6:
        return None
    values = []
    for element in node.elts:
        sign = 1.0
        if isinstance(element, ast.UnaryOp) and isinstance(element.op, ast.USub | ast.UAdd):
            sign = -1.0 if isinstance(element.op, ast.USub) else 1.0
            element = element.operand
        if not isinstance(element, ast.Constant) or not _is_number(element.value):
            return None
        values.append(sign * float(element.value))
    return _as_six(values)


def _as_six(values: Sequence[float]) -> Six | None:
    if len(values) != 6 or not all(map(isfinite, values)):
        return None
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)


def _point(q: Six, pose: Six, line: int, name: str) -> Point:
    return Point(q, pose, line, name)


_NUMBERS: Final = r"p?\[\s*([^\[\]]*?)\s*\]"
_MOVE_WITH_POSE: Final = re.compile(rf"movej\s*\(\s*(?:q\s*=\s*)?{_NUMBERS}[^#\n]*#[^\n]*?{_NUMBERS}")


def _points_in_comments(text: str) -> Iterator[Point]:
    """Yield moves to joints whose line has the pose in a comment."""
    for number, line in enumerate(text.splitlines(), 1):
        match = _MOVE_WITH_POSE.search(line)
        if match is None:
            continue
        q, pose = (_numbers(part) for part in match.groups())
        if q is not None and pose is not None:
            yield _point(q, pose, number, f"line {number}")


def _numbers(text: str) -> Six | None:
    try:
        return _as_six([float(part) for part in text.split(",")])
    except ValueError:
        return None


# ---------------------------------------------------------------- CSV and JSON


def points_of_file(text: str, name: str, tcp: Six | None = None) -> Points:
    """Return the points of a CSV or JSON file.

    CSV: twelve columns, q1 to q6 in rad and x, y, z, rx, ry, rz in m and rad; a line of names may come first.
    JSON: a list of `{"q": [...], "pose": [...]}`, each with a `tcp` if it has one.

    Raises:
        UsageError: something else; the text names the place.
    """
    rows = _json_rows(text, name) if name.lower().endswith(".json") else _csv_rows(text, name)
    offset = NO_TCP if tcp is None else tcp
    found = [point if point.tcp is not None else point._replace(tcp=offset) for point in rows]
    if tcp is not None:
        words = "the TCP offset is the one that was given"
    elif any(point.tcp is not None for point in rows):
        words = f"the TCP offset is that of {name}"
    else:
        words = "no TCP offset was given, so poses are taken as those of the flange: one along its z axis is part of d6"
    return _points(found, words)


def _cells(text: str, name: str) -> Iterator[list[str]]:
    reader = csv.reader(io.StringIO(text))
    try:
        yield from reader
    except csv.Error as error:
        raise UsageError(f"{name}:{reader.line_num}: not CSV: {error}") from None


def _csv_rows(text: str, name: str) -> list[Point]:
    found = []
    for number, row in enumerate(_cells(text, name), 1):
        if not row or not "".join(row).strip() or row[0].lstrip().startswith("#"):
            continue
        try:
            numbers = [float(cell) for cell in row]
        except ValueError:
            if number == 1:
                continue
            raise UsageError(
                f"{name}:{number}: needs twelve numbers, q1 to q6 in rad, x, y, z in m, rx, ry, rz"
            ) from None
        if len(numbers) != 12:
            raise UsageError(f"{name}:{number}: has {len(numbers)} numbers, needs twelve: six joints, then the pose")
        found.append(_checked(numbers[:6], numbers[6:], number, f"{name}:{number}"))
    return found


def _json_rows(text: str, name: str) -> list[Point]:
    try:
        rows = json_value(text)
    except JsonError as error:
        raise UsageError(f"{name}:{error.line}: not JSON: {error}") from None
    if not isinstance(rows, list):
        raise UsageError(f'{name}: needs a list of {{"q": [...], "pose": [...]}}')
    found = []
    for number, row in enumerate(rows):
        place = f"{name}: point {number}"
        if not isinstance(row, dict) or not {"q", "pose"} <= row.keys():
            raise UsageError(f'{place}: needs "q" and "pose", has {row!r}')
        point = _checked(row["q"], row["pose"], number + 1, place)
        if "tcp" in row:
            point = point._replace(tcp=_checked(row["tcp"], NO_TCP, 0, f"{place}: tcp").q)
        found.append(point)
    return found


def _checked(q: Any, pose: Any, line: int, place: str) -> Point:
    rows = []
    for values in (q, pose):
        numbers = isinstance(values, Sequence) and not isinstance(values, str)
        if not numbers or len(values) != 6 or not all(_is_number(value) for value in values):
            raise UsageError(f"{place}: needs six finite numbers, has {values!r}")
        a, b, c, d, e, f = map(float, values)
        rows.append((a, b, c, d, e, f))
    if max(map(abs, rows[0])) > JOINTS_MAX_RAD:
        raise UsageError(f"{place}: {max(rows[0], key=abs):g} rad is more than two turns: joints are in rad")
    return _point(rows[0], rows[1], line, place)


def _is_number(value: object) -> TypeGuard[int | float]:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    try:
        return isfinite(value)
    except OverflowError:
        return False
