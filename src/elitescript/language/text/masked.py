"""Masks and searches code: in masked code strings and comments cannot match."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from keyword import iskeyword

from elitescript.language.text.lexer import Lexed, TextScanner, is_in_word, name_pattern

OPERATOR_WORDS = frozenset(("and", "as", "else", "for", "from", "if", "import", "in", "is", "not", "or"))
"""Keywords that may follow a value."""


def lex(text: str) -> Lexed:
    """Scan a text with LF line ends. Never fails: flaws are part of the result."""
    if not text.isascii():
        from elitescript.language.text.wide_signs import has_wide_signs

        if has_wide_signs(text):
            from elitescript.language.text.wide_lexer import WideScanner

            return WideScanner(text).scan()
    return TextScanner(text).scan()


@cache
def compiled(pattern: str) -> re.Pattern[str]:
    """Return a pattern, compiled when it is needed for the first time."""
    return re.compile(pattern)


def top_level(code: str, mark: str, begin: int = 0) -> Iterator[int]:
    """Yield indices of `mark` outside brackets in masked code."""
    if mark not in code[begin:]:
        return
    depth = 0
    for index in range(begin, len(code)):
        character = code[index]
        if character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
        elif character == mark and depth == 0:
            yield index


def header_colon(code: str) -> int:
    """Return the index of the colon that ends the header in the masked code of a compound statement; -1 if none."""
    if code.endswith(":") and (code.count(":") == 1 or "?" in code):
        return len(code) - 1
    depth = lambdas = 0
    for found in compiled(r"[()\[\]{}]|:=?|\blambda\b").finditer(code):
        mark = found.group()
        if mark in "([{":
            depth += 1
        elif mark in ")]}":
            depth -= 1
        elif depth == 0:
            if mark == "lambda":
                lambdas += 1
            elif mark == ":":
                if not lambdas:
                    return found.start()
                lambdas -= 1
    return -1


def operand_before(code: str) -> bool:
    """Return whether masked code ends with a value: a name, a number, a string, a closing bracket."""
    code = code.rstrip()
    if not code or not (is_in_word(code[-1]) or code[-1] in ')]}"'):
        return False
    word = compiled(rf"{name_pattern(code)}\Z").search(code)
    return word is None or not iskeyword(word.group()) or word.group() in ("True", "False", "None")
