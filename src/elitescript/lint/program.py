"""Analyses a program for the rules: its tree, its names, the commands it calls, the firmware it is for."""

from __future__ import annotations

import ast
import re
from bisect import bisect_left
from collections.abc import Callable, Collection, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, TypeVar

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.plausibility import (
    COMPARED,
    JUDGES,
    OF_ANGLES,
    TAKEN_FOR_EACH_OTHER,
    ArmFacts,
    Doubt,
    mistaken,
)
from elitescript.commands.definition.quantities import Anything
from elitescript.commands.definition.registry import Command, Param
from elitescript.commands.definition.reserved import GENERATED_PREFIXES
from elitescript.commands.definition.vocabulary import vocabulary_of
from elitescript.language.advice.unknown_names import KNOWN, advice
from elitescript.language.diagnostics import Outdated
from elitescript.language.nodes import Census
from elitescript.language.options import SCRIPT, SECONDARY
from elitescript.language.parser import Parsed
from elitescript.language.policy import is_dunder
from elitescript.language.symbols import Resolution, Scope, Symbols
from elitescript.language.text.source import find_word
from elitescript.lint.arguments import Arguments, Placements, arrange
from elitescript.lint.constants import Constants, Unknown
from elitescript.lint.refusals import ArgumentRefusal, refuse, refuse_description
from elitescript.messages.profile import Profile, release_of
from elitescript.records import NamedTuple
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.errors import ScriptError
    from elitescript.lint.list_uses import ListUses
    from elitescript.lint.passed_values import PassedCall, PassedValues
    from elitescript.values.memory import Memory
    from elitescript.values.program import Values

_SIX: Final = 6
_POSE_UNIT: Final = "m, rad"
SURELY_LARGE: Final = 6.0
"""A number of which neither metres nor radians are meant beside a coordinate or an angle."""
_MOST_SUGGESTIONS: Final = 20
"""Limit of unknown names of one program for which similar names are searched."""

_Node = TypeVar("_Node", bound=ast.AST)
_Derived = TypeVar("_Derived")


