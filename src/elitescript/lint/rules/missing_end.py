"""A block without the `end` that the other blocks of the text have.

Indentation alone decides where a block ends, so the program runs; but where most blocks are closed, one that is
not is usually a slip, and the lines behind it may belong somewhere else than it seems. Functions are compared
with functions, loops and branches with loops and branches; blocks in one line (`if done: return`) need no `end`,
and texts that close no block but their outermost one, or only every other one, are written in Python's way and
left alone. So are texts with line marks: the pendant has written them, together with its plug-ins.

    def job():
      if get_flag(0):
        sync()
      end
      while get_flag(1):         # W216
        sync()
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.options import LINE
from elitescript.language.text.rewriting import BlockEnd
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, rule
from elitescript.said import Said, said


@rule(code="W216", since="0.2", needs_all_lines=True)
def missing_end(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such block at its header."""
    if program.parsed.options.kind == LINE or program.parsed.has_line_marks:
        return
    groups: dict[str, list[BlockEnd]] = {}
    for block in program.parsed.translation.ends:
        groups.setdefault(_group(block), []).append(block)
    inner_ends = sum(block.has_end for group, blocks in groups.items() if group != _OUTERMOST for block in blocks)
    for group, blocks in groups.items():
        open_blocks = [block for block in blocks if not block.has_end]
        closed = len(blocks) - len(open_blocks) + (inner_ends if group == _OUTERMOST else 0)
        if not group or not closed or len(open_blocks) > max(1, closed // _CLOSED_FOR_EACH_OPEN):
            continue
        for block in open_blocks:
            yield _finding(program, block, closed)


_OUTERMOST = "outermost"
_CLOSED_FOR_EACH_OPEN = 3
"""Closed blocks for each open one beyond the first; a text with fewer mixes two ways of writing."""


def _group(block: BlockEnd) -> str:
    """Return what a block is compared with; empty for what needs no `end`."""
    if block.word in ("", "case", "async"):
        return ""
    if block.word in ("def", "sec", "thread"):
        if block.outer == "class":
            return "method"
        return "function" if block.outer else _OUTERMOST
    return "class" if block.word == "class" else "statement"


def _finding(program: AnalysedProgram, block: BlockEnd, closed: int) -> Finding:
    opener, last = block.opener, block.last
    row = program.source.line(opener.line)
    start = len(row) - len(row.lstrip()) + 1
    where = Span(opener.line, start, opener.line, len(row.rstrip()) + 1)
    others = (
        Said("another block has its own") if closed == 1 else said("{closed} other blocks have theirs", closed=closed)
    )
    text = said(
        "the `{word}` of line {line} has no `end`, and {others}: by its indentation it ends after line {last_line}",
        word=block.word,
        line=opener.line,
        others=others,
        last_line=last.last_line,
    )
    column = len(program.source.line(last.last_line)) + 1
    edit = Edit(last.last_line, column, last.last_line, column, f"\n{row[: start - 1]}end")
    hint = said(
        "write `end` in column {start} below line {last_line}, or indent what else belongs to it",
        start=start,
        last_line=last.last_line,
    )
    return Finding(where, text, hint, Fix("close it where it ends", (edit,), safe=True))
