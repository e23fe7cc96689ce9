"""A text that was saved as GBK and is UTF-8 by chance.

The bytes of `停止` in GBK are valid UTF-8 as well: they read as marks of scripts that no program mixes. The program
runs, but its texts are those marks. `--fix` converts nothing, as both readings are possible. `textmsg("停止")` in a file
that was saved as UTF-8 is no finding, nor are texts in Latin, Greek, Cyrillic, Hebrew or Arabic letters.

    def job():
      textmsg("\u0221")                 # W222: in GBK, these bytes are a Chinese character
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, rule

_SHOWN: Final = 60
"""Characters of a line that are shown in GBK."""


@rule(code="W222", since="0.2")
def gbk_by_chance(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first line with such characters."""
    source = program.parsed.source
    if source.text.isascii():
        return
    from elitescript.text_encoding import by_chance

    if (reads := by_chance(source.text)) is None:
        return
    number = next(n for n, line in enumerate(source.lines, 1) if not line.isascii())
    line = source.line(number)
    first = next(column for column, sign in enumerate(line, 1) if not sign.isascii())
    shown = reads.split("\n")[number - 1].strip()[:_SHOWN]
    yield Finding(
        Span(number, first, number, len(line) + 1),
        f"the text looks like GBK that is UTF-8 by chance: as GBK the line reads `{shown}`",
        "open the file as GBK in the editor and save it as UTF-8",
    )
