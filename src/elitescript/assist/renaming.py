"""Renames variables, parameters, functions and what else a program defines.

A rename is refused if any name, the renamed one or another, would stand for something else afterwards, and if a use of
the name may be hidden: in a line that cannot be read, behind `**`, in an attribute of an unknown object. So is one that
would change what `f"{name=}"` prints.
"""

from __future__ import annotations

import ast
import builtins
import io
import re
from functools import cache
from itertools import pairwise
from keyword import iskeyword
from typing import Final
from unicodedata import normalize

from elitescript.assist.document import Document
from elitescript.assist.names import Entity, EntityKind, Names, Occurrence, takes_keyword
from elitescript.assist.value_types import ValueTypes, attribute, attribute_names, module_names, real_module
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.reserved import RESERVED
from elitescript.language.advice.unknown_names import KNOWN
from elitescript.language.diagnostics import Edit
from elitescript.language.policy import DENIED_ATTRIBUTES, FORMAT_ATTRIBUTES
from elitescript.language.symbols import Scope
from elitescript.language.text.lexer import WORD_END, WORD_START
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.paths import PROGRAM_SUFFIX, is_program_name, is_task_name
from elitescript.records import record
from elitescript.values.references import ModuleType, OwnClass

_OWN_KEYWORDS: Final = frozenset(("case", "end", "match", "sec", "thread"))
_READ_NAMES: Final = frozenset(
    ("delattr", "dir", "eval", "exec", "getattr", "globals", "hasattr", "locals", "setattr", "vars")
)
"""Functions by which a program reaches variables or attributes through strings."""
_KINDS: Final = (*vars(builtins).values(), io.TextIOWrapper, io.BufferedRandom, real_module("time").struct_time)
_OF_PYTHON: Final = frozenset(name for kind in _KINDS if isinstance(kind, type) for name in dir(kind))
"""Attributes of objects that a program does not define."""
_PROXIES: Final = frozenset(("rpc_factory",))
"""Commands that return objects with any attributes."""
_THREADS: Final = frozenset(("Thread", "Timer"))
"""Classes whose objects call a function with the arguments of a dictionary."""


@record
class Renamable:
    """What a rename would change.

    Attributes:
        span: the name at the cursor.
        name: the name.
        refusal: why it cannot be renamed; empty if it can.
    """

    span: Span
    name: str
    refusal: str = ""


@record
class Renaming:
    """The result of a rename.

    Attributes:
        edits: all at once, they do not overlap; empty if it is refused, or if the name stays as it is.
        refusal: why it is refused; empty if it is not.
    """

    edits: tuple[Edit, ...] = ()
    refusal: str = ""


def prepare_rename(document: Document, line: int, column: int) -> Renamable | None:
    """Return what a rename at a place would change; None if no name stands there. Never raises."""
    found = document.names.at(line, column)
    if found is not None:
        refusal = _of_tree(document) or _refusal(document, found.entity)
        return Renamable(found.span, found.entity.name.rpartition(".")[2], refusal)
    for word in re.finditer(r"[^\W\d]\w*", document.code_line(line)):
        if word.start() < column <= word.end() + 1:
            span = Span(line, word.start() + 1, line, word.end() + 1)
            return Renamable(span, word.group(), _no_name(document, line, word.group()))
    return None


def rename(document: Document, line: int, column: int, new_name: str) -> Renaming:
    """Return the edits that give the name at a place another name.

    The text afterwards compiles to the same code, up to the name. Strings and comments stay as they are. Never raises:
    what would change the meaning of the program is refused, with the reason.
    """
    ready = prepare_rename(document, line, column)
    found = document.names.at(line, column)
    if ready is None or found is None or ready.refusal:
        return Renaming(refusal=ready.refusal if ready is not None else "no name stands here")
    if new_name == ready.name:
        return Renaming()
    refusal = _bad_name(new_name) or _hidden_uses(document, new_name) or _conflict(document, found.entity, new_name)
    if refusal:
        return Renaming(refusal=refusal)
    edits = [_edit(item, new_name) for item in document.names.of(found.entity)]
    return Renaming(tuple(edits))


def _edit(item: Occurrence, new_name: str) -> Edit:
    is_bare_import = item.role == "import" and isinstance(item.node, ast.alias) and item.node.asname is None
    return Edit(*item.span, f"{item.entity.name} as {new_name}" if is_bare_import else new_name)


# ---------------------------------------------------------------- what cannot be renamed


def _of_tree(document: Document) -> str:
    """Return why nothing is renamed in a script that a pendant generates; empty, if it is none by its name."""
    name = document.name.rpartition("/")[2]
    stem = name[: -len(PROGRAM_SUFFIX)] if is_program_name(name) else name
    return f"this text is generated from the tree in {stem}: rename it there" if is_task_name(stem) else ""


