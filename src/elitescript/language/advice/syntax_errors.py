"""Rewords Python's syntax messages.

Their wording differs between versions of Python; the texts here do not.
"""

from __future__ import annotations

import re
from keyword import iskeyword
from typing import Final

from elitescript.language.text.lexer import NAME
from elitescript.language.text.masked import lex
from elitescript.said import said

_ESCAPE: Final = r"(?s)\\(?:x[0-9a-fA-F]{0,2}|u[0-9a-fA-F]{0,4}|U[0-9a-fA-F]{0,8}|N(?:\{[^}]*\})?|.)"
_ESCAPE_ERROR: Final = r"\((?:unicode|value) error\).*escape"

# (pattern of Python's message, our text, hint); groups may be used in both.
_TABLE: Final = (
    (
        r"invalid syntax\. Perhaps you forgot a comma",
        "something is missing between these values",
        "put a comma or an operator between them",
    ),
    (
        r"invalid syntax\. Maybe you meant '==' or ':=' instead of '='"
        r"|expression cannot contain assignment, perhaps you meant \"==\"",
        "`=` assigns and cannot stand here",
        "`==` compares",
    ),
    (r"expected ':'", "a colon is missing", "lines that begin a block end with `:`"),
    (r"expected '\('", "an opening bracket is missing", "the form is `def name():`"),
    (
        r"invalid (decimal|hexadecimal|octal|binary|imaginary) literal",
        "this is neither a number nor a name",
        "names begin with a letter, and numbers contain no letters",
    ),
    (r"invalid digit '(.)' in (octal|binary) literal", r"the digit \1 does not exist in \2 numbers", ""),
    (
        r"invalid non-printable character (U\+[0-9A-F]+)",
        r"the invisible character \1 cannot stand here",
        "delete it; text copied from documents or web pages often has such characters",
    ),
    (
        r"invalid character '(.*)' \((U\+[0-9A-F]+)\)",
        r"the character '\1' (\2) cannot stand here",
        "outside strings and comments use plain letters, digits and signs",
    ),
    (
        r"cannot (?:assign to|use|delete) (.*?)(?: here.*| as .*)?$",
        r"a value cannot be put into this: \1",
        "on the left of `=` stands a name, an element `a[0]` or an attribute `a.b`; a comparison is written `==`",
    ),
    (
        r"inconsistent use of tabs and spaces in indentation",
        "tabs and blanks are mixed, so the indentation is ambiguous",
        "indent all lines of a block in the same way",
    ),
    (r"unexpected indent", "this line is indented, but no block begins here", "align it with the line above"),
    (r"expected an indented block", "the body of a block should be indented here", "write `pass` for an empty body"),
    (r"unindent does not match", "the indentation goes back to no earlier line", "align it with a line above"),
    (r"'(break|continue)' (?:outside loop|not properly in loop)", r"`\1` stands outside every loop", ""),
    (r"'return' outside function", "`return` stands outside every function", ""),
    (
        r"name '(.*)' is parameter and (global|nonlocal)",
        r"`\1` is a parameter of this function and cannot be \2",
        "give the parameter another name",
    ),
    (r"name '(.*)' is nonlocal and global", r"`\1` cannot be both nonlocal and global", "keep one of the two"),
    (
        r"annotated name '(.*)' can't be (global|nonlocal)",
        r"`\1` is declared \2 and cannot take a type here",
        "leave the type out",
    ),
    (
        r"no binding for nonlocal '(.*)' found",
        r"no enclosing function has a variable `\1`",
        "`nonlocal` reaches variables of enclosing functions, `global` those of the whole program",
    ),
    (
        r"name '(.*)' is (?:used prior to|assigned to before) (global|nonlocal) declaration",
        r"`\2 \1` comes after \1 was used",
        "move the declaration to the top of the function",
    ),
    (r"duplicate argument '(.*)' in function definition", r"the parameter `\1` occurs twice", "rename one of them"),
    (
        r"positional argument follows keyword argument",
        "an argument without a name follows one with a name",
        "put the arguments with names last",
    ),
    (r"keyword argument repeated: (.*)", r"the argument `\1` is given twice", "remove one of them"),
    (
        r"(?:non-default argument follows default argument"
        r"|parameter without a default follows parameter with a default)",
        "a parameter without a default follows one with a default",
        "put the parameters with defaults last",
    ),
    (r"import \* only allowed at module level", "`import *` is not possible here", "name what is to be imported"),
    (r"default 'except:' must be last", "an `except:` without a class must be the last one", "move it to the end"),
    (
        r"unexpected character after line continuation",
        "something follows the `\\\\` that continues the line",
        "the backslash must be the last character of its line; in a path it belongs into quotes",
    ),
    (_ESCAPE_ERROR, "the string has a broken escape", "double each backslash, or write r'...'"),
    (r"bytes can only contain ASCII", "b'...' holds only ASCII characters", "write 'text'.encode() instead"),
    (r"[Gg]enerator expression must be parenthesized", "this generator needs brackets of its own", ""),
    (r"(?:too many statically nested blocks|too many levels of indentation)", "blocks are nested too deeply", ""),
    (r"too many nested parentheses", "brackets are nested too deeply", ""),
    (r"Exceeds the limit", "this number has too many digits", "write it as a power or in hexadecimal"),
    (r"'(yield|await)' outside function|'(async .*|asynchronous comprehension)' outside", "this cannot stand here", ""),
    (
        r"expected 'except' or 'finally' block",
        "a `try` has neither `except` nor `finally`",
        "say what to do with an error: `except Exception as e:`",
    ),
    (r"unterminated (?:triple-quoted )?string literal", "this string is not closed", "add the missing quote"),
    (r"'(.)' was never closed", r"this '\1' is never closed", "add the missing bracket"),
    (r"unmatched '(.)'", r"this '\1' closes nothing", "remove it, or open the bracket before it"),
    (r"(?:unexpected EOF|unexpected end of file)", "the text ends too early", ""),
)

