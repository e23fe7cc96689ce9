"""Detects remains of Python 2.

Older manuals were written from a Python 2 text. What they teach is accepted with a warning and
rewritten; the rest is named and gets a repair.
"""

from __future__ import annotations

from collections.abc import Callable

from elitescript.language.diagnostics import Fix
from elitescript.language.text.lexer import NAME, LogicalLine, StringToken
from elitescript.language.text.masked import OPERATOR_WORDS, compiled, top_level
from elitescript.language.text.rewriting import Draft
from elitescript.said import said

_KNOWN_ESCAPES = frozenset("\n\\'\"abfnrtvx01234567")
_KNOWN_IN_TEXT = _KNOWN_ESCAPES | frozenset("NuU")


def read_escapes(draft: Draft) -> None:
    """Report escapes in strings that Python does not have, and rewrite those of Python 2."""
    for string in draft.lexed.strings:
        _escapes(draft, string)


# Statements


def _print(draft: Draft, line: LogicalLine, start: int, end: int) -> None:
    code = draft.lexed.masked[start:end]
    rest = code[5:].lstrip()
    gap = len(code) - 5 - len(rest)
    if not _is_print_statement(rest, gap):
        return
    comma = rest.endswith(",")
    closing = ' end=" ")' if comma else ")"
    opening = draft.edit(start + 5, start + 5 + gap, "(")
    text = "this is the print statement of Python 2; a Python 3 controller refuses it"
    fix = Fix("write print(...)", (opening, draft.edit(end, end, closing)), safe=True)
    draft.report("E106", start, start + 5, text, "write print(...)", fix, draft.tolerated())
    draft.replace(start + 5, start + 5 + min(gap, 1), "(")
    draft.replace(end, end, closing)


def _is_print_statement(rest: str, gap: int) -> bool:
    if not rest:
        return True
    first = rest[0]
    if first in '"`{~':
        return True
    if not gap:
        return False
    word = compiled(NAME).match(rest)
    if word:
        if word.group() == "not":
            return not compiled(r"not\s+in\b").match(rest)
        return word.group() not in OPERATOR_WORDS
    if first.isdigit() or (first == "." and rest[1:2].isdigit()):
        return True
    if first == "[":
        return not any(top_level(rest, "="))
    # `print -x` has a blank before the sign and none behind it; `print - x` is a difference.
    return first in "+-" and rest[1:2] not in ("", " ", "\t", "=", first)


def _raise(draft: Draft, line: LogicalLine, start: int, end: int) -> None:
    code = draft.lexed.masked[start:end]
    commas = list(top_level(code, ","))
    if not commas:
        return
    fix = None
    if len(commas) == 1:
        at = start + commas[0]
        value = at + 1 + len(code[commas[0] + 1 :]) - len(code[commas[0] + 1 :].lstrip())
        fix = Fix("call the class", (draft.edit(at, value, "("), draft.edit(end, end, ")")), safe=True)
    hint = "write raise ValueError(text), without a comma"
    draft.report("E112", start, end, "this form of `raise` is Python 2", hint, fix)
    draft.hide(line, start + commas[0], end)


def _except(draft: Draft, line: LogicalLine, start: int, end: int) -> None:
    code = draft.lexed.masked[start:end]
    commas = list(top_level(code, ","))
    if not commas:
        return
    at = commas[0]
    name = code[at + 1 :]
    fix = None
    if len(commas) == 1 and compiled(rf"[ \t]*{NAME}[ \t]*").fullmatch(name):
        blank_before = len(code[:at]) - len(code[:at].rstrip())
        edit = draft.edit(start + at - blank_before, start + at + 1, " as" if name[:1] in " \t" else " as ")
        fix = Fix("write `as`", (edit,), safe=True)
    hint = "write `except ValueError as e:`; several classes go into brackets: `except (A, B) as e:`"
    draft.report("E112", start, end, "this form of `except` is Python 2", hint, fix)
    draft.hide(line, start + at, end)


def _exec(draft: Draft, line: LogicalLine, start: int, end: int) -> None:
    code = draft.lexed.masked[start:end]
    found = compiled(rf'exec(?:[ \t]+(?P<word>{NAME})|[ \t]*")').match(code)
    if not found or found["word"] in OPERATOR_WORDS:
        return
    hint = "it is a function: write exec(text), with brackets"
    draft.report("E112", start, end, "`exec` as a statement is Python 2", hint)
    draft.broken.add(line)


STATEMENT_RULES: dict[str, Callable[[Draft, LogicalLine, int, int], None]] = {
    "print": _print,
    "raise": _raise,
    "except": _except,
    "exec": _exec,
}
"""The reader of a statement, by its first word."""


