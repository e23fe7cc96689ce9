"""Trees as text and as data: a node a line, and what differs between two trees, node by node."""

from __future__ import annotations

from difflib import SequenceMatcher
from math import isnan
from typing import Any, Final

from elitescript.program_tree import nodes
from elitescript.program_tree.cells import Expression, is_taught
from elitescript.program_tree.nodes import Node, Position
from elitescript.program_tree.rows import Row, rows_of
from elitescript.program_tree.script.writing import Problem
from elitescript.program_tree.task import Task
from elitescript.records import fields_of, record

_UNITS: Final = {
    "joint_speed": "rad/s",
    "joint_acceleration": "rad/s^2",
    "speed": "m/s",
    "acceleration": "m/s^2",
    "radius": "m",
    "duration": "s",
    "timeout": "s",
    "distance": "m",
    "force": "N",
    "joint_deceleration": "rad/s^2",
    "deceleration": "m/s^2",
}
"""Units of fields of all kinds of nodes."""
_ON_THE_SIDE: Final = ("children", "branches", "source", "is_suppressed", "type_name")

_KINDS: Final[dict[type[Node], str]] = {
    nodes.InitVariables: "Initial variables",
    nodes.BeforeStart: "Before start",
    nodes.MainTask: "Main task",
    nodes.SubTask: "Sub-task",
    nodes.ElseIf: "Else if",
    nodes.CallSubTask: "Call",
    nodes.ScriptLine: "Script line",
    nodes.ScriptFile: "Script file",
    nodes.Extension: "Plugin node",
    nodes.Unknown: "Unknown node",
}
_MOVES: Final = {"joint": "MoveJ", "linear": "MoveL", "process": "MoveP"}


def kind_of(node: Node) -> str:
    """Return the name of the kind of a node, in English."""
    if isinstance(node, nodes.Move):
        return _MOVES.get(node.movement, "Move")
    return _KINDS.get(type(node), type(node).__name__)


def name_of(node: Node) -> str:
    """Return the name that a node has; empty: it has none."""
    if isinstance(node, nodes.Waypoint) and node.position == "variable":
        return node.variable
    if isinstance(node, nodes.Unknown):
        return node.element
    name = getattr(node, "name", "") or getattr(node, "variable", "")
    return name if isinstance(name, str) else ""


def summary_of(node: Node) -> str:
    """Return what a node does in a few words; values with units."""
    parts = [*_SUMMARIES.get(type(node), _nothing)(node)]
    if node.is_suppressed:
        parts.append("suppressed")
    return ", ".join(part for part in parts if part)


def tree_text(task: Task) -> str:
    """Return a task as text, one node a line: row, indentation, kind, name, summary."""
    rows = rows_of(task)
    width = len(str(len(rows)))
    lines = []
    for row in rows:
        words = " ".join(word for word in (kind_of(row.node), _word(name_of(row.node))) if word)
        summary = summary_of(row.node)
        lines.append(f"{row.number:<{width}} {'  ' * row.level}{words}{f': {summary}' if summary else ''}")
    return "".join(f"{line}\n" for line in lines)


def _word(name: str) -> str:
    return " ".join(name.split())


def _measure(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.6g} {unit}"


def _text(expression: Expression) -> str:
    return " ".join(expression.text().split())


def _nothing(_: Any) -> list[str]:
    return []


def _of_move(node: nodes.Move) -> list[str]:
    if node.movement == "joint":
        motion = (_measure(node.joint_speed, "rad/s"), _measure(node.joint_acceleration, "rad/s^2"))
    else:
        motion = (_measure(node.speed, "m/s"), _measure(node.acceleration, "m/s^2"))
    radius = _measure(node.radius, "m") if node.movement == "process" else ""
    frame = node.frame if node.frame not in ("", "Ctrl_base_frame") else ""
    return [
        *motion,
        f"blend {radius}" if radius else "",
        f"frame {frame}" if frame else "",
        f"TCP {node.tcp}" if node.tcp else "",
    ]


def _of_waypoint(node: nodes.Waypoint) -> list[str]:
    parts = [node.position] if node.position != "fixed" else []
    if node.position == "fixed":
        parts.append(_place(node.target))
    if node.has_own_radius:
        parts.append(f"blend {_measure(node.radius or 0.0, 'm')}")
    if node.motion_by == "speed":
        parts += [_measure(node.joint_speed, "rad/s"), _measure(node.speed, "m/s")]
    elif node.motion_by == "time":
        parts.append(_measure(node.duration, "s"))
    return parts