# What stands at the place of a plain "invalid syntax".
_AT_PLACE: Final = (
    (r"else\s+if\b|if\b.*\belse\s*$", "`else if` is written `elif`", "write `elif condition:`"),
    (r"(?:elseif|elsif)\b", "this is written `elif`", "write `elif condition:`"),
    (r".*\bthen\b", "`then` does not exist here", "end the line with `:`"),
    (r"end[ \t]+\w", "`end` stands alone on its line", "one `end` closes every kind of block"),
    (r"//|/\*", "a comment begins with `#`", "write `#` in front of it"),
    (r"(?:wait|delay|sleep)[ \t]+[\w.]", "the argument of a call stands in parentheses", "write sleep(0.5)"),
    (r"for\s*\(.*;.*;", "a `for` loop goes over a list or a range", "write `for i in range(3):`"),
    (r"foreach\b|for[ \t]+each\b", "a loop over a list is a `for`", "write `for item in items:`"),
    (r"(?:loop|repeat)\b", "loops are `while` and `for`", "write `for n in range(3):` or `while True:`"),
    (r"(?:switch|select)\b", "`switch` does not exist here", "write `if x == 1:`, `elif x == 2:`, `else:`"),
    (r"(?:case\b|default[ \t]*:)", "this stands outside every `match`", "write `if x == 1:`, `elif x == 2:`, `else:`"),
    (r"catch\b", "this is written `except`", "write `except Exception as e:`"),
    (r"[^'\"]*\bnew[ \t]+\w", "objects are made without `new`", "write x = Name()"),
    (r"[^'\"]*\b(?:AND|OR|NOT)\b", "`and`, `or` and `not` are written in small letters", "write them in small letters"),
    (r"[^'\"]*(?:&[ \t]*&|\|[ \t]*\|)", "this is an operator of C", "write `and`, `or`"),
    (r"[^'\"]*[=!]==", "this comparison has one `=` too many", "write `==` or `!=`"),
    (r"[\w.]+[ \t]*:=", "an assignment is written `=`", "write x = 1"),
    (r".*[^=!<>]=>|.*=<", "this comparison is written the other way round", "write >= or <="),
    (r".*\{\s*$", "a block does not begin with `{`", "end the line with `:` and indent the body"),
    (r"^\s*\}\s*$", "a block does not end with `}`", "a block ends where its indentation ends"),
    (r"(?:var|let|const|int|float|bool|string)\s+\w", "variables are not declared with a type in front", "write x = 1"),
    (r"(?:function|func|sub|void)\s+\w", "functions are written differently", "write `def name():`"),
)


def explain(message: str, row: str, at: int = 0) -> tuple[str, str]:
    """Return (text, hint) for one of Python's messages about the line `row`, at the index `at`."""
    if message.startswith("f-string: "):
        text, hint = explain(message.removeprefix("f-string: "), "")
        return said("in the f-string: {text}", text=text), hint or "check the braces { } and what stands between them"
    vague = message == "invalid syntax" or message.startswith("expected ")
    # Python takes the first part of a loop of C for a comparison.
    vague = vague or (message.startswith("invalid syntax") and ";" in row)
    if vague:
        stripped = row.strip()
        for pattern, text, hint in _AT_PLACE:
            if re.match(pattern, stripped):
                return text, hint
        if re.search(r"//[ \t]*\w+[ \t]*$", row[:at]):
            return "a comment begins with `#`; `//` divides", "write `#` in place of `//`"
        words = re.match(rf"({NAME})[ \t]+({NAME})", stripped)
        if words and not iskeyword(words[1]) and not iskeyword(words[2]):
            return said("something is missing between `{first}` and `{second}`", first=words[1], second=words[2]), said(
                "a call is written {name}(...)", name=words[1]
            )
    for pattern, text, hint in _TABLE:
        found = re.match(pattern, message)
        if found:
            return found.expand(text), hint
    if vague:
        rest = row[at:].strip()
        last = re.search(r"(\w+|[^\w\s]+)\s*$", row[:at])
        if last and (not rest or rest.startswith("#")):
            return said("something is missing behind `{word}`", word=last[1]), ""
        return "this is not valid here", ""
    return message[:1].lower() + message[1:], ""


def broken_escape(message: str, code: str) -> tuple[int, int, int] | None:
    """Locate the broken escape of a message, which itself locates only the string, or its end.

    Args:
        message: Python's message.
        code: the logical line with the string, without what stands before it on other lines.

    Returns:
        (line, column, end column), from 1, the end exclusive; None if the message is about something else.
    """
    if not re.match(_ESCAPE_ERROR, message):
        return None
    lexed = lex(code)
    for string in lexed.strings:
        kinds = "x" if "b" in code[string.start : string.body].lower() else "xuUN"
        for found in re.finditer(_ESCAPE, code[string.body : string.end]):
            if found.group()[1] in kinds and not _is_complete(found.group()):
                line, column = lexed.place(string.body + found.start())
                return line, column, column + len(found.group())
    return None


def _is_complete(escape: str) -> bool:
    try:
        escape.encode().decode("unicode_escape")
    except UnicodeDecodeError:
        return False
    return True