class Span(NamedTuple):
    """A range of the text; lines and columns from 1, columns in characters, the end exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int


class Use(NamedTuple):
    """A use of a name that the program itself does not define."""

    name: str
    node: ast.Name
    scope: Scope
    is_call: bool
    """Whether it is called there."""


class CommandCall(NamedTuple):
    """A call of a command."""

    command: Command
    call: ast.Call
    scope: Scope

    @property
    def written(self) -> ast.Call:
        """The call as it is written."""
        return self.call


class Doubted(NamedTuple):
    """A doubt about an argument.

    Attributes:
        node: the expression that is doubtful: the argument, or an element of it.
        doubt: what is doubtful.
        param: the parameter; None where no command takes it yet.
        whole: the argument.
        scope: where it stands.
    """

    node: ast.expr
    doubt: Doubt
    param: Param | None
    whole: ast.expr
    scope: Scope


class JoinedLists(NamedTuple):
    """A sum or product of lists where numbers were meant.

    Attributes:
        words: what it gives.
        hint: what to write instead.
    """

    words: str
    hint: str


class AnalysedProgram:
    """One text, analysed.

    Attributes:
        parsed: the text and its tree.
        profile: the firmware.
        is_strict: what only this implementation accepts is an error.
        presets: names that have a value before the program begins.
        arm: the arm that it is for; None if that is not known.
        is_outdated: returns whether the text has changed meanwhile, in a program that is written.
        symbols: scopes and names.
        census: all nodes of the tree.
    """

    def __init__(
        self,
        parsed: Parsed,
        profile: Profile,
        *,
        is_strict: bool = False,
        presets: Collection[str] = (),
        arm: ArmFacts | None = None,
        is_outdated: Callable[[], bool] = bool,
        memory: Memory | None = None,
    ) -> None:
        self.parsed = parsed
        self.source = parsed.source
        self.profile = profile
        self.is_strict = is_strict
        self.presets = presets
        self.arm = arm
        self.is_outdated = is_outdated
        self._memory = memory
        self.symbols = Symbols(parsed)
        self.census = Census(parsed.tree)
        self._derived: dict[Any, Any] = {}
        self._hidden: dict[tuple[str, Scope], bool] = {}
        self._fitting_lists: set[tuple[int, int | None] | None] = set()
        """Parameters, by identity, and lengths of lists that they accept; None if the length is not known."""

    def release(self) -> None:
        """Let go of all that is known of the text, which takes as much memory as its tree; it is of no use then.

        What was computed of a program knows the program, so without this it would stay until the collector comes.
        """
        if "values" in self.__dict__:
            self.values.release()
        for scope in self.symbols.scopes:
            scope.children.clear()
            scope.reads.clear()
            scope.bindings.clear()
            scope.calls.clear()
        self.__dict__.clear()

    def stop_if_outdated(self) -> None:
        """Do nothing while the text is the newest one.

        Raises:
            Outdated: it is not.
        """
        if self.is_outdated():
            raise Outdated

    @cached_property
    def values(self) -> Values:
        """What each expression is, in any run."""
        # Short programs do without: everything is written where it is used.
        from elitescript.values.program import Values

        return Values(self.symbols, self.presets, self.stop_if_outdated, self._memory, self.profile)

    @cached_property
    def constants(self) -> Constants:
        """Values of expressions that are certain."""
        return Constants(lambda: self.values)

    # The tree

    def nodes(self, kind: type[_Node]) -> list[_Node]:
        """Return all nodes of one kind, in no particular order."""
        return self.census.of(kind)

    def span(self, node: ast.AST) -> Span:
        """Return where a node stands."""
        return Span(*self.symbols.range_of(node))

    def header_span(self, node: ast.AST) -> Span:
        """Return the first line of a node."""
        line, column = self.symbols.place(node)
        span = self.span(node)
        end = span.end_column if span.end_line == line else len(self.source.line(line).rstrip()) + 1
        return Span(line, column, line, end)

    def name_span(self, node: ast.AST, name: str) -> Span:
        """Return where the name stands that a node binds: for a definition, behind its keyword."""
        line, column, _, _ = self.symbols.range_of(node)
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.alias, ast.ExceptHandler)):
            row = self.source.line(line)
            column = max(find_word(row, name, column - 1), column - 1) + 1
        return Span(line, column, line, column + len(name))

    @cached_property
    def secondaries(self) -> tuple[ast.FunctionDef, ...]:
        """The secondary programs in the text."""
        lines = self.parsed.translation.secondaries
        return tuple(
            node for node in self.parsed.tree.body if isinstance(node, ast.FunctionDef) and node.lineno in lines
        )

    # Names

    def is_in_secondary(self, node: ast.expr) -> bool:
        """Return whether a node stands inside a secondary program."""
        return any(outer.lineno <= node.lineno <= (outer.end_lineno or 0) for outer in self.secondaries)

    @property
    def shares_globals(self) -> bool:
        """Whether it is a secondary program, which shares the globals of the running program."""
        return self.parsed.kind == SECONDARY

    @cached_property
    def unread_lines(self) -> frozenset[int]:
        """Lines that could not be read, and those with errors."""
        parsed = self.parsed
        if not parsed.has_errors:
            return frozenset()
        rows: set[int] = set()
        for problem in parsed.diagnostics:
            if problem.is_error:
                rows.update(range(problem.line, problem.end_line + 1))
        logical = parsed.translation.lines
        for line in (*(logical[index] for index in parsed.hidden), *parsed.translation.dropped):
            rows.update(range(line.line, line.last_line + 1))
        return frozenset(rows)

    @cached_property
    def unread_names(self) -> frozenset[str]:
        """Words of the lines that could not be read: any of them may be defined there."""
        return frozenset(word for row in self.unread_lines for word in re.findall(r"[^\W\d]\w*", self.source.line(row)))

    @cached_property
    def outside(self) -> tuple[Use, ...]:
        """Uses of names that come from outside the program: commands, built-ins, or nothing."""
        return tuple(self._outside())

    def _outside(self) -> Iterator[Use]:
        parent = self.symbols.parent
        for scope in self.symbols.scopes:
            for name, reads in scope.reads.items():
                if scope.resolve(name) is Resolution.BUILTIN:
                    for node in reads:
                        above = parent(node)
                        yield Use(name, node, scope, isinstance(above, ast.Call) and above.func is node)

    @cached_property
    def unknown(self) -> tuple[Use, ...]:
        """Uses of names that nothing defines, in what could be read."""
        if any(alias.name == "*" for node in self.nodes(ast.ImportFrom) for alias in node.names):
            return ()
        unset = () if self.source.tree is None else self.source.tree.unset
        return tuple(
            use
            for use in self.outside
            if not (use.name in KNOWN or use.name in self.unread_names or is_dunder(use.name))
            and use.name not in self.presets
            and use.name not in unset
            and CATALOGUE.get(use.name) is None
        )

    def undefined(self, *, is_call: bool) -> Iterator[tuple[Use, str, str]]:
        """Yield calls, or other uses, of `unknown` names, each with the name that is meant and the hint.

        Both may be empty. The hint is that of the alarm at run time.
        """
        advised: dict[tuple[str, Scope], tuple[str, str]] = {}
        for use in self.unknown:
            if use.is_call is not is_call or self.expects_missing_names(use.node):
                continue
            # A script without a `def` may be a node of a program whose other parts the pendant writes.
            if self.parsed.kind == SCRIPT and use.name.startswith(GENERATED_PREFIXES):
                continue
            key = (use.name, use.scope)
            if key not in advised:
                is_searched = len(advised) < _MOST_SUGGESTIONS
                names = vocabulary_of(self.profile)
                advised[key] = advice(use.node, use.scope, self.symbols, names, is_searched=is_searched)
            yield use, *advised[key]

    def command(self, name: str, scope: Scope) -> Command | None:
        """Return the command that `name` means in `scope`; None if the program gives it another meaning."""
        found = CATALOGUE.get(name)
        if found is None:
            return None
        key = (name, scope)
        is_hidden = self._hidden.get(key)
        if is_hidden is None:
            is_hidden = self._hidden[key] = scope.resolve(name) is not Resolution.BUILTIN
        return None if is_hidden else found

    def is_available(self, command: Command) -> bool:
        """Return whether the firmware has a command."""
        return release_of(command.since) <= self.profile.release

    def expects_missing_names(self, node: ast.AST) -> bool:
        """Return whether a `try` around a node catches `NameError`: then the program tests whether a name exists."""
        types = [handler.type for statement in self._tries(node) for handler in statement.handlers if handler.type]
        caught = [part for kind in types for part in ast.walk(kind)]
        return any(isinstance(part, ast.Name) and part.id == "NameError" for part in caught)

    def is_tried(self, node: ast.AST) -> bool:
        """Return whether a `try` of the same function catches what a node raises: then the program expects that."""
        return bool(self.nodes(ast.Try)) and any(statement.handlers for statement in self._tries(node))

    def _tries(self, node: ast.AST) -> Iterator[ast.Try]:
        """Yield the `try` statements of the same function whose bodies hold a node."""
        child = node
        for above in self.symbols.ancestors(node):
            if isinstance(above, (ast.FunctionDef, ast.Lambda)):
                return
            if isinstance(above, ast.Try) and self.symbols.block_of(child)[0] == "body":
                yield above
            child = above

    # Calls

    @cached_property
    def command_calls(self) -> tuple[CommandCall, ...]:
        """The calls of commands that the firmware has."""
        calls = []
        for scope in self.symbols.scopes:
            known: dict[str, Command | None] = {}
            for call in scope.calls:
                function = call.func
                if type(function) is not ast.Name:
                    continue
                name = function.id
                if name not in known:
                    command = self.command(name, scope)
                    known[name] = command if command is not None and self.is_available(command) else None
                command = known[name]
                if command is not None:
                    calls.append(CommandCall(command, call, scope))
        return tuple(calls)

    @cached_property
    def arguments(self) -> tuple[Arguments, ...]:
        """The arguments of `command_calls`, in order."""
        known: Placements = {}
        return tuple(arrange(found.command, found.call, known) for found in self.command_calls)

    @cached_property
    def passed_calls(self) -> tuple[tuple[PassedCall, Arguments], ...]:
        """The calls of commands once more, with what each turn of a loop and each caller gives them."""
        if not self._may_pass_values:
            return ()
        known: Placements = {}
        calls = self.passed_values.calls
        return tuple((found, arrange(found.command, found.call, known)) for found in calls)

    @property
    def _may_pass_values(self) -> bool:
        """Whether a loop, a parameter or a variable that is called may give something to a command."""
        if self.nodes(ast.For) or any(scope.parameters for scope in self.symbols.scopes):
            return True
        called = [(call.func, scope) for scope in self.symbols.scopes for call in scope.calls]
        return any(
            isinstance(func, ast.Name) and any(b.kind == "assign" for b in scope.bindings.get(func.id, ()))
            for func, scope in called
        )

    @cached_property
    def judged_calls(self) -> list[tuple[CommandCall | PassedCall, Arguments]]:
        """The calls of commands with their arguments, and behind them `passed_calls`."""
        return [*zip(self.command_calls, self.arguments, strict=True), *self.passed_calls]

    @cached_property
    def passed_values(self) -> PassedValues:
        """What turns of loops and callers give to commands."""
        from elitescript.lint.passed_values import PassedValues

        return PassedValues(self)

    def derived(self, make: Callable[[AnalysedProgram], _Derived]) -> _Derived:
        """Return what is computed of the program by a function or class, once."""
        if make not in self._derived:
            self._derived[make] = make(self)
        found: _Derived = self._derived[make]
        return found

    @cached_property
    def refusals(self) -> tuple[ArgumentRefusal, ...]:
        """The arguments that commands will certainly refuse."""
        mistakes = sorted((problem.line, problem.column) for problem in self.parsed.diagnostics if problem.is_error)
        found = []
        # Programs give the same numbers again and again.
        accepted: set[tuple[int, type, Any]] = set()
        for called, arguments in self.judged_calls:
            if called.written is not called.call and self.is_tried(called.written):
                # The program expects it.
                continue
            for param, node in arguments.given:
                if type(param.quantity) is Anything:
                    continue
                # A placeholder stands there in place of the author's text.
                if mistakes:
                    span = self.span(node)
                    place = bisect_left(mistakes, span[:2])
                    if place < len(mistakes) and mistakes[place] < span[2:]:
                        continue
                if type(node) is ast.Constant:
                    literal = (id(param), type(node.value), node.value)
                    if literal in accepted:
                        continue
                    value = self.constants.value(node, called.scope)
                    error = refuse(param, value) or self._refused_kind(param, node, value)
                    if error is None:
                        accepted.add(literal)
                        continue
                else:
                    value = self.constants.value(node, called.scope)
                    error = refuse(param, value) or self._refused_kind(param, node, value)
                if error is not None and not self._is_joined(node):
                    found.append(ArgumentRefusal(called.command, param, node, error))
        return tuple(found)

    def least_number(self, node: ast.expr, scope: Scope) -> float | None:
        """Return the least number that an expression can be; None if it may be anything else."""
        value = self.constants.value(node, scope)
        if isinstance(value, Unknown):
            described = self.values.of(node)
            return described.low if described.is_number else None
        return value if isinstance(value, (int, float)) else None

    def _refused_kind(self, param: Param, node: ast.expr, value: Any) -> ScriptError | None:
        """Return the error that a parameter raises for every value that an expression can have."""
        if not isinstance(value, Unknown):
            return None
        described = self.values.of(node)
        if not described.is_known or described.has_constant:
            return None
        items = described.items
        # Of a list with other elements than constants its length alone can be wrong.
        fitting = (id(param), None if items is None else len(items)) if described.is_list else None
        if fitting in self._fitting_lists:
            return None
        error = refuse_description(param, described, ast.unparse(node))
        if error is None and fitting is not None:
            self._fitting_lists.add(fitting)
        return error

    def _is_joined(self, node: ast.expr) -> bool:
        """Return whether a value is one of `joined_lists`: one cause is one finding."""
        if isinstance(node, (ast.Constant, ast.List, ast.Tuple)):
            return False
        return self.values.of(node).node in self.joined_lists

    @cached_property
    def joined_lists(self) -> dict[ast.AST, JoinedLists]:
        """Sums and products of poses, joint positions and their like, by their node."""
        found: dict[ast.AST, JoinedLists] = {}
        for node in self.nodes(ast.BinOp):
            if not isinstance(node.op, (ast.Add, ast.Mult)):
                continue
            from elitescript.values.description import INT
            from elitescript.values.results import LIST_ROLES

            sides = [self.values.of(side) for side in (node.left, node.right)]
            # A list that is gone through may be as long as it likes.
            above = self.symbols.parent(node)
            if isinstance(above, (ast.For, ast.comprehension)) or not any(side.role in LIST_ROLES for side in sides):
                continue
            if isinstance(node.op, ast.Add):
                is_offset = any(
                    isinstance(side, ast.List) and len(side.elts) == _SIX for side in (node.left, node.right)
                )
                if is_offset and all(side.is_list for side in sides):
                    hint = "pose_trans adds an offset in the frame of the pose, pose_add in that of the base"
                    if not any(side.role == "pose" for side in sides):
                        hint = "add element by element: [a + b for a, b in zip(p, q)]"
                    found[node] = JoinedLists("12 numbers", hint)
            elif any(side.has_constant and side.kinds == INT and side.constant > 1 for side in sides):
                found[node] = JoinedLists("the same numbers again", "multiply element by element: [2 * a for a in p]")
        return found

    @cached_property
    def doubts(self) -> tuple[Doubted, ...]:
        """The arguments that commands accept, but that are hardly meant; see `commands.definition.plausibility`."""
        refused = {refusal.node for refusal in self.refusals}
        found: list[Doubted] = []
        accepted: set[tuple[int, type, Any]] = set()
        for called, arguments in self.judged_calls:
            for param, node in arguments.given:
                literal = None
                if type(node) is ast.Constant:
                    # Programs give the same numbers again and again.
                    literal = (id(param), type(node.value), node.value)
                    if literal in accepted:
                        continue
                meaning = param.quantity.meaning
                is_transform = not meaning and param.quantity.unit == _POSE_UNIT
                if is_transform:
                    meaning = "pose"
                if node in refused:
                    continue
                others: list[Doubt] = []
                if param.quantity.unit in COMPARED and (not _is_written(node) or called.command.name in OF_ANGLES):
                    # Imported late: short programs do without values.
                    from elitescript.lint.quantity_doubts import quantity_doubts

                    others += quantity_doubts(self.values, called.command, param, node)
                if not meaning:
                    found += [self._doubted(called, param, node, doubt) for doubt in others]
                    if literal is not None and not others:
                        accepted.add(literal)
                    continue
                value = self.constants.bounds(node, called.scope)
                # Programs also compute with transforms in other units, but not with those of the arm.
                is_judged = not is_transform or self._is_target(called, arguments)
                reported = list(JUDGES[meaning](value, self.arm)) if is_judged else []
                if meaning in TAKEN_FOR_EACH_OTHER and not isinstance(node, (ast.List, ast.Tuple)):
                    other = mistaken(meaning, self.values.of(node).role)
                    reported += [] if other is None else [other]
                if literal is not None and is_judged and not reported and not others:
                    accepted.add(literal)
                found += [self._doubted(called, param, node, doubt) for doubt in (*reported, *others)]
        return tuple(found)

    def _doubted(self, called: CommandCall | PassedCall, param: Param, node: ast.expr, doubt: Doubt) -> Doubted:
        command, argument = called.command.name, param.name
        text = said("{command}: {argument}{doubt}", command=command, argument=argument, doubt=doubt.text)
        return Doubted(element(node, doubt.element), doubt._replace(text=text), param, node, called.scope)

    @cached_property
    def list_uses(self) -> ListUses:
        """Where lists go to as joint positions and as poses."""
        # Imported late: short programs have no lists in variables.
        from elitescript.lint.list_uses import ListUses

        calls = zip(self.command_calls, self.arguments, strict=True)
        given = [(called.command, called.call, arguments.given) for called, arguments in calls]
        return ListUses(given, self.values, self.symbols, self.nodes(ast.Subscript))

    def _is_target(self, called: CommandCall | PassedCall, arguments: Arguments) -> bool:
        """Return whether a transform is computed from poses of the arm, or gives one."""
        if any(self._is_of_the_arm(other) for _, other in arguments.given):
            return True
        # A result that is certain, and doubtful itself, is told where it is a target.
        if any(JUDGES["pose"](self.constants.value(called.call, called.scope), self.arm)):
            return False
        return self.list_uses.is_pose(self.values.of(called.call).sites)

    def _is_of_the_arm(self, node: ast.expr) -> bool:
        """Return whether a list is a reading or target of the arm, which is in metres."""
        if isinstance(node, (ast.Constant, ast.List, ast.Tuple)):
            return False
        from elitescript.values.description import COMMANDED, MEASURED

        value = self.values.of(node)
        return value.role == "pose" and bool(value.must & (COMMANDED | MEASURED))

    @property
    def has_large_numbers(self) -> bool:
        """Whether any operator has a number beside it that is no length in metres."""
        kinds: tuple[type[ast.expr] | type[ast.stmt], ...] = (ast.BinOp, ast.Compare, ast.Assign)
        return any(
            isinstance(part, ast.Constant) and isinstance(part.value, (int, float)) and abs(part.value) > SURELY_LARGE
            for kind in kinds
            for node in self.nodes(kind)
            for part in ast.iter_child_nodes(node)
        )


def _is_written(node: ast.expr) -> bool:
    """Return whether a number, or a list of numbers, is written out where it is used."""
    parts = node.elts if isinstance(node, (ast.List, ast.Tuple)) else (node,)
    return all(isinstance(part.operand if isinstance(part, ast.UnaryOp) else part, ast.Constant) for part in parts)


def element(node: ast.expr, index: int | None) -> ast.expr:
    """Return the element of a list that is written out, or the whole expression."""
    if index is not None and isinstance(node, (ast.List, ast.Tuple)) and index < len(node.elts):
        return node.elts[index]
    return node