def _no_name(document: Document, line: int, word: str) -> str:
    if iskeyword(word) or word in _OWN_KEYWORDS:
        return f"`{word}` is a word of the language"
    if line in document.program.unread_lines or not document.parsed.is_complete:
        return f"line {line} cannot be read yet: repair it first"
    return f"`{word}` is no name of this program"


def _refusal(document: Document, entity: Entity) -> str:
    """Return why something cannot be renamed, whatever the new name; empty if it can."""
    name = entity.name
    if entity.kind is EntityKind.OUTSIDE:
        last = name.rpartition(".")[2]
        if CATALOGUE.get(name) is not None:
            return f"`{name}` is a command of the robot"
        return f"`{last}` is not defined in this text"
    if entity.kind is EntityKind.STRING:
        return f"the name of a {entity.family} stands in a string, and strings are not changed"
    if name.startswith("__"):
        return f"`{name}` has a meaning of its own: names that begin with two underscores are not renamed"
    return _hidden_uses(document, name) or _refusal_of_kind(document, entity) or _printed(document, entity)


def _refusal_of_kind(document: Document, entity: Entity) -> str:
    names, program, name = document.names, document.program, entity.name
    if entity.kind is EntityKind.ATTRIBUTE:
        return _refusal_of_attribute(document, name)
    through = next((use for use in program.outside if use.name in _READ_NAMES), None)
    if through is not None:
        return f"`{through.name}` in line {through.node.lineno} may reach `{name}` through a string"
    if entity.kind is EntityKind.GLOBAL:
        if name in program.presets:
            return f"`{name}` has its value before the program begins"
        if program.shares_globals:
            return f"`{name}` is shared with the program that runs beside this one"
    for item in names.of(entity):
        if item.role == "class":
            inner = next((other for other in names.occurrences if other.entity.name.startswith(f"_{name}__")), None)
            if inner is not None:
                return f"`{inner.entity.name}` in line {inner.span.line} is made of the name of the class"
        if isinstance(item.node, ast.alias) and item.node.asname is None and "." in item.node.name:
            return f"line {item.span.line} imports `{item.node.name}`, which has no other name"
        if item.role == "parameter" and isinstance(item.node, ast.arg):
            refusal = _refusal_of_parameter(names, item)
            if refusal:
                return refusal
    return ""


def _printed(document: Document, entity: Entity) -> str:
    """Return the line of a formatted string that prints the source of an expression with a name, as `f"{x=}"` does."""
    symbols = document.symbols
    printed = set()
    for string in document.program.nodes(ast.JoinedStr):
        for before, value in pairwise(string.values):
            text = before.value if isinstance(before, ast.Constant) else ""
            # The parser puts the source, up to the `=`, into the text before the value.
            if isinstance(value, ast.FormattedValue) and isinstance(text, str) and text.rstrip().endswith("="):
                end_line, end = symbols.range_of(value.value)[2:]
                if _shows_source(document.source.line(end_line)[end - 1 :]):
                    printed.add(value)
    for item in document.names.of(entity) if printed else ():
        if not printed.isdisjoint(symbols.ancestors(item.node)):
            return f"the formatted string of line {item.span.line} prints the name `{entity.name}`"
    return ""


def _shows_source(behind: str) -> bool:
    """Return whether `=` ends an expression in a formatted string; also if that stands on a later line."""
    return re.match(r"[\s)]*(?:=\s*(?:[!:}]|$)|#|$)", behind) is not None


def _refusal_of_parameter(names: Names, parameter: Occurrence) -> str:
    """Return the call that may name a parameter without being known to."""
    function = parameter.scope
    name = parameter.entity.name
    if function is names.symbols.body or not takes_keyword(function, name):
        return ""
    escapes = _escapes(names, function)
    for call, targets in names.splats:
        if function in targets if targets is not None else escapes:
            return f"line {call.lineno} may pass `{name}` by `**`"
    if not escapes:
        return ""
    if name in names.loose_keywords:
        line = names.loose_keywords[name][0].lineno
        return f"line {line} passes an argument `{name}` to a function that is not known"
    if any(use.entity.name.rpartition(".")[2] in _THREADS for use in names.occurrences):
        keys = (key for node in names.program.nodes(ast.Dict) for key in node.keys if isinstance(key, ast.Constant))
        line = min((key.lineno for key in keys if key.value == name), default=0)
        return f"line {line} may pass `{name}` to a thread" if line else ""
    return ""


