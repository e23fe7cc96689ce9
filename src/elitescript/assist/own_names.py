"""Finds the names of the program that a place can use, and what is known of them."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cached_property
from typing import Any, Final
from unicodedata import normalize

from elitescript.assist.document import Document
from elitescript.assist.units import value_text, with_unit
from elitescript.assist.value_types import ValueTypes
from elitescript.commands.definition.registry import Param
from elitescript.language.scopes import Binding, Resolution, Scope
from elitescript.language.symbols import THREAD_STARTER
from elitescript.lint.arguments import Arguments
from elitescript.lint.constants import Unknown
from elitescript.lint.program import CommandCall
from elitescript.records import NamedTuple
from elitescript.untrusted.escaping import markdown_text
from elitescript.values.description import FUNCTION, OBJECT, Value
from elitescript.values.references import ModuleType, OwnClass
from elitescript.values.words import ROLES, words

_SHORT: Final = 40
LIST_KINDS: Final = {"joints": "joints", "pose": "pose", "tcp": "pose"}
"""Kind of six numbers by `Quantity.meaning`."""


class OwnName(NamedTuple):
    """A name that the program defines.

    Attributes:
        name: the name.
        home: the scope whose variable it is; None for a global.
        bindings: where it gets its values.
        distance: scopes between its home and the place; that of a global is the greatest.
    """

    name: str
    home: Scope | None
    bindings: tuple[Binding, ...]
    distance: int


class Use(NamedTuple):
    """A parameter that gets a name as its whole argument."""

    command: str
    param: Param


def visible_names(document: Document, scope: Scope) -> list[OwnName]:
    """Return the names of the program that a scope sees, the nearest first."""
    symbols = document.symbols
    found: dict[str, OwnName] = {}
    above: Scope | None = scope
    distance = 0
    while above is not None:
        if above.kind != "class" or above is scope:
            for name, bindings in above.bindings.items():
                if name not in found and above.has_local(name) and any(b.kind != "delete" for b in bindings):
                    found[name] = OwnName(name, above, tuple(bindings), distance)
        above = above.parent
        distance += 1
    for name in sorted(symbols.global_names):
        if name not in found:
            found[name] = OwnName(name, None, tuple(symbols.global_bindings(name)), distance)
    return sorted(found.values(), key=lambda own: (own.distance, own.name))


def own_name(document: Document, name: str, scope: Scope) -> OwnName | None:
    """Return what a name, as it is written, means in a scope; None if the program does not define it."""
    if not name.isascii():
        # As Python reads it: letters with accents may be written in two ways.
        name = normalize("NFKC", name)
    if scope.resolve(name) is Resolution.BUILTIN:
        return None
    return OwnName(name, scope.home(name), tuple(document.symbols.bindings(name, scope)), 0)


def function_of(document: Document, name: str, scope: Scope) -> ast.FunctionDef | None:
    """Return the only function that a name stands for in a scope; None if it may be something else."""
    own = own_name(document, name, scope)
    if own is None or len(own.bindings) != 1 or not isinstance(own.bindings[0].node, ast.FunctionDef):
        return None
    return own.bindings[0].node


def method_of(document: Document, owner: OwnClass, name: str) -> ast.FunctionDef | None:
    """Return a method of a class of the program; None if it has none of that name."""
    for binding in owner.scope.bindings.get(name, ()):
        if isinstance(binding.node, ast.FunctionDef):
            return binding.node
    return None


def function_signature(function: ast.FunctionDef) -> str:
    """Return the header of a function without its keyword: `raised(pose, height=0.1)`."""
    return f"{function.name}({ast.unparse(function.args)})"


def function_text(document: Document, function: ast.FunctionDef) -> str:
    """Return as Markdown what the program says of a function: its docstring, or the comment at its header."""
    text = ast.get_docstring(function)
    if text:
        return markdown_text(text)
    line = function.lineno
    below = _comment(document, line + 1, 1)
    return markdown_text(below or _comment(document, line - 1, -1))


def _comment(document: Document, line: int, step: int) -> str:
    """Return the text of the comment lines that follow each other from a line on."""
    rows = []
    while (row := document.line(line).strip()).startswith("#"):
        rows.append(row.lstrip("#").strip())
        line += step
    return "\n".join(rows[::step]).strip()


class NameFacts:
    """What is known of the names of one document; makes its tables when they are first needed."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self._types = document.once(ValueTypes)

    def value(self, own: OwnName) -> Any:
        """Return the value that a name certainly has; an `Unknown` if there is none."""
        return self.document.program.constants.value(_read(own), self._scope(own))

    def kind(self, own: OwnName) -> str:
        """Return `joints` or `pose` for six numbers of that kind, by their origin or by their use; else empty."""
        role = self.description(own).role
        if role in ("joints", "pose"):
            return role
        kinds = {LIST_KINDS.get(use.param.quantity.meaning, "") for use in self.uses(own)}
        return kinds.pop() if len(kinds) == 1 else ""

    def uses(self, own: OwnName) -> tuple[Use, ...]:
        """Return the parameters of commands that get a name as their whole argument, each once."""
        return tuple(self._uses.get((own.name, own.home), {}))

    def type_text(self, own: OwnName) -> str:
        """Return the type that a name certainly has, such as `list`; empty if there is none."""
        kind = self._types.of(_read(own), self._scope(own))
        if isinstance(kind, ModuleType):
            return f"module {kind.name}"
        if isinstance(kind, OwnClass):
            return kind.scope.name if kind.is_object else f"class {kind.scope.name}"
        return "" if kind is None or kind is type(None) else kind.__name__

    def description(self, own: OwnName) -> Value:
        """Return what is known of all values of a name."""
        return self.document.program.values.evaluated(_read(own), self._scope(own))

    def described(self, own: OwnName, value: Value | None = None) -> str:
        """Return what a name is, such as `pose in the base frame, measured`; empty if that is not known.

        Args:
            own: the name.
            value: description of the values that it has at a place; None for those that it has anywhere.
        """
        value = self.description(own) if value is None else value
        if value.kinds & (OBJECT | FUNCTION) and value.is_known:
            return self.type_text(own) or words(value)
        kind = self.kind(own)
        return ROLES[kind] if kind and not value.role else words(value)

    def role(self, own: OwnName) -> str:
        """Return what a name is: `function`, `thread function`, `parameter`, `global`, `import`, `variable` ..."""
        kinds = {binding.kind for binding in own.bindings}
        if kinds == {"def"}:
            return "thread function" if own.name in self.thread_functions else "function"
        if kinds == {"import"}:
            return "import"
        if kinds == {"class"}:
            return "class"
        if own.home is None:
            return "global"
        if "parameter" in kinds:
            return f"parameter of {own.home.name}" if own.home.name else "parameter"
        if own.home.kind == "comprehension" or kinds == {"for"}:
            return "loop variable"
        return "error" if kinds == {"except"} else "variable"

    def detail(self, own: OwnName) -> str:
        """Return one line about a name: its signature, its value, or what it is."""
        first = own.bindings[0].node if own.bindings else None
        if isinstance(first, ast.FunctionDef) and len(own.bindings) == 1:
            return function_signature(first)
        role, value = self.role(own), self.value(own)
        if not isinstance(value, Unknown):
            kind = self.kind(own) if isinstance(value, list) else ""
            words = ("" if role == "variable" else role, kind, value_text(value, _SHORT))
            return " ".join(word for word in words if word)
        kind = self.described(own)
        if role == "import":
            return kind or role
        return f"{role}: {kind}" if kind else role

    @cached_property
    def thread_functions(self) -> frozenset[str]:
        """Names that `start_thread` gets as functions."""
        found: set[str] = set()
        for called, arguments in self._calls:
            if called.command.name == THREAD_STARTER:
                found.update(node.id for _, node in arguments.given[:1] if isinstance(node, ast.Name))
        return frozenset(found)

    @property
    def _calls(self) -> Iterator[tuple[CommandCall, Arguments]]:
        program = self.document.program
        return zip(program.command_calls, program.arguments, strict=True)

    @cached_property
    def _uses(self) -> dict[tuple[str, Scope | None], dict[Use, None]]:
        found: dict[tuple[str, Scope | None], dict[Use, None]] = {}
        for called, arguments in self._calls:
            for param, node in arguments.given:
                if isinstance(node, ast.Name):
                    uses = found.setdefault((node.id, called.scope.home(node.id)), {})
                    uses[Use(called.command.name, param)] = None
        return found

    def _scope(self, own: OwnName) -> Scope:
        return own.home or self.document.symbols.body


def _read(own: OwnName) -> ast.Name:
    return ast.Name(own.name, ast.Load())


def named_values(value: Any, names: tuple[str, ...], units: tuple[str, ...]) -> list[str]:
    """Return the elements of a list with their names and units, `z 0.3 m (300 mm)`."""
    return [
        f"{name} {with_unit(number, unit)}"
        for name, unit, number in zip(names, units, value, strict=False)
        if not isinstance(number, Unknown)
    ]
