"""Shows the signature of the call around a place, and which argument stands there."""

from __future__ import annotations

import ast
import builtins
from typing import Final

from elitescript.assist.completion import parameter_at
from elitescript.assist.cursor import CallAt, Cursor
from elitescript.assist.describing import parameter_markdown
from elitescript.assist.document import Document
from elitescript.assist.enclosing import scope_at
from elitescript.assist.own_names import function_of, function_text, method_of, own_name
from elitescript.assist.python_texts import python_signature
from elitescript.assist.units import element_names, element_unit
from elitescript.assist.value_types import attribute, type_of_text
from elitescript.commands.definition.registry import Command
from elitescript.language.scopes import Scope
from elitescript.records import NamedTuple, record
from elitescript.values.references import OwnClass


class ShownParameter(NamedTuple):
    """One parameter of a signature.

    Attributes:
        start, end: where it stands in the label; offsets in characters from 0, the end exclusive.
        markdown: text about it.
    """

    start: int
    end: int
    markdown: str


@record
class SignatureHelp:
    """The signature of one call.

    Attributes:
        label: the signature as text.
        markdown: what the function does.
        parameters: its parameters, in order.
        active: index of the parameter that stands at the place; None if it has none for it.
    """

    label: str
    markdown: str
    parameters: tuple[ShownParameter, ...]
    active: int | None


TRIGGERS: Final = ("(", ",", "=")
"""Characters after which an editor should ask by itself."""


def signature_help(document: Document, line: int, column: int) -> SignatureHelp | None:
    """Return the signature of the innermost call around a place; None if that is of nothing known. Never raises."""
    cursor = Cursor(document, line, column)
    call = cursor.call
    if call is None or cursor.is_in_comment:
        return None
    scope = scope_at(document, cursor.line, cursor.column)
    command = document.program.command(call.function, scope)
    if command is not None:
        return _of_command(command, call)
    function, skipped = _own_function(document, call.function, scope)
    if function is not None:
        return _of_function(document, function, skipped, call)
    return _of_python(document, call, scope)


def _of_command(command: Command, call: CallAt) -> SignatureHelp:
    param = parameter_at(command, call)
    active = None if param is None else command.params.index(param)
    if param is None and command.takes_more and not call.at.keyword and command.params:
        active = len(command.params) - 1
    parts = []
    for index, each in enumerate(command.params):
        text = parameter_markdown(each)
        if index == active and call.path:
            place = call.path[0][1]
            names = element_names(each.quantity)
            if place < len(names):
                text = f"**{names[place]} [{element_unit(each.quantity, place)}]** of {text}"
        parts.append((each.name if each.is_required else f"{each.name}={each.default_text}", text))
    return _help(command.name, parts, active, " ".join(command.details.summary.split()))


def _help(name: str, parts: list[tuple[str, str]], active: int | None, markdown: str) -> SignatureHelp:
    """Lay a signature out; `parts` are parameters as they are shown, and their texts."""
    label = f"{name}("
    shown = []
    for index, (text, about) in enumerate(parts):
        label += ", " if index else ""
        shown.append(ShownParameter(len(label), len(label) + len(text), about))
        label += text
    return SignatureHelp(f"{label})", markdown, tuple(shown), active)


def _own_function(document: Document, called: str, scope: Scope) -> tuple[ast.FunctionDef | None, int]:
    """Return the function of the program that a call means, and how many of its parameters no call passes."""
    receiver, dot, name = called.rpartition(".")
    if dot:
        owner = type_of_text(document, receiver, scope)
        return (method_of(document, owner, name), int(owner.is_object)) if isinstance(owner, OwnClass) else (None, 0)
    function = function_of(document, name, scope)
    if function is not None:
        return function, 0
    owner = type_of_text(document, name, scope) if own_name(document, name, scope) is not None else None
    return (method_of(document, owner, "__init__"), 1) if isinstance(owner, OwnClass) else (None, 0)


def _of_function(document: Document, function: ast.FunctionDef, skipped: int, call: CallAt) -> SignatureHelp:
    args = function.args
    positional = [*args.posonlyargs, *args.args]
    without = len(positional) - len(args.defaults)
    parts = []
    for index, argument in enumerate(positional[skipped:], skipped):
        parts.append((_with_default(argument.arg, args.defaults[index - without] if index >= without else None), ""))
    names = [argument.arg for argument in positional[skipped:]]
    if args.vararg is not None:
        parts.append((f"*{args.vararg.arg}", ""))
        names.append("*")
    for argument, default in zip(args.kwonlyargs, args.kw_defaults, strict=True):
        parts.append((_with_default(argument.arg, default), ""))
        names.append(argument.arg)
    if args.kwarg is not None:
        parts.append((f"**{args.kwarg.arg}", ""))
        names.append("**")
    positions = len(positional) - skipped
    active: int | None = None
    if call.at.keyword:
        active = names.index(call.at.keyword) if call.at.keyword in names else _index(names, "**")
    elif call.position < positions:
        active = call.position
    else:
        active = _index(names, "*")
    name = call.function if skipped else function.name
    return _help(name, parts, active, function_text(document, function))


def _index(names: list[str], name: str) -> int | None:
    return names.index(name) if name in names else None


def _with_default(name: str, default: ast.expr | None) -> str:
    return name if default is None else f"{name}={ast.unparse(default)}"


def _of_python(document: Document, call: CallAt, scope: Scope) -> SignatureHelp | None:
    """Return the signature of a function of Python's library; None if it is not known."""
    receiver, dot, name = call.function.rpartition(".")
    if dot:
        owner = type_of_text(document, receiver, scope)
        found = None if owner is None else attribute(owner, name)
    else:
        found = None if own_name(document, name, scope) is not None else getattr(builtins, name, None)
    signature = python_signature(name, found) if callable(found) else ""
    if not signature.startswith("("):
        return None
    parts = [(part.strip(), "") for part in _split(signature[1:-1]) if part.strip() not in ("", "*", "/")]
    names = [part.partition("=")[0] for part, _ in parts]
    more = next((index for index, each in enumerate(names) if each[:1] == "*" != each[1:2]), None)
    active: int | None = call.position if call.position < len(parts) else None
    if call.at.keyword:
        active = _index(names, call.at.keyword)
    elif more is not None and call.position > more:
        active = more
    text = (getattr(found, "__doc__", None) or "").strip().partition("\n\n")[0]
    return _help(call.function, parts, active, text)


def _split(text: str) -> list[str]:
    """Cut a text at its commas outside brackets and quotes."""
    parts, depth, quote = [""], 0, ""
    for character in text:
        if character == "," and not depth and not quote:
            parts.append("")
            continue
        if character in "'\"":
            quote = "" if quote == character else quote or character
        depth += (character in "([{") - (character in ")]}") if not quote else 0
        parts[-1] += character
    return parts
