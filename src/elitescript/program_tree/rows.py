"""Rows of a task: the numbers that the pendant shows beside its nodes, and the texts of its line marks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.program_tree import nodes
from elitescript.program_tree.nodes import Node
from elitescript.program_tree.task import Task, nodes_in
from elitescript.records import record

WORDS: Final[dict[str, dict[str, str]]] = {
    "en": {"times": "times", "robot": "Robot", "tool": "Tool", "expression": "Expression"},
    "ko": {"times": "횟수", "robot": "로봇", "tool": "Tool", "expression": "표현식"},
}
"""Words of marks besides the name of the kind, as pairs of tree and script have them; other languages get the English
ones (*assumed*), and so does `tool`."""

_LANGUAGES: Final = {"로봇 메인 작업": "ko", "机器人主任务": "zh", "ロボットの主なタスク": "ja"}

_TYPE_NAMES: Final[dict[type[Node], str]] = {
    nodes.InitVariables: "Init Variables Value",
    nodes.BeforeStart: "BeforeStart",
    nodes.MainTask: "Robot Main Task",
    nodes.SubTask: "Subtask",
    nodes.Folder: "Folder",
    nodes.ScriptLine: "Script",
    nodes.ScriptFile: "Script",
    nodes.If: "If",
    nodes.ElseIf: "Else If",
    nodes.Else: "Else",
    nodes.Loop: "Loop",
    nodes.Waypoint: "Waypoint",
    nodes.Arc: "ArcMotion",
    nodes.Direction: "Direction",
    nodes.Until: "Until",
    nodes.Wait: "Wait",
    nodes.Set: "Set",
    nodes.Assignment: "Assignment",
    nodes.Halt: "Halt",
    nodes.Switch: "Switch",
    nodes.Case: "Case",
    nodes.CallSubTask: "Call",
    nodes.Popup: "Popup",
    nodes.Timer: "Timer",
    nodes.Comment: "Comment",
    nodes.Thread: "Thread",
    nodes.Event: "Event",
    nodes.Placeholder: "Placeholder",
    nodes.Extension: "Extension",
}
"""Names of kinds in English, for nodes whose file has none."""

_MOVES: Final = {"joint": "MoveJ", "linear": "MoveL", "process": "MoveP"}


@record
class Row:
    """A node in its row.

    Attributes:
        number: of the row, from 1, as in `$ LINE: (number, …)`.
        node: in the row.
        mark: text of its mark.
        level: 0 for parts of the task, one more for each node around it.
        parent: number of the row of the node around it; 0: there is none.
        inside: the rows in it.
    """

    number: int
    node: Node
    mark: str
    level: int
    parent: int
    inside: tuple[Row, ...] = ()


def rows_of(task: Task) -> tuple[Row, ...]:
    """Return all rows of a task in their order; the row of number n is at n - 1.

    A suppressed node takes one row, with all that is in it.
    """
    language = language_of(task)
    rows: list[Row] = []

    def add(node: Node, level: int, parent: int) -> Row:
        place = len(rows)
        rows.append(_NO_ROW)
        inside: tuple[Row, ...] = ()
        if not node.is_suppressed:
            inside = tuple([add(child, level + 1, place + 1) for child in nodes_in(node)])
        row = rows[place] = Row(place + 1, node, mark_of(node, language), level, parent, inside)
        return row

    for part in parts_in_order(task):
        add(part, 0, 0)
    return tuple(rows)


_NO_ROW: Final = Row(0, Node(), "", 0, 0)


def parts_in_order(task: Task) -> Iterator[Node]:
    """Yield the parts of a task that have rows, in the order of these."""
    ranks = (nodes.InitVariables, nodes.BeforeStart, nodes.MainTask)
    main = task.main
    for kind in ranks:
        for part in task.parts:
            if type(part) is kind and (kind is not nodes.InitVariables or main.has_init_variables):
                yield part
    for part in task.parts:
        if type(part) not in ranks:
            yield part


def language_of(task: Task) -> str:
    """Return the language of the pendant that saved a task, as a key of `WORDS`; English, if that is not known."""
    language = _LANGUAGES.get(task.main.type_name.strip(), "en")
    return language if language in WORDS else "en"


def mark_of(node: Node, language: str = "en") -> str:
    """Return the text of the mark of a node."""
    words = WORDS[language]
    name = type_name_of(node)
    if isinstance(node, nodes.Folder | nodes.SubTask | nodes.CallSubTask | nodes.Thread | nodes.Event | nodes.Case):
        return node.name or name
    if isinstance(node, nodes.Waypoint):
        return (node.variable if node.position == "variable" else node.name) or name
    if isinstance(node, nodes.Loop) and node.kind == "count":
        return f"{name} {node.count} {words['times']}"
    if isinstance(node, nodes.Direction) and node.is_axis:
        frame = "tool" if node.frame == "Ctrl_tool_frame" else "robot"
        sign = "+" if node.axis.endswith("Positive") else "-"
        return f"{name} {words[frame]} {node.axis[:1]}{sign}"
    if isinstance(node, nodes.Until) and node.kind == "expression":
        return f"{name} ({words['expression']})"
    if isinstance(node, nodes.Extension):
        return node.name or name
    return name


def type_name_of(node: Node) -> str:
    """Return the name of the kind of a node, in the language of its file if that says it."""
    if node.type_name.strip():
        return node.type_name.strip()
    if isinstance(node, nodes.Move):
        return _MOVES.get(node.movement, "Move")
    if isinstance(node, nodes.Unknown):
        return node.element
    return _TYPE_NAMES[type(node)]


def place_of(rows: tuple[Row, ...], number: int) -> str:
    """Return where a row is, as people say it: the row of the node around it and the row itself."""
    row = rows[number - 1]
    here = f"{number} {row.mark}"
    if not row.parent:
        return here
    around = rows[row.parent - 1]
    return f"{around.number} {around.mark} > {here}"
