"""The whole script of a task: its sections in their order, and the table of what writes each kind of node."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final

from elitescript.language.garbage import without_collection
from elitescript.program_tree import nodes
from elitescript.program_tree.cells import Expression, VariableCell
from elitescript.program_tree.configuration import Configuration, GlobalVariable
from elitescript.program_tree.fields import ChildExpression, Objects, variable_of
from elitescript.program_tree.nodes import Else, ElseIf, If, Node
from elitescript.program_tree.rows import Row, rows_of
from elitescript.program_tree.script import flow, moves, signals
from elitescript.program_tree.script.writing import Problem, Script, identifier, listed
from elitescript.program_tree.task import Task, nodes_in
from elitescript.program_tree.xml_text import Element
from elitescript.records import record
from elitescript.said import said

NO_VALUE: Final = "W227"

WRITERS: Final[dict[type[Node], Callable[[Script, Row], None]]] = {
    nodes.Folder: flow.folder,
    nodes.Loop: flow.loop,
    nodes.Switch: flow.switch,
    nodes.CallSubTask: flow.call,
    nodes.Move: moves.move,
    nodes.Wait: signals.wait,
    nodes.Set: signals.set_output,
    nodes.Assignment: signals.assignment,
    nodes.Popup: signals.popup,
    nodes.Timer: signals.timer,
    nodes.ScriptLine: signals.script_line,
    nodes.ScriptFile: signals.script_file,
    nodes.Comment: signals.comment,
    nodes.Halt: signals.halt,
    nodes.Placeholder: signals.placeholder,
    nodes.Extension: signals.extension,
    nodes.Unknown: signals.unknown,
}
"""What writes a node that stands among others; the rest stands in moves, switches or directly in the task."""


@record
class Generated:
    """The script of a task.

    Attributes:
        text: the script; a node that cannot be generated has its mark alone.
        rows: of the task.
        line_rows: the number of the row of each line; 0: the line belongs to no row.
        problems: found on the way, in the order of rows.
        unset: variables of the configuration without a value, which nodes use; the problems name them.
        installation: variables of the configuration: the name of each and that in the script.
        variables: those of the task, in the same form.
    """

    text: str
    rows: tuple[Row, ...]
    line_rows: tuple[int, ...]
    problems: tuple[Problem, ...]
    unset: tuple[str, ...] = ()
    installation: tuple[tuple[str, str], ...] = ()
    variables: tuple[tuple[str, str], ...] = ()

    @property
    def errors(self) -> tuple[Problem, ...]:
        """The problems that keep it from running."""
        return tuple(problem for problem in self.problems if problem.is_error)


def script_of(
    task: Task, configuration: Configuration | None = None, variables: tuple[GlobalVariable, ...] | None = None
) -> str:
    """Return the script of a task as a pendant generates it; what cannot be generated has its mark alone.

    Args:
        task: the task.
        configuration: what stands in `INST.configuration`; None: there is no such file.
        variables: of `INST.configuration.variables`; None: there is no such file.
    """
    return generated(task, configuration, variables).text


@without_collection
def generated(
    task: Task, configuration: Configuration | None = None, variables: tuple[GlobalVariable, ...] | None = None
) -> Generated:
    """Return the script of a task with the row of each line and what is wrong with it; arguments as of `script_of`."""
    rows = rows_of(task)
    given = configuration or Configuration()
    script = Script(identifier(task.name or "task"), task.name or "task", given, body)
    parts = [row for row in rows if not row.parent and not row.node.is_suppressed]
    texts = _Parts(task, parts)
    script.shared = texts.shared
    # Bodies first: the preamble has helpers only if a node needs them.
    script.line(f"def {script.name}():")
    script.level = 1
    _begin(script, variables or ())
    place = len(script.lines)
    _sub_tasks(script, texts)
    _threads_and_events(script, texts)
    _main(script, texts)
    script.level = 0
    script.comment("end")
    preamble = Script(script.name, script.title, given, body)
    preamble.level = 1
    _initial_variables(preamble, task, texts, has_direction=script.has_direction)
    lines = [*script.lines[:place], *preamble.lines, *script.lines[place:]]
    line_rows = [*script.rows[:place], *preamble.rows, *script.rows[place:]]
    problems = sorted((*script.problems, *preamble.problems), key=lambda problem: problem.row)
    unset = _unset(rows, variables or ())
    file = f"{task.installation or task.name}.configuration.variables"
    if variables is not None:
        for name, row in unset.items():
            text = said("the variable {name} has no value", name=name)
            hint = said("It is one of the installation, whose file {file} has no value for it.", file=file)
            problems.append(Problem(row, text, is_error=False, hint=hint, code=NO_VALUE))
        problems.sort(key=lambda problem: problem.row)
    elif unset:
        missing = said("there are no values of the variables {names}", names=", ".join(unset))
        problems.insert(0, Problem(0, missing, is_error=False, hint=said("They stand in {file}.", file=file)))
    text = "\n".join(lines) + "\n"
    if any("\n" in line for line in lines):
        # A text with an end of line inside would shift the rows of all lines behind it.
        line_rows = [row for line, row in zip(lines, line_rows, strict=True) for _ in range(line.count("\n") + 1)]
    installation = tuple((variable.name, identifier(variable.name)) for variable in variables or ())
    of_task = {**texts.variables, **{identifier(name): name for name in _initial_names(texts.initial)}}
    pairs = tuple((name, known) for known, name in of_task.items())
    return Generated(text, rows, tuple(line_rows), tuple(problems), tuple(unset), installation, pairs)


def body(script: Script, rows: tuple[Row, ...]) -> None:
    """Write nodes one after the other; the branches behind an if belong to it."""
    place = 0
    while place < len(rows):
        row = rows[place]
        place += 1
        node = row.node
        if node.is_suppressed:
            continue
        if isinstance(node, If):
            behind = place
            while behind < len(rows) and isinstance(rows[behind].node, ElseIf | Else):
                behind += 1
            inside = tuple(child for child in row.inside if not isinstance(child.node, ElseIf | Else))
            branches = tuple(child for child in row.inside if isinstance(child.node, ElseIf | Else))
            flow.conditions(script, row, inside, branches + rows[place:behind])
            place = behind
            continue
        write = WRITERS.get(type(node))
        if write is None:
            script.mark(row)
            script.refuse(row, said("a `{kind}` node cannot stand here", kind=row.mark))
        else:
            write(script, row)


class _Parts:
    """The parts of a task by their kinds."""

    __slots__ = ("before_start", "events", "initial", "main", "others", "sub_tasks", "threads", "variables")

    def __init__(self, task: Task, parts: list[Row]) -> None:
        def of(kind: type[Node]) -> list[Row]:
            return [row for row in parts if isinstance(row.node, kind)]

        self.initial = of(nodes.InitVariables)
        self.before_start = of(nodes.BeforeStart)
        self.main = of(nodes.MainTask)
        self.sub_tasks = of(nodes.SubTask)
        self.threads = of(nodes.Thread)
        self.events = of(nodes.Event)
        known = (nodes.InitVariables, nodes.BeforeStart, nodes.MainTask, nodes.SubTask, nodes.Thread, nodes.Event)
        self.others = [row for row in parts if not isinstance(row.node, known)]
        self.variables = task_variables(task)

    def shared(self, row: Row) -> tuple[str, ...]:
        """Return the variables of the task that a part sets, which are global in its function."""
        found: dict[str, None] = {}
        waiting = [row]
        while waiting:
            here = waiting.pop(0)
            node = here.node
            if name := _counted_or_assigned(node):
                found[identifier(name)] = None
            elif isinstance(node, nodes.Timer) and node.variable:
                found[identifier(node.variable)] = None
                found[f"timer_{identifier(node.variable)}_on"] = None
            elif isinstance(node, nodes.ScriptLine):
                assigned = _ASSIGNED.match(node.statement.text())
                if assigned is not None and assigned[1] in self.variables:
                    found[assigned[1]] = None
            waiting[:0] = here.inside
        return tuple(found)


def _unset(rows: tuple[Row, ...], variables: tuple[GlobalVariable, ...]) -> dict[str, int]:
    """Return the variables of the configuration that nodes use and that have no value, with the row of the first."""
    found: dict[str, int] = {}
    given = {variable.name for variable in variables if variable.value.strip()}
    for row in rows:
        node = row.node
        if node.is_suppressed:
            continue
        if isinstance(node, nodes.Waypoint) and node.position == "variable" and node.is_global and node.variable:
            found.setdefault(node.variable, row.number)
        for expression in _expressions(node):
            for cell in expression.cells:
                if isinstance(cell, VariableCell) and cell.is_global:
                    found.setdefault(cell.name, row.number)
    # What a node sets has a value by the time another reads it, as far as a tree shows.
    given |= {row.node.variable for row in rows if isinstance(row.node, nodes.Assignment) and row.node.is_global}
    return {name: row for name, row in found.items() if name not in given}


def task_variables(task: Task) -> dict[str, str]:
    """Return the variables of a task that are none of the configuration, in the order of the file.

    Returns:
        Their names in the tree by those in the script.
    """
    found: dict[str, str] = {}
    for node in _nodes(task):
        is_global = isinstance(node, nodes.Assignment | nodes.Waypoint) and node.is_global
        name = node.variable if isinstance(node, nodes.Loop | nodes.Assignment | nodes.Waypoint) else ""
        if name and not is_global:
            found.setdefault(identifier(name), name)
        for expression in _expressions(node):
            for cell in expression.cells:
                if isinstance(cell, VariableCell) and not cell.is_global:
                    found.setdefault(identifier(cell.name), cell.name)
    for node in _nodes(task):
        if isinstance(node, nodes.Timer):
            found.pop(identifier(node.variable), None)
    return found


def _counted_or_assigned(node: Node) -> str:
    """Return the variable that a node sets as it runs; empty: it sets none."""
    if isinstance(node, nodes.Assignment) or (isinstance(node, nodes.Loop) and node.kind == "count"):
        return node.variable
    return ""


_ASSIGNED: Final = re.compile(r"\s*([^\W\d]\w*)\s*=(?!=)")


def _nodes(task: Task) -> list[Node]:
    """Return all nodes of a task that are not suppressed, in the order of the file."""
    found: list[Node] = []
    waiting = list(reversed(task.parts))
    while waiting:
        node = waiting.pop()
        if not node.is_suppressed:
            found.append(node)
            waiting.extend(reversed(nodes_in(node)))
    return found


def _expressions(node: Node) -> tuple[Expression, ...]:
    match node:
        case nodes.If() | nodes.ElseIf() | nodes.Loop() | nodes.Until() | nodes.Wait() | nodes.Event():
            return (node.condition,)
        case nodes.Switch() | nodes.Assignment():
            return (node.value,)
        case nodes.Direction():
            return (node.vector,)
        case nodes.Set():
            return (node.expression,)
        case nodes.ScriptLine():
            return (node.statement,)
        case _:
            return ()


# ---------------------------------------------------------------- sections


def _begin(script: Script, variables: tuple[GlobalVariable, ...]) -> None:
    script.comment("# Preamble Script.")
    script.comment("# Test Preamble Script To Be Added In The Future.")
    script.line("set_safety_mode_transition_hardness(1)")
    script.comment("# Configuration Preamble Script.")
    script.comment("# Configuration variables.")
    for variable in variables:
        name = identifier(variable.name)
        script.comment(f"# {' '.join(variable.remarks.splitlines())}")
        script.line(f"global {name}")
        script.line(f"{name} = {variable.value.strip() or 'None'}")
    given = script.configuration
    for line in (*given.tool_lines, *given.setup_lines):
        script.line(line)
    script.comment("# Frame variables.")
    for frame in given.frames:
        if frame.pose is not None:
            script.line(f"global {identifier(frame.name)}")
            script.line(f"{identifier(frame.name)} = {listed(frame.pose)}")
    script.comment("# Temporary frame variables.")
    script.comment("# Conveyor Config")
    for note in given.notes:
        script.note(None, note)
    script.comment("# Set Node Preamble Script.")
    script.comment("# Loop Node Preamble Script.")
    script.comment("# Waypoint Node Preamble Script.")


def _initial_variables(script: Script, task: Task, parts: _Parts, *, has_direction: bool) -> None:
    script.comment("# Initial Variables value.")
    entries = _initial_values(script, parts.initial)
    for name in dict.fromkeys((*parts.variables, *(identifier(name) for name, _, _ in entries))):
        script.line(f"global {name}")
    for name, value, row in entries:
        script.line(f"{identifier(name)} = {value}", row)
    if has_direction:
        with script.block(f"def {moves.HELPER}(frame, direction, position_distance):", None):
            script.line("direction_length = norm([direction[0], direction[1], direction[2]])")
            with script.block("if (direction_length < 1e-6):", None):
                script.line("return get_target_waypoint()")
            script.line("factor = position_distance / direction_length")
            script.line(
                "displacement = [direction[0] * factor, direction[1] * factor, direction[2] * factor, 0.0, 0.0, 0.0]"
            )
            script.line("offset = pose_sub(pose_trans(frame, displacement), frame)")
            script.line("return pose_add(get_target_waypoint(), offset)")
    timers = dict.fromkeys(
        identifier(node.variable) for node in _nodes(task) if isinstance(node, nodes.Timer) and node.variable
    )
    script.comment("# Timer Node Preamble Script.")
    for name in timers:
        script.line(f"global {name}")
        script.line(f"{name} = 0")
        script.line(f"global timer_{name}_on")
        script.line(f"timer_{name}_on = False")
    if timers:
        with script.function("def timer_thread():", None):
            for name in timers:
                script.line(f"global {name}")
            with script.block("while (True):", None, is_loop=True):
                for name in timers:
                    with script.block(f"if (timer_{name}_on):", None):
                        script.line(f"{name} = {name} + get_steptime()")
                script.line("sync()")
        script.line("threadId_timer_thread = start_thread(timer_thread, (), detach_mode = False)")


def _initial_values(script: Script, rows: list[Row]) -> list[tuple[str, str, Row]]:
    """Return what is set at each start: names with the text of their values. The shape of entries is *assumed*."""
    found: list[tuple[str, str, Row]] = []
    for row in rows:
        for entry in row.node.source.elements if row.node.source is not None else ():
            name, text = _initial_value(entry)
            if name and text:
                found.append((name, text, row))
            else:
                script.note(row, said("an entry of the initial variables is not understood: `{kind}`", kind=entry.name))
    return found


def _initial_names(rows: list[Row]) -> list[str]:
    """Return the variables that are set at each start."""
    entries = [entry for row in rows if row.node.source is not None for entry in row.node.source.elements]
    return [name for name, _ in map(_initial_value, entries) if name]


def _initial_value(entry: Element) -> tuple[str, str]:
    objects = Objects()
    name = next((named for child in entry.elements if (named := variable_of(child, objects)[0])), "")
    (value,) = ChildExpression("value").read(entry, objects)
    return name, value.text().strip()


def _sub_tasks(script: Script, parts: _Parts) -> None:
    script.comment("# SubTask Node Preamble Script.")
    for row in parts.sub_tasks:
        flow.sub_task(script, row)
    script.comment("# Before Start Preamble Script.")
    for row in parts.before_start:
        script.mark(row)
        script.body(script, row.inside)


def _threads_and_events(script: Script, parts: _Parts) -> None:
    script.comment("# Thread Node Preamble Script.")
    for row in parts.threads:
        flow.thread(script, row)
    script.comment("# Event Node Preamble Script.")
    for row in parts.events:
        flow.event(script, row)
    for row in parts.others:
        signals.unknown(script, row)


def _main(script: Script, parts: _Parts) -> None:
    script.comment("# Main Task Script.")
    for row in parts.main:
        node = row.node
        if isinstance(node, nodes.MainTask) and node.loops is not True:
            script.mark(row)
            script.body(script, row.inside)
        else:
            with script.block("while (True):", row, is_loop=True):
                script.mark(row)
                script.body(script, row.inside)
