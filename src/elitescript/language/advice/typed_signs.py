"""Reports signs of code that an input method or a word processor has typed, and mends them.

One finding for each line, at its first sign, mends all signs of the line; one finding mends the indentation of all
lines. What is in strings and comments stays as it is.
"""

from __future__ import annotations

from typing import Final

from elitescript.language.diagnostics import Fix
from elitescript.language.text.lexer import WideSign
from elitescript.language.text.rewriting import Draft
from elitescript.language.text.wide_signs import CORNERS, DASHES, LONG_VOWEL, WIDE_BLANK
from elitescript.said import Said, said

_TITLE: Final = "write plain signs"
_HINT: Final = "switch the input method to English for code; the repair changes no string and no comment"
_MOST_LINES: Final = 50
"""Lines with a finding of their own; the last one mends the rest of the text as well."""


def read_wide_signs(draft: Draft) -> None:
    """Report the wide signs of `draft.lexed`, and give Python the plain ones."""
    lexed = draft.lexed
    lines: dict[int, list[WideSign]] = {}
    indentation = []
    for sign in lexed.wide_signs:
        row, column = lexed.place(sign.start)
        if column == 1 and not lexed.text[sign.start : sign.end].strip():
            indentation.append(sign)
        elif len(lines) < _MOST_LINES or row in lines:
            lines.setdefault(row, []).append(sign)
        else:
            lines[next(reversed(lines))].append(sign)
        if sign.plain and (len(sign.plain) != sign.end - sign.start or sign.plain != lexed.text[sign.start : sign.end]):
            draft.replace(sign.start, sign.end, sign.plain)
    if indentation:
        _report_indentation(draft, indentation)
    for signs in lines.values():
        _report(draft, signs)


def _fix(draft: Draft, signs: list[WideSign]) -> Fix | None:
    edits = tuple(draft.edit(sign.start, sign.end, sign.plain) for sign in signs if sign.plain)
    return Fix(_TITLE, edits, safe=True) if edits else None


def _report_indentation(draft: Draft, signs: list[WideSign]) -> None:
    first = signs[0]
    row, _ = draft.place(first.start)
    blank = next(sign for sign in draft.source.line(row) if not sign.isascii())
    name = "full-width blanks" if blank == WIDE_BLANK else "blanks"
    lines = Said("this line is") if len(signs) == 1 else said("{count} lines are", count=len(signs))
    text = said(
        "{lines} indented with {name} (U+{code:04X}), which are not blanks of code",
        lines=lines,
        name=Said(name),
        code=ord(blank),
    )
    width = "; each is as wide as two plain blanks" if blank == WIDE_BLANK else ""
    draft.report(
        "E001", first.start, first.end, text, said("type plain blanks{width}", width=Said(width)), _fix(draft, signs)
    )


def _report(draft: Draft, signs: list[WideSign]) -> None:
    first = signs[0]
    row, column = draft.place(first.start)
    written = draft.source.line(row)[column - 1 : column - 1 + first.end - first.start]
    code = next((ord(sign) for sign in written if not sign.isascii()), 0)
    shown = "a blank" if written.isspace() else f"`{written}`"
    kind = "a full-width sign of an input method" if code >= 0x3000 else "a sign of an input method or word processor"
    if written[:1].isalnum() and written != LONG_VOWEL:
        kind = "in full-width characters of an input method"
    text = said("{shown} (U+{code:04X}) is {kind}", shown=Said(shown), code=code, kind=Said(kind))
    if first.plain == " ":
        text = said("{text}, not a plain blank", text=text)
    elif first.plain:
        text = said("{text}, not `{plain}`", text=text, plain=first.plain)
    else:
        text = said("{text}, and {reason}", text=text, reason=Said(_unclear(written)))
    draft.report("E001", first.start, first.end, text, _HINT, _fix(draft, signs))


def _unclear(written: str) -> str:
    """Return why it is not certain what a sign stands for."""
    if written == DASHES:
        return "can be `_` or a minus"
    if written[0] in CORNERS:
        return "can be a quotation mark or a square bracket"
    return "it is not certain where its string ends"
