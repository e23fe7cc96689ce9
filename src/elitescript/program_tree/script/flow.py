"""Folders, conditions, loops, cases, sub-tasks, threads and events."""

from __future__ import annotations

import re

from elitescript.program_tree import nodes
from elitescript.program_tree.nodes import Case, ElseIf, Event, If, Loop, SubTask, Switch, Thread
from elitescript.program_tree.rows import Row
from elitescript.program_tree.script.writing import Script, identifier
from elitescript.said import said

CASE_OFFSET = 1
"""The case `case_k` stands for the value k minus this. *Assumed*: files have no value of a case."""


def folder(script: Script, row: Row) -> None:
    """Write a folder: its mark, and what is in it at the same level."""
    script.mark(row)
    script.body(script, row.inside)


def conditions(script: Script, row: Row, inside: tuple[Row, ...], branches: tuple[Row, ...]) -> None:
    """Write an if with branches that may stand in it or behind it."""
    node = row.node
    assert isinstance(node, If)
    script.mark(row)
    test = script.expression(node.condition, row, "condition")
    branches = tuple(branch for branch in branches if not branch.node.is_suppressed)
    if node.is_continuous is True:
        if branches:
            script.refuse(branches[0], said("an if that is checked all the time has no other branch"))
        continuously(script, row, inside, f"if ({test}):", test, f"Thread_if_{row.number}")
        return
    with script.block(f"if ({test}):", row, end=False):
        script.body(script, inside)
    has_else = False
    for branch in branches:
        if has_else:
            script.refuse(branch, said("a branch stands behind the else of its if"))
        if isinstance(branch.node, ElseIf):
            head = f"elif ({script.expression(branch.node.condition, branch, 'condition')}):"
        else:
            head, has_else = "else:", True
        with script.block(head, branch, end=False):
            script.mark(branch)
            script.body(script, branch.inside)
    script.comment("end", row)


def continuously(script: Script, row: Row, inside: tuple[Row, ...], head: str, test: str, helper: str) -> None:
    """Write nodes that run in a thread of their own, which ends when a condition is no longer true."""
    number = row.number
    flag, handle = f"thread_flag_{number}", f"thread_handler_{number}"
    with script.function(f"def {helper}():", row):
        script.line(f"global {flag}", row)
        _declared(script, row)
        if isinstance(row.node, Loop):
            with script.block("while (True):", row, is_loop=True):
                script.body(script, inside)
        else:
            script.body(script, inside)
        script.line(f"{flag} = 1", row)
    script.line(f"global {flag}", row)
    script.line(f"{flag} = 0", row)
    with script.block(head, row):
        script.line(f"{handle} = start_thread({helper}, (), detach_mode = False)", row)
        with script.block(f"while ({flag} == 0):", row, is_loop=True):
            with script.block(f"if not ({test}):", row, end=False):
                script.line(f"stop_thread({handle})", row)
                script.line(f"{flag} = 2", row)
            with script.block("else:", row):
                script.line("sync()", row)


def loop(script: Script, row: Row) -> None:
    """Write a loop."""
    node = row.node
    assert isinstance(node, Loop)
    script.mark(row)
    if node.kind == "always":
        with script.block("while (True):", row, is_loop=True):
            script.body(script, row.inside)
    elif node.kind == "count":
        if node.count.__class__ is not int or node.count < 0:
            script.refuse(row, said("the number of turns is {count!r}", count=node.count))
        counter = identifier(node.variable) if node.variable else f"Loop_{row.number}"
        script.line(f"{counter} = 0", row)
        with script.block(f"while ({counter} < {node.count}):", row, is_loop=True):
            script.body(script, row.inside)
            script.line(f"{counter} = {counter} + 1", row)
    elif node.kind == "expression":
        test = script.expression(node.condition, row, "condition")
        if node.is_checked_continuously is True:
            continuously(script, row, row.inside, f"if ({test}):", test, f"Thread_while_{row.number}")
        elif node.is_post_test is True:
            with script.block("while (True):", row, is_loop=True):
                script.body(script, row.inside)
                with script.block(f"if (not ({test})):", row):
                    script.line("break", row)
        else:
            with script.block(f"while ({test}):", row, is_loop=True):
                script.body(script, row.inside)
    else:
        script.refuse(row, said("the kind of loop {kind!r} is not known", kind=node.kind))


