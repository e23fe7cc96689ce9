"""Detects a text that was saved in GBK and is UTF-8 by chance, as of `停止`."""

from __future__ import annotations

from typing import Final

from elitescript.language.text.rewriting import Draft
from elitescript.said import said
from elitescript.text_encoding import by_chance

_HINT: Final = "open the file as GBK in the editor and save it as UTF-8"
_SHOWN: Final = 60
"""Characters of a line that are shown in GBK."""


def read_gbk_by_chance(draft: Draft) -> None:
    """Report the first line with such characters."""
    text = draft.lexed.text
    if (reads := by_chance(text)) is None:
        return
    start = next(at for at, sign in enumerate(text) if not sign.isascii())
    end = text.find("\n", start)
    row = text.count("\n", 0, start)
    shown = reads.split("\n")[row].strip()[:_SHOWN]
    problem = said("the text looks like GBK that is UTF-8 by chance: as GBK the line reads `{shown}`", shown=shown)
    draft.report("W222", start, len(text) if end < 0 else end, problem, _HINT)
