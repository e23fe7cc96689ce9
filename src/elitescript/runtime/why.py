"""Says why a thread does not go on: the condition of the loop in which it is, and the values that decide it.

Nothing of the program runs for that: names are looked up where they are stored, signals are read as they are. What
could only be known by asking a device again is left out.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import FrameType
from typing import Any, Final

from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.runtime.connections.connection import Receiver, ScriptConnection
from elitescript.runtime.stdlib.locks import holder_awaited
from elitescript.runtime.threads.strand import ENDED, Strand
from elitescript.said import Said, joined, said
from elitescript.values.concrete import glance

SHOWN_MAX: Final = 80
"""Most characters of a value or a condition."""
EXITS_MAX: Final = 3
"""Most conditions of one endless loop."""

_READS: Final = {
    "get_standard_digital_in": "standard_digital_in",
    "get_standard_digital_out": "standard_digital_out",
    "get_configurable_digital_in": "configurable_digital_in",
    "get_configurable_digital_out": "configurable_digital_out",
    "get_standard_analog_in": "standard_analog_in",
    "get_flag": "flag",
    "read_input_boolean_register": "input_bool_register",
    "read_input_float_register": "input_float_register",
    "read_input_integer_register": "input_int_register",
    "read_output_boolean_register": "output_bool_register",
    "read_output_float_register": "output_float_register",
    "read_output_integer_register": "output_int_register",
}
"""Commands that only read a point, and its family."""
_PLAIN: Final = (bool, int, float, str, bytes, list, tuple, type(None))

ReadSignal = Callable[[str, int], Any]


def reason_of(strand: Strand, source: SourceFile, read: ReadSignal, connections: Iterable[Receiver] = ()) -> str:
    """Return why a thread of a program does not go on, for behind what it waits for; empty if that is not known.

    Args:
        strand: the thread.
        source: text of the program.
        read: returns the level of a point by family and index.
        connections: of its program.
    """
    held = _holder(strand) or _data_there(strand, connections)
    tree: ast.AST | None = None
    for frame in strand.script_frames():
        tree = tree or parse(source).tree
        loop = _loop_at(tree, frame.f_lineno or 0)
        if loop is not None and frame.f_code.co_filename == source.name:
            return joined("; ", filter(None, (held, _Loop(tree, loop, frame, read).words())))
    return held


def _holder(strand: Strand) -> str:
    holder = holder_awaited(strand)
    if holder is None:
        return ""
    if holder is strand:
        return Said("it holds the lock itself")
    if holder.state is ENDED:
        return said("{thread} holds the lock and has ended", thread=holder.name)
    return said("{thread} holds the lock", thread=holder.name)


def _data_there(strand: Strand, connections: Iterable[Receiver]) -> str:
    """Return the data that a thread has not got from the connection for which it waits, and what is missing in it."""
    for connection in connections:
        if isinstance(connection, ScriptConnection) and connection.is_awaited_by(strand) and connection.received:
            data = bytes(connection.received[:SHOWN_MAX])
            there = said("{data!r} is there", data=data.decode("utf-8", "backslashreplace"))
            lacks = getattr(connection.rule, "lacks", None)
            if lacks is None:
                return there
            what, wanted = lacks(data)
            if what == "count":
                return said("{there}, {count}", there=there, count=wanted)
            return said("{there}, its {part} {mark!r} has not come", there=there, part=Said(what), mark=wanted)
    return ""


def _loop_at(tree: ast.AST, line: int) -> ast.While | None:
    """Return the innermost `while` around a line."""
    found: ast.While | None = None
    for node in ast.walk(tree):
        if isinstance(node, ast.While) and node.lineno <= line <= (node.end_lineno or node.lineno):
            found = node if found is None or node.lineno >= found.lineno else found
    return found


def _scope_at(tree: ast.AST, line: int) -> ast.AST:
    """Return the innermost function around a line, or the whole text."""
    found = tree
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.lineno <= line <= (node.end_lineno or node.lineno):
            found = node
    return found


class _Loop:
    """A loop in which a thread is."""

    __slots__ = ("_loop", "_names", "_read", "_tree")

    def __init__(self, tree: ast.AST, loop: ast.While, frame: FrameType, read: ReadSignal) -> None:
        self._tree = tree
        self._loop = loop
        self._names: Mapping[str, Any] = {**frame.f_globals, **frame.f_locals}
        self._read = read

    def words(self) -> str:
        """Return the condition of the loop, or those of its ends, with the values in them."""
        loop = self._loop
        test, line = _text(loop.test), loop.lineno
        if not isinstance(loop.test, ast.Constant):
            values = self._values(loop.test)
            return said("`while {test}` in line {line} goes on{values}", test=test, line=line, values=values)
        exits = list(_exits(loop.body))[:EXITS_MAX]
        if not exits:
            return said("`while {test}` in line {line} has no end", test=test, line=line)
        ends = joined(
            " or ",
            (
                said(
                    "in line {line} when `{test}`{values}",
                    line=node.lineno,
                    test=_text(node.test),
                    values=self._values(node.test),
                )
                for node in exits
            ),
        )
        return said("`while {test}` in line {line} is left {ends}", test=test, line=line, ends=ends)

    def _values(self, test: ast.expr) -> str:
        parts = [
            said("{name} is {value}{setters}", name=name, value=_shown(value), setters=self._setters(node))
            for node, name, value in self._atoms(test)
        ]
        parts += self._line_ends(test)
        return said(": {values}", values=joined(", ", parts)) if parts else ""

    def _atoms(self, test: ast.expr) -> Iterator[tuple[ast.expr, str, Any]]:
        """Yield what a condition reads, each once: node, text, value."""
        seen, stack = set(), [test]
        while stack:
            node = stack.pop()
            name, value = self._known(node)
            if name and name not in seen:
                seen.add(name)
                yield node, name, value
            # Of `q[i]` the value of `i` is of interest, that of the whole `q` is not.
            inner = [node.slice] if name and isinstance(node, ast.Subscript) else ast.iter_child_nodes(node)
            if not name or (not isinstance(node, ast.Attribute) and not _is_length(node)):
                stack += reversed([child for child in inner if isinstance(child, ast.expr)])

    def _known(self, node: ast.expr) -> tuple[str, Any]:
        """Return text and value of something that is read, without running code for it; else an empty text."""
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _READS and node.args:
            number = glance(node.args[0], self._names)
            return (_text(node), self._read(_READS[node.func.id], number)) if type(number) is int else ("", None)
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript | ast.Call):
            value = glance(node, self._names)
            if type(value) in _PLAIN:
                return _text(node), value
        return "", None

    def _setters(self, node: ast.expr) -> str:
        """Return the lines that could set a variable which the loop does not set: not those that led to the loop."""
        if not isinstance(node, ast.Name):
            return ""
        loop, lines = self._loop, set()
        own = _scope_at(self._tree, loop.lineno)
        for other in ast.walk(self._tree):
            if isinstance(other, ast.Name) and other.id == node.id and isinstance(other.ctx, ast.Store):
                line = other.lineno
                if loop.lineno <= line <= (loop.end_lineno or loop.lineno):
                    return ""
                if line > loop.lineno or _scope_at(self._tree, line) is not own:
                    lines.add(line)
        return said(" (set in line {lines})", lines=", ".join(map(str, sorted(lines)))) if lines else ""

    def _line_ends(self, test: ast.expr) -> Iterator[str]:
        for node in ast.walk(test):
            if isinstance(node, ast.Compare) and len(node.ops) == 1:
                left, right = (
                    side.value if isinstance(side, ast.Constant) else self._known(side)[1]
                    for side in (node.left, node.comparators[0])
                )
                if isinstance(left, str) and isinstance(right, str) and left != right and left.strip() == right.strip():
                    yield said("{left!r} and {right!r} differ by a line end or blanks", left=left, right=right)


def _exits(body: list[ast.stmt]) -> Iterator[ast.If]:
    """Yield each `if` that leaves a loop: with a `break` of it, or a `return`."""
    for statement in body:
        if isinstance(statement, ast.If):
            if any(isinstance(inner, ast.Break | ast.Return) for inner in statement.body):
                yield statement
            else:
                yield from _exits(statement.body)
            yield from _exits(statement.orelse)
        elif isinstance(statement, ast.Try | ast.With):
            yield from _exits(statement.body)


def _is_length(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "len"


def _text(node: ast.AST) -> str:
    text = ast.unparse(node)
    return text if len(text) <= SHOWN_MAX else f"{text[:SHOWN_MAX]}…"


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= SHOWN_MAX else f"{text[:SHOWN_MAX]}…"
