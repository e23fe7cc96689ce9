"""Edits of a task: functions of a tree that return a tree. Rows are those of `$ LINE`, from 1.

An edit touches the nodes on the way to its row; all others stay the same objects, so that they are written as they
were read.
"""

from __future__ import annotations

from collections.abc import Callable

from elitescript.errors import UsageError
from elitescript.program_tree.nodes import Else, ElseIf, If, MainTask, Node
from elitescript.program_tree.rows import Row, rows_of
from elitescript.program_tree.task import Task, nodes_in
from elitescript.records import replace as changed
from elitescript.said import said

Nodes = tuple[Node, ...]


def insert(task: Task, row: int, node: Node) -> Task:
    """Return the task with a node in a row: in front of the node that is there now, beside it.

    One row behind the last is the end of the main task.

    Raises:
        UsageError: there is no such row, or it is a part of the task.
    """
    rows = rows_of(task)
    if row == len(rows) + 1:
        main = _number_of_main(rows)
        return _with(task, rows, main, lambda old: (changed(old, children=(*old.children, node)),))
    return _with(task, rows, row, lambda old: (node, old), is_inside=True)


def remove(task: Task, row: int) -> Task:
    """Return the task without the node of a row and all that is in it.

    Raises:
        UsageError: there is no such row, or it is the main task.
    """
    rows = rows_of(task)
    if isinstance(_row(rows, row).node, MainTask):
        raise UsageError(said("row {row} is the main task, which every task has", row=row))
    return _with(task, rows, row, lambda _: ())


def move(task: Task, row: int, to_row: int) -> Task:
    """Return the task with the node of a row, and all in it, in another row.

    Args:
        task: the task.
        row: where it is.
        to_row: its row afterwards.

    Raises:
        UsageError: there is no such row, or the node is a part of the task.
    """
    node = _row(rows_of(task), row).node
    return insert(remove(task, row), to_row, node)


def replace(task: Task, row: int, node: Node) -> Task:
    """Return the task with another node in place of that of a row.

    A node that was made of the old one (`dataclasses.replace`) keeps in the file what is not understood of it.

    Raises:
        UsageError: there is no such row.
    """
    return _with(task, rows_of(task), row, lambda _: (node,))


def set_enabled(task: Task, row: int, is_enabled: bool) -> Task:
    """Return the task with the node of a row suppressed or not.

    Raises:
        UsageError: there is no such row, or it is a part of the task.
    """
    rows = rows_of(task)
    return _with(task, rows, row, lambda old: (changed(old, is_suppressed=not is_enabled),), is_inside=True)


def _row(rows: tuple[Row, ...], number: int) -> Row:
    if not 1 <= number <= len(rows):
        raise UsageError(said("there is no row {row}: the rows are 1 to {last}", row=repr(number), last=len(rows)))
    return rows[number - 1]


def _number_of_main(rows: tuple[Row, ...]) -> int:
    for row in rows:
        if isinstance(row.node, MainTask):
            return row.number
    raise UsageError(said("the task has no main task"))


def _with(
    task: Task, rows: tuple[Row, ...], number: int, made: Callable[[Node], Nodes], *, is_inside: bool = False
) -> Task:
    """Return the task with what a function makes of a node in its place."""
    row = _row(rows, number)
    if is_inside and not row.parent:
        raise UsageError(said("row {row} is a part of the task: this is done to nodes in parts", row=number))
    new = made(row.node)
    while row.parent:
        around = rows[row.parent - 1]
        place = next(place for place, child in enumerate(around.inside) if child.number == row.number)
        inside = nodes_in(around.node)
        new = (_holding(around.node, (*inside[:place], *new, *inside[place + 1 :])),)
        row = around
    part = _place_of_part(task, rows, row)
    return changed(task, parts=(*task.parts[:part], *new, *task.parts[part + 1 :]))


def _place_of_part(task: Task, rows: tuple[Row, ...], row: Row) -> int:
    """Return where the node of a row stands in `task.parts`."""
    same = [place for place, part in enumerate(task.parts) if part is row.node]
    among = [other for other in rows if not other.parent and other.node is row.node]
    return same[among.index(row)] if len(same) > 1 else same[0]


def _holding(node: Node, inside: Nodes) -> Node:
    """Return a node with other nodes in it."""
    if not isinstance(node, If):
        return changed(node, children=inside)
    children = tuple(child for child in inside if not isinstance(child, ElseIf | Else))
    return changed(
        node, children=children, branches=tuple(child for child in inside if isinstance(child, ElseIf | Else))
    )
