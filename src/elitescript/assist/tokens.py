"""Says what each name of a text is, for its colour."""

from __future__ import annotations

import ast
import builtins
import re
from bisect import bisect_left
from collections.abc import Iterator
from enum import StrEnum
from typing import Final

from elitescript.assist.document import Document
from elitescript.assist.names import Access, Entity, EntityKind, Names, Occurrence
from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.options import SCRIPT
from elitescript.language.symbols import Scope
from elitescript.lint.constants import Unknown
from elitescript.lint.program import Span
from elitescript.records import NamedTuple


class TokenType(StrEnum):
    """What a token is.

    The order is that of the legend; the texts are those of the protocol of editors where it has one.
    """

    COMMAND = "command"
    """A command of the robot."""
    FUNCTION = "function"
    """A function of the program, or one that Python has."""
    CLASS = "class"
    METHOD = "method"
    PARAMETER = "parameter"
    VARIABLE = "variable"
    PROPERTY = "property"
    """An attribute."""
    NAMESPACE = "namespace"
    """A module."""
    KEYWORD = "keyword"
    """`end`, `sec`, `thread` and `$ LINE`."""
    SIGNAL = "signal"
    """A name of a signal, connection, line or register in a string."""


class TokenModifier(StrEnum):
    """What else is known of a token; the order is that of the bits."""

    DEFINITION = "definition"
    """It is defined there."""
    WRITE = "modification"
    """It gets a value there."""
    CAPTURED = "captured"
    """A variable that a function inside its scope uses too."""
    GLOBAL = "global"
    """A global of the program: a `global` statement declares it, or it has its value before the program begins."""
    LIBRARY = "defaultLibrary"
    """Not of this program: the robot has it, or Python."""
    UNUSED = "unused"
    """Nothing reads it."""
    UNAVAILABLE = "unavailable"
    """The chosen firmware does not have it."""
    THREAD = "thread"
    """A function that runs as a thread."""
    READONLY = "readonly"
    """It gets one value, which is known before the run."""


TOKEN_TYPES: Final = tuple(TokenType)
"""The legend: `TOKEN_TYPES.index(token.type)` is the number on the wire."""

TOKEN_MODIFIERS: Final = tuple(TokenModifier)
"""The legend of the modifiers: bit `n` of the set is that of element `n`."""


class Token(NamedTuple):
    """A token, which lies on one line.

    Attributes:
        line, column: where, from 1.
        length: in characters.
        type: what it is.
        modifiers: what else is known of it, in the order of the legend.
    """

    line: int
    column: int
    length: int
    type: TokenType
    modifiers: tuple[TokenModifier, ...]


_MARK: Final = re.compile(r"\$[ \t]*LINE")


def semantic_tokens(document: Document, span: Span | None = None) -> tuple[Token, ...]:
    """Return the tokens of a text, or of the lines of a range, in the order of the text. They do not overlap.

    Never raises.
    """
    tokens = document.once(_tokens)
    if span is None:
        return tokens
    first = bisect_left(tokens, span.line, key=lambda token: token.line)
    return tokens[first : bisect_left(tokens, span.end_line + 1, key=lambda token: token.line)]


def _tokens(document: Document) -> tuple[Token, ...]:
    return tuple(sorted([*_keywords(document), *_names(document)]))


# ---------------------------------------------------------------- words of the language


def _keywords(document: Document) -> Iterator[Token]:
    translation = document.translation
    for end in translation.ends:
        if end.has_end and end.follower is not None:
            yield _keyword(document, end.follower.line, len("end"))
    for header in translation.headers:
        if header.word in ("sec", "thread"):
            yield _keyword(document, header.line, len(header.word))
    for line, column in translation.marks:
        found = _MARK.match(document.line(line), column - 1)
        if found is not None:
            yield Token(line, column, len(found.group()), TokenType.KEYWORD, ())


def _keyword(document: Document, line: int, length: int) -> Token:
    row = document.line(line)
    return Token(line, len(row) - len(row.lstrip()) + 1, length, TokenType.KEYWORD, ())


# ---------------------------------------------------------------- names


def _names(document: Document) -> Iterator[Token]:
    names = document.names
    known: dict[Entity, tuple[TokenType, frozenset[TokenModifier]] | None] = {}
    for item in names.occurrences:
        entity = item.entity
        if entity not in known:
            known[entity] = _kind(document, entity)
        kind = known[entity]
        if kind is None:
            continue
        modifiers = set(kind[1])
        if item.access is Access.WRITE:
            is_definition = item.role in ("def", "class", "import", "parameter", "label")
            modifiers.add(TokenModifier.DEFINITION if is_definition else TokenModifier.WRITE)
        token_type = kind[0]
        if token_type is TokenType.PROPERTY and _is_called(names, item):
            token_type = TokenType.FUNCTION if entity.kind is EntityKind.OUTSIDE else TokenType.METHOD
        ordered = tuple(modifier for modifier in TOKEN_MODIFIERS if modifier in modifiers) if modifiers else ()
        span = item.span
        yield Token(span.line, span.column, span.end_column - span.column, token_type, ordered)


