"""Explains what stands at a place: a command, an argument, a name, a number, a signal, a word of the language."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable
from math import degrees
from typing import Any, Final

from elitescript.assist.completion import parameter_at
from elitescript.assist.cursor import CallAt, Cursor
from elitescript.assist.describing import KEYWORDS, command_markdown, fenced, parameter_markdown, signal_markdown
from elitescript.assist.document import Document
from elitescript.assist.enclosing import scope_at
from elitescript.assist.last_run import LastRun
from elitescript.assist.names_in_strings import inputs, uses_of_name
from elitescript.assist.own_names import (
    NameFacts,
    OwnName,
    function_of,
    function_signature,
    function_text,
    method_of,
    own_name,
)
from elitescript.assist.python_texts import python_markdown
from elitescript.assist.units import element_names, element_unit, value_text, with_unit
from elitescript.assist.value_types import expression, type_of_text
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.quantities import JOINTS, POSE
from elitescript.commands.definition.registry import Param
from elitescript.errors import UsageError
from elitescript.language.modules import AVAILABLE
from elitescript.language.scopes import Scope
from elitescript.lint.constants import Unknown
from elitescript.lint.places import TargetPlaces, six
from elitescript.lint.program import Span
from elitescript.messages.signals import parse_signal_name
from elitescript.records import record
from elitescript.untrusted.escaping import code_span
from elitescript.values.description import Value
from elitescript.values.references import ModuleType, OwnClass
from elitescript.values.words import words

_LINES_MAX: Final = 4
"""Lines that a list of places names."""
_EXPRESSIONS: Final = (ast.Subscript, ast.BinOp, ast.Call, ast.UnaryOp, ast.Compare, ast.BoolOp, ast.IfExp)
_SOFT_WORDS: Final = ("case", "end", "match", "sec")


@record
class Hover:
    """An explanation.

    Attributes:
        span: what it is about.
        markdown: the text.
    """

    span: Span
    markdown: str


def hover(document: Document, line: int, column: int, last_run: LastRun | None = None) -> Hover | None:
    """Return what is known of the text at a place; None if that is nothing. Never raises.

    Args:
        document: the text.
        line, column: the place, from 1.
        last_run: for the values that variables had.
    """
    cursor = Cursor(document, line, column)
    if cursor.is_in_comment:
        return None
    if cursor.string is not None and cursor.field is None:
        return _string(document, cursor)
    word = cursor.word_text
    if not word:
        return _expression(document, cursor)
    explain: Callable[[Document, Cursor, LastRun | None], str] = _number if word[0].isdigit() else _word
    text = explain(document, cursor, last_run)
    if not text:
        return _expression(document, cursor)
    return Hover(_number_span(cursor) if word[0].isdigit() else cursor.word_span, text)


# -------------------------------------------------------------------- words


def _word(document: Document, cursor: Cursor, last_run: LastRun | None) -> str:
    word, scope = cursor.word_text, scope_at(document, cursor.line, cursor.column)
    if cursor.receiver is not None:
        return _member(document, cursor.receiver, word, scope)
    is_soft = word in _SOFT_WORDS
    if word in KEYWORDS and (not is_soft or (not cursor.head.strip() and own_name(document, word, scope) is None)):
        return f"**`{word}`** {KEYWORDS[word]}"
    text = _argument_name(document, cursor, scope)
    if text:
        return text
    if cursor.head.strip().startswith(("import", "from")) and word in AVAILABLE:
        return python_markdown(word)
    own = own_name(document, word, scope)
    if own is not None:
        return _own(document, own, last_run, _value_at(document, cursor.word_span))
    command = CATALOGUE.get(word)
    if command is not None:
        return command_markdown(command, document.settings.profile)
    return python_markdown(f"builtins.{word}") if hasattr(builtins, word) else python_markdown(word)


def _member(document: Document, receiver: str, name: str, scope: Scope) -> str:
    kind = type_of_text(document, receiver, scope)
    if isinstance(kind, OwnClass):
        method = method_of(document, kind, name)
        if method is None:
            return f"`{name}`: of `{kind.scope.name}`" if name in kind.scope.bindings else ""
        return _function(document, method)
    if isinstance(kind, ModuleType):
        return python_markdown(f"{kind.name}.{name}")
    return "" if kind is None else python_markdown(f"builtins.{kind.__name__}.{name}")


def _argument_name(document: Document, cursor: Cursor, scope: Scope) -> str:
    """Return the text of the parameter whose keyword stands at the place; empty if none does."""
    call = cursor.call
    if call is None or call.path or call.at.keyword != cursor.word_text or cursor.word[1] > call.at.value:
        return ""
    command = document.program.command(call.function, scope)
    if command is not None:
        param = parameter_at(command, call)
        return "" if param is None else f"{fenced(command.signature)}\n\n{parameter_markdown(param)}"
    function = function_of(document, call.function, scope)
    return "" if function is None else fenced(function_signature(function))


def _function(document: Document, function: ast.FunctionDef) -> str:
    word = "sec" if function.lineno in document.translation.secondaries else "def"
    text = function_text(document, function)
    return "\n\n".join(part for part in (fenced(f"{word} {function_signature(function)}:"), text) if part)


def _value_at(document: Document, span: Span) -> Value | None:
    """Return the description of the name that is read at a place; None if none is."""
    program = document.program
    for node in program.nodes(ast.Name):
        if node.lineno == span.line and isinstance(node.ctx, ast.Load) and program.span(node) == span:
            return program.values.of(node)
    return None


def _expression(document: Document, cursor: Cursor) -> Hover | None:
    """Explain the innermost element, sum, call ... around a place without a name, such as the bracket of `p[2]`."""
    program, best = document.program, None
    for kind in _EXPRESSIONS:
        for node in program.nodes(kind):
            if node.lineno == cursor.line == node.end_lineno:
                span = program.span(node)
                inside = span.column <= cursor.column < span.end_column
                if inside and (best is None or span.column >= best[0].column >= span.column):
                    best = span, node
    value = None if best is None else program.values.of(best[1])
    text = "" if value is None or value.has_constant else words(value)
    if best is None or not text:
        return None
    return Hover(best[0], f"{fenced(ast.unparse(best[1]))}\n\n{text[:1].upper()}{text[1:]}.")


def _own(document: Document, own: OwnName, last_run: LastRun | None, at: Value | None) -> str:
    facts = document.once(NameFacts)
    parts = []
    first = own.bindings[0].node if own.bindings else None
    if isinstance(first, ast.FunctionDef) and len(own.bindings) == 1:
        parts.append(_function(document, first))
        if own.name in facts.thread_functions:
            parts.append("Runs as a thread.")
        return "\n\n".join([*parts, f"*Line {first.lineno}.*"])
    value = facts.value(own)
    kind = facts.kind(own)
    is_known = not isinstance(value, Unknown)
    what = (kind or facts.type_text(own)) if is_known else facts.described(own, at)
    parts.append(fenced(f"{own.name} = {value_text(value)}" if is_known else f"{own.name}"))
    parts.append(f"{facts.role(own).capitalize()}{f', {what}' if what else ''}; {_places(own)}.")
    uses = facts.uses(own)
    if is_known and isinstance(value, list):
        parts.append(_list(document, value, kind))
    elif is_known:
        parts += [with_unit(value, unit) for unit in dict.fromkeys(use.param.quantity.unit for use in uses)]
    if uses:
        parts.append(
            "Used as " + ", ".join(f"`{use.param.name}` of `{use.command}`" for use in uses[:_LINES_MAX]) + "."
        )
    parts.append(_special(document, own))
    parts.append(_last_values(document, own, last_run))
    return "\n\n".join(part for part in parts if part)


def _special(document: Document, own: OwnName) -> str:
    """Return what some values of a name mean, if it is the result of one command: `False: failed.`."""
    calls = {id(called.call): called.command for called in document.program.command_calls}
    commands = set()
    for binding in own.bindings:
        statement = document.symbols.parent(binding.node)
        command = calls.get(id(getattr(statement, "value", None)))
        if command is None:
            return ""
        commands.add(command)
    return commands.pop().details.result.special_text if len(commands) == 1 else ""


def _places(own: OwnName) -> str:
    lines = sorted({binding.line for binding in own.bindings if binding.kind != "delete"})
    if not lines:
        return "gets its value elsewhere"
    shown = ", ".join(map(str, lines[:_LINES_MAX])) + (" ..." if len(lines) > _LINES_MAX else "")
    word = "line" if len(lines) == 1 else "lines"
    return f"parameter in line {lines[0]}" if own.bindings[0].kind == "parameter" else f"set in {word} {shown}"


def _last_values(document: Document, own: OwnName, last_run: LastRun | None) -> str:
    if last_run is None:
        return ""
    scope = "" if own.home is None or own.home is document.symbols.body else own.home.name
    value = last_run.values.get(scope, {}).get(own.name)
    return "" if value is None else f"In the last run at last: {code_span(value)}"


# -------------------------------------------------------------------- lists of six numbers


def _list(document: Document, value: list[Any], kind: str) -> str:
    """Return elements with units, and whether the arm reaches them."""
    if kind not in ("joints", "pose") or len(value) != 6:
        return ""
    quantity = JOINTS if kind == "joints" else POSE
    rows = [
        f"- {name}: {with_unit(number, element_unit(quantity, index))}"
        for index, (name, number) in enumerate(zip(element_names(quantity), value, strict=True))
        if not isinstance(number, Unknown)
    ]
    reach = _joints_reach(document, value) if kind == "joints" else _pose_reach(document, value)
    return "\n".join(rows) + (f"\n\n{reach}" if reach else "")


def _joints_reach(document: Document, value: list[Any]) -> str:
    arm, q = document.settings.arm, six(value)
    if arm is None or q is None:
        return ""
    faults = [
        f"{name} is outside {degrees(low):.0f} to {degrees(high):.0f} deg"
        f" by {degrees(max(low - angle, angle - high)):.1f} deg"
        for name, angle, (low, high) in zip(element_names(JOINTS), q, arm.joint_ranges, strict=True)
        if not low <= angle <= high
    ]
    return f"**Not reachable**: {'; '.join(faults)}." if faults else "Within the joint limits of the arm."


def _pose_reach(document: Document, value: list[Any]) -> str:
    arm, p = document.settings.arm, six(value)
    if arm is None or p is None:
        return ""
    places = TargetPlaces(document.program)
    if not places.tcps:
        return ""
    reason = places.unreachable(arm, p)
    return f"**Not reachable**: {reason}." if reason else "The arm reaches it."


# -------------------------------------------------------------------- numbers


def _number_span(cursor: Cursor) -> Span:
    return cursor.span(*_number_range(cursor))


def _number_range(cursor: Cursor) -> tuple[int, int]:
    """Return start and end of the number around the place, with its sign if that is no operator."""
    masked = cursor.masked
    start, end = cursor.word
    while start and (masked[start - 1].isdigit() or masked[start - 1] == "."):
        start -= 1
    while end < len(masked) and (masked[end].isalnum() or masked[end] == "."):
        end += 1
    if masked[end - 1] in "eE" and masked[end : end + 1] in ("-", "+"):
        end += 1
        while end < len(masked) and masked[end].isdigit():
            end += 1
    before = masked[cursor.statement_start : start].rstrip()
    if before.endswith("-") and (not before[:-1].rstrip() or before[:-1].rstrip()[-1] in "([{,=+-*/%<>:"):
        start = cursor.statement_start + len(before) - 1
    return start, end


def _number(document: Document, cursor: Cursor, last_run: LastRun | None) -> str:
    start, end = _number_range(cursor)
    node = expression("".join(cursor.text[start:end].split()))
    call = cursor.call
    if call is None or not isinstance(node, (ast.Constant, ast.UnaryOp)):
        return ""
    number = ast.literal_eval(node)
    if isinstance(number, complex):
        return ""
    command = document.program.command(call.function, scope_at(document, cursor.line, cursor.column))
    param = None if command is None else parameter_at(command, call)
    if command is None or param is None or len(call.path) > 1 or not _is_alone(cursor, start, end):
        return ""
    where, unit = _element(param, call)
    shown = with_unit(number, unit)
    return f"`{param.name}`{where} of `{command.name}`: **{shown}**\n\n{parameter_markdown(param)}"


def _is_alone(cursor: Cursor, start: int, end: int) -> bool:
    """Return whether a number is a whole argument or element."""
    before, after = cursor.masked[:start].rstrip()[-1:], cursor.masked[end:].lstrip()[:1]
    return before in ("(", "[", ",", "=") and after in (")", "]", ",", "")


def _element(param: Param, call: CallAt) -> tuple[str, str]:
    """Return which element of the parameter stands at the place, as text, and its unit."""
    if not call.path:
        return "", param.quantity.unit
    index = call.path[0][1]
    names = element_names(param.quantity)
    name = names[index] if index < len(names) else f"element {index}"
    return f"[{index}], {name},", element_unit(param.quantity, index)


# -------------------------------------------------------------------- strings


def _string(document: Document, cursor: Cursor) -> Hover | None:
    """Explain a name of a signal, an RTSI input, a connection or a file in a string."""
    string = cursor.string
    assert string is not None
    name = cursor.text[string.body : string.end]
    span = cursor.span(string.body, string.end)
    if not name or "\n" in name:
        return None
    try:
        signal, _ = parse_signal_name(name)
    except UsageError:
        found = next((item for item in inputs() if item.name == name), None)
        text = f"`{name}`: {found.text}" if found else _used_name(document, cursor, name)
    else:
        text = signal_markdown(signal, name)
    return Hover(span, text) if text else None


def _used_name(document: Document, cursor: Cursor, name: str) -> str:
    call = cursor.call
    scope = scope_at(document, cursor.line, cursor.column)
    command = None if call is None or call.path else document.program.command(call.function, scope)
    param = None if command is None or call is None else parameter_at(command, call)
    if command is None or param is None:
        return ""
    lines = uses_of_name(document, param, name)
    places = f"\n\nIn this program: lines {', '.join(map(str, lines))}." if lines else ""
    return f"`{param.name}` of `{command.name}`: {param.text}{places}"
