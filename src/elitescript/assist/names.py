"""Finds every place in a text where a name stands, and what it stands for."""

from __future__ import annotations

import ast
import re
from bisect import bisect_right
from collections.abc import Iterator
from enum import StrEnum
from functools import cached_property
from operator import itemgetter
from typing import Final
from unicodedata import normalize

from elitescript.language.parser import character_offset
from elitescript.language.symbols import THREAD_STARTER, Binding, Resolution, Scope
from elitescript.language.text.lexer import WORD_END, WORD_START
from elitescript.lint.arguments import Placements, arrange
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.records import NamedTuple

STRING_NAMES: Final = {
    "signal_name": "MODBUS signal",
    "socket_name": "connection",
    "port": "serial line",
    "variable": "input variable",
}
"""Parameters of commands whose strings name something, and what that is."""

_MAKERS: Final = frozenset(("modbus_add_rw_signal", "modbus_add_signal", "serial_config", "socket_open"))
"""Commands that make what their string names."""

_START: Final = itemgetter(0, 1)
"""Line and column of a span."""

_MAIN_BINDINGS: Final = ("class", "def", "import", "parameter")


class Access(StrEnum):
    """What is done with a name at a place."""

    READ = "read"
    WRITE = "write"
    """It gets a value there, also by `def`, `for`, `import`, `except ... as`."""
    TEXT = "text"
    """It is only named there: in a `global` statement or in a string."""


class EntityKind(StrEnum):
    """What a name stands for."""

    LOCAL = "local"
    """A variable, function or parameter of a scope, which may be that of the program's body."""
    GLOBAL = "global"
    """A program global: some `global` statement declares it."""
    OUTSIDE = "outside"
    """Bound nowhere in the text: a command, something of Python, or nothing."""
    ATTRIBUTE = "attribute"
    """An attribute of any object; classes are not told apart."""
    LABEL = "label"
    """The name of a program, to which nothing is bound."""
    STRING = "string"
    """A signal, connection and so on that strings name."""


class Entity(NamedTuple):
    """What names stand for: equal for places that mean the same.

    Attributes:
        kind: what it is.
        name: the name.
        home: the scope whose variable it is; None for what is no `LOCAL`.
        family: of a `STRING`, what it names: a value of `STRING_NAMES`.
    """

    kind: EntityKind
    name: str
    home: Scope | None = None
    family: str = ""


class Occurrence(NamedTuple):
    """A place where a name stands.

    Attributes:
        span: the name.
        entity: what it stands for.
        access: what is done with it.
        role: `read`, `attribute`, `keyword` (name of an argument), `global`, `nonlocal`, `string`, `label`, or the kind
            of a `Binding`.
        node: the node that holds it.
        scope: the scope in which it stands.
    """

    span: Span
    entity: Entity
    access: Access
    role: str
    node: ast.AST
    scope: Scope


