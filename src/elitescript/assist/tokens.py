"""Says what each name of a text is, for its colour."""

from __future__ import annotations

from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.lint.program import Span
from elitescript.records import NamedTuple


class TokenType(StrEnum):
    """What a token is. The order is that of the legend; the texts are those of the protocol of editors where it has one."""

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
    """`end`, `sec`, `thread`, and `$ LINE`."""
    SIGNAL = "signal"
    """A name of a signal, register or connection in a string."""


class TokenModifier(StrEnum):
    """What else is known of a token; the order is that of the bits."""

    DEFINITION = "definition"
    """It is defined there."""
    WRITE = "modification"
    """It gets a value there."""
    CAPTURED = "captured"
    """A variable of a function, or of the program, around this one; or one that a function inside uses."""
    GLOBAL = "global"
    """A global of the program."""
    LIBRARY = "defaultLibrary"
    """The program does not define it."""
    UNUSED = "unused"
    """Nothing reads it."""
    DEPRECATED = "deprecated"
    UNAVAILABLE = "unavailable"
    """The chosen firmware does not have it."""
    THREAD = "thread"
    """A function that runs as a thread."""
    READONLY = "readonly"
    """It gets one value, which is known before the run."""


TOKEN_TYPES = tuple(TokenType)
"""The legend: `TOKEN_TYPES.index(token.type)` is the number on the wire."""

TOKEN_MODIFIERS = tuple(TokenModifier)
"""The legend of the modifiers: bit `n` of the set is that of element `n`."""


class Token(NamedTuple):
    """A token, which lies on one line.

    Attributes:
        line, column: where, from 1.
        length: in characters.
        type: what it is.
        modifiers: what else is known of it.
    """

    line: int
    column: int
    length: int
    type: TokenType
    modifiers: tuple[TokenModifier, ...]


def semantic_tokens(document: Document, span: Span | None = None) -> tuple[Token, ...]:
    """Return the tokens of a text, or of the lines of a range, in the order of the text. Never raises."""
    return ()
