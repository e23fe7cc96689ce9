"""Breakpoints of a living robot: they wait for programs that may come and go, and find their statements in each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from hashlib import blake2b
from pathlib import PurePosixPath

from elitescript.debugger.api import (
    BREAKPOINT,
    DATA_BREAKPOINT,
    FUNCTION_BREAKPOINT,
    BreakpointState,
    DataBreakpoint,
    FunctionBreakpoint,
    LineBreakpoint,
)
from elitescript.debugger.calls import calls_by_statement
from elitescript.debugger.rules import Watch, checked, hit_condition
from elitescript.errors import DebugError
from elitescript.language.compiler import CompiledUnit
from elitescript.language.probes import CountedStatement

Request = LineBreakpoint | FunctionBreakpoint | DataBreakpoint


class Text:
    """A program that has arrived.

    Args:
        name: unique among the texts that are known.
        unit: the program, with the table of its statements.

    Attributes:
        digest: of its text.
    """

    __slots__ = ("_calls", "digest", "name", "unit")

    def __init__(self, name: str, unit: CompiledUnit) -> None:
        self.name = name
        self.unit = unit
        self.digest = digest_of(unit.source.text)
        self._calls: dict[str, frozenset[int]] | None = None

    def calls(self, name: str) -> frozenset[int]:
        """Return the statements that call a name."""
        if self._calls is None:
            source = self.unit.source
            self._calls = calls_by_statement(source.name, source.text, self.unit.statements)
        return self._calls.get(name, frozenset())

    def is_of(self, path: str, digest: str) -> bool:
        """Return whether it is the text of a file, by its name or by what is in it; of any without both."""
        if not path and not digest:
            return True
        if digest and digest == self.digest:
            return True
        if not path:
            return False
        parts, own = PurePosixPath(path.replace("\\", "/")).parts, PurePosixPath(self.name).parts
        return path == self.name or (not self.name.startswith("<") and parts[-len(own) :] == own)

    def statement(self, line: int, column: int = 0) -> CountedStatement | None:
        """Return the first statement that begins at a place or behind it."""
        for statement in self.unit.statements:
            if statement.line > line or (statement.line == line and statement.column >= column):
                return statement
        return None


class Breakpoint:
    """One breakpoint.

    Attributes:
        id: its number.
        reason: of the stop that it makes.
        hits: how often it was reached with its condition true.
        watch: what a data breakpoint looks at; None for others.
        numbers: of its statements.
        state: what is known of its place; why it was refused.
        value: of what a data breakpoint watches, when it was seen last.
        is_refused: whether it can never stop.
        is_said: whether it has stopped since it cannot be evaluated, which it does only once.
        is_given_up: whether it took too long, and is not evaluated any more.
    """

    __slots__ = (
        "_counts",
        "condition",
        "hits",
        "id",
        "is_given_up",
        "is_refused",
        "is_said",
        "log_message",
        "numbers",
        "reason",
        "request",
        "state",
        "value",
        "watch",
    )

    def __init__(self, number: int, request: Request, reason: str) -> None:
        self.id = number
        self.request = request
        self.reason = reason
        self.condition = request.condition.strip()
        self.log_message = request.log_message if isinstance(request, LineBreakpoint) else ""
        self.hits = 0
        self.numbers: set[int] = set()
        self.state = BreakpointState(number, False, "no program has it yet")
        self.value = ""
        self.watch: Watch | None = None
        self.is_said = self.is_given_up = self.is_refused = False
        self._counts: Callable[[int], bool] = lambda hits: False
        try:
            checked(request)
            self._counts = hit_condition(request.hit_condition)
            if isinstance(request, DataBreakpoint):
                self.watch = Watch(request.data_id)
                self.state = BreakpointState(number, True)
        except DebugError as error:
            self.is_refused = True
            self.state = BreakpointState(number, False, str(error))

    def is_hit(self) -> bool:
        """Count a pass, and return whether it stops."""
        self.hits += 1
        return self._counts(self.hits)


class LivingBreakpoints:
    """All breakpoints of one debugger.

    Attributes:
        at: breakpoints by the number of the statement.
        data: data breakpoints.
    """

    __slots__ = ("_functions", "_last", "_lines", "at", "data")

    def __init__(self) -> None:
        self._last = 0
        self._lines: dict[tuple[str, str], list[Breakpoint]] = {}
        self._functions: list[Breakpoint] = []
        self.data: list[Breakpoint] = []
        self.at: dict[int, list[Breakpoint]] = {}

    def set_lines(
        self, path: str, digest: str, requests: Sequence[LineBreakpoint], texts: Iterable[Text]
    ) -> tuple[BreakpointState, ...]:
        """Replace those of the lines of one file."""
        made = [self._made(request, BREAKPOINT) for request in requests]
        for key in [key for key in self._lines if key[0] == path and (path or key[1] == digest)]:
            del self._lines[key]
        if made:
            self._lines[path, digest] = made
        self._find(texts)
        return tuple(item.state for item in made)

    def set_functions(
        self, requests: Sequence[FunctionBreakpoint], texts: Iterable[Text]
    ) -> tuple[BreakpointState, ...]:
        """Replace those of functions and commands."""
        self._functions = [self._made(request, FUNCTION_BREAKPOINT) for request in requests]
        self._find(texts)
        return tuple(item.state for item in self._functions)

    def set_data(self, requests: Sequence[DataBreakpoint]) -> list[Breakpoint]:
        """Replace the data breakpoints."""
        made = [self._made(request, DATA_BREAKPOINT) for request in requests]
        self.data = [item for item in made if not item.is_refused]
        return made

    def add(self, text: Text) -> list[BreakpointState]:
        """Find the statements of a text that has arrived; return the breakpoints that have found their first one."""
        return [
            item.state for item in self._place(text) if len(item.numbers) == 1 or item.reason == FUNCTION_BREAKPOINT
        ]

    def _made(self, request: Request, reason: str) -> Breakpoint:
        self._last += 1
        return Breakpoint(self._last, request, reason)

    def _find(self, texts: Iterable[Text]) -> None:
        self.at.clear()
        for item in (*self._functions, *(item for items in self._lines.values() for item in items)):
            item.numbers.clear()
        for text in texts:
            self._place(text)

    def _place(self, text: Text) -> list[Breakpoint]:
        """Note the statements of one text at which breakpoints stop; return these."""
        found = []
        for (path, digest), items in self._lines.items():
            if text.is_of(path, digest):
                found += [item for item in items if not item.is_refused and self._place_line(item, text)]
        functions = [item for item in self._functions if not item.is_refused]
        return found + [item for item in functions if self._place_function(item, text)]

    def _place_line(self, item: Breakpoint, text: Text) -> bool:
        request = item.request
        assert isinstance(request, LineBreakpoint)
        statement = text.statement(request.line, request.column)
        if statement is None:
            item.state = BreakpointState(item.id, False, f"no statement begins in line {request.line} or below")
            return False
        _, line, column, end_line, end_column, _ = statement
        item.state = BreakpointState(item.id, True, "", line, column, end_line, end_column)
        self._note(item, statement.number)
        return True

    def _place_function(self, item: Breakpoint, text: Text) -> bool:
        request = item.request
        assert isinstance(request, FunctionBreakpoint)
        own = [item.number for item in text.unit.probes.functions if _is_named(item.name, request.name)]
        numbers = own or sorted(text.calls(request.name))
        for number in numbers:
            if number >= 0:
                self._note(item, number)
        if numbers:
            item.state = BreakpointState(item.id, True)
        return bool(numbers)

    def _note(self, item: Breakpoint, number: int) -> None:
        item.numbers.add(number)
        self.at.setdefault(number, []).append(item)


def digest_of(text: str) -> str:
    """Return what is the same for texts that differ only in their line ends and in blanks at the ends of lines."""
    lines = [line.rstrip() for line in text.splitlines()]
    while lines and not lines[-1]:
        lines.pop()
    return blake2b("\n".join(lines).encode("utf-8", "replace"), digest_size=16).hexdigest()


def _is_named(name: str, wanted: str) -> bool:
    return name == wanted or name.endswith(f".{wanted}")