class Names:
    """All names of one text.

    Attributes:
        program: the text.
        occurrences: every place, in the order of the text.
        unlocated: names that stand at a place which is not known exactly, such as in some formatted strings.
        loose_keywords: by name, the keyword arguments that may reach a function which is not known.
        splats: the calls with `**`, each with the functions of the text that it may call; None if they are not known.
    """

    def __init__(self, program: AnalysedProgram) -> None:
        self.program = program
        self.symbols = program.symbols
        self.unlocated: set[str] = set()
        self.loose_keywords: dict[str, list[ast.keyword]] = {}
        self.splats: list[tuple[ast.Call, list[Scope] | None]] = []
        self._rows = program.source.lines
        self._same: dict[Entity, Entity] = {}
        self._label = Entity(EntityKind.LABEL, program.parsed.name) if program.parsed.unit is not None else None
        found: dict[Span, Occurrence] = {}
        for occurrence in self._find():
            # `a += 1` reads and writes at one place; two names at one place are a formatted string of an old Python.
            if found.setdefault(occurrence.span, occurrence).node is not occurrence.node:
                self.unlocated.add(occurrence.entity.name)
        ordered = [found[span] for span in sorted(found, key=_START)]
        if self._same:
            ordered = [item._replace(entity=self._same.get(item.entity, item.entity)) for item in ordered]
        self.occurrences = tuple(ordered)
        self._starts = [item.span[:2] for item in ordered]

    # ---------------------------------------------------------------- what is at a place

    def at(self, line: int, column: int) -> Occurrence | None:
        """Return the name that holds a place or ends at it; None if there is none."""
        index = bisect_right(self._starts, (line, column)) - 1
        if index < 0:
            return None
        span = self.occurrences[index].span
        return self.occurrences[index] if span.line == line and column <= span.end_column else None

    def of(self, entity: Entity) -> tuple[Occurrence, ...]:
        """Return the places of what a name stands for, in the order of the text."""
        return self._by_entity.get(entity, ())

    @cached_property
    def _by_entity(self) -> dict[Entity, tuple[Occurrence, ...]]:
        found: dict[Entity, list[Occurrence]] = {}
        for item in self.occurrences:
            found.setdefault(item.entity, []).append(item)
        return {entity: tuple(items) for entity, items in found.items()}

    def named(self, name: str) -> tuple[Occurrence, ...]:
        """Return the places where a name stands, whatever it stands for, in the order of the text."""
        return self._by_name.get(name, ())

    @cached_property
    def _by_name(self) -> dict[str, tuple[Occurrence, ...]]:
        found: dict[str, list[Occurrence]] = {}
        for item in self.occurrences:
            found.setdefault(item.entity.name, []).append(item)
        return {name: tuple(items) for name, items in found.items()}

    @cached_property
    def entities(self) -> tuple[Entity, ...]:
        """What the names of the text stand for, in the order of their first places."""
        return tuple(self._by_entity)

    def entity(self, name: str, scope: Scope) -> Entity:
        """Return what a name stands for when it is used in a scope."""
        home = scope.home(name)
        if home is not None:
            found = _variable(name, home)
            return self._same.get(found, found)
        if scope.resolve(name) is Resolution.GLOBAL:
            return Entity(EntityKind.GLOBAL, name)
        if self._label is not None and name == self._label.name:
            return self._label
        return Entity(EntityKind.OUTSIDE, name)

    def definitions(self, entity: Entity) -> tuple[Occurrence, ...]:
        """Return the places that define it.

        Those of `def`, `class`, `import` and of parameters, if there are any; else the first that gives it a value.
        """
        places = self.of(entity)
        main = tuple(item for item in places if item.role in _MAIN_BINDINGS or item.role == "label")
        if main:
            return main
        written = [item for item in places if item.access is Access.WRITE and item.role != "delete"]
        if entity.kind is EntityKind.STRING:
            return tuple(written)
        plain = [item for item in written if item.role != "augmented"]
        return tuple((plain or written)[:1])

    def functions(self, entity: Entity) -> tuple[ast.FunctionDef | ast.AsyncFunctionDef, ...]:
        """Return the definitions of the functions that it stands for."""
        nodes = [item.node for item in self.of(entity) if item.role == "def"]
        return tuple(node for node in nodes if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)))

    def defined_at(self, function: Scope) -> Span | None:
        """Return where the name of a function stands."""
        return self._behind_keyword(function.node, function.name)

    @cached_property
    def thread_starts(self) -> tuple[tuple[ast.Call, Occurrence], ...]:
        """The calls of `start_thread`, each with the name that it is given."""
        found = []
        for called in self.program.command_calls:
            if (called.command.alias_of or called.command.name) == THREAD_STARTER and called.call.args:
                first = called.call.args[0]
                name = self.at(*self.symbols.place(first)) if isinstance(first, ast.Name) else None
                if name is not None:
                    found.append((called.call, name))
        return tuple(found)

    @cached_property
    def threads(self) -> frozenset[Entity]:
        """What is given to `start_thread`."""
        return frozenset(name.entity for _, name in self.thread_starts)

    # ---------------------------------------------------------------- finding them

    def _find(self) -> Iterator[Occurrence]:
        if self._label is not None and self.program.parsed.unit is not None:
            unit = self.program.parsed.unit
            span = self._behind_keyword(unit, unit.name)
            if span is not None:
                yield Occurrence(span, self._label, Access.WRITE, "label", unit, self.symbols.body)
        for scope in self.symbols.scopes:
            for name, bindings in scope.bindings.items():
                entity = self.entity(name, scope)
                for binding in bindings:
                    span = self._span_of_binding(binding)
                    if span is not None:
                        # `:=` in a comprehension binds around it, but stands inside.
                        inside = self.symbols.scope_of(binding.node) if binding.kind == "walrus" else scope
                        yield Occurrence(span, entity, Access.WRITE, binding.kind, binding.node, inside)
            for name, reads in scope.reads.items():
                entity = self.entity(name, scope)
                for read in reads:
                    span = self._exact(read, name)
                    if span is not None:
                        yield Occurrence(span, entity, Access.READ, "read", read, scope)
            for kind, declared in (("global", scope.globals), ("nonlocal", scope.nonlocals)):
                for name, statements in declared.items():
                    entity = self.entity(name, scope)
                    for statement in statements:
                        spans = list(self._words(statement, name))
                        if not spans:
                            self.unlocated.add(name)
                        for span in spans:
                            yield Occurrence(span, entity, Access.TEXT, kind, statement, scope)
            for call in scope.calls:
                if call.keywords:
                    yield from self._keywords(call, scope)
        yield from self._attributes()
        yield from self._strings()

    def _keywords(self, call: ast.Call, scope: Scope) -> Iterator[Occurrence]:
        targets = self.targets(call, scope)
        if any(keyword.arg is None for keyword in call.keywords):
            self.splats.append((call, targets))
        takes_more = targets is None or any(_takes_more(target) for target in targets)
        for keyword in call.keywords:
            if keyword.arg is None:
                continue
            homes = [target for target in targets or () if takes_keyword(target, keyword.arg)]
            if takes_more and not homes:
                self.loose_keywords.setdefault(keyword.arg, []).append(keyword)
            if not homes:
                continue
            entity = Entity(EntityKind.LOCAL, keyword.arg, homes[0])
            entity = self._same.get(entity, entity)
            for home in homes[1:]:
                self._unite(Entity(EntityKind.LOCAL, keyword.arg, home), entity)
            line, column = self.symbols.place(keyword)
            span = self._checked(Span(line, column, line, column + len(keyword.arg)), keyword.arg)
            if span is not None:
                yield Occurrence(span, entity, Access.TEXT, "keyword", keyword, scope)

    def _unite(self, one: Entity, other: Entity) -> None:
        old = self._same.get(one, one)
        if old == other:
            return
        for entity, target in self._same.items():
            if target == old:
                self._same[entity] = other
        self._same[old] = other

    def targets(self, call: ast.Call, scope: Scope) -> list[Scope] | None:
        """Return the functions of the text that a call may call; None if they are not known.

        What a decorator makes of a function is not known, nor what a function of a module does with one that it gets.
        """
        function = call.func
        if not isinstance(function, ast.Name):
            return None
        name = function.id
        if scope.resolve(name) is Resolution.BUILTIN:
            return []
        found: list[Scope] = []
        for binding in self.symbols.bindings(name, scope):
            made = self.symbols.scope_made_by(binding.node)
            if binding.kind == "assign":
                statement = self.symbols.parent(binding.node)
                if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Lambda):
                    made = self.symbols.scope_made_by(statement.value)
            if getattr(binding.node, "decorator_list", []):
                return None
            if made is not None and made.kind == "class":
                made = next((child for child in made.children if child.name == "__init__"), None)
            if made is None or getattr(made.node, "decorator_list", []):
                return None
            found.append(made)
        return found

    def _attributes(self) -> Iterator[Occurrence]:
        for node in self.program.nodes(ast.Attribute):
            span = self._exact(node, node.attr)
            if span is None:
                continue
            base = node.value
            scope = self.symbols.scope_of(node)
            if isinstance(base, ast.Name) and self.symbols.imported(base.id, scope):
                entity = Entity(EntityKind.OUTSIDE, f"{base.id}.{node.attr}")
            else:
                entity = Entity(EntityKind.ATTRIBUTE, node.attr)
            access = Access.READ if isinstance(node.ctx, ast.Load) else Access.WRITE
            yield Occurrence(span, entity, access, "attribute", node, scope)
        for pattern in self.program.nodes(ast.MatchClass):
            self.unlocated.update(pattern.kwd_attrs)

    def _strings(self) -> Iterator[Occurrence]:
        known: Placements = {}
        for called in self.program.command_calls:
            if STRING_NAMES.keys().isdisjoint(param.name for param in called.command.params):
                continue
            for param, node in arrange(called.command, called.call, known).given:
                family = STRING_NAMES.get(param.name)
                if family is None or not isinstance(node, ast.Constant) or not isinstance(node.value, str):
                    continue
                span = self.inside_quotes(node, node.value)
                if span is not None:
                    is_made = (called.command.alias_of or called.command.name) in _MAKERS
                    access = Access.WRITE if is_made else Access.TEXT
                    entity = Entity(EntityKind.STRING, node.value, None, family)
                    yield Occurrence(span, entity, access, "string", node, called.scope)

    # ---------------------------------------------------------------- places

    def _exact(self, node: ast.expr, name: str) -> Span | None:
        """Return where the name stands with which a node ends, if the text there is that name."""
        end_line = node.end_lineno or node.lineno
        row = self._rows[end_line - 1] if end_line <= len(self._rows) else ""
        end = character_offset(row, node.end_col_offset or 0) + 1
        start = end - len(name)
        if row[start - 1 : end - 1] == name:
            return Span(end_line, start, end_line, end)
        if isinstance(node, ast.Name):
            start = character_offset(row, node.col_offset) + 1
        return self._checked(Span(end_line, start, end_line, end), name)

    def _checked(self, span: Span, name: str) -> Span | None:
        """Return a span if the name stands there; else note that the place of the name is not known."""
        row = self.program.source.line(span.line)
        text = row[span.column - 1 : span.end_column - 1]
        if text == name or (not text.isascii() and normalize("NFKC", text) == name):
            return span
        self.unlocated.add(name)
        return None

    def _span_of_binding(self, binding: Binding) -> Span | None:
        node, name = binding.node, binding.name
        if isinstance(node, ast.Name):
            return self._exact(node, name)
        if isinstance(node, ast.arg):
            line, column = self.symbols.place(node)
            return self._checked(Span(line, column, line, column + len(name)), name)
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            return self._behind_keyword(node, name)
        if isinstance(node, ast.ExceptHandler):
            return self._of_handler(node, name)
        spans = list(self._words(node, name))
        if not spans:
            self.unlocated.add(name)
            return None
        return spans[0] if isinstance(node, ast.alias) and node.asname is None else spans[-1]

    def _behind_keyword(self, node: ast.AST, name: str) -> Span | None:
        line, column = self.symbols.place(node)
        row = self.program.source.line(line)
        found = re.compile(r"(?:async\s+)?\w+\s+").match(row, column - 1)
        start = (found.end() if found else column) + 1
        return self._checked(Span(line, start, line, start + len(name)), name)

    def _of_handler(self, node: ast.ExceptHandler, name: str) -> Span | None:
        end = self.symbols.range_of(node.type or node)[2:]
        line = end[0]
        found = re.compile(rf"\bas\s+({re.escape(name)}){WORD_END}").search(self.program.source.line(line), end[1] - 1)
        if found is None:
            self.unlocated.add(name)
            return None
        return Span(line, found.start(1) + 1, line, found.end(1) + 1)

    def _words(self, node: ast.AST, name: str) -> Iterator[Span]:
        """Yield where a name stands as a word in the text of a node that holds no string."""
        line, column, end_line, end_column = self.symbols.range_of(node)
        pattern = re.compile(rf"{WORD_START}{re.escape(name)}{WORD_END}")
        for number in range(line, end_line + 1):
            row = self.program.source.line(number)
            stop = end_column - 1 if number == end_line else len(row)
            for found in pattern.finditer(row, column - 1 if number == line else 0, stop):
                yield Span(number, found.start() + 1, number, found.end() + 1)

    def inside_quotes(self, node: ast.Constant, text: str) -> Span | None:
        """Return where the text of a string stands, if it is written out plainly on one line."""
        line, column, end_line, end_column = self.symbols.range_of(node)
        row = self.program.source.line(line)[column - 1 : end_column - 1]
        quotes = 3 if row.endswith(('"""', "'''")) and len(row) >= 6 else 1
        start = end_column - quotes - len(text)
        if not text or line != end_line or row[:-quotes][-len(text) :] != text or row.count(text) != 1:
            return None
        return Span(line, start, line, start + len(text))


def _variable(name: str, home: Scope) -> Entity:
    return Entity(EntityKind.ATTRIBUTE, name) if home.kind == "class" else Entity(EntityKind.LOCAL, name, home)


def takes_keyword(function: Scope, name: str) -> bool:
    """Return whether calls of a function can name a parameter."""
    parameter = function.parameters.get(name)
    args = getattr(function.node, "args", None)
    if parameter is None or not isinstance(args, ast.arguments):
        return False
    return parameter in args.args or parameter in args.kwonlyargs


def _takes_more(function: Scope) -> bool:
    args = getattr(function.node, "args", None)
    return isinstance(args, ast.arguments) and args.kwarg is not None
