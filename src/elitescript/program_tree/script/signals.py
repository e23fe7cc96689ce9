"""Waits, outputs, assignments, popups, timers, and texts of script."""

from __future__ import annotations

from elitescript.program_tree import nodes
from elitescript.program_tree.cells import Quantity, number_text
from elitescript.program_tree.nodes import Assignment, Popup, ScriptFile, ScriptLine, Set, Timer, Wait
from elitescript.program_tree.rows import Row
from elitescript.program_tree.script.writing import Script, identifier, quoted
from elitescript.said import said


def script_line(script: Script, row: Row) -> None:
    """Write a statement as it is."""
    node = row.node
    assert isinstance(node, ScriptLine)
    script.mark(row)
    text = script.expression(node.statement, row, "statement")
    if node.statement:
        script.text(text, row)


def script_file(script: Script, row: Row) -> None:
    """Write the text of a file as it was when the node was saved."""
    node = row.node
    assert isinstance(node, ScriptFile)
    script.mark(row)
    if not node.text.strip():
        script.refuse(row, said("the node has no text of its file {path!r}", path=node.path))
        return
    script.text(node.text, row)


def assignment(script: Script, row: Row) -> None:
    """Write an assignment."""
    node = row.node
    assert isinstance(node, Assignment)
    script.mark(row)
    if not node.variable:
        script.refuse(row, said("the assignment has no variable"))
    value = script.expression(node.value, row, "value")
    if node.is_copied is True:
        value = f"copy.deepcopy({value})"
    script.line(f"{identifier(node.variable or '_')} = {value}", row)


def wait(script: Script, row: Row) -> None:
    """Write a wait."""
    node = row.node
    assert isinstance(node, Wait)
    script.mark(row)
    if node.kind == "time":
        if node.duration is None:
            script.refuse(row, said("the wait has no time"))
            return
        script.line(f"sleep({number_text(node.duration)})", row)
        return
    if node.kind == "input":
        test = f"{script.pin(node.pin, row)} == {not node.is_high}"
    elif node.kind == "expression":
        test = f"not ({script.expression(node.condition, row, 'condition')})"
    else:
        script.refuse(row, said("the kind of wait {kind!r} is not known", kind=node.kind))
        return
    limit = node.timeout if node.has_timeout is True else None
    if node.has_timeout is True and limit is None:
        script.refuse(row, said("the wait ends by a time-out, and has no time"))
    counter = f"wait_time_{row.number}"
    if limit is not None:
        script.line(f"{counter} = 0.0", row)
    with script.block(f"while ({test}):", row, is_loop=True):
        script.line("sync()", row)
        if limit is not None:
            script.line(f"{counter} = {counter} + get_steptime()", row)
            with script.block(f"if ({counter} >= {number_text(limit)}):", row):
                script.line("break", row)


def set_output(script: Script, row: Row) -> None:
    """Write an output."""
    node = row.node
    assert isinstance(node, Set)
    script.mark(row)
    if node.sets_tcp is True:
        script.refuse(row, said("the node sets a TCP, and which one its file says in a form that is not known"))
    if node.kind == "digital":
        script.line(script.pin(node.pin, row, str(node.is_high is True)), row)
    elif node.kind == "analog":
        if node.value is None or node.unit not in ("A", "V"):
            script.refuse(row, said("the output has no value in A or V"))
            return
        share = (node.value * 1000.0 - 4.0) / 16.0 if node.unit == "A" else node.value / 10.0
        script.line(script.pin(node.pin, row, number_text(Quantity(round(share, 12) + 0.0))), row)
    elif node.kind == "expression":
        script.line(script.pin(node.pin, row, script.expression(node.expression, row, "value")), row)
    elif node.kind != "none" or not node.sets_tcp:
        script.refuse(row, said("what it sets is not known: {kind!r}", kind=node.kind))


def popup(script: Script, row: Row) -> None:
    """Write a popup."""
    node = row.node
    assert isinstance(node, Popup)
    script.mark(row)
    text = f"str({identifier(node.message)})" if node.is_variable else quoted(node.message)
    flags = ", ".join(
        f"{name}={value}"
        for name, value in (
            ("warning", node.kind == "warning"),
            ("error", node.kind == "error"),
            ("blocking", node.is_blocking is True),
        )
    )
    script.line(f"popup(s={text}, title={quoted(script.title)}, {flags})", row)


def timer(script: Script, row: Row) -> None:
    """Write what a timer does."""
    node = row.node
    assert isinstance(node, Timer)
    script.mark(row)
    name = identifier(node.variable)
    if not node.variable or node.action not in nodes.TIMER_ACTIONS:
        script.refuse(
            row, said("the timer has no variable, or an action that is not known: {kind!r}", kind=node.action)
        )
    elif node.action == "reset":
        script.line(f"{name} = 0", row)
    else:
        script.line(f"timer_{name}_on = {node.action == 'start'}", row)


def comment(script: Script, row: Row) -> None:
    """Write a comment."""
    node = row.node
    assert isinstance(node, nodes.Comment)
    script.mark(row)
    for line in node.text.splitlines() or [""]:
        script.comment(f"# {line}", row)


def halt(script: Script, row: Row) -> None:
    """Write the end of the program."""
    script.mark(row)
    script.line("halt()", row)


def placeholder(script: Script, row: Row) -> None:
    """Write the mark of a placeholder, which does nothing."""
    script.mark(row)


def extension(script: Script, row: Row) -> None:
    """Write what frames the text of a plugin's node; the text only the plugin can write."""
    node = row.node
    assert isinstance(node, nodes.Extension)
    script.comment("# Begin: ELITECO Plugin Task Node", row)
    script.comment(f"#   Source: {node.plugin}, {node.version}, {node.vendor}", row)
    script.comment(f"#   Type: {row.mark}", row)
    script.mark(row)
    script.body(script, row.inside)
    script.comment("# End: ELITECO Plugin Task Node", row)
    script.refuse(
        row,
        said("this is a node of a plugin, which alone could write its text"),
        "Run the script that the pendant has written: `--generated`.",
    )


def unknown(script: Script, row: Row) -> None:
    """Write the mark of a node whose kind is not known."""
    script.mark(row)
    script.refuse(
        row,
        said("nodes of the kind `{kind}` are not known", kind=row.mark),
        "Run the script that the pendant has written: `--generated`.",
    )
