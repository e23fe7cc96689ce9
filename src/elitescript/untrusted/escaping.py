"""Shows texts that others wrote as texts: nothing in them is a mark, a link or a command of what shows them."""

from __future__ import annotations

import re
from typing import Final

_HIDDEN: Final = r"\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"
"""Control characters except line ends and tabs, and those that change the direction of text."""

_HIDDEN_SIGN: Final = re.compile(f"[{_HIDDEN}]")

OWN_COLORS: Final = ("0", "1;31", "33", "32", "36", "1", "2")
"""Colours that commands print on a terminal, as the terminal takes them."""

_NOT_FOR_A_TERMINAL: Final = re.compile(
    rf"(\x1b\[(?:{'|'.join(OWN_COLORS)})m)|[{_HIDDEN}]|\r(?!\n)",
)

_MARKS: Final = re.compile(
    r"[\\`*_{}\[\]<>|~&@]"  # anywhere: code, emphasis, links, HTML, tables, entities, addresses
    r"|(?<![^\n])(?=[ \t]*[-+=#])[ \t]*(?P<line>[-+=#])"  # at the begin of a line: lists, rules, headings
    r"|(?<![^\n])[ \t]*[0-9]{1,9}(?P<list>[.)])"
    r"|(?P<address>:)(?=//)|(?<=www)\."
)
"""Characters that Markdown, with the addresses that GitHub and editors make links of, takes for marks."""

_GITHUB_COMMAND: Final = re.compile(r"(?m)^(\s*)(::|##\[)")


def visible(text: str) -> str:
    """Return a text with its hidden characters as escapes such as `\\u202e`; line ends and tabs stay."""
    return _HIDDEN_SIGN.sub(_escape, text)


def terminal_text(text: str) -> str:
    """Return what a command prints as a terminal may get it: nothing in it moves the cursor or asks the terminal.

    The colours of `OWN_COLORS` and line ends stay; all else that drives a terminal is shown as an escape.
    """
    return _NOT_FOR_A_TERMINAL.sub(lambda found: found[1] or _escape(found), text)


def github_text(text: str) -> str:
    """Return what a command prints without workflow commands of GitHub: `::` at the begin of a line is `\\::`."""
    return _GITHUB_COMMAND.sub(r"\1\\\2", text)


def markdown_text(text: str) -> str:
    """Return a text as Markdown that shows it letter by letter; an empty line begins a paragraph."""
    return _MARKS.sub(_marked, visible(text))


def code_span(text: str) -> str:
    """Return a text as code within a line of Markdown; line ends are blanks."""
    shown = " ".join(visible(text).split("\n"))
    marks = "`" * (_longest_run(shown) + 1)
    blank = " " if shown[:1] == "`" or shown[-1:] == "`" else ""
    return f"{marks}{blank}{shown}{blank}{marks}"


def code_block(text: str, language: str) -> str:
    """Return a text as a block of code of Markdown."""
    marks = "`" * max(3, _longest_run(text) + 1)
    return f"{marks}{language}\n{visible(text)}\n{marks}"


def _longest_run(text: str) -> int:
    return max(map(len, re.findall("`+", text)), default=0)


def _marked(found: re.Match[str]) -> str:
    mark = found[0]
    return f"{mark[:-1]}\\{mark[-1]}"


def _escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    return "\\r" if code == 0x0D else f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
