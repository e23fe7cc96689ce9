"""Makes a program of the pieces that its compiler has sent: only in the process in which the program runs.

Making code of bytes means to trust them as one trusts a program (`docs/explanation/decisions/`, the record on the
compiler). So nothing but the process of the robot imports this, which is locked in and runs programs anyway.
"""

from __future__ import annotations

import marshal
from collections.abc import Iterator, Sequence
from types import CodeType
from typing import Any, overload

from elitescript.codec.values import read_text
from elitescript.language.compiler import CompiledUnit
from elitescript.language.diagnostics import Diagnostic, Severity
from elitescript.language.probes import CountedBranch, CountedFunction, CountedStatement, ProbeTable
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import CheckResult
from elitescript.services.compiler.packing import END, FUNCTION, LENGTH, PROBLEMS, STATEMENTS, TREE, UNIT, VALUES


class KeptStatements(Sequence[CountedStatement]):
    """The counted statements of a program, made when a debugger asks for the first of them.

    Args:
        pieces: marshalled lists of them.
    """

    __slots__ = ("_made", "_pieces")

    def __init__(self, pieces: list[bytes]) -> None:
        self._pieces = pieces
        self._made: tuple[CountedStatement, ...] | None = None

    def _all(self) -> tuple[CountedStatement, ...]:
        if self._made is None:
            self._made = tuple(CountedStatement(*row) for piece in self._pieces for row in marshal.loads(piece))
            self._pieces = []
        return self._made

    def __len__(self) -> int:
        return len(self._all())

    @overload
    def __getitem__(self, index: int) -> CountedStatement: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[CountedStatement, ...]: ...

    def __getitem__(self, index: int | slice) -> CountedStatement | tuple[CountedStatement, ...]:
        return self._all()[index]

    def __iter__(self) -> Iterator[CountedStatement]:
        return iter(self._all())


class Loading:
    """A program that arrives.

    Args:
        source: its text.

    Attributes:
        result: what has come of the text; None until the last piece is there.
    """

    __slots__ = ("_buffer", "_places", "_problems", "_source", "_statements", "_texts", "_unit", "_values", "result")

    def __init__(self, source: SourceFile) -> None:
        self._source = source
        self._buffer = bytearray()
        self._values: list[Any] = []
        self._problems: list[Diagnostic] = []
        self._statements: list[bytes] = []
        self._unit: CompiledUnit | None = None
        self._texts: list[str] = []
        self._places: list[str] = []
        self.result: CheckResult | None = None

    def feed(self, data: bytes) -> None:
        """Take bytes.

        Raises:
            Exception: of any kind, if they are not what a compiler of ours has sent.
        """
        buffer = self._buffer
        buffer += data
        while len(buffer) >= LENGTH.size:
            end = LENGTH.size + LENGTH.unpack_from(buffer)[0]
            if len(buffer) < end:
                return
            piece = bytes(buffer[LENGTH.size : end])
            del buffer[:end]
            self._take(piece[:1], piece[1:])

    def _take(self, mark: bytes, data: bytes) -> None:
        if mark == STATEMENTS:
            self._statements.append(data)
            return
        value = marshal.loads(data)
        if mark == VALUES:
            self._values += value
        elif mark == FUNCTION:
            count, code = value
            at = len(self._values) - count
            self._values[at:] = [code.replace(co_consts=tuple(self._values[at:]))]
        elif mark == PROBLEMS:
            self._problems += [
                Diagnostic(
                    code, Severity(severity), line, column, end_line, end_column, read_text(text), read_text(hint)
                )
                for code, severity, line, column, end_line, end_column, text, hint in value
            ]
        elif mark == TREE and isinstance(value, str):
            self._texts.append(value)
        elif mark == TREE:
            for place, count in value:
                self._places += [place] * count
        elif mark == UNIT:
            self._unit = self._made(*value)
        elif mark == END:
            self.result = CheckResult(self._unit, tuple(self._problems), value)
        else:
            raise ValueError(f"no piece of a program begins with {mark!r}")

    def _made(
        self, kind: str, name: str, global_names: list[str], has_line_marks: bool, shows_hash_order: bool, probes: Any
    ) -> CompiledUnit:
        (code,) = self._values
        if not isinstance(code, CodeType):
            raise TypeError("the value that is left is no code")
        if self._texts:
            self._source = SourceFile(self._source.name, "".join(self._texts), tuple(self._places))
        first, size, branches, functions = probes
        table = ProbeTable(
            first,
            size,
            KeptStatements(self._statements),
            tuple(CountedBranch(*row) for row in branches),
            tuple(CountedFunction(*row) for row in functions),
        )
        return CompiledUnit(
            self._source,
            kind,
            name,
            code,
            frozenset(global_names),
            (),
            has_line_marks,
            shows_hash_order,
            table,
        )
