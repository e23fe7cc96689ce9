"""Invariants of trees, over random ones: what is written is read as the same, edits touch what they name."""

from __future__ import annotations

import re
from random import Random

import pytest

from elitescript.language.compiler import compile_unit
from elitescript.language.text.source import SourceFile
from elitescript.program_tree import (
    Task,
    generated,
    insert,
    move,
    nodes,
    read_task,
    remove,
    replace,
    rows_of,
    set_enabled,
    task_bytes,
)
from elitescript.program_tree.edits import Nodes
from elitescript.program_tree.nodes import MainTask, Node
from elitescript.records import replace as changed
from tests.program_tree.trees import random_task

SEEDS = range(40)


def read_again(task: Task) -> Task:
    return read_task(task_bytes(task))


@pytest.mark.parametrize("seed", SEEDS)
class TestInvariants:
    def test_a_written_task_is_read_as_the_same(self, seed: int) -> None:
        task = random_task(Random(seed))
        data = task_bytes(task)
        read = read_task(data)
        assert read == task
        assert task_bytes(read) == data

    def test_edits(self, seed: int) -> None:
        """Random edits of a task that was read: the file that is written is the tree that was made."""
        random = Random(seed)
        task = read_again(random_task(random, 15))
        for _ in range(8):
            task = random_edit(random, task)
            read = read_again(task)
            assert read == task
            assert not [row for row in read.damage if "refers" in row.text]
            task = read if random.random() < 0.5 else task

    def test_numbers_and_marks(self, seed: int) -> None:
        task = random_task(Random(seed))
        result = generated(task)
        rows = rows_of(task)
        assert [row.number for row in rows] == list(range(1, len(rows) + 1))
        marks = [int(number) for number in re.findall(r"\$ LINE: \((\d+), \"", result.text)]
        assert len(marks) == len(set(marks))
        for part in (row for row in rows if not row.parent):
            # Sub-tasks, threads and events stand in front of the main task, with numbers behind its own.
            last = next((row.number for row in rows[part.number :] if not row.parent), len(rows) + 1)
            own = [mark for mark in marks if part.number <= mark < last]
            assert own == sorted(own)
        silent = {row.number for row in rows if row.node.is_suppressed or isinstance(row.node, nodes.InitVariables)}
        assert set(marks) == {row.number for row in rows} - silent

    def test_the_script_compiles(self, seed: int) -> None:
        result = generated(random_task(Random(seed)))
        assert not result.errors
        compile_unit(SourceFile("cell", result.text))
        assert generated(random_task(Random(seed))).text == result.text

    def test_suppressing_changes_numbers_and_its_own_text_alone(self, seed: int) -> None:
        random = Random(seed)
        task = random_task(random)
        rows = [row for row in rows_of(task) if row.parent and not row.inside and not row.node.is_suppressed]
        row = random.choice(rows)
        assert set_enabled(set_enabled(task, row.number, False), row.number, True) == task
        assert len(rows_of(set_enabled(task, row.number, False))) == len(rows_of(task))


def random_edit(random: Random, task: Task) -> Task:
    rows = rows_of(task)
    inner = [row.number for row in rows if row.parent and not _is_bound(row.node)]
    if not inner:
        return insert(task, len(rows) + 1, nodes.Halt())
    row = random.choice(inner)
    match random.randrange(5):
        case 0:
            return remove(task, row)
        case 1:
            return insert(task, row, random_task(random, 3).main.children[0])
        case 2:
            rest = remove(task, row)
            places = [other.number for other in rows_of(rest) if other.parent and not _is_bound(other.node)]
            return move(task, row, random.choice([*places, len(rows_of(rest)) + 1]))
        case 3:
            return set_enabled(task, row, random.random() < 0.5)
        case _:
            node = rows[row - 1].node
            if isinstance(node, nodes.Wait) and node.kind == "time":
                return replace(task, row, changed(node, duration=2.5))
            if isinstance(node, nodes.Loop):
                return replace(task, row, changed(node, count=7, variable=random.choice(("a", "new"))))
            if isinstance(node, nodes.Folder):
                return replace(task, row, changed(node, name="other & <new>"))
            return replace(task, row, nodes.Halt())


def _is_bound(node: Node) -> bool:
    bound = nodes.Waypoint | nodes.Direction | nodes.Until | nodes.ElseIf | nodes.Else | nodes.Case | MainTask
    return isinstance(node, bound)


def test_copies_of_a_node_that_holds_an_object() -> None:
    """Beside the one that was read, its copy refers to the same variable."""
    task = read_again(Task("t", "t", "CS66", parts=(MainTask(children=_loop()),)))
    loop = rows_of(task)[1].node
    twice = insert(task, 2, loop)
    text = task_bytes(twice).decode()
    assert text.count('name="Loop_1"') == 1
    assert text.count('reference="../../LoopNode/TaskVariable"') == 1
    assert read_again(twice) == twice


def _loop() -> Nodes:
    return (nodes.Loop(kind="count", count=2, variable="Loop_1"),)
