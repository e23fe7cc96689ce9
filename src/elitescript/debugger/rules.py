"""Breakpoints as an engine follows them, and what it watches for them. Frozen, but for the watches."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable
from typing import Any, Final

from elitescript.controller.controller import Controller
from elitescript.debugger.api import ALARM_FILTER, DataBreakpoint, FunctionBreakpoint, LineBreakpoint
from elitescript.debugger.telling import filled
from elitescript.debugger.values import shown
from elitescript.errors import DebugError, UsageError
from elitescript.messages.signals import signal_name
from elitescript.records import record
from elitescript.runtime.program_globals import ProgramGlobals
from elitescript.values.concrete import (
    CONDITION_STEPS_MAX,
    MissingName,
    Refusal,
    computed,
    parsed,
    short,
    truth,
    variables_of,
)
from elitescript.values.places import signal_at

ROBOT_MODE: Final = "robot mode"
SAFETY: Final = "safety"

_SIGNS: Final[dict[str, Callable[[int, int], bool]]] = {
    ">=": operator.ge,
    ">": operator.gt,
    "<=": operator.le,
    "<": operator.lt,
    "==": operator.eq,
    "": operator.eq,
    "%": lambda count, number: count % number == 0,
}


@record
class CodeRule:
    """A breakpoint at statements.

    Attributes:
        id: its number.
        reason: `breakpoint` or `function breakpoint`.
        numbers: of the statements.
        condition, hit_condition, log_message: see `LineBreakpoint`.
    """

    id: int
    reason: str
    numbers: frozenset[int]
    condition: str = ""
    hit_condition: str = ""
    log_message: str = ""


@record
class DataRule:
    """A data breakpoint; see `DataBreakpoint`."""

    id: int
    data_id: str
    condition: str = ""
    hit_condition: str = ""


@record
class Rules:
    """All breakpoints and filters.

    Attributes:
        code, data: breakpoints.
        filters: of exceptions.
        said: numbers of the breakpoints that have stopped since they could not be evaluated, and do so only once.
        given_up: those of them that took too long, and are not evaluated any more.
    """

    code: tuple[CodeRule, ...] = ()
    data: tuple[DataRule, ...] = ()
    filters: frozenset[str] = frozenset((ALARM_FILTER,))
    said: frozenset[int] = frozenset()
    given_up: frozenset[int] = frozenset()

    @property
    def count_hits(self) -> bool:
        """Whether a breakpoint depends on how often it was met since the start."""
        return any(rule.hit_condition for rule in self.code) or any(rule.hit_condition for rule in self.data)


NO_RULES: Final = Rules()


def hit_condition(text: str) -> Callable[[int], bool]:
    """Return the function of the number of hits that a text such as `>= 3` means.

    Raises:
        DebugError: it means none.
    """
    if not text.strip():
        return lambda count: True
    found = re.fullmatch(r"\s*(>=|<=|==|>|<|%|)\s*(\d{1,12})\s*", text, re.ASCII)
    if found is None:
        raise DebugError(f"{short(text)!r} is no number of hits: write 3, >= 3, < 3 or % 3")
    sign, number = _SIGNS[found[1]], int(found[2])
    if (number == 0 and found[1] in ("%", "==", "")) or (found[1] in ("<", "<=") and not sign(1, number)):
        raise DebugError(f"{short(text)!r} is no number of hits that can come: they count from 1")
    return lambda count: sign(count, number)


def checked(request: LineBreakpoint | FunctionBreakpoint | DataBreakpoint) -> None:
    """Check the texts of a breakpoint, as far as they can be without a run.

    Raises:
        DebugError: a condition, number of hits or message makes no sense.
    """
    hit_condition(request.hit_condition)
    texts = [request.condition]

    def note(text: str) -> str:
        texts.append(text)
        return ""

    if isinstance(request, LineBreakpoint):
        filled(request.log_message, note)
    for text in texts:
        if text.strip():
            parsed(text)


def unevaluated(what: str, text: str, error: DebugError) -> str:
    """Return in words that a condition, or what a data breakpoint watches, cannot be evaluated.

    Args:
        what: such as `the condition of line 4`.
        text: the expression.
        error: why not.
    """
    reason = f"it may change nothing: {error.reason}" if isinstance(error, Refusal) else str(error)
    if isinstance(error, MissingName):
        reason += error.near()
    return f"{what} cannot be evaluated: {short(text)}: {reason} (said once)"


class Watch:
    """Something that a data breakpoint watches.

    Args:
        data_id: see `DataBreakpoint`.

    Attributes:
        data_id: in its usual form.
        is_polled: whether changes cannot be told from events, so that it is looked at behind each statement.
        is_of_motion: whether it may change while nothing is due, so that it is looked at in every tick.
        stops_when_true: whether it is an expression, which stops when it becomes true.
        variables: that it reads, by their names: program globals, for an expression also values of the robot.
        error: why it could not be evaluated when it was looked at last; None if it could. A variable that is not there
            yet is no error.
        was_there: whether it has had a value.

    Raises:
        DebugError: it names nothing that can be watched.
    """

    __slots__ = (
        "_read",
        "_tree",
        "data_id",
        "error",
        "is_of_motion",
        "is_polled",
        "stops_when_true",
        "variables",
        "was_there",
    )

    def __init__(self, data_id: str) -> None:
        self.data_id = data_id.strip()
        self.is_polled = self.is_of_motion = self.stops_when_true = False
        self.error: DebugError | None = None
        self.was_there = False
        self._tree: ast.expr | None = None
        self._read: Callable[[Controller], str] | None = None
        self.variables: frozenset[str] = frozenset()
        if self.data_id.lower() in (ROBOT_MODE, SAFETY):
            self.data_id = self.data_id.lower()
            self._read = _robot_mode if self.data_id == ROBOT_MODE else _safety_mode
            return
        tree = parsed(self.data_id)
        try:
            found = signal_at(tree)
        except UsageError as error:
            raise DebugError(str(error)) from None
        if found is not None:
            signal, index = found
            self.data_id = signal_name(signal, index)
            self._read = lambda controller: shown(controller.read(signal.name, index))
        else:
            self._tree = tree
            self.variables = variables_of(self._tree)
            self.is_polled = True
            self.stops_when_true = not isinstance(self._tree, ast.Name)
            self.is_of_motion = self.stops_when_true

    def text(
        self, controller: Controller, globals_: ProgramGlobals | None, names: Any, steps_max: int = CONDITION_STEPS_MAX
    ) -> str:
        """Return the present value as text; empty for none.

        Args:
            controller: the machine.
            globals_: of the program that runs.
            names: of an expression: an object with `value` and `call`.
            steps_max: most nodes that an expression may take.
        """
        text = self._text(controller, globals_, names, steps_max)
        self.was_there = self.was_there or text != ""
        return text

    def _text(self, controller: Controller, globals_: ProgramGlobals | None, names: Any, steps_max: int) -> str:
        if self._read is not None:
            return self._read(controller)
        assert self._tree is not None
        if isinstance(self._tree, ast.Name):
            values = {} if globals_ is None else globals_.values
            return shown(values[self._tree.id]) if self._tree.id in values else ""
        self.error = None
        try:
            return shown(truth(computed(self._tree, names.value, names.call, steps_max)))
        except MissingName:
            return ""
        except DebugError as error:
            self.error = error
            return ""


def _robot_mode(controller: Controller) -> str:
    return controller.state().robot_mode.name.lower().replace("_", " ")


def _safety_mode(controller: Controller) -> str:
    return controller.state().safety_mode.name.lower().replace("_", " ")
