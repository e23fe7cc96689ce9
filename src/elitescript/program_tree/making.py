"""New tasks: an empty one, and one that holds a script."""

from __future__ import annotations

from elitescript.program_tree.nodes import InitVariables, MainTask, Node, Placeholder, ScriptFile
from elitescript.program_tree.task import Task


def new_task(name: str, robot_type: str, children: tuple[Node, ...] = (Placeholder(type_name="PlaceHolder"),)) -> Task:
    """Return a task with a main part, as a pendant makes it.

    Args:
        name: of the task, and of its installation.
        robot_type: `CS66`, …
        children: nodes of the main part.
    """
    main = MainTask(type_name="Robot Main Task", loops=False, has_init_variables=True, children=children)
    return Task(name, name, robot_type, parts=(InitVariables(type_name="Init Variables Value"), main))


def wrapped(name: str, robot_type: str, body: str, path: str) -> Task:
    """Return a task that does what a script does.

    Args:
        name: of the task.
        robot_type: `CS66`, …
        body: the body of its `def`, at the left margin.
        path: of the script, which the node names.
    """
    return new_task(name, robot_type, (ScriptFile(type_name="Script", path=path, text=body),))