def _place(position: Position) -> str:
    if position.pose is not None:
        return f"pose [{', '.join(f'{value:.5g}' for value in position.pose)}]"
    if is_taught(position.joints):
        return f"joints [{', '.join(f'{value:.5g}' for value in position.joints)}]"
    return "never taught"


def _of_direction(node: nodes.Direction) -> list[str]:
    direction = node.axis if node.is_axis else _text(node.vector)
    return [direction, *((_measure(node.speed, "m/s"),) if node.has_own_motion else ())]


def _of_until(node: nodes.Until) -> list[str]:
    match node.kind:
        case "expression":
            return [_text(node.condition)]
        case "input":
            return [f"{node.pin} is {'high' if node.is_high else 'low'}"]
        case "distance":
            return [_measure(node.distance, "m")]
        case "contact":
            return [_measure(node.force, "N")]
        case _:
            return [str(node.kind)]


def _of_loop(node: nodes.Loop) -> list[str]:
    if node.kind == "count":
        return [f"{node.count} times"]
    if node.kind == "expression":
        return [f"while {_text(node.condition)}", "tested after a turn" if node.is_post_test else ""]
    return ["for ever"] if node.kind == "always" else [str(node.kind)]


def _of_wait(node: nodes.Wait) -> list[str]:
    limit = f"at most {_measure(node.timeout, 's')}" if node.has_timeout else ""
    match node.kind:
        case "time":
            return [_measure(node.duration, "s")]
        case "input":
            return [f"{node.pin} is {'high' if node.is_high else 'low'}", limit]
        case _:
            return [_text(node.condition), limit]


def _of_set(node: nodes.Set) -> list[str]:
    match node.kind:
        case "digital":
            return [f"{node.pin} = {'high' if node.is_high else 'low'}"]
        case "analog":
            return [f"{node.pin} = {_measure(node.value, node.unit)}"]
        case _:
            return [f"{node.pin} = {_text(node.expression)}"]


def _first_line(text: str) -> str:
    line = " ".join(text.strip().split("\n", 1)[0].split())
    return line if len(line) <= 60 else f"{line[:57]}..."


_SUMMARIES: Final[dict[type[Node], Any]] = {
    nodes.MainTask: lambda node: ["for ever" if node.loops else "once"],
    nodes.Move: _of_move,
    nodes.Waypoint: _of_waypoint,
    nodes.Direction: _of_direction,
    nodes.Until: _of_until,
    nodes.Loop: _of_loop,
    nodes.If: lambda node: [_text(node.condition), "tested all the time" if node.is_continuous else ""],
    nodes.ElseIf: lambda node: [_text(node.condition)],
    nodes.Switch: lambda node: [_text(node.value)],
    nodes.Event: lambda node: [_text(node.condition)],
    nodes.Wait: _of_wait,
    nodes.Set: _of_set,
    nodes.Assignment: lambda node: [f"= {_text(node.value)}"],
    nodes.Popup: lambda node: [node.kind, repr(_first_line(node.message)), "waits" if node.is_blocking else ""],
    nodes.Timer: lambda node: [str(node.action)],
    nodes.Comment: lambda node: [_first_line(node.text)],
    nodes.ScriptLine: lambda node: [_first_line(_text(node.statement))],
    nodes.ScriptFile: lambda node: [node.path, f"{len(node.text.splitlines())} lines"],
}


# ---------------------------------------------------------------- data


def task_record(task: Task, problems: tuple[Problem, ...] = ()) -> dict[str, Any]:
    """Return a task as JSON has it: nodes by rows, fields in SI units, what cannot be generated."""
    rows = rows_of(task)
    lines = task.lines_of([row.node for row in rows])
    return {
        "name": task.name,
        "installation": task.installation,
        "robot_type": task.robot_type,
        "damage": [{"line": row.line, "text": str(row.text)} for row in task.damage],
        "problems": [
            {
                "row": row.row,
                "severity": "error" if row.is_error else "note",
                "text": str(row.text),
                "hint": str(row.hint),
            }
            for row in problems
        ],
        "rows": [_record_of(row, line) for row, line in zip(rows, lines, strict=True)],
    }


def _record_of(row: Row, line: int) -> dict[str, Any]:
    node = row.node
    return {
        "row": row.number,
        "parent": row.parent or None,
        "kind": kind_of(node),
        "mark": row.mark,
        "is_suppressed": node.is_suppressed,
        "line": line,
        "summary": summary_of(node),
        "fields": {name: _plain(value) for name, value in _own_fields(node)},
    }


def _own_fields(node: Node) -> list[tuple[str, Any]]:
    return [(name, getattr(node, name)) for name in fields_of(type(node)) if name not in _ON_THE_SIDE]