def _is_called(names: Names, item: Occurrence) -> bool:
    above = names.symbols.parent(item.node)
    return isinstance(above, ast.Call) and above.func is item.node


def _kind(document: Document, entity: Entity) -> tuple[TokenType, frozenset[TokenModifier]] | None:
    """Return what a name is wherever it stands; None for a name that means nothing."""
    if entity.kind is EntityKind.STRING:
        return TokenType.SIGNAL, frozenset()
    if entity.kind is EntityKind.LABEL:
        return TokenType.FUNCTION, frozenset()
    places = document.names.of(entity)
    roles = {item.role for item in places}
    if entity.kind is EntityKind.ATTRIBUTE:
        return (TokenType.METHOD if "def" in roles else TokenType.PROPERTY), frozenset()
    if entity.kind is EntityKind.OUTSIDE:
        return _outside(document, entity.name)
    modifiers = set()
    if entity.kind is EntityKind.GLOBAL:
        modifiers.add(TokenModifier.GLOBAL)
    elif any(_function_of(item.scope) is not _function_of(entity.home) for item in places if item.role != "keyword"):
        modifiers.add(TokenModifier.CAPTURED)
    if _is_unused(document, entity, places):
        modifiers.add(TokenModifier.UNUSED)
    token_type = _type(document.names, places, roles)
    if token_type is TokenType.FUNCTION and entity in document.names.threads:
        modifiers.add(TokenModifier.THREAD)
    if "import" in roles:
        modifiers.add(TokenModifier.LIBRARY)
    if token_type is TokenType.VARIABLE and _is_constant(document, places):
        modifiers.add(TokenModifier.READONLY)
    return token_type, frozenset(modifiers)


def _type(names: Names, places: tuple[Occurrence, ...], roles: set[str]) -> TokenType:
    if "def" in roles:
        return TokenType.FUNCTION
    if "class" in roles:
        return TokenType.CLASS
    if "parameter" in roles:
        return TokenType.PARAMETER
    if "import" in roles:
        made = next(item for item in places if item.role == "import")
        if isinstance(names.symbols.parent(made.node), ast.Import):
            return TokenType.NAMESPACE
        return TokenType.FUNCTION if any(_is_called(names, item) for item in places) else TokenType.VARIABLE
    return TokenType.VARIABLE


def _outside(document: Document, name: str) -> tuple[TokenType, frozenset[TokenModifier]] | None:
    library = frozenset((TokenModifier.LIBRARY,))
    command = CATALOGUE.get(name)
    if command is not None:
        is_available = document.program.is_available(command)
        return TokenType.COMMAND, library if is_available else library | {TokenModifier.UNAVAILABLE}
    if "." in name:
        return TokenType.PROPERTY, library
    if name in document.settings.presets:
        return TokenType.VARIABLE, frozenset((TokenModifier.GLOBAL,))
    of_python = getattr(builtins, name, None)
    if of_python is None:
        return None
    return (TokenType.CLASS if isinstance(of_python, type) else TokenType.FUNCTION), library


def _function_of(scope: Scope | None) -> Scope | None:
    """Return the function in which a scope lies: a comprehension, and the body of a class, belong to it."""
    while scope is not None and scope.kind in ("comprehension", "class"):
        scope = scope.parent
    return scope


def _is_unused(document: Document, entity: Entity, places: tuple[Occurrence, ...]) -> bool:
    """Return whether nothing reads a variable, as far as that is certain."""
    name, home, program = entity.name, entity.home, document.program
    if home is None or name.startswith("_") or name in program.unread_names or name in document.names.unlocated:
        return False
    if home is document.symbols.body and program.parsed.kind == SCRIPT:
        # A script may be a part of a program whose other parts are not known.
        return False
    if any(
        item.role == "parameter" and item.scope.parent is not None and item.scope.parent.kind == "class"
        for item in places
    ):
        # Others may call the method with it.
        return False
    return all(item.access is not Access.READ and item.role != "augmented" for item in places)


def _is_constant(document: Document, places: tuple[Occurrence, ...]) -> bool:
    written = [item for item in places if item.access is Access.WRITE]
    if len(written) != 1 or written[0].role != "assign" or not isinstance(written[0].node, ast.Name):
        return False
    return not isinstance(document.program.constants.value(written[0].node, written[0].scope), Unknown)
