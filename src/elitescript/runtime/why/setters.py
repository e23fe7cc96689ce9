"""Finds which lines of a program could change a variable or a signal for which a thread waits."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final, Protocol

from elitescript.language.scopes import Scope
from elitescript.language.symbols import Symbols
from elitescript.messages.signals import point_names
from elitescript.runtime.why.loops import scope_at
from elitescript.said import Said, said

LINES_MAX: Final = 4
"""Most lines that are named."""

_WRITERS: Final = {
    "set_standard_digital_out": "standard_digital_out",
    "set_configurable_digital_out": "configurable_digital_out",
    "set_standard_analog_out": "standard_analog_out",
    "set_tool_digital_out": "tool_digital_out",
    "set_flag": "flag",
    "write_output_boolean_register": "output_bool_register",
    "write_output_float_register": "output_float_register",
    "write_output_integer_register": "output_int_register",
}
"""Commands that set a point of the signal image, and its family."""

FrameOf = Callable[[Scope], tuple[str, int, Mapping[str, Any]] | None]
"""Returns for a function a thread that is in it: its name, the line there, and the variables; None if none is."""


class Sayer(Protocol):
    """Says conditions; see `conditions.Conditions`."""

    def text(self, node: ast.expr) -> str: ...

    def holds(self, test: ast.expr, names: Mapping[str, Any]) -> bool | None: ...

    def values(self, test: ast.expr, names: Mapping[str, Any], scope: Scope, loop: ast.stmt | None) -> str: ...


class Setters:
    """What sets the variables of one program.

    Args:
        symbols: of its text.
        frame_of: which thread is in a function.
    """

    __slots__ = ("_frame_of", "_symbols")

    def __init__(self, symbols: Symbols, frame_of: FrameOf) -> None:
        self._symbols = symbols
        self._frame_of = frame_of

    def words(self, name: str, scope: Scope, loop: ast.stmt | None, conditions: Sayer) -> str:
        """Return in parentheses what could change a variable that decides about a loop; empty if that is not certain.

        Args:
            name: of the variable.
            scope: in which it is read.
            loop: which it decides; None for no loop.
            conditions: says the condition of a line.
        """
        if loop is None:
            return ""
        home = scope.home(name)
        inside, elsewhere = [], []
        for binding in self._symbols.bindings(name, scope):
            if binding.kind in ("parameter", "import", "def", "class"):
                continue
            place = self._symbols.scope_of(binding.node)
            if _is_in(loop, binding.line) and place is scope_at(self._symbols, loop.lineno):
                inside.append(binding.line)
            elif place is not scope_at(self._symbols, loop.lineno):
                elsewhere.append((binding.line, binding.node, place))
        if inside:
            return said(" ({lines} of the loop {sets} it)", lines=_lines(inside), sets=_sets(inside))
        if elsewhere:
            return self._elsewhere(elsewhere, conditions)
        own = self._own_ones(name, home, scope)
        if own:
            return said(
                " (nothing changes it: {lines} {sets} a variable of {its} own)",
                lines=_lines(own),
                sets=_sets(own),
                its=_its(own),
            )
        if home is None and name not in self._symbols.global_names:
            return ""
        return " (nothing changes it)"

    def _elsewhere(self, found: list[tuple[int, ast.AST, Scope]], conditions: Sayer) -> str:
        """Return which lines of other functions set a variable, and what keeps a single one from it."""
        lines = [line for line, _, _ in found]
        if len(found) > 1:
            return said(" ({lines} {sets} it)", lines=_lines(lines), sets=_sets(lines))
        line, node, place = found[0]
        where = self._frame_of(place)
        if where is None:
            return (
                said(" (line {line} sets it, in {place}, which no thread runs now)", line=line, place=place.name)
                if place.name
                else ""
            )
        thread, at, names = where
        guards = [
            above.test
            for above in self._symbols.ancestors(node)
            if isinstance(above, ast.If) and any(part is node or _contains(part, node) for part in above.body)
        ]
        if not guards:
            return said(" (line {line} sets it, and {thread} is in line {at})", line=line, thread=thread, at=at)
        guard = guards[0]
        is_true = conditions.holds(guard, names)
        state = "" if is_true is None else Said(", which is true now" if is_true else ", which is false now")
        inner = conditions.values(guard, names, place, None)
        return said(
            " (line {line} sets it when `{text}`{state}{inner})",
            line=line,
            text=conditions.text(guard),
            state=state,
            inner=inner,
        )

    def _own_ones(self, name: str, home: Scope | None, scope: Scope) -> list[int]:
        """Return lines that give the same name in other functions another variable: `global` or `nonlocal` misses."""
        found = []
        for other in self._symbols.scopes:
            if other is not home and other is not scope and other.kind == "function" and other.has_local(name):
                found += [item.line for item in other.bindings[name] if item.kind in ("assign", "augmented")]
        return sorted(set(found))

    def of_point(self, family: str, index: int) -> list[str]:
        """Return the lines that set a point of the signal image, as a sentence without subject."""
        lines, is_certain = [], True
        for scope in self._symbols.scopes:
            for call in scope.calls:
                if isinstance(call.func, ast.Name) and _WRITERS.get(call.func.id) == family and call.args:
                    given = call.args[0]
                    if not isinstance(given, ast.Constant):
                        is_certain = False
                    elif given.value == index:
                        lines.append(call.lineno)
        if lines:
            return [said("{lines} {sets} it", lines=_lines(lines), sets=_sets(lines))]
        return [] if is_certain else [said("a line may set {point}", point=point_names(family)[index])]


def _is_in(loop: ast.stmt, line: int) -> bool:
    return loop.lineno <= line <= (loop.end_lineno or loop.lineno)


def _contains(node: ast.AST, other: ast.AST) -> bool:
    return any(part is other for part in ast.walk(node))


def _lines(lines: Iterable[int]) -> str:
    found = sorted(set(lines))
    text = ", ".join(map(str, found[:LINES_MAX])) + (", …" if len(found) > LINES_MAX else "")
    return said("lines {lines}" if len(found) > 1 else "line {lines}", lines=text)


def _sets(lines: Iterable[int]) -> str:
    return "set" if len(set(lines)) > 1 else "sets"


def _its(lines: Iterable[int]) -> str:
    return "their" if len(set(lines)) > 1 else "its"