def switch(script: Script, row: Row) -> None:
    """Write a switch with its cases."""
    node = row.node
    assert isinstance(node, Switch)
    script.mark(row)
    name = f"switch_{row.number}"
    script.line(f"{name} = {script.expression(node.value, row, 'value')}", row)
    cases = [child for child in row.inside if not child.node.is_suppressed]
    ordered = [child for child in cases if _number_of(child) is not None]
    others = [child for child in cases if _number_of(child) is None]
    head = "if"
    for child in ordered:
        number = _number_of(child)
        assert number is not None
        with script.block(f"{head} ({name} == {number - CASE_OFFSET}):", child, end=False):
            script.mark(child)
            script.body(script, child.inside)
        head = "elif"
    for child in others[1:]:
        script.refuse(child, said("a switch has one default case, and this is another: {name!r}", name=child.mark))
    if others and not isinstance(others[0].node, Case):
        script.refuse(others[0], said("a `{kind}` node cannot stand in a switch", kind=others[0].mark))
    if others and head == "elif":
        with script.block("else:", others[0], end=False):
            script.mark(others[0])
            script.body(script, others[0].inside)
    elif others:
        script.mark(others[0])
        script.body(script, others[0].inside)
    if head == "elif":
        script.comment("end", row)


def _number_of(row: Row) -> int | None:
    """Return the k of `case_k`; None: it is the default case, or no case."""
    if not isinstance(row.node, Case):
        return None
    found = re.search(r"_([0-9]{1,6})$", row.node.name.strip())
    return int(found[1]) if found else None


def call(script: Script, row: Row) -> None:
    """Write the call of a sub-task."""
    node = row.node
    assert isinstance(node, nodes.CallSubTask)
    script.mark(row)
    if not node.name:
        script.refuse(row, said("the sub-task that it runs is not in the file"))
        return
    script.line(f"subTask_{identifier(node.name)}()", row)


def sub_task(script: Script, row: Row) -> None:
    """Write a sub-task as a function."""
    node = row.node
    assert isinstance(node, SubTask)
    with script.function(f"def subTask_{identifier(node.name)}():", row):
        _declared(script, row)
        script.mark(row)
        script.body(script, row.inside)


def thread(script: Script, row: Row) -> None:
    """Write a thread and its start."""
    node = row.node
    assert isinstance(node, Thread)
    name = identifier(node.name) if node.name else f"Thread_{row.number}"
    with script.function(f"def {name}():", row):
        _declared(script, row)
        if node.loops:
            with script.block("while (True):", row, is_loop=True):
                script.mark(row)
                script.body(script, row.inside)
        else:
            script.mark(row)
            script.body(script, row.inside)
    script.line(f"threadId_{name} = start_thread({name}, (), detach_mode = False)", row)


def event(script: Script, row: Row) -> None:
    """Write an event as a thread that waits for its condition."""
    node = row.node
    assert isinstance(node, Event)
    name = identifier(node.name) if node.name else f"Event_{row.number}"
    test = script.expression(node.condition, row, "condition")
    with script.function(f"def {name}():", row):
        _declared(script, row)
        with script.block("while (True):", row, is_loop=True):
            with script.block(f"if ({test}):", row):
                script.mark(row)
                script.body(script, row.inside)
                with script.block(f"while ({test}):", row, is_loop=True):
                    script.line("sync()", row)
            script.line("sync()", row)
    script.line(f"threadId_{name} = start_thread({name}, (), detach_mode = False)", row)


def _declared(script: Script, row: Row) -> None:
    """Declare the variables of the task that a function sets."""
    for name in script.shared(row):
        script.comment(f"global {name}", row)
