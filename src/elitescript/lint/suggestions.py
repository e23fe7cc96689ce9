"""What an unknown name of a program was meant to be; the words are those of the alarm at run time."""

from __future__ import annotations

from typing import Final

from elitescript.commands.definition.vocabulary import vocabulary_of
from elitescript.language.advice.unknown_names import advice, nearest
from elitescript.lint.program import AnalysedProgram, Use

__all__ = ["MOST_SUGGESTIONS", "meant_by", "nearest"]

MOST_SUGGESTIONS: Final = 20
"""Names of one program that are looked up; a text with more unknown names is no program for this robot."""


def meant_by(use: Use, program: AnalysedProgram, *, is_searched: bool) -> tuple[str, str]:
    """Return the name that is meant, if one can take its place, and the hint; both may be empty."""
    return advice(use.node, use.scope, program.symbols, vocabulary_of(program.profile), is_searched=is_searched)