# Operators


def _diamond(draft: Draft) -> None:
    for _, found in draft.find("<>"):
        start, end = found.span()
        fix = Fix("write !=", (draft.edit(start, end, "!="),), safe=True)
        draft.report("E111", start, end, "`<>` is Python 2", "write != for 'is not equal'", fix)
        draft.replace(start, end, "!=")


def _backquotes(draft: Draft) -> None:
    opened: tuple[LogicalLine, int] | None = None
    for line, found in draft.find("`"):
        at = found.start()
        if opened is None or opened[0] is not line:
            if opened is not None:
                _lone_backquote(draft, *opened)
            opened = (line, at)
            continue
        begin = opened[1]
        opened = None
        edits = (draft.edit(begin, begin + 1, "repr("), draft.edit(at, at + 1, ")"))
        fix = Fix("write repr(...)", edits, safe=True)
        draft.report("E111", begin, at + 1, "backquotes are Python 2", "write repr(x), or to_str(x)", fix)
        draft.replace(begin, begin + 1, "(")
        draft.replace(at, at + 1, ")")
    if opened is not None:
        _lone_backquote(draft, *opened)


def _lone_backquote(draft: Draft, line: LogicalLine, at: int) -> None:
    draft.report("E111", at, at + 1, "a backquote has no meaning in a program", "strings take ' or \"")
    draft.broken.add(line)


def read_numbers(draft: Draft) -> None:
    # Patterns that begin with a character that they look for are searched much faster than those that look back first.
    for _, found in draft.find(r"0(?<![\w.]0)(?<![0-9.][eE][+-]0)[0-9_]*[1-9][0-9_]*[lL]?(?![\w.])"):
        start, end = found.span()
        digits = found.group().rstrip("lL").lstrip("0_")
        fix = None
        hint = "leave the zeros in front out"
        if set(digits) <= set("01234567_"):
            new = f"0o{digits}"
            hint = said("an octal number is written {new}; for the decimal number leave the zeros out", new=new)
            fix = Fix(said("write {new}", new=new), (draft.edit(start, end, new),), safe=True)
        draft.report("E001", start, end, "a number cannot begin with 0", hint, fix)
        draft.replace(start, end, "0" * (end - start))
    if compiled(r"[lL](?<=[0-9a-fA-F_][lL])(?!\w)").search(draft.lexed.masked) is None:
        return
    pattern = r"(?<![\w.])(?:0[xX][0-9a-fA-F_]+|0[oO][0-7_]+|0[bB][01_]+|[1-9][0-9_]*|0+)[lL](?!\w)"
    for _, found in draft.find(pattern):
        start, end = found.span()
        blank = " " if draft.lexed.masked[end : end + 1] == "." else ""
        text = "the suffix L is Python 2; a Python 3 controller refuses it"
        fix = Fix("leave the L out", (draft.edit(end - 1, end, blank),), safe=True)
        draft.report("E110", start, end, text, "leave it out: integers have no limit", fix, draft.tolerated())
        draft.blank(end - 1, end)


# Strings


def _escapes(draft: Draft, string: StringToken) -> None:
    text = draft.lexed.text
    is_bytes = "b" in text[string.start : string.body].lower()
    known = _KNOWN_ESCAPES if is_bytes else _KNOWN_IN_TEXT
    for found in compiled(r"(?s)\\(.)").finditer(text, string.body, string.end):
        letter = found[1]
        if letter in known:
            continue
        start, end = found.span()
        if letter == "e":
            new, meaning = "\\x1b", "the escape character (27)"
        elif letter == "o" and text[end : end + 1] in tuple("01234567"):
            while text[end : end + 1] in tuple("01234567") and end - start < 4:
                end += 1
            new, meaning = "\\0" + text[start + 2 : end], "an octal number"
        else:
            problem = said("Python has no escape \\{letter}: the backslash stays in the string", letter=letter)
            fix = Fix("double the backslash", (draft.edit(start, start, "\\"),), safe=True)
            draft.report("W210", start, end, problem, "write \\\\ for a backslash", fix)
            continue
        problem = said(
            "{text} is read as {meaning}; a Python 3 controller keeps the backslash",
            text=text[start:end],
            meaning=meaning,
        )
        fix = Fix(said("write {new}", new=new), (draft.edit(start, end, new),), safe=True)
        draft.report("W210", start, end, problem, said("write {new}", new=new), fix, draft.tolerated())
        draft.replace(start, end, new)


MARK_RULES: tuple[tuple[tuple[str, ...], Callable[[Draft], None]], ...] = (
    (("<>",), _diamond),
    (("`",), _backquotes),
)
"""The readers of a text that contains one of the marks."""
