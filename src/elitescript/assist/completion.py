"""Offers what can stand at a place: commands, names, arguments, values, names in strings."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Callable, Iterable, Iterator
from enum import StrEnum
from typing import Any, Final

from elitescript.assist.cursor import CallAt, Cursor
from elitescript.assist.describing import KEYWORDS, command_markdown, fenced, parameter_label, parameter_markdown
from elitescript.assist.document import Document
from elitescript.assist.enclosing import Block, blocks_around, indentation_step, scope_at
from elitescript.assist.fitting import NO_FIT, fit_of
from elitescript.assist.names_in_strings import names_for
from elitescript.assist.own_names import (
    NameFacts,
    OwnName,
    function_of,
    function_signature,
    function_text,
    method_of,
    visible_names,
)
from elitescript.assist.python_texts import python_markdown, python_signature
from elitescript.assist.value_types import ValueType, attribute, attribute_names, module_names, type_of_text
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.quantities import Boolean, Choice, Either, Optionally, Quantity
from elitescript.commands.definition.registry import Command, Param
from elitescript.language.advice.unknown_names import KNOWN, PRELOADED
from elitescript.language.builtin_names import REFUSED_BUILTINS, WITHHELD_ERRORS
from elitescript.language.modules import AVAILABLE
from elitescript.language.scopes import Resolution
from elitescript.language.symbols import THREAD_STARTER
from elitescript.language.text.lexer import MARKS, NAME, is_in_word
from elitescript.language.text.masked import operand_before
from elitescript.lint.program import Span
from elitescript.messages.profile import PROFILES, release_of
from elitescript.records import NamedTuple, record, replace
from elitescript.values.references import ModuleType, OwnClass


class ItemKind(StrEnum):
    """What a completion stands for."""

    COMMAND = "command"
    FUNCTION = "function"
    CLASS = "class"
    VARIABLE = "variable"
    CONSTANT = "constant"
    """A variable with a certain value."""
    ARGUMENT = "argument"
    """A keyword argument of a call, with its `=`."""
    KEYWORD = "keyword"
    SNIPPET = "snippet"
    """A whole block."""
    MODULE = "module"
    METHOD = "method"
    FIELD = "field"
    """What stands behind a `.` and is no method."""
    VALUE = "value"
    """One value of an argument that has few."""
    NAME = "name"
    """A name inside a string: of a signal, a socket, a variable of a client."""
    FILE = "file"


@record
class Completion:
    """One offer.

    Attributes:
        label: what the list shows.
        kind: what it is.
        span: the text that it replaces; one line, it holds the cursor.
        text: what is inserted by clients without snippets.
        snippet: what is inserted by clients with snippets, in their syntax (`$0`, `${1:a}`); empty if that is `text`.
        detail: one line about it, shown beside the label.
        sort: key of the order in the list.
        is_missing: the chosen firmware does not have it.
        is_deprecated: it works, but another one should be used.
        source: what `resolved` needs; empty if there is nothing to add.
        documentation: Markdown; empty before `resolved`.
    """

    label: str
    kind: ItemKind
    span: Span
    text: str
    snippet: str = ""
    detail: str = ""
    sort: str = ""
    is_missing: bool = False
    is_deprecated: bool = False
    source: str = ""
    documentation: str = ""


TRIGGERS: Final = (".", "(", ",", "=", '"', "'", "[")
"""Characters after which an editor should ask by itself, besides letters."""

# Ranks: the first letter of `Completion.sort`.
_VALUES, _ARGUMENTS, _EXPECTED, _OWN, _COMMANDS, _ALIASES, _PYTHON, _SNIPPETS, _WORDS, _MISSING = "abcdefghij"

_MODULES: Final = re.compile(rf"\s*(?:import\s+(?:[\w.{MARKS}]*(?:\s+as\s+{NAME})?\s*,\s*)*|from\s+)[\w.{MARKS}]*\Z")
_MODULE_NAMES: Final = re.compile(rf"\s*from\s+([\w.]+)\s+import\s+\(?(?:{NAME}(?:\s+as\s+{NAME})?\s*,\s*)*\Z")
_AFTER_FROM: Final = re.compile(r"\s*from\s+[\w.]+\s+\Z")
_GLOBALS: Final = re.compile(rf"\s*(?:global|nonlocal)\s+(?:{NAME}\s*,\s*)*\Z")
_NEW_NAME: Final = re.compile(
    rf"\s*(?:def|sec|class|thread)\s+\Z|\bas\s+\Z|(?:^|\b)for\s+(?:{NAME}\s*,\s*)*\Z|\blambda\s+(?:{NAME}\s*,\s*)*\Z"
    rf"|\s*(?:def|sec|thread)\s+{NAME}\s*\((?:[^()=]*,)?\s*\Z"
)
_AFTER_FOR: Final = re.compile(rf"\bfor\s+{NAME}(?:\s*,\s*{NAME})*\s+\Z")
_ERRORS_WANTED: Final = re.compile(rf"\s*(?:except|raise)\s+\(?(?:{NAME}\s*,\s*)*\Z")
_BLOCK_HEADER: Final = re.compile(r"\s*(?:if|elif|else|while|for|try|except|finally|with|def|sec|class)\b.*:\s*\Z")

_OPERATORS: Final = ("and", "if", "in", "is", "not", "or")
_VALUE_WORDS: Final = ("None", "True", "False", "not", "lambda")
_STATEMENT_WORDS: Final = ("assert", "del", "from", "global", "import", "pass", "raise", "return")
_BLOCK_WORDS: Final = ("class", "def", "for", "if", "match", "try", "while", "with")
_LOOPS: Final = ("for", "while")


class Fitting(NamedTuple):
    """What can stand at a place and fits what is written of it.

    Attributes:
        items: the offers, the most likely first.
        is_all: nothing else can stand there, whatever is written.
    """

    items: tuple[Completion, ...]
    is_all: bool


def completions(document: Document, line: int, column: int) -> tuple[Completion, ...]:
    """Return what can stand at a place, the most likely first. Never raises."""
    return _sorted(document, Cursor(document, line, column), lambda name: True)


def fitting_completions(document: Document, line: int, column: int) -> Fitting:
    """Return those of `completions` that fit what is written in front of the place. Never raises.

    A name fits if a word of it begins so: `digital_out` and `STANDARD` fit `set_standard_digital_out`. If there is none
    those fit that have the same characters in their order.
    """
    cursor = Cursor(document, line, column)
    row = document.line(cursor.line)
    found: tuple[Completion, ...] = ()
    for fits in (_begins_so, _has_all_of) if cursor.typed else (_always,):
        # Long lists are of names that replace the word at the place, but texts in strings replace more.
        items = _sorted(document, cursor, lambda name, fits=fits: fits(name, cursor.typed))  # type: ignore[misc]
        found = tuple(item for item in items if fits(item.label, row[item.span.column - 1 : cursor.column - 1]))
        if found:
            break
    return Fitting(found, not cursor.typed)


def _always(name: str, written: str) -> bool:
    return True


def _begins_so(name: str, written: str) -> bool:
    """Return whether a word of a name begins with what is written, in small letters or capitals."""
    return re.search(rf"(?:^|[\W_]){re.escape(written)}", name, re.IGNORECASE) is not None


def _has_all_of(name: str, written: str) -> bool:
    """Return whether a name has the characters that are written, in their order."""
    left = iter(name.lower())
    return all(character in left for character in written.lower())


def _sorted(document: Document, cursor: Cursor, fits: Callable[[str], bool]) -> tuple[Completion, ...]:
    if cursor.is_in_comment:
        return ()
    found = _Offers(document, cursor, fits).offers()
    return tuple(sorted({item.label: item for item in reversed(list(found))}.values(), key=lambda item: item.sort))


def resolved(item: Completion) -> Completion:
    """Return an item with its documentation."""
    what, _, name = item.source.partition(":")
    text = _TEXTS[what](name) if what in _TEXTS else ""
    return replace(item, documentation=text) if text else item


class _Offers:
    """What is offered at one place; of long lists, what fits."""

    def __init__(self, document: Document, cursor: Cursor, fits: Callable[[str], bool]) -> None:
        self.document = document
        self.fits = fits
        self.cursor = cursor
        self.span = cursor.word_span
        self.scope = scope_at(document, cursor.line, cursor.column)
        self.is_called = cursor.text[cursor.word[1] : cursor.word[1] + 1] == "("

    @property
    def facts(self) -> NameFacts:
        """What is known of names, which takes the values of all expressions."""
        return self.document.once(NameFacts)

    def offers(self) -> Iterator[Completion]:
        cursor = self.cursor
        if cursor.string is not None:
            yield from self._in_string()
            return
        head = cursor.head
        if cursor.receiver is not None and not _MODULES.match(head):
            yield from self._members(cursor.receiver)
        elif cursor.is_in_number or _NEW_NAME.search(head):
            return
        elif "$" in head:
            # A line mark consists of that word, a number and texts.
            if head.rstrip().endswith("$"):
                yield self._word("LINE")
        elif _MODULES.match(head):
            yield from self._modules(head)
        elif found := _MODULE_NAMES.match(head):
            yield from self._names_of_module(found[1])
        elif _AFTER_FROM.match(head):
            yield self._word("import")
        elif _GLOBALS.match(head):
            yield from self._shareable_names()
        elif _AFTER_FOR.search(head):
            yield self._word("in")
        elif _ERRORS_WANTED.match(head):
            yield from self._errors()
        elif head.strip() and operand_before(head) and not _BLOCK_HEADER.match(head):
            yield from (self._word(word) for word in _OPERATORS)
        else:
            yield from self._at_code()

    # ---------------------------------------------------------------- code

    def _at_code(self) -> Iterator[Completion]:
        cursor = self.cursor
        head = cursor.head
        is_statement = not head.strip() or bool(_BLOCK_HEADER.match(head))
        call = cursor.call
        if call is not None and not call.path:
            yield from self._of_call(call)
        yield from self._own_names()
        yield from self._commands()
        yield from self._python_names()
        yield from (self._word(word) for word in _VALUE_WORDS)
        if is_statement:
            yield from self._statements(is_alone=not head.strip())

    def _own_names(self) -> Iterator[Completion]:
        wanted = self._wanted()
        for own in visible_names(self.document, self.scope):
            if self.fits(own.name) and not self._is_only_here(own):
                fit = NO_FIT if wanted is None else fit_of(self.facts.description(own), wanted, self.facts.kind(own))
                rank = _OWN if fit == NO_FIT else f"{_EXPECTED}{fit}"
                yield self._own(own, f"{rank}{min(own.distance, 9)}{own.name}")
        for name in sorted(self.document.settings.presets):
            if self.scope.resolve(name) is Resolution.BUILTIN:
                yield Completion(name, ItemKind.VARIABLE, self.span, name, "", "global", f"{_OWN}9{name}")

    def _wanted(self) -> Quantity | None:
        """Return what the argument at the place takes; None if that is not known."""
        call = self.cursor.call
        if call is None or call.path:
            return None
        command = self.document.program.command(call.function, self.scope)
        param = None if command is None else parameter_at(command, call)
        return None if param is None else param.quantity

    def _is_only_here(self, own: OwnName) -> bool:
        """Return whether a name is what is just being written."""
        span = self.span
        places = [(binding.line, binding.column) for binding in own.bindings]
        return all(line == span.line and span.column <= column <= span.end_column for line, column in places)

    def _own(self, own: OwnName, sort: str, *, is_call: bool = True) -> Completion:
        name, detail = own.name, self.facts.detail(own)
        node = own.bindings[0].node if own.bindings else None
        if isinstance(node, ast.FunctionDef) and len(own.bindings) == 1:
            source = f"text:{fenced(detail)}\n\n{function_text(self.document, node)}".rstrip()
            snippet = _function_snippet(node) if is_call and not self.is_called else ""
            return Completion(name, ItemKind.FUNCTION, self.span, name, snippet, detail, sort, source=source)
        kinds = {binding.kind for binding in own.bindings}
        kind = ItemKind.CLASS if kinds == {"class"} else ItemKind.VARIABLE
        if kinds == {"import"}:
            kind = ItemKind.MODULE
        elif "=" not in detail and name.isupper():
            kind = ItemKind.CONSTANT
        return Completion(name, kind, self.span, name, "", detail, sort)

    def _commands(self) -> Iterator[Completion]:
        profile = self.document.settings.profile
        is_secondary = self.document.parsed.kind == "secondary"
        for name in CATALOGUE.names():
            command = CATALOGUE.get(name) if self.fits(name) else None
            if command is None or self.scope.resolve(name) is not Resolution.BUILTIN:
                continue
            is_missing = release_of(command.since) > profile.release
            rank = _MISSING if is_missing else _ALIASES if command.alias_of else _COMMANDS
            detail = command.signature.removeprefix(name)
            if is_missing:
                detail = f"needs firmware {command.since}"
            elif is_secondary and not command.works_in_sec:
                rank, detail = _MISSING, "not in secondary programs"
            yield Completion(
                name,
                ItemKind.COMMAND,
                self.span,
                name,
                "" if self.is_called else command_snippet(command),
                detail,
                rank + name,
                is_missing=is_missing,
                source=f"command:{profile.name}:{name}",
            )

    def _python_names(self) -> Iterator[Completion]:
        for name in _BUILTINS:
            if self.fits(name) and self.scope.resolve(name) is Resolution.BUILTIN:
                found = getattr(builtins, name, None)
                is_class = isinstance(found, type) and issubclass(found, BaseException)
                kind = ItemKind.CLASS if is_class else ItemKind.FUNCTION
                detail = "Python" if is_class else python_signature(name, found)
                snippet = "" if is_class or self.is_called or found is None else f"{name}($0)"
                is_old = name in _PYTHON2
                yield Completion(
                    name,
                    kind,
                    self.span,
                    name,
                    snippet,
                    "Python 2" if is_old else detail,
                    (_MISSING if is_old else _PYTHON) + name,
                    is_deprecated=is_old,
                    source=f"python:builtins.{name}",
                )

    # ---------------------------------------------------------------- calls

    def _of_call(self, call: CallAt) -> Iterator[Completion]:
        """Yield keywords and values of the call around the place."""
        at = call.at
        is_name_wanted = not at.keyword and self.cursor.word[0] >= at.start and not self._before_word(at.start)
        command = self.document.program.command(call.function, self.scope)
        if command is not None:
            placement = command.place(call.positional, call.others, is_complete=False)
            taken = {
                param.name for param, slot in zip(command.params, placement.slots, strict=True) if slot is not None
            }
            param = parameter_at(command, call)
            if param is not None and not self._before_word(at.value):
                yield from self._values(param.quantity, param.text)
                if command.name == THREAD_STARTER and param.quantity.type_name == "function":
                    yield from self._functions()
            if is_name_wanted:
                for index, each in enumerate(command.params[call.position :], call.position):
                    if each.name not in taken:
                        source = f"argument:{command.name}:{each.name}"
                        yield self._argument(each.name, parameter_label(each), index, source)
            return
        function = function_of(self.document, call.function, self.scope)
        if function is not None and is_name_wanted:
            args = function.args
            listed = [*args.posonlyargs, *args.args]
            offered = listed[max(call.position, len(args.posonlyargs)) :] + args.kwonlyargs
            for index, given in enumerate(offered):
                if given.arg not in call.others:
                    yield self._argument(given.arg, f"of {function_signature(function)}", index, "")

    def _before_word(self, start: int) -> str:
        """Return what stands between an offset and the word."""
        return self.cursor.masked[start : self.cursor.word[0]].strip()

    def _argument(self, name: str, detail: str, index: int, source: str) -> Completion:
        follows = self.cursor.masked[self.cursor.word[1] :].lstrip(" ")[:2]
        text = name if follows[:1] == "=" and follows != "==" else f"{name}="
        sort = f"{_ARGUMENTS}{index:02}"
        return Completion(f"{name}=", ItemKind.ARGUMENT, self.span, text, "", detail, sort, source=source)

    def _values(self, quantity: Quantity, text: str) -> Iterator[Completion]:
        values = (value_source(value) for value in choices_of(quantity))
        for index, value in enumerate(values):
            sort = f"{_VALUES}{index:02}"
            yield Completion(value, ItemKind.VALUE, self.span, value, "", text, sort)

    def _functions(self) -> Iterator[Completion]:
        for own in visible_names(self.document, self.scope):
            if own.bindings and isinstance(own.bindings[0].node, ast.FunctionDef):
                yield self._own(own, f"{_EXPECTED}{own.name}", is_call=False)

    # ---------------------------------------------------------------- statements

    def _statements(self, *, is_alone: bool) -> Iterator[Completion]:
        cursor = self.cursor
        blocks = blocks_around(self.document, cursor.line, min(self.span.column, cursor.column))
        for word in _STATEMENT_WORDS:
            yield self._word(word)
        if any(block.word in _LOOPS for block in _of_this_function(blocks)):
            yield self._word("break")
            yield self._word("continue")
        if not is_alone:
            return
        for word in _BLOCK_WORDS:
            yield self._word(word)
        if blocks:
            yield self._word("end")
        for word in _clauses(self.document, cursor, blocks):
            yield self._word(word)
        step = " " * indentation_step(self.document)
        is_empty = not any(line.word != "end" for line in self.cursor.lines if line.line != cursor.line)
        for label, template, detail in _BLOCKS:
            if label == "sec" and not is_empty:
                continue
            snippet = template.replace("\t", step)
            yield Completion(
                label,
                ItemKind.SNIPPET,
                self.span,
                plain_text(snippet),
                snippet,
                detail,
                _SNIPPETS + label,
                source=f"keyword:{label.partition(' ')[0]}",
            )

    def _word(self, word: str) -> Completion:
        return Completion(word, ItemKind.KEYWORD, self.span, word, sort=_WORDS + word, source=f"keyword:{word}")

    # ---------------------------------------------------------------- imports, globals, errors

    def _modules(self, head: str) -> Iterator[Completion]:
        start = self.cursor.word[0]
        masked = self.cursor.masked
        while start and (is_in_word(masked[start - 1]) or masked[start - 1] == "."):
            start -= 1
        span = self.cursor.span(start, self.cursor.word[1])
        for name in sorted(AVAILABLE):
            detail = "module of Python's library"
            yield Completion(name, ItemKind.MODULE, span, name, "", detail, _PYTHON + name, source=f"module:{name}")

    def _names_of_module(self, module: str) -> Iterator[Completion]:
        for name in module_names(module):
            yield self._member(ModuleType(module), name, is_called=True)

    def _shareable_names(self) -> Iterator[Completion]:
        """Yield names of globals, and those that other functions use without one of their own."""
        symbols = self.document.symbols
        here = self.scope
        names = set(symbols.global_names) | {name for scope in symbols.scopes for name in scope.bindings}
        names |= self.document.settings.presets
        declared = {name for name in here.globals if name != self.cursor.word_text}
        for name in sorted(names - declared):
            own = OwnName(name, None, tuple(symbols.global_bindings(name)), 0)
            is_global = name in symbols.global_names and name != self.cursor.word_text
            rank = _EXPECTED if is_global else _OWN
            detail = self.facts.detail(own) if is_global else "not global yet"
            if name != self.cursor.word_text or is_global:
                yield Completion(name, ItemKind.VARIABLE, self.span, name, "", detail, rank + name)

    def _errors(self) -> Iterator[Completion]:
        for item in (*self._own_names(), *self._python_names()):
            is_error = item.kind is ItemKind.CLASS
            yield replace(item, sort=_EXPECTED + item.label) if is_error else item

    # ---------------------------------------------------------------- behind a dot

    def _members(self, receiver: str) -> Iterator[Completion]:
        kind = type_of_text(self.document, receiver, self.scope)
        if kind is None:
            if receiver not in AVAILABLE or self.scope.resolve(receiver) is not Resolution.BUILTIN:
                return
            if receiver not in PRELOADED:
                return
            kind = ModuleType(receiver)
        for name in attribute_names(kind):
            yield self._member(kind, name, is_called=self.is_called)

    def _member(self, kind: ValueType, name: str, *, is_called: bool) -> Completion:
        if isinstance(kind, OwnClass):
            method = method_of(self.document, kind, name)
            if method is None:
                return Completion(name, ItemKind.FIELD, self.span, name, "", f"of {kind.scope.name}", _OWN + name)
            snippet = "" if is_called else _function_snippet(method, skips_first=True)
            text = f"text:{fenced(function_signature(method))}\n\n{function_text(self.document, method)}".rstrip()
            detail = function_signature(method)
            return Completion(name, ItemKind.METHOD, self.span, name, snippet, detail, _OWN + name, source=text)
        found = attribute(kind, name)
        owner = kind.name if isinstance(kind, ModuleType) else f"builtins.{kind.__name__}"
        if not isinstance(kind, ModuleType) and kind.__module__ != "builtins":
            owner = f"{kind.__module__}.{kind.__qualname__}"
        is_function = callable(found) and not isinstance(found, type)
        item = ItemKind.METHOD if is_function else ItemKind.CLASS if isinstance(found, type) else ItemKind.FIELD
        snippet = f"{name}($0)" if is_function and not is_called else ""
        detail = python_signature(name, found)
        return Completion(name, item, self.span, name, snippet, detail, _PYTHON + name, source=f"python:{owner}.{name}")

    # ---------------------------------------------------------------- strings

    def _in_string(self) -> Iterator[Completion]:
        cursor = self.cursor
        field, string = cursor.field, cursor.string
        if field is not None:
            if re.fullmatch(rf"\s*(?:.*[^\w.\s{MARKS}])?\s*(?:{NAME})?", field):
                yield from self._own_names()
                yield from (item for item in self._commands() if not item.is_missing)
                yield from self._python_names()
            return
        call = cursor.call
        if string is None or call is None or call.path:
            return
        command = self.document.program.command(call.function, self.scope)
        param = None if command is None else parameter_at(command, call)
        before = self.cursor.masked[call.at.value : string.start].strip()
        if command is None or param is None or before:
            return
        span = cursor.span(string.body, string.end if string.is_closed else max(cursor.offset, cursor.word[1]))
        if not string.is_closed:
            span = cursor.span(string.body, cursor.offset)
        if span.line != span.end_line:
            return
        for index, value in enumerate(choices_of(param.quantity)):
            if isinstance(value, str):
                yield Completion(value, ItemKind.VALUE, span, value, "", param.text, f"{_VALUES}{index:02}")
        is_file = param.name == "file_name"
        for index, found in enumerate(names_for(self.document, param)):
            kind = ItemKind.FILE if is_file else ItemKind.NAME
            yield Completion(found.name, kind, span, found.name, "", found.text, f"{_EXPECTED}{index:03}")


# -------------------------------------------------------------------- what is inserted


def command_snippet(command: Command) -> str:
    """Return a call of a command with a placeholder for each required argument; one of few values is a choice."""
    required = [param for param in command.params if param.is_required]
    if not required:
        return f"{command.name}($0)" if command.params else f"{command.name}()"
    places = ", ".join(_placeholder(index, param) for index, param in enumerate(required, 1))
    return f"{command.name}({places})"


def _placeholder(index: int, param: Param) -> str:
    values = [value_source(value) for value in choices_of(param.quantity)]
    if values and not isinstance(_innermost(param.quantity), Boolean):
        return f"${{{index}|{','.join(values)}|}}"
    return f"${{{index}:{param.name}}}"


def _function_snippet(function: ast.FunctionDef, *, skips_first: bool = False) -> str:
    args = function.args
    listed = [argument.arg for argument in (*args.posonlyargs, *args.args)]
    required = listed[int(skips_first) : len(listed) - len(args.defaults)]
    required += [f"{a.arg}=" for a, default in zip(args.kwonlyargs, args.kw_defaults, strict=True) if default is None]
    if not required:
        has_more = len(listed) > int(skips_first) or args.vararg or args.kwarg or args.kwonlyargs
        return f"{function.name}($0)" if has_more else f"{function.name}()"
    places = []
    for index, name in enumerate(required, 1):
        keyword = name if name.endswith("=") else ""
        places.append(f"{keyword}${{{index}:{name.rstrip('=')}}}")
    return f"{function.name}({', '.join(places)})"


def plain_text(snippet: str) -> str:
    """Return what a snippet inserts if nothing is typed over: each placeholder with its default, `$0` with `pass`."""
    text = re.sub(r"\$\{\d+\|([^,|]*)[^}]*\|\}", r"\1", snippet)
    text = re.sub(r"\$\{\d+:?([^}]*)\}", r"\1", text)
    return re.sub(r"(?m)^(\s*)\$0$", r"\1pass", text).replace("$0", "")


def choices_of(quantity: Quantity) -> tuple[Any, ...]:
    """Return the values of a parameter that has few; none for others."""
    if isinstance(quantity, Either):
        return tuple(value for kind in quantity.kinds for value in choices_of(kind))
    inner = _innermost(quantity)
    if isinstance(inner, Boolean):
        return (True, False)
    return inner.choices if isinstance(inner, Choice) else ()


def _innermost(quantity: Quantity) -> Quantity:
    return quantity.inner if isinstance(quantity, Optionally) else quantity


def value_source(value: Any) -> str:
    """Return a value as source text, texts in double quotes."""
    return f'"{value}"' if isinstance(value, str) else repr(value)


def parameter_at(command: Command, call: CallAt) -> Param | None:
    """Return the parameter that gets the argument at the place; None if there is none for it."""
    params = command.params
    if call.at.keyword:
        index = command.details.indices.get(call.at.keyword)
        return None if index is None else params[index]
    if any(argument.is_spread for argument in call.arguments[: call.place + 1]):
        return None
    return params[call.position] if call.position < len(params) else None


_BLOCKS: Final = (
    ("if … end", "if ${1:True}:\n\t$0\nend", "a condition"),
    ("if … else … end", "if ${1:True}:\n\t${2:pass}\nelse:\n\t$0\nend", "two ways"),
    ("while … end", "while ${1:True}:\n\t${0:sync()}\nend", "a loop"),
    ("for … end", "for ${1:i} in range(${2:3}):\n\t$0\nend", "a counted loop"),
    ("def … end", "def ${1:name}(${2}):\n\t$0\nend", "a function"),
    ("try … end", "try:\n\t${1:pass}\nexcept ${2:Exception} as ${3:e}:\n\t${0:textmsg(e)}\nend", "what may fail"),
    ("with … end", "with ${1:lock}:\n\t$0\nend", "a lock or a file"),
    ("class … end", "class ${1:Name}:\n\tdef __init__(self):\n\t\t$0\n\tend\nend", "a class"),
    (
        "thread … start_thread",
        "def ${1:work}():\n\twhile True:\n\t\t${0:sync()}\n\tend\nend\n${2:handle} = start_thread(${1:work}, ())",
        "a thread",
    ),
    ("sec", "sec ${1:name}():\n\t${0:pass}\nend", "a secondary program"),
)
"""Label, snippet with a tab for each level, and what it is."""


def _of_this_function(blocks: tuple[Block, ...]) -> tuple[Block, ...]:
    inner = [index for index, block in enumerate(blocks) if block.word in ("def", "sec", "class", "thread")]
    return blocks[inner[-1] + 1 :] if inner else blocks


def _clauses(document: Document, cursor: Cursor, blocks: tuple[Block, ...]) -> Iterable[str]:
    """Return the words that may continue a statement whose body is around the place."""
    found: dict[str, None] = {}
    for block in blocks:
        found.update(dict.fromkeys(_CLAUSES.get(block.word, ())))
    return found


_CLAUSES: Final = {
    "if": ("elif", "else"),
    "for": ("else",),
    "while": ("else",),
    "try": ("except", "else", "finally"),
    "match": ("case",),
}

_BUILTINS: Final = tuple(
    sorted(
        name
        for name in KNOWN
        if name[0].isalpha()
        and name not in REFUSED_BUILTINS
        and name not in WITHHELD_ERRORS
        and name not in ("True", "False", "None", "copyright", "credits", "license", "input")
        and CATALOGUE.get(name) is None
    )
)
"""Names of Python that programs find."""

_PYTHON2: Final = frozenset(name for name in PRELOADED if name not in AVAILABLE and not hasattr(builtins, name))
"""Names that only Python 2 has; they still work here."""


# -------------------------------------------------------------------- texts


def _command_text(name: str) -> str:
    firmware, _, name = name.partition(":")
    command = CATALOGUE.get(name)
    return "" if command is None else command_markdown(command, PROFILES[firmware])


def _argument_text(name: str) -> str:
    command_name, _, name = name.partition(":")
    command = CATALOGUE.get(command_name)
    params = () if command is None else command.params
    return next((parameter_markdown(param) for param in params if param.name == name), "")


_TEXTS: Final[dict[str, Callable[[str], str]]] = {
    "text": str,
    "command": _command_text,
    "argument": _argument_text,
    "keyword": lambda word: KEYWORDS.get(word, ""),
    "module": lambda name: python_markdown(name),
    "python": lambda name: python_markdown(name),
}
"""What makes the documentation, by the first word of `Completion.source`."""
