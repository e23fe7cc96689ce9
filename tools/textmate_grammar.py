"""The TextMate grammar of the language, with the commands of the catalogue: editors/textmate."""

from __future__ import annotations

import json
import keyword
from pathlib import Path
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.paths import PROGRAM_SUFFIX

PATH: Final = Path(__file__).resolve().parent.parent / "editors" / "textmate" / "elitescript.tmLanguage.json"

_SCOPE: Final = "elitescript"
_CONSTANTS: Final = ("True", "False", "None", "Ellipsis", "NotImplemented", "__debug__")
_OPERATOR_WORDS: Final = ("and", "in", "is", "not", "or")
_MODIFIERS: Final = ("global", "nonlocal")
_STORAGE: Final = ("async", "class", "def", "lambda", "sec")
_IMPORTS: Final = ("as", "from", "import")
_BUILTINS: Final = (
    "abs all any ascii bin bool bytearray bytes callable chr classmethod complex delattr dict dir divmod enumerate eval"
    " exec filter float format frozenset getattr hasattr hash hex id int isinstance issubclass iter len list map max"
    " min next object oct open ord pow print property range repr reversed round set setattr slice sorted staticmethod"
    " str sum super tuple type zip"
)
_NAME: Final = r"[^\W\d]\w*"
_FREE: Final = r"(?<![.\w])"
"""Before a name that is no attribute."""


def grammar_text() -> str:
    """Return the grammar as the text of its file."""
    return json.dumps(_grammar(), indent=2, ensure_ascii=False) + "\n"


