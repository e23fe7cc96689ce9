"""Detects C, URScript and syntax of newer Pythons.

Python's own message for most of them is "invalid syntax"; here each is named and, where the
meaning is clear, gets a repair.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from elitescript.language.advice import python2
from elitescript.language.diagnostics import Fix
from elitescript.language.text.lexer import NAME, LogicalLine
from elitescript.language.text.masked import OPERATOR_WORDS, compiled, operand_before
from elitescript.language.text.rewriting import Draft
from elitescript.said import said


def read_foreign(draft: Draft) -> None:
    """Report and replace what is not Python. Needs `draft.headers`."""
    masked = draft.lexed.masked
    for line in draft.lexed.lines:
        if line.word in _STATEMENT_RULES or line in draft.headers or ";" in masked[line.start : line.end]:
            for start, end, word in draft.statements(line):
                rule = _STATEMENT_RULES.get(word)
                if rule:
                    rule(draft, line, start, end)
    for marks, mark_rule in _MARK_RULES:
        if any(mark in masked for mark in marks):
            mark_rule(draft)
    python2.read_numbers(draft)


def _global(draft: Draft, line: LogicalLine, start: int, end: int) -> None:
    code = draft.lexed.masked[start:end]
    found = compiled(rf"global[ \t]+(?P<names>{NAME}(?:[ \t]*,[ \t]*{NAME})*)(?P<gap>[ \t]*)=(?!=)").match(code)
    if not found:
        return
    names = found["names"]
    alone = start == line.start and end == line.end and line not in draft.headers
    row, column = draft.lexed.place(start)
    begin = draft.lexed.starts[row - 1]
    indentation = draft.lexed.text[begin : begin + column - 1]
    separator = f"\n{indentation}" if alone else "; "
    at = start + found.start("gap")
    edit = draft.edit(at, start + found.end() - 1, f"{separator}{names} ")
    text = "`global` cannot assign: it only says that the name is shared"
    fix = Fix("assign in a statement of its own", (edit,), safe="," not in names)
    draft.report("E108", start, end, text, said("write `global {names}` and below it the assignment", names=names), fix)
    draft.hide(line, at, end)


def _logic(draft: Draft) -> None:
    for _, found in draft.find(r"&&|\|\|"):
        start, end = found.span()
        word = "and" if found.group() == "&&" else "or"
        text = draft.lexed.text
        padded = ("" if text[start - 1].isspace() else " ") + word + ("" if text[end : end + 1].isspace() else " ")
        fix = Fix(said("write `{word}`", word=word), (draft.edit(start, end, padded),), safe=True)
        draft.report(
            "E113",
            start,
            end,
            said("`{sign}` is an operator of C", sign=found.group()),
            said("write `{word}`", word=word),
            fix,
        )
        draft.replace(start, end, "+ ")


def _exclamation(draft: Draft) -> None:
    for _, found in draft.find(r"!(?!=)[ \t]*"):
        start, end = found.span()
        fix = Fix("write `not`", (draft.edit(start, end, "not "),), safe=True)
        draft.report("E113", start, start + 1, "`!` is an operator of C", "write `not`", fix)
        draft.replace(start, start + 1, "~")


def _steps(draft: Draft) -> None:
    masked = draft.lexed.masked
    for line, found in draft.find(r"(?<![+-])(?:\+\+|--)(?![+-])"):
        start, end = found.span()
        rest = masked[end : line.end].lstrip()
        if (rest and rest[0] not in ")]},;:") or not operand_before(masked[line.start : start]):
            continue
        sign = found.group()[0]
        target = masked[line.start : start].rstrip()
        fix = None
        if (not rest or rest[0] == ";") and compiled(r"[\w.]+").fullmatch(target):
            begin = line.start + len(target)
            fix = Fix(said("write {sign}= 1", sign=sign), (draft.edit(begin, end, f" {sign}= 1"),), safe=True)
        text = said("`{sign}` is an operator of C", sign=found.group())
        draft.report("E113", start, end, text, said("write `x {sign}= 1` as a statement", sign=sign), fix)
        draft.blank(start, end)


def _question(draft: Draft) -> None:
    masked = draft.lexed.masked
    for line, found in draft.find(r"\?"):
        at = found.start()
        begin, colon, end = _conditional_parts(masked, line, at)
        fix = None
        if colon and line not in draft.headers:
            condition = masked[begin:at].strip()
            start = begin + len(masked[begin:at]) - len(masked[begin:at].lstrip())
            text = draft.lexed.text
            then, other = text[at + 1 : colon].strip(), text[colon + 1 : end].strip()
            if condition and then and other and "?" not in masked[at + 1 : end]:
                source = text[start : start + len(condition)]
                stop = colon + 1 + len(text[colon + 1 : end].rstrip())
                edit = draft.edit(start, stop, f"{then} if {source} else {other}")
                fix = Fix("write `a if condition else b`", (edit,), safe=False)
            draft.replace(at, at + 1, "+")
            draft.replace(colon, colon + 1, "+")
        else:
            draft.broken.add(line)
        draft.report("E113", at, at + 1, "`? :` is an operator of C", "write `a if condition else b`", fix)


def _conditional_parts(masked: str, line: LogicalLine, at: int) -> tuple[int, int, int]:
    """Return start of the condition, offset of the colon (0 if there is none), end of the whole."""
    depth = 0
    begin = line.start
    for index in range(at - 1, line.start - 1, -1):
        character = masked[index]
        if character in ")]}":
            depth += 1
        elif character in "([{":
            depth -= 1
            if depth < 0:
                begin = index + 1
                break
        elif depth == 0 and (
            character in ",;" or (character == "=" and masked[index - 1] not in "=!<>" and masked[index + 1] != "=")
        ):
            begin = index + 1
            break
    keyword = compiled(r"\s*(?:return|if|elif|while|print|not)\b").match(masked, begin, at)
    if keyword:
        begin = keyword.end()
    depth = colon = 0
    nested = 0
    for index in range(at + 1, line.end):
        character = masked[index]
        if character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
            if depth < 0:
                return begin, colon, index
        elif depth == 0 and character == "?":
            nested += 1
        elif depth == 0 and character == ":" and nested:
            nested -= 1
        elif depth == 0 and character == ":" and not colon:
            colon = index
        elif depth == 0 and (character in ",;" or (character == ":" and colon)):
            return begin, colon, index
    return begin, colon, line.end


def _dollar(draft: Draft) -> None:
    for line, found in draft.find(r"\$"):
        start = found.start()
        if draft.place(start) in draft.marks:
            continue
        draft.report("E001", start, start + 1, "`$` only begins a line mark", 'the form is: $ LINE: (12, "label")')
        draft.broken.add(line)


# URScript


def _adjacent_words(draft: Draft) -> None:
    operators = "|".join(sorted(OPERATOR_WORDS))
    pattern = rf"\b(?P<word>thread|run|kill|join|local)[ \t]+(?!(?:{operators})\b)(?P<name>{NAME})"
    for line, found in draft.find(pattern):
        if found.start() and draft.lexed.masked[found.start() - 1] == ".":
            continue
        word, name = found["word"], found["name"]
        start = found.start()
        advice, fix = _instead(draft, line, found)
        draft.report("E114", start, found.end(), said("`{word} {name}` is URScript", word=word, name=name), advice, fix)
        if word == "thread" and line in draft.headers:
            draft.replace(start, start + 6, "def   ")
        else:
            draft.broken.add(line)


def _instead(draft: Draft, line: LogicalLine, found: re.Match[str]) -> tuple[str, Fix | None]:
    word, name, start, end = found["word"], found["name"], found.start(), found.end()
    if word == "thread":
        fix = Fix("write `def`", (draft.edit(start, start + 6, "def"),), safe=False)
        return said("write `def {name}():` and start it with start_thread({name}, ())", name=name), fix
    if word == "run":
        call = compiled(r"[ \t]*\((?P<args>[^()]*)\)").match(draft.lexed.masked, end, line.end)
        if not call:
            return said("start a function in a thread of its own with start_thread({name}, ())", name=name), None
        inside = draft.lexed.text[call.start("args") : call.end("args")].strip()
        arguments = f"({inside},)" if inside else "()"
        new = f"start_thread({name}, {arguments})"
        return said("write {new}", new=new), Fix("write start_thread", (draft.edit(start, call.end(), new),), safe=True)
    if word == "local":
        fix = Fix("remove `local`", (draft.edit(start, found.start("name"), ""),), safe=True)
        return "leave `local` out: a name is local unless `global` declares it", fix
    new = f"{'stop' if word == 'kill' else 'join'}_thread({name})"
    return said("write {new}", new=new), Fix(said("write {new}", new=new), (draft.edit(start, end, new),), safe=True)


def _xor(draft: Draft) -> None:
    masked = draft.lexed.masked
    for line, found in draft.find(r'\bxor\b(?=[ \t]*[\w("\[{~+-])'):
        start, end = found.span()
        if masked[start - 1 : start] == "." or not operand_before(masked[line.start : start]):
            continue
        fix = Fix("write !=", (draft.edit(start, end, "!="),), safe=False)
        hint = "write != between truth values, ^ between bit patterns"
        draft.report("E114", start, end, "`xor` is URScript", hint, fix)
        draft.replace(start, end, " ^ ")


# Newer Pythons


def _type_parameters(draft: Draft, line: LogicalLine, start: int, end: int) -> None:
    code = draft.lexed.masked[start:end]
    found = compiled(rf"\w+[ \t]+{NAME}[ \t]*\[").match(code)
    if not found:
        return
    depth, at = 1, found.end()
    while depth and at < len(code):
        depth += (code[at] in "([{") - (code[at] in ")]}")
        at += 1
    start, end = start + found.end() - 1, start + at
    _too_new(draft, start, end, "type parameters are", "leave the brackets behind the name out")
    draft.hide(line, start, end)


def _type_statement(draft: Draft, line: LogicalLine, start: int, end: int) -> None:
    code = draft.lexed.masked[start:end]
    if compiled(rf"(?s)type[ \t]+{NAME}[ \t]*(?:\[.*\][ \t]*)?=(?!=)").match(code):
        hint = "a type gets a name like any value: X = int"
        _too_new(draft, start, start + len("type"), "the `type` statement is", hint)
        draft.broken.add(line)


def _too_new(draft: Draft, start: int, end: int, what: str, hint: str) -> None:
    # Python 3.11 refuses this and newer ones accept it; reported here, the result is the same.
    draft.report(
        "E001", start, end, said("{what} syntax of Python 3.12, which the robot does not have", what=what), hint
    )


_STATEMENT_RULES: dict[str, Callable[[Draft, LogicalLine, int, int], None]] = {
    **python2.STATEMENT_RULES,
    "global": _global,
    **dict.fromkeys(("def", "sec", "class"), _type_parameters),
    "type": _type_statement,
}
_MARK_RULES: tuple[tuple[tuple[str, ...], Callable[[Draft], None]], ...] = (
    (("$",), _dollar),
    *python2.MARK_RULES,
    (("&&", "||"), _logic),
    (("!",), _exclamation),
    (("++", "--"), _steps),
    (("?",), _question),
    (("xor",), _xor),
    (("thread ", "run ", "kill ", "join ", "local "), _adjacent_words),
)
