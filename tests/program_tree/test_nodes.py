"""Each kind of node, with the script that was written for it by hand; and what its text does in the language."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from elitescript.language.compiler import compile_unit
from elitescript.language.text.source import SourceFile
from elitescript.program_tree import (
    Configuration,
    GlobalVariable,
    Task,
    generated,
    insert,
    read_task,
    rows_of,
    task_bytes,
)
from elitescript.program_tree.configuration import Frame, Pins, Tool
from elitescript.program_tree.nodes import Halt

PAGE = Path(__file__).with_name("nodes.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"^## (.+?)\n\n```xml\n(.*?)```\n```elitescript\n(.*?)```\n", PAGE, re.DOTALL | re.MULTILINE)
TITLES = [title for title, _, _ in EXAMPLES]
CONFIGURATION = Configuration(
    tools=(Tool("gripper", (0.0, 0.0, 0.2, 0.0, 0.0, 0.0), ("0.0", "0.0", "0.2", "0.0", "0.0", "0.0")),),
    frames=(Frame("table", (0.4, 0.1, 0.0, 0.0, 0.0, 0.0)),),
    pins=Pins(
        (
            ("part_ready", "standard_digital_in", 3),
            ("door", "configurable_digital_in", 1),
            ("lamp", "tool_digital_out", 0),
            ("count", "output_integer_register", 5),
        )
    ),
)
VARIABLES = (GlobalVariable("home", "[0.0, -1.5, 1.5, -1.5, -1.57, 0.0]"), GlobalVariable("n", "1", "pieces"))


def task_of(xml: str) -> tuple[bytes, Task]:
    data = (
        '<EliTask name="cell" installationName="inst" robotType="CS66">\n'
        '  <MainTask isTaskAlwaysLoops="false" hasInitVariables="false" typeName="Robot Main Task">\n'
        f"{xml}  </MainTask>\n</EliTask>"
    ).encode()
    return data, read_task(data)


def test_the_page_is_read() -> None:
    assert len(EXAMPLES) == PAGE.count("\n## ") > 25


@pytest.mark.parametrize(("title", "xml", "expected"), EXAMPLES, ids=TITLES)
class TestNodes:
    def test_script(self, title: str, xml: str, expected: str) -> None:
        _, task = task_of(xml)
        result = generated(task, CONFIGURATION, VARIABLES)
        assert result.problems == ()
        lines = result.text.split("\n")
        start = lines.index('  $ LINE: (1, "Robot Main Task")')
        assert [line[2:] for line in lines[start + 1 : -2]] == expected.split("\n")[:-1]

    def test_it_compiles(self, title: str, xml: str, expected: str) -> None:
        _, task = task_of(xml)
        compile_unit(SourceFile("cell", generated(task, CONFIGURATION, VARIABLES).text))

    def test_each_line_has_the_row_of_its_mark(self, title: str, xml: str, expected: str) -> None:
        _, task = task_of(xml)
        result = generated(task, CONFIGURATION, VARIABLES)
        lines = result.text.split("\n")[:-1]
        assert len(lines) == len(result.line_rows)
        for line, row in zip(lines, result.line_rows, strict=True):
            if found := re.match(r' *\$ LINE: \((\d+), "', line):
                assert row == int(found[1])

    def test_the_file_is_written_as_it_was_read(self, title: str, xml: str, expected: str) -> None:
        data, task = task_of(xml)
        assert task_bytes(task) == data

    def test_nodes_made_anew_are_read_as_the_same(self, title: str, xml: str, expected: str) -> None:
        _, task = task_of(xml)
        new = Task("cell", "inst", "CS66", parts=tuple(without_source(part) for part in task.parts))
        assert read_task(task_bytes(new)) == task

    def test_an_edit_beside_it_leaves_its_text(self, title: str, xml: str, expected: str) -> None:
        data, task = task_of(xml)
        new = task_bytes(insert(task, len(rows_of(task)) + 1, Halt(type_name="Halt"))).decode()
        found = re.search(r'\n *<HaltNode typeName="Halt"/>(?=\s*</MainTask>)', new)
        assert found is not None
        assert new[: found.start()] + new[found.end() :] == data.decode()


def without_source(node):  # type: ignore[no-untyped-def]
    from elitescript.program_tree.nodes import If
    from elitescript.records import replace

    given = {"source": None, "children": tuple(without_source(child) for child in node.children)}
    if isinstance(node, If):
        given["branches"] = tuple(without_source(child) for child in node.branches)
    return replace(node, **given)