def _grammar() -> dict[str, Any]:
    return {
        "comment": "Written by `python tools/write_reference.py`; do not edit.",
        "name": "EliteScript",
        "scopeName": f"source.{_SCOPE}",
        "fileTypes": [PROGRAM_SUFFIX.lstrip(".")],
        "patterns": [{"include": "#statement"}, {"include": "#expression"}],
        "repository": {
            "statement": {"patterns": [_include(name) for name in ("mark", "definition", "class", "end", "decorator")]},
            "expression": {
                "patterns": [
                    _include(name)
                    for name in (
                        "comment",
                        "string",
                        "number",
                        "keyword",
                        "attribute",
                        "command",
                        "builtin",
                        "call",
                        "brackets",
                        "operator",
                        "punctuation",
                    )
                ]
            },
            "comment": {
                "match": r"(#).*$",
                "name": _scope("comment.line.number-sign"),
                "captures": {"1": {"name": _scope("punctuation.definition.comment")}},
            },
            "mark": {
                "begin": r"^\s*(\$\s*LINE)\s*(:)",
                "beginCaptures": _captures("keyword.control.directive.line-mark", "punctuation.separator.colon"),
                "end": r"$",
                "name": _scope("meta.line-mark"),
                "patterns": [_include("expression")],
            },
            "end": {"match": r"^\s*(end)(?=\s*;?\s*(?:#|$))", "captures": _captures("keyword.control.end")},
            "decorator": {
                "match": rf"^\s*(@)\s*({_NAME}(?:\.{_NAME})*)",
                "captures": _captures("punctuation.definition.decorator", "entity.name.function.decorator"),
            },
            "definition": {
                "begin": rf"^\s*(?:(async)\s+)?(def|sec)\s+({_NAME})\s*(?=\()",
                "beginCaptures": _captures("storage.modifier.async", "storage.type.function", "entity.name.function"),
                "end": r"(:)|$",
                "endCaptures": _captures("punctuation.section.function.begin"),
                "name": _scope("meta.function"),
                "patterns": [
                    {
                        "begin": r"\(",
                        "beginCaptures": {"0": {"name": _scope("punctuation.definition.parameters.begin")}},
                        "end": r"\)",
                        "endCaptures": {"0": {"name": _scope("punctuation.definition.parameters.end")}},
                        "name": _scope("meta.function.parameters"),
                        "patterns": [
                            {
                                "match": rf"(?:(?<=[(,*])|^)\s*({_NAME})\s*(?=[,=:)\n]|$)",
                                "captures": _captures("variable.parameter.function"),
                            },
                            _include("expression"),
                        ],
                    },
                    {"match": r"->", "name": _scope("keyword.operator.annotation.result")},
                    _include("expression"),
                ],
            },
            "class": {
                "match": rf"^\s*(class)\s+({_NAME})",
                "captures": _captures("storage.type.class", "entity.name.type.class"),
            },
            "string": {
                "patterns": [
                    _string(prefix, quote, name, body)
                    for quote in ('"""', "'''", '"', "'")
                    for prefix, name, body in (
                        (r"[rR][bB]|[bB][rR]|[rR]", "string.quoted.raw", ()),
                        (r"[fF][rR]?|[rR][fF]", "string.interpolated", ("escape", "field")),
                        (r"[bBuU]?", "string.quoted", ("escape", "placeholder")),
                    )
                ]
            },
            "escape": {
                "match": r"\\(?:[\\'\"abfnrtv\n]|[0-7]{1,3}|x[\da-fA-F]{2}|u[\da-fA-F]{4}|U[\da-fA-F]{8}|N\{[^}]+\}|$)",
                "name": _scope("constant.character.escape"),
            },
            "placeholder": {
                "match": r"%(?:\(\w+\))?[-#0 +]*(?:\d+|\*)?(?:\.(?:\d+|\*))?[diouxXeEfFgGcrsa%]"
                r"|\{\w*(?:![rsa])?(?::[^{}'\"\n]*)?\}",
                "name": _scope("constant.other.placeholder"),
            },
            "field": {
                "patterns": [
                    {"match": r"\{\{|\}\}", "name": _scope("constant.character.escape")},
                    {
                        "begin": r"\{",
                        "beginCaptures": {"0": {"name": _scope("punctuation.section.embedded.begin")}},
                        "end": r"(?:(![rsa])?(:[^{}'\"\n]*)?)(\})|$",
                        "endCaptures": _captures(
                            "storage.type.format",
                            "constant.other.format-specification",
                            "punctuation.section.embedded.end",
                        ),
                        "name": _scope("meta.embedded"),
                        "patterns": [_include("expression")],
                    },
                ]
            },
            "number": {
                "patterns": [
                    {"match": r"\b0[xX][\da-fA-F_]+\b", "name": _scope("constant.numeric.hex")},
                    {"match": r"\b0[bB][01_]+\b", "name": _scope("constant.numeric.binary")},
                    {"match": r"\b0[oO][0-7_]+\b", "name": _scope("constant.numeric.octal")},
                    {
                        "match": r"(?<![\w.])(?:\d[\d_]*\.[\d_]*|\.\d[\d_]*|\d[\d_]*(?=[eE][+-]?\d))"
                        r"(?:[eE][+-]?\d[\d_]*)?[jJ]?",
                        "name": _scope("constant.numeric.float"),
                    },
                    {"match": r"(?<![\w.])\d[\d_]*[jJ]?\b", "name": _scope("constant.numeric.integer")},
                ]
            },
            "keyword": {
                "patterns": [
                    _words(_CONSTANTS, "constant.language"),
                    _words(_OPERATOR_WORDS, "keyword.operator.logical"),
                    _words(_MODIFIERS, "storage.modifier.scope"),
                    _words(("lambda",), "storage.type.function.lambda"),
                    _words(("async",), "storage.modifier.async"),
                    _words(("class",), "storage.type.class"),
                    _words(("def",), "storage.type.function"),
                    _words(_IMPORTS, "keyword.control.import"),
                    _words(_control_words(), "keyword.control.flow"),
                    {
                        "match": r"^\s*(match|case)(?=\s[^=].*:\s*(?:#|$))",
                        "captures": _captures("keyword.control.flow"),
                    },
                ]
            },
            "attribute": {
                "match": rf"(\.)\s*(?:({_NAME})(?=\s*\()|({_NAME}))",
                "captures": _captures("punctuation.accessor", "entity.name.function.member", "variable.other.property"),
            },
            "command": _words(CATALOGUE.names(), "support.function.command"),
            "builtin": {
                "patterns": [
                    {
                        "match": rf"{_FREE}[A-Z]\w*(?:Error|Exception|Warning|Exit|Iteration)\b",
                        "name": _scope("support.type.exception"),
                    },
                    _words(
                        tuple(name for name in _BUILTINS.split() if CATALOGUE.get(name) is None),
                        "support.function.builtin",
                    ),
                ]
            },
            "call": {"match": rf"{_FREE}({_NAME})(?=\s*\()", "captures": _captures("entity.name.function.call")},
            "brackets": {
                "patterns": [
                    {
                        "begin": r"\(",
                        "beginCaptures": {"0": {"name": _scope("punctuation.parenthesis.begin")}},
                        "end": r"\)",
                        "endCaptures": {"0": {"name": _scope("punctuation.parenthesis.end")}},
                        "patterns": [
                            {
                                "match": rf"(?:(?<=[(,])|^)\s*({_NAME})\s*(=)(?!=)",
                                "captures": _captures(
                                    "variable.parameter.function-call", "keyword.operator.assignment"
                                ),
                            },
                            _include("expression"),
                        ],
                    },
                    {"match": r"[\[\]]", "name": _scope("punctuation.definition.list")},
                    {"match": r"[{}]", "name": _scope("punctuation.definition.dict")},
                ]
            },
            "operator": {
                "patterns": [
                    {"match": r"==|!=|<=|>=|<(?!<)|(?<!>)>(?!>)", "name": _scope("keyword.operator.comparison")},
                    {
                        "match": r":=|(?:\*\*|//|>>|<<|[-+*/%@&|^])?=",
                        "name": _scope("keyword.operator.assignment"),
                    },
                    {"match": r"\*\*|//|[-+*/%@]", "name": _scope("keyword.operator.arithmetic")},
                    {"match": r"<<|>>|[&|^~]", "name": _scope("keyword.operator.bitwise")},
                ]
            },
            "punctuation": {
                "patterns": [
                    {"match": r",", "name": _scope("punctuation.separator.comma")},
                    {"match": r":", "name": _scope("punctuation.separator.colon")},
                    {"match": r";", "name": _scope("punctuation.terminator.statement")},
                ]
            },
        },
    }


