"""Texts to lay out, and what must be equal before and after."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random
from types import CodeType
from typing import Any

from elitescript.language.compiler import compile_unit
from elitescript.language.text.masked import lex
from elitescript.language.text.source import SourceFile

ROOT = Path(__file__).parents[2]
_LONE_SIGN = re.compile(r"(?<![-+*/=<>!:.,%&|^@$])[-+*/=<>,()\[\]{}:%](?![-+*/=<>!:.,%&|^@])")


def texts_of_the_repository() -> dict[str, str]:
    """Examples, programs of the specification, programs of the pages; by a name that says where they are."""
    found = {path.name: path.read_bytes().decode() for path in sorted((ROOT / "examples").glob("*.script"))}
    for folder, fence in (("tests/spec", "elite"), ("docs", "elitescript")):
        for page in sorted((ROOT / folder).rglob("*.md")):
            blocks = re.findall(rf"^```{fence}\b[^\n]*\n(.*?)^```", page.read_text("utf-8"), re.DOTALL | re.MULTILINE)
            found |= {f"{page.stem}-{number}": text for number, text in enumerate(blocks)}
    return found


def shape(code: CodeType) -> tuple[Any, ...]:
    """All of a code object but the columns of its instructions: lines too."""
    return (
        code.co_name,
        code.co_qualname,
        code.co_code,
        code.co_names,
        code.co_varnames,
        code.co_freevars,
        code.co_cellvars,
        code.co_flags,
        code.co_stacksize,
        code.co_firstlineno,
        code.co_exceptiontable,
        [line for _, _, line in code.co_lines()],
        [shape(item) if isinstance(item, CodeType) else (type(item), repr(item)) for item in code.co_consts],
    )


def compiled(text: str) -> tuple[Any, ...]:
    """What runs of a text, and the findings about it without their columns."""
    unit = compile_unit(SourceFile("p.script", text))
    return shape(unit.code), unit.kind, unit.name, [(found.code, found.line) for found in unit.diagnostics]


def mangled(rng: Random, text: str) -> str:
    """The same program, badly laid out: other indentation, blanks around signs, at the ends of lines."""
    lexed = lex(text)
    indent = rng.choice((" ", "   ", "    ", "\t", "\t  "))
    line_starts = {line.start for line in lexed.lines}
    chance = rng.choice((0.0, 0.1, 0.5))
    parts: list[str] = []
    position = 0
    for found in _LONE_SIGN.finditer(lexed.masked):
        if rng.random() < chance and "$" not in lexed.text[lexed.starts[lexed.place(found.start())[0] - 1] :][:80]:
            # Blanks at the start of a line would be indentation.
            left = "" if found.start() in line_starts else " " * rng.randrange(3)
            is_alone = found.group() in "*/<>="
            right = " " * (rng.randrange(3) or is_alone)
            parts += (lexed.text[position : found.start()], left, found.group(), right)
            position = found.end()
    spread = "".join((*parts, lexed.text[position:]))
    lexed = lex(spread)
    outer = [0]
    changes = []
    for line in lexed.lines:
        while outer[-1] > line.column:
            outer.pop()
        if line.column > outer[-1]:
            outer.append(line.column)
        changes.append((line.start, indent * (len(outer) - 1)))
    rows = []
    position = 0
    for start, blanks in changes:
        row_start = spread.rfind("\n", 0, start) + 1
        rows += (spread[position:row_start], blanks)
        position = start
    return "".join((*rows, spread[position:]))
