"""Graphical programs as the page has them: the rows of a tree, and the node of each line of its script."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from elitescript.conversation import describe
from elitescript.conversation.limits import cut_name, cut_text
from elitescript.environment.task_files import OpenedTask
from elitescript.program_tree import Generated, place_of
from elitescript.program_tree.listing import kind_of, name_of, summary_of

Message = dict[str, Any]


def tree(script: Generated | None) -> Message:
    """Return the tree of a task.

    Args:
        script: of the task; None if the file is no task: then there are neither rows nor nodes.

    Returns:
        `rows` with `level`, `kind`, `name`, `summary` and `is_suppressed` in the order of their numbers; `lines`: for
        each line of the script the number of its row, 0 for none; `places`: of the rows, as people say them, the empty
        place of row 0 first.
    """
    if script is None:
        return {"rows": [], "lines": [], "places": [""]}
    rows = [
        {
            "level": row.level,
            "kind": kind_of(row.node),
            "name": cut_name(" ".join(name_of(row.node).split())),
            "summary": cut_text(summary_of(row.node)),
            "is_suppressed": row.node.is_suppressed,
        }
        for row in script.rows
    ]
    places = ["", *(cut_name(place_of(script.rows, row.number)) for row in script.rows)]
    return {"rows": rows, "lines": list(script.line_rows), "places": places}


def nodes(places: Sequence[str]) -> Message:
    """Return the node of each line of a script as `tree` does, without rows: of a recorded run no tree is known."""
    known = {"": 0}
    lines = [known.setdefault(cut_name(place), len(known)) for place in places]
    return {"rows": [], "lines": lines, "places": list(known)}


def with_task(message: Message, task: OpenedTask | None) -> Message:
    """Return the findings of a script with what is known of the graphical program that it was generated from.

    Args:
        message: with the findings of the script.
        task: the graphical program; None if it is none.
    """
    if task is None:
        return message
    found = describe.problems(message["version"], (*task.errors, *task.source.notes), compiles=not task.errors)
    # Without a script that can run, what was found in it says nothing.
    return found if task.errors else message | {"list": [*found["list"], *message["list"]]}
