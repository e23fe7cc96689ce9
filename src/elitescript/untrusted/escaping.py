"""Shows texts that others wrote in Markdown: nothing in them is a mark, a link or a command of what shows them."""

from __future__ import annotations

import re
from typing import Final

from elitescript.shown import visible

_MARKS: Final = re.compile(
    r"[\\`*_{}\[\]<>|~&@]"  # anywhere: code, emphasis, links, HTML, tables, entities, addresses
    r"|(?<![^\n])(?=[ \t]*[-+=#])[ \t]*(?P<line>[-+=#])"  # at the begin of a line: lists, rules, headings
    r"|(?<![^\n])[ \t]*[0-9]{1,9}(?P<list>[.)])"
    r"|(?P<address>:)(?=//)|(?<=www)\."
)
"""Characters that Markdown, with the addresses that GitHub and editors make links of, takes for marks."""


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
