"""Tells texts apart by their code: a change of comments and blank lines moves lines and changes nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import blake2b
from types import CodeType
from typing import Any

from elitescript.language.compiler import CompiledUnit
from elitescript.language.hooks import LOOP


def digest_of(unit: CompiledUnit, settings: Any) -> str:
    """Return a text that is the same for two programs with the same code and settings, wherever their lines are.

    Columns count: they are in alarms. So do the findings of the compiler, but for their lines.
    """
    found = blake2b(digest_size=16)
    for part in _parts(unit.code):
        found.update(repr(part).encode("utf-8", "surrogatepass"))
    about = [(item.code, item.column, item.text) for item in unit.diagnostics]
    found.update(repr((unit.kind, unit.name, sorted(unit.global_names), about, settings)).encode("utf-8", "replace"))
    return found.hexdigest()


def lines_of(unit: CompiledUnit) -> list[int]:
    """Return the lines of all instructions, in an order that depends on the code alone; 0 for none."""
    return [line or 0 for code in _codes(unit.code) for line, _, _, _ in code.co_positions()]


def moved_lines(before: list[int], now: list[int]) -> dict[int, int] | None:
    """Return where each line has gone; None if one would have to be in two places.

    Args:
        before: `lines_of` a program.
        now: those of another one with the same digest.
    """
    if len(before) != len(now):
        return None
    found: dict[int, int] = {0: 0}
    for old, new in zip(before, now, strict=True):
        if found.setdefault(old, new) != new:
            return None
    return found


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _parts(unit: CodeType) -> Iterator[Any]:
    for code in _codes(unit):
        yield (
            *(code.co_name, code.co_qualname, code.co_flags, code.co_code, code.co_exceptiontable),
            *(code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount),
            *(code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars),
            [_without_line(constant) for constant in code.co_consts],
            [(column, end_column) for _, _, column, end_column in code.co_positions()],
        )


def _without_line(constant: object) -> object:
    """Return a constant as it is compared: the mark of a loop without its line."""
    if isinstance(constant, CodeType):
        return None
    return LOOP if isinstance(constant, tuple) and constant[:1] == (LOOP,) else constant
