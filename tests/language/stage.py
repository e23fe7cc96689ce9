"""A stage on which compiled programs run: the hooks, `textmsg`, and nothing else of a robot."""

from __future__ import annotations

import builtins
import copy
from typing import Any

from elitescript.language.compiler import CompiledUnit, compile_unit
from elitescript.language.hooks import ATTRIBUTE, CHECKPOINT, LINE, LOOP, MAIN, PAY, RANGE, STOP, TICK
from elitescript.language.options import DEFAULT, Options
from elitescript.language.text.source import SourceFile


class Stopped(BaseException):
    """Ends a program from outside."""


class Stage:
    """Runs programs and keeps what they said.

    Args:
        work: units of work until the program is stopped.
    """

    def __init__(self, work: int = 100_000) -> None:
        self.out: list[str] = []
        self.marks: list[tuple[Any, ...]] = []
        self.work = work
        self.range: object = range
        self.fuel = [False] + [True] * work
        self.globals: dict[str, Any] = {}

    def run(self, text: str, options: Options = DEFAULT) -> CompiledUnit:
        unit = compile_unit(SourceFile("stage.script", text), options)
        self.globals = {"__builtins__": {**vars(builtins), **self._names()}}
        exec(unit.code, self.globals)
        program = self.globals.pop(MAIN)
        try:
            program()
        finally:
            del self.globals["__builtins__"]
        return unit

    def _names(self) -> dict[str, Any]:
        return {
            TICK: self.fuel.pop,
            CHECKPOINT: self._checkpoint,
            PAY: self._pay,
            LOOP: lambda line: True,
            RANGE: self.range,
            STOP: Stopped,
            LINE: lambda *mark: self.marks.append(mark),
            ATTRIBUTE: getattr,
            "textmsg": lambda *parts: self.out.append("".join(map(str, parts))),
            "copy": copy,
            "elicopy": copy,
        }

    @property
    def ticks(self) -> int:
        """Units of work that were used up."""
        return self.work + 1 - len(self.fuel)

    def _pay(self, count: int) -> bool:
        if len(self.fuel) <= count:
            return False
        del self.fuel[-count:]
        return True

    def _checkpoint(self) -> bool:
        self.fuel[:] = [False]
        raise Stopped


def output(text: str, **options: Any) -> list[str]:
    """What a program says."""
    stage = Stage()
    stage.run(text, Options(**options))
    return stage.out