def _plain(value: Any) -> Any:
    if isinstance(value, Expression):
        return value.text()
    if isinstance(value, Position):
        return {"joints": _plain(value.joints), "pose": _plain(value.pose)}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return None if isnan(value) else float(value)
    return value


# ---------------------------------------------------------------- differences


@record
class Difference:
    """One difference of two trees.

    Attributes:
        kind: `added`, `removed`, `moved` or `changed`.
        old, new: rows in the first and the second tree; None: it is not there.
        fields: of a changed node: name, value before, value after.
    """

    kind: str
    old: Row | None
    new: Row | None
    fields: tuple[tuple[str, str, str], ...] = ()


def differences(old: Task, new: Task) -> tuple[Difference, ...]:
    """Return what differs between two trees, by node, in the order of the second one.

    A node that is the same but for its children is the same; one that stands elsewhere is moved; one with the same kind
    and name, or at the same place between the same neighbours, is changed.
    """
    before, after = rows_of(old), rows_of(new)
    keys = [_key(row) for row in before], [_key(row) for row in after]
    matcher = SequenceMatcher(None, *keys, False)
    pairs: dict[int, int] = {}
    for start, at, length in matcher.get_matching_blocks():
        pairs.update((at + step, start + step) for step in range(length))
    found: list[tuple[int, Difference]] = []
    gone = [place for place in range(len(before)) if place not in set(pairs.values())]
    come = [place for place in range(len(after)) if place not in pairs]
    contents: dict[tuple[Any, ...], list[int]] = {}
    for place in gone:
        contents.setdefault(keys[0][place][1:], []).append(place)
    for place in list(come):
        if same := contents.get(keys[1][place][1:]):
            origin = same.pop(0)
            gone.remove(origin)
            come.remove(place)
            found.append((place, Difference("moved", before[origin], after[place])))
    for tag, start, end, at, until in matcher.get_opcodes():
        if tag != "replace":
            continue
        olds = [place for place in range(start, end) if place in gone]
        for place in range(at, until):
            if place not in come:
                continue
            node = after[place].node
            origin = next(
                (
                    other
                    for other in olds
                    if type(before[other].node) is type(node)
                    and (name_of(before[other].node) == name_of(node) or len(olds) == 1)
                ),
                next((other for other in olds if type(before[other].node) is type(node)), -1),
            )
            if origin < 0:
                continue
            olds.remove(origin)
            gone.remove(origin)
            come.remove(place)
            fields = _changed_fields(before[origin].node, node)
            found.append((place, Difference("changed", before[origin], after[place], fields)))
    found += [(place, Difference("added", None, after[place])) for place in come]
    behind = {origin: place for place, origin in pairs.items()}
    for place in gone:
        near = next((behind[other] for other in range(place, -1, -1) if other in behind), -1)
        found.append((near, Difference("removed", before[place], None)))
    return tuple(row for _, row in sorted(found, key=lambda item: item[0]))


def _key(row: Row) -> tuple[Any, ...]:
    node = row.node
    return row.level, type(node), node.is_suppressed, tuple((name, repr(value)) for name, value in _own_fields(node))


def _changed_fields(old: Node, new: Node) -> tuple[tuple[str, str, str], ...]:
    fields = [
        (name, _shown(name, value), _shown(name, getattr(new, name)))
        for name, value in _own_fields(old)
        if repr(value) != repr(getattr(new, name))
    ]
    if old.is_suppressed != new.is_suppressed:
        fields.append(("suppressed", "yes" if old.is_suppressed else "no", "yes" if new.is_suppressed else "no"))
    return tuple(fields)


def _shown(name: str, value: Any) -> str:
    if isinstance(value, Expression):
        return _text(value) or "nothing"
    if isinstance(value, Position):
        return _place(value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return _measure(value, _UNITS.get(name, "")).strip()
    if value is None or value == "":
        return "nothing"
    return " ".join(str(value).split())


def difference_text(rows: tuple[Difference, ...]) -> str:
    """Return differences as text, one a line: what, the row in the first and the second tree, the node."""
    lines = []
    for row in rows:
        shown = row.new or row.old
        assert shown is not None
        words = " ".join(word for word in (kind_of(shown.node), _word(name_of(shown.node))) if word)
        where = " -> ".join(str(place.number) for place in (row.old, row.new) if place is not None)
        what = "; ".join(f"{name.replace('_', ' ')} {old} -> {new}" for name, old, new in row.fields)
        if not what and row.kind in ("added", "removed"):
            what = summary_of(shown.node)
        lines.append(f"{row.kind:<8} {where:<10} {words}{f': {what}' if what else ''}\n")
    return "".join(lines)