def _control_words() -> tuple[str, ...]:
    others = {*_CONSTANTS, *_OPERATOR_WORDS, *_MODIFIERS, *_STORAGE, *_IMPORTS}
    return tuple(word for word in keyword.kwlist if word not in others)


def _scope(name: str) -> str:
    return f"{name}.{_SCOPE}"


def _include(name: str) -> dict[str, str]:
    return {"include": f"#{name}"}


def _captures(*names: str) -> dict[str, dict[str, str]]:
    return {str(number): {"name": _scope(name)} for number, name in enumerate(names, 1)}


def _words(names: tuple[str, ...] | list[str], scope: str) -> dict[str, str]:
    return {"match": rf"{_FREE}(?:{'|'.join(sorted(names))})\b", "name": _scope(scope)}


def _string(prefix: str, quote: str, name: str, body: tuple[str, ...]) -> dict[str, Any]:
    kind = {'"""': "triple", "'''": "triple", '"': "double", "'": "single"}[quote]
    inside: list[dict[str, str]] = [_include(part) for part in body]
    if not body:
        # A backslash keeps the quote behind it inside the string.
        inside = [{"match": r"\\."}]
    return {
        "begin": rf"(?<!\w)({prefix})({quote})",
        "beginCaptures": _captures("storage.type.string", "punctuation.definition.string.begin"),
        # A string of one line ends with it, closed or not.
        "end": f"({quote})" if kind == "triple" else rf"({quote})|(?<!\\)$",
        "endCaptures": _captures("punctuation.definition.string.end"),
        "name": _scope(f"{name}.{kind}"),
        "patterns": inside,
    }
