"""What each expression of a program is: the one place to ask."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection

from elitescript.language.scopes import Scope
from elitescript.language.symbols import Symbols
from elitescript.messages.profile import DEFAULT_FIRMWARE, PROFILES, Profile
from elitescript.values.description import DEPTH_MAX, UNKNOWN, Shape, Value
from elitescript.values.evaluation import Evaluation
from elitescript.values.memory import Memory, StartAgain
from elitescript.values.state import GivenUp


class Values:
    """Describes the expressions and variables of one program, in any run.

    Args:
        symbols: of its text.
        presets: names of globals that have a value before the program begins.
        stop_if_outdated: called before each statement; what it raises ends the evaluation.
        memory: of the version before, from which it takes what has not changed; gets what is known of this one.
        profile: the firmware that it is for; the newest without.

    Attributes:
        is_known: False if the program is nested too deep, or takes too long: then everything is unknown.
    """

    def __init__(
        self,
        symbols: Symbols,
        presets: Collection[str] = (),
        stop_if_outdated: Callable[[], object] = bool,
        memory: Memory | None = None,
        profile: Profile = PROFILES[DEFAULT_FIRMWARE],
    ) -> None:
        self.symbols = symbols
        self._evaluation = Evaluation(symbols, presets, stop_if_outdated, memory, profile)
        self.is_known = True
        try:
            try:
                self._evaluation.run()
            except StartAgain:
                assert memory is not None
                memory.forget()
                self._evaluation = Evaluation(symbols, presets, stop_if_outdated, memory, profile)
                self._evaluation.run()
        except (GivenUp, RecursionError):
            self.is_known = False

    @property
    def evaluated_functions(self) -> list[str]:
        """The names of the functions that were evaluated, each as often as it was; others are as they were."""
        return [function.scope.name for function in self._evaluation.evaluated]

    def release(self) -> None:
        """Let go of what is known: functions know those that have read what they return."""
        self._evaluation.release()

    def of(self, node: ast.expr) -> Value:
        """Return what an expression of the program is."""
        if not self.is_known:
            return UNKNOWN
        found = self._evaluation.values.get(node, UNKNOWN)
        if found.shape is None and not found.sites:
            return found if found.kinds else UNKNOWN
        # What makes a list gives it as it is then, before anything changes it.
        is_new = bool(found.sites) and found.sites is self._evaluation.sites.known(node)
        return self._complete(found, is_new=is_new)

    def before(self, node: ast.AugAssign) -> Value:
        """Return what the target of `x += 1` is before the statement."""
        found = self._evaluation.values.get(node, UNKNOWN) if self.is_known else UNKNOWN
        return self._complete(found)

    def variable(self, name: str, scope: Scope) -> Value:
        """Return all that a variable ever is, by a name and the scope in which it is used."""
        if not self.is_known:
            return UNKNOWN
        variable = self._evaluation.variable(name, scope)
        return UNKNOWN if variable is None else self._complete(variable.cell.value)

    def evaluated(self, node: ast.expr, scope: Scope) -> Value:
        """Return what an expression is that stands in a scope but not in the text, or anywhere in that scope."""
        if not self.is_known:
            return UNKNOWN
        if node in self._evaluation.values:
            return self.of(node)
        try:
            return self._complete(self._evaluation.aside(node, scope))
        except (GivenUp, RecursionError):
            return UNKNOWN

    def _complete(self, value: Value, depth: int = 0, *, is_new: bool = False) -> Value:
        """Return a description with what is put into its lists later."""
        if not value.kinds:
            return UNKNOWN
        if not is_new:
            value = self._evaluation.sites.now(value)
        shape = value.shape
        if shape is None:
            return value
        if depth > DEPTH_MAX:
            return value.but(shape=None)
        if shape.is_plain:
            return value
        if shape.items is None:
            element = self._complete(shape.element, depth + 1)
            return value.but(shape=Shape(None, element, shape.least, shape.most, shape.is_counted))
        items = tuple(self._complete(item, depth + 1) for item in shape.items)
        return value.but(shape=Shape(items, is_counted=shape.is_counted))
