"""The text of a program as an editor holds it, and what is computed of it once.

Places are lines and columns from 1, columns in characters, as everywhere in this package; `lsp` alone counts in UTF-16.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from itertools import accumulate
from typing import Any, Final, TypeVar

from elitescript.assist.names import Names
from elitescript.commands.definition.plausibility import ArmFacts
from elitescript.language.diagnostics import Diagnostic, Edit, Outdated
from elitescript.language.garbage import without_collection
from elitescript.language.options import Options
from elitescript.language.parser import Parsed, parse, translated
from elitescript.language.symbols import Symbols
from elitescript.language.text.dialect import Translation
from elitescript.language.text.pieces import Pieces
from elitescript.language.text.source import BOM, SourceFile
from elitescript.lint.engine import WrittenProgram
from elitescript.lint.program import AnalysedProgram
from elitescript.messages.profile import DEFAULT_FIRMWARE, PROFILES, Profile
from elitescript.records import field, record
from elitescript.values.memory import Memory

_Found = TypeVar("_Found")

_FOUND: Final = ("translation", "parsed", "program", "names", "_written", "quick_problems", "problems")
"""What is kept of a document once it was found."""

_LINE_END = re.compile(r"\r\n|\r|\n")


@record
class Settings:
    """What a program is written for.

    Attributes:
        profile: the firmware.
        strict: as `check --strict`.
        arm: facts of the arm; None leaves out what depends on it.
        presets: names of globals that have a value before the program begins.
        names: names of what is beside the robot, by kind: `address` (of servers), `file` (of the task folder), and the
            kinds of `names.STRING_NAMES`. Completion in strings offers them.
    """

    profile: Profile = PROFILES[DEFAULT_FIRMWARE]
    strict: bool = False
    arm: ArmFacts | None = None
    presets: frozenset[str] = frozenset()
    names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


class _OfTwins:
    """Holds what the twins of all versions of a text have in common, which are used one after the other."""

    __slots__ = ("memory", "pieces")

    def __init__(self) -> None:
        self.pieces = Pieces(may_move=True)
        self.memory = Memory()


class Document:
    """One version of a text. Never changes; `edited` returns the next version.

    Args:
        name: path or URI, for messages.
        text: as it is in the editor, with its own line ends and perhaps a byte order mark.
        version: number of the editor.
        settings: what it is written for.

    Attributes:
        is_outdated: set when there is a next version: what is being found in this one is given up.
    """

    def __init__(self, name: str, text: str, version: int = 0, settings: Settings | None = None) -> None:
        self.name = name
        self.text = text
        self.version = version
        self.settings = settings or Settings()
        self.is_outdated = False
        self._pieces = Pieces()
        self._memory = Memory()
        self._of_twins = _OfTwins()
        self._found: dict[Callable[[Document], Any], Any] = {}

    # ---------------------------------------------------------------- the text

    @cached_property
    def source(self) -> SourceFile:
        """The text with LF as line ends and no byte order mark."""
        return SourceFile(self.name, self.text)

    @cached_property
    def _starts(self) -> list[int]:
        """Offset in `text` at which each line starts."""
        mark = len(BOM) if self.text.startswith(BOM) else 0
        return [mark, *(found.end() for found in _LINE_END.finditer(self.text, mark))]

    @property
    def line_count(self) -> int:
        """Number of lines; a text that ends with a line end has an empty last line."""
        return len(self._starts)

    def line(self, number: int) -> str:
        """Return a line, from 1, without its line end; empty outside the text."""
        return self.source.line(number)

    def offset(self, line: int, column: int) -> int:
        """Return the offset in `text` of a place; places outside the text are moved into it.

        Column 0 of the first line is in front of the byte order mark.
        """
        line = min(max(line, 1), self.line_count)
        start = self._starts[line - 1]
        first = -start if line == 1 else 0
        return start + min(max(column - 1, first), len(self.line(line)))

    def place(self, offset: int) -> tuple[int, int]:
        """Return line and column of an offset in `text`."""
        line = max(1, bisect_right(self._starts, offset))
        return line, min(max(0, offset - self._starts[line - 1]), len(self.line(line))) + 1

    @cached_property
    def source_starts(self) -> list[int]:
        """Offset in `source.text` at which each line starts."""
        return list(accumulate((len(row) + 1 for row in self.source.lines[:-1]), initial=0))

    def edited(self, edits: Iterable[Edit], version: int) -> Document:
        """Return the text after edits that are made one after the other, each in what the one before left."""
        after = self
        for edit in edits:
            start = after.offset(edit.line, edit.column)
            end = max(start, after.offset(edit.end_line, edit.end_column))
            text = after.text[:start] + edit.text + after.text[end:]
            after = Document(self.name, text, version, self.settings)
        if after is self:
            after = Document(self.name, self.text, version, self.settings)
        after._pieces, after._memory, after._of_twins = self._pieces, self._memory, self._of_twins
        return after

    # ---------------------------------------------------------------- what is known of it

    def once(self, find: Callable[[Document], _Found]) -> _Found:
        """Return what a function finds in this document; it is called once for each document."""
        if find not in self._found:
            self._found[find] = without_collection(find)(self)
        found: _Found = self._found[find]
        return found

    def release(self) -> None:
        """Let go of all that was found, which knows this document and would wait for the collector."""
        program = self.__dict__.get("program")
        for name in _FOUND:
            self.__dict__.pop(name, None)
        self._found.clear()
        if program is not None:
            program.release()

    def twin(self) -> Document:
        """Return the same version for another thread: what is found of it later is found by each for itself.

        The twins of all versions of a text are for one thread: what was read of one is used for the next.
        """
        made = Document(self.name, self.text, self.version, self.settings)
        made._pieces, made._memory = self._of_twins.pieces, self._of_twins.memory
        if "translation" in self.__dict__:
            made.translation = self.translation
        return made

    @property
    def _options(self) -> Options:
        return Options(strict=self.settings.strict)

    @cached_property
    def translation(self) -> Translation:
        """The text as Python sees it, with its logical lines and blocks; takes half of the time of `parsed`."""
        return translated(self.source, self._options)

    @cached_property
    def parsed(self) -> Parsed:
        """The text as it was read; lines with mistakes are left out of its tree. Compiling would change it."""
        return parse(self.source, self._options, self.translation, self._pieces)

    @cached_property
    def _code_lines(self) -> list[str]:
        # Line ends inside brackets are masked too, so the lines are cut where they are in the text.
        masked = self.translation.masked
        rows = []
        start = 0
        for row in self.source.lines:
            rows.append(masked[start : start + len(row)])
            start += len(row) + 1
        return rows

    def code_line(self, number: int) -> str:
        """Return a line in which strings are runs of `"` and comments are blank, of the length of the line."""
        rows = self._code_lines
        return rows[number - 1] if 1 <= number <= len(rows) else ""

    @property
    def symbols(self) -> Symbols:
        """Scopes, names and calls."""
        return self.program.symbols

    @cached_property
    @without_collection
    def program(self) -> AnalysedProgram:
        """The text as the rules see it: calls of commands, constants, uses of names."""
        settings = self.settings
        return AnalysedProgram(
            self.parsed,
            settings.profile,
            is_strict=settings.strict,
            presets=settings.presets,
            arm=settings.arm,
            is_outdated=lambda: self.is_outdated,
            memory=self._memory,
        )

    @cached_property
    @without_collection
    def names(self) -> Names:
        """Every place where a name stands, and what it stands for."""
        return Names(self.program)

    @cached_property
    def _written(self) -> WrittenProgram:
        # Each of them takes a while for a long text.
        for step in ("translation", "parsed", "program"):
            if self.is_outdated:
                raise Outdated
            getattr(self, step)
        return WrittenProgram(self.program)

    @cached_property
    def quick_problems(self) -> tuple[Diagnostic, ...]:
        """Those of `problems` that need no values of expressions; found in a third of the time.

        Raises:
            Outdated: there is a next version.
        """
        return self._written.quick_problems()

    @cached_property
    def problems(self) -> tuple[Diagnostic, ...]:
        """What `check` finds, in the order of the text.

        Raises:
            Outdated: there is a next version.
        """
        return self._written.problems()