def _escapes(names: Names, function: Scope) -> bool:
    """Return whether calls that are not known to call a function may do so."""
    node = function.node
    if isinstance(node, ast.Lambda):
        statement = names.symbols.parent(node)
        target = statement.targets[0] if isinstance(statement, ast.Assign) and len(statement.targets) == 1 else None
        if not isinstance(target, ast.Name):
            return True
        name, outer = target.id, names.symbols.scope_of(target)
    else:
        name, outer = function.name, names.symbols.scope_of(node)
    if outer.kind == "class" or getattr(node, "decorator_list", []):
        return True
    starts = [start.args[0] for start, _ in names.thread_starts]
    for use in names.of(names.entity(name, outer)):
        if use.role == "read" and use.node not in starts:
            call = names.symbols.parent(use.node)
            if not isinstance(call, ast.Call) or call.func is not use.node or names.targets(call, use.scope) is None:
                return True
    return False


def _refusal_of_attribute(document: Document, name: str) -> str:
    names = document.names
    classes = [scope for scope in names.symbols.scopes if scope.kind == "class"]
    owners = [scope for scope in classes if name in attribute_names(OwnClass(scope, True))]
    if not owners:
        return f"no class of this text defines `{name}`"
    if len(owners) > 1:
        rows = " and ".join(str(names.symbols.place(scope.node)[0]) for scope in owners[:2])
        return f"the classes of lines {rows} both have `{name}`"
    owner = owners[0]
    if getattr(owner.node, "bases", ()) or any(owner.name in _bases(scope) for scope in classes):
        return f"`{owner.name}` is derived from another class, or another one from it"
    through = next((use for use in names.program.outside if use.name in _READ_NAMES), None)
    if through is not None:
        return f"`{through.name}` in line {through.node.lineno} may reach `{name}` through a string"
    return (
        _use_in_class(names, owner, name)
        or _use_in_string(names, owner, name)
        or _use_of_another_object(document, owner, name)
    )


def _use_in_class(names: Names, owner: Scope, name: str) -> str:
    """Return why the body of a class may read another variable of the name."""
    bindings, reads = owner.bindings.get(name, ()), owner.reads.get(name, ())
    outside = names.entity(name, owner.parent or names.symbols.body)
    is_outside = outside.kind is not EntityKind.OUTSIDE or name in KNOWN or CATALOGUE.get(name) is not None
    first = min(((b.line, b.column) for b in bindings), default=(0, 0))
    if reads and (is_outside or any(names.symbols.place(read) < first for read in reads)):
        return f"`{owner.name}` may read a `{name}` from outside before it has its own"
    if getattr(owner.node, "decorator_list", []) and any(binding.kind != "def" for binding in bindings):
        return f"the decorator of `{owner.name}` may use the names of its attributes"
    return ""


def _use_in_string(names: Names, owner: Scope, name: str) -> str:
    """Return the line of a string that may name an attribute: in `__slots__`, or to be formatted."""
    if "__slots__" in owner.bindings:
        return f"`__slots__` of `{owner.name}` may name `{name}`"
    if FORMAT_ATTRIBUTES.isdisjoint(node.attr for node in names.program.nodes(ast.Attribute)):
        return ""
    pattern = re.compile(rf"\{{[^{{}}]*\.{re.escape(name)}{WORD_END}")
    for node in names.program.nodes(ast.Constant):
        if isinstance(node.value, str) and pattern.search(node.value):
            return f"the string of line {node.lineno} may name `{name}`"
    return ""


def _use_of_another_object(document: Document, owner: Scope, name: str) -> str:
    """Return the line that may use an attribute of an object of another class."""
    program = document.program
    is_of_python = name in _OF_PYTHON or any(called.command.name in _PROXIES for called in program.command_calls)
    may_be_another = is_of_python or any(map(_has_classes, _imported(program)))
    types = document.once(ValueTypes)
    for item in document.names.named(name):
        if item.entity.kind is EntityKind.ATTRIBUTE and isinstance(item.node, ast.Attribute):
            kind = types.of(item.node.value, item.scope)
            is_own = isinstance(kind, OwnClass) and kind.scope is owner
            if not is_own and (may_be_another or kind is not None):
                return f"line {item.span.line} may use the `{name}` of an object of another class"
    return ""


def _imported(program: AnalysedProgram) -> set[str]:
    """Return the names of the modules that a text imports, or takes names from."""
    found = {alias.name for node in program.nodes(ast.Import) for alias in node.names}
    return found | {node.module or "" for node in program.nodes(ast.ImportFrom)}


@cache
def _has_classes(module: str) -> bool:
    """Return whether a module may make objects with attributes that `_OF_PYTHON` does not list."""
    found = (attribute(ModuleType(module), name) for name in module_names(module))
    return module != "time" and any(isinstance(kind, type) and not issubclass(kind, Exception) for kind in found)


def _bases(scope: Scope) -> set[str]:
    return {base.id for base in getattr(scope.node, "bases", ()) if isinstance(base, ast.Name)}


