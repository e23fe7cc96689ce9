"""An element that a list does not have: an alarm (`IndexError`). Elements count from 0.

A reading of three numbers is a list of four: how many arrived, then the numbers.

    def job():
      p = get_target_tcp_pose()
      textmsg(p[5])                               # fine: the last one
      textmsg(p[6])                               # W265: six elements, 0 to 5
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said
from elitescript.values.description import INT, LIST, TUPLE


@rule(code="W265", since="0.3", needs_values=True)
def index_out_of_range(program: AnalysedProgram) -> Iterator[Finding]:
    """Report indices and unpackings of lists whose length is certain."""
    written = _are_counts_written(program)
    for node in program.nodes(ast.Subscript):
        if isinstance(node.slice, ast.Slice):
            continue
        index = program.values.of(node.slice)
        # A variable may be a switch, or be checked before.
        if (
            not index.has_constant
            or index.kinds != INT
            or any(isinstance(part, ast.Name) for part in ast.walk(node.slice))
        ):
            continue
        length = _length(program, node.value, written)
        if length is not None and not -length <= index.constant < length and not program.is_tried(node):
            text = said(
                "{expression} has {length} elements, and none with the index {index}",
                expression=shown_source(program, node.value),
                length=length,
                index=index.constant,
            )
            yield Finding(node, text, said("the first is 0, the last {length}", length=length - 1) if length else "")
    for assignment in program.nodes(ast.Assign):
        for target in assignment.targets:
            if not isinstance(target, (ast.Tuple, ast.List)) or any(
                isinstance(part, ast.Starred) for part in target.elts
            ):
                continue
            length = _length(program, assignment.value, written)
            if length is not None and length != len(target.elts) and not program.is_tried(assignment):
                what = said(
                    "{expression} has {length} elements",
                    expression=shown_source(program, assignment.value),
                    length=length,
                )
                yield Finding(
                    target,
                    said("{what}, and {count} names take them", what=what, count=len(target.elts)),
                    "take as many as there are",
                )


def _are_counts_written(program: AnalysedProgram) -> bool:
    """Return whether each reading says as a number how many values it waits for; else that may be filled in later."""
    readings = [
        found
        for found in program.derived(CalledCommands)
        if "number" in found.given and found.name.startswith("socket_read_")
    ]
    return all(isinstance(found.given["number"], ast.Constant) for found in readings)


def _length(program: AnalysedProgram, node: ast.expr, is_written: bool) -> int | None:
    """Return how many elements a list has in any case; None if that is not certain."""
    value = program.values.of(node)
    shape = value.shape
    if (
        value.kinds not in (LIST, TUPLE)
        or shape is None
        or shape.items is None
        or (shape.is_counted and not is_written)
    ):
        return None
    return len(shape.items)