def _hidden_uses(document: Document, name: str) -> str:
    """Return the line that cannot be read and holds a name."""
    names, program = document.names, document.program
    if not document.parsed.is_complete:
        return "the text cannot be read yet: repair it first"
    if name in names.unlocated:
        return f"`{name}` stands at a place that is not known exactly, as in a formatted string"
    if name in program.unread_names:
        word = re.compile(rf"{WORD_START}{re.escape(name)}{WORD_END}")
        line = next((line for line in sorted(program.unread_lines) if word.search(program.source.line(line))), 1)
        return f"line {line} has `{name}` too and cannot be read yet: repair it first"
    return ""


# ---------------------------------------------------------------- the new name


def _bad_name(name: str) -> str:
    if not name.isidentifier():
        return f"`{name}` is no name: letters, digits and underscores, not beginning with a digit"
    if normalize("NFKC", name) != name:
        return f"Python reads `{name}` as `{normalize('NFKC', name)}`"
    if iskeyword(name) or name in _OWN_KEYWORDS:
        return f"`{name}` is a word of the language"
    if CATALOGUE.get(name) is not None:
        return f"`{name}` is a command of the robot"
    if name in RESERVED:
        return f"`{name}` is reserved by the robot"
    if name in KNOWN or name in dir(builtins):
        return f"`{name}` is something that Python has itself"
    if name.startswith("__") or name in DENIED_ATTRIBUTES:
        return f"names like `{name}` belong to Python itself"
    return ""


def _conflict(document: Document, entity: Entity, new: str) -> str:
    """Return the place whose meaning the new name would change; empty if there is none."""
    names = document.names
    if entity.kind is EntityKind.LABEL:
        unknown = next((item for item in names.named(new) if item.entity.kind is EntityKind.OUTSIDE), None)
        return "" if unknown is None else f"line {unknown.span.line} uses a `{new}` that this text does not define"
    if entity.kind is EntityKind.ATTRIBUTE:
        same = names.named(new)
        if same or new in _OF_PYTHON:
            return f"there is a `{new}` already" + (f", in line {same[0].span.line}" if same else "")
        return ""
    if entity.kind is EntityKind.GLOBAL and new in document.program.presets:
        return f"`{new}` has its value before the program begins"
    if new == "_" and any(isinstance(item.node, (ast.MatchAs, ast.MatchStar)) for item in names.of(entity)):
        return "in a `case`, `_` stands for anything and gets no value"
    if any(alias.name == "*" for node in document.program.nodes(ast.ImportFrom) for alias in node.names):
        return "`import *` may define that name too"
    places = names.of(entity)
    homes = {entity.home} | {item.scope for item in places if item.role == "parameter"}
    other = _captured(names, homes, new) or _capturing(places, homes, new)
    if other is not None:
        return f"line {other} has another `{new}`: one of both would hide the other"
    if any(isinstance(item.node, ast.arg) for item in places):
        return _second_argument(document, homes, new)
    return ""


def _captured(names: Names, homes: set[Scope | None], new: str) -> int | None:
    """Return the line of a use of the new name that would mean the renamed thing."""
    for home in homes:
        inside = set((home or names.symbols.body).walk())
        for item in names.named(new):
            is_variable = item.role not in ("attribute", "keyword", "string")
            if is_variable and item.scope in inside and item.entity.kind is not EntityKind.ATTRIBUTE:
                owner = item.entity.home
                if owner is home or owner is None or owner not in inside:
                    return item.span.line
    return None


def _capturing(places: tuple[Occurrence, ...], homes: set[Scope | None], new: str) -> int | None:
    """Return the line at which a variable with the new name would take a use of the renamed thing."""
    for item in places:
        scope: Scope | None = item.scope
        while item.role != "keyword" and scope is not None and scope not in homes:
            if scope is item.scope or scope.kind != "class":
                nodes = [binding.node for binding in scope.bindings.get(new, ())]
                declared = [*nodes, *scope.globals.get(new, ()), *scope.nonlocals.get(new, ())]
                if declared:
                    return int(getattr(declared[0], "lineno", item.span.line))
            scope = scope.parent
    return None


def _second_argument(document: Document, homes: set[Scope | None], new: str) -> str:
    """Return why calls would not tell a renamed parameter from another argument."""
    names = document.names
    for home in homes:
        if home is None or home.kind != "function" or home is names.symbols.body:
            continue
        for function in names.functions(names.entity(home.name, names.symbols.scope_of(home.node))):
            other = names.symbols.scope_made_by(function)
            if other is not None and other not in homes and new in other.parameters:
                return f"the `{home.name}` of line {function.lineno} has a parameter `{new}`, and calls may mean either"
    takes_more = any(getattr(getattr(home and home.node, "args", None), "kwarg", None) for home in homes)
    for keyword in document.program.nodes(ast.keyword) if takes_more else ():
        if keyword.arg == new:
            return f"line {keyword.lineno} passes an argument `{new}`, which would be another one"
    return ""
