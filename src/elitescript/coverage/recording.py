"""The record of what a process has run of programs: counters and facts in one block of bytes.

The block is a file that is mapped into memory, so that it holds everything at any moment, however the process ends:
nothing has to be written at its end, and a process that may write no file can count too.

The block is cells of 8 bytes in the order of the computer. The first holds `MAGIC`. Records follow: a cell with the
kind, one with the number of cells that follow, one with the length of a JSON text in bytes, the text, and, of
`COUNTERS`, the counters. A kind of 0 ends the block, `FULL` says that something found no room.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager
from hashlib import blake2b
from typing import Any, Final

from elitescript.records import NamedTuple

CELL: Final = 8
MAGIC: Final = 0x656C69746573_0001
"""Format and its version."""
COUNTERS: Final = 1
FACT: Final = 2
FULL: Final = 3

BLOCK_BYTES: Final = 32 * 1024 * 1024
"""Size of a block: counters of some 10,000 different programs. Bytes that are not used take no room on most disks."""
_HEAD: Final = 2
_COUNTERS_OF_A_STATEMENT: Final = 3
"""Most counters that a statement needs: its own, and those of two sides on which no statement stands."""


def digest_of(text: str) -> str:
    """Return what identifies a program text, wherever it comes from: line ends and blanks at its end do not count."""
    same = text.replace("\r\n", "\n").replace("\r", "\n").rstrip()
    return blake2b(same.encode("utf-8", "surrogatepass"), digest_size=16).hexdigest()


def counters_max(text: str) -> int:
    """Return a number of counters that is enough for a text: statements end with a line, a semicolon or a colon."""
    ends = text.count("\n") + text.count("\r") + text.count(";") + text.count(":")
    return _COUNTERS_OF_A_STATEMENT * (ends + 1)


class Recorder:
    """Writes the record of a process.

    Args:
        block: bytes that are all 0, or hold what this process has recorded before.
        lock: held while room is given away; robots may run in several threads.

    Attributes:
        cells: the block as numbers; the counters of a program are some of them.
    """

    __slots__ = ("_end", "_facts", "_firsts", "_lock", "cells")

    def __init__(self, block: bytearray | memoryview, lock: AbstractContextManager[Any]) -> None:
        self.cells = memoryview(block).cast("B").cast("Q")
        self.cells[0] = MAGIC
        self._end = 1
        self._firsts: dict[str, int] = {}
        self._facts: set[str] = set()
        self._lock = lock

    def counters(self, name: str, text: str) -> int | None:
        """Return the number of the first counter of a program: an index of `cells`; None if there is no more room.

        The counters of a text that was recorded before are the same ones.

        Args:
            name: of the program: a path, or its origin in angle brackets.
            text: of the program.
        """
        digest = digest_of(text)
        with self._lock:
            first = self._firsts.get(digest)
            if first is None:
                about = {"name": name, "digest": digest}
                first = self._append(COUNTERS, about, counters_max(text))
                if first is not None:
                    self._firsts[digest] = first
        return first

    def fact(self, kind: str, *words: str) -> None:
        """Record something that has happened, once: what it is, and its details."""
        text = json.dumps([kind, *words])
        if text not in self._facts:
            with self._lock:
                self._facts.add(text)
                self._append(FACT, [kind, *words], 0)

    def copied(self, block: bytearray | memoryview, lock: AbstractContextManager[Any]) -> Recorder:
        """Return a recorder for another block with the same programs, by the same numbers; its counts are 0.

        Args:
            block: bytes that are all 0, as many as this one has.
            lock: of the other one.
        """
        copy = Recorder(block, lock)
        copy.cells[1 : self._end] = self.cells[1 : self._end]
        copy._end, copy._firsts, copy._facts = self._end, dict(self._firsts), set(self._facts)
        for kind, payload in _records(copy.cells):
            if kind == COUNTERS:
                counters = payload[1 + _text_cells(payload) :]
                counters.cast("B")[:] = bytes(counters.nbytes)
        return copy

    def _append(self, kind: int, about: object, counters: int) -> int | None:
        """Append a record; return the index of its first counter, None if there is no room."""
        data = json.dumps(about).encode("ascii")
        text = self._end + _HEAD + 1
        first = text - (-len(data) // CELL)
        end = first + counters
        if end + _HEAD > len(self.cells):
            self.cells[self._end] = FULL
            return None
        self.cells[text - 1] = len(data)
        self.cells.cast("B")[text * CELL : text * CELL + len(data)] = data
        self.cells[self._end + 1] = end - self._end - _HEAD
        # Last, so that a reader never finds a record that is only begun.
        self.cells[self._end] = kind
        self._end = end
        return first


class RecordedProgram(NamedTuple):
    """Counters of a program text in one process; more than it has are 0."""

    name: str
    digest: str
    counts: tuple[int, ...]


class Record(NamedTuple):
    """What a process has recorded.

    Attributes:
        programs: in the order in which they were compiled first.
        facts: kind and details of each.
        is_complete: whether everything found room.
    """

    programs: tuple[RecordedProgram, ...]
    facts: frozenset[tuple[str, ...]]
    is_complete: bool


def read_record(block: bytes | memoryview) -> Record:
    """Return what a block holds. What a process has written is checked: it may have run any program.

    Raises:
        ValueError: it is no block of this version, or is damaged.
    """
    whole = memoryview(block)
    cells = whole[: len(whole) // CELL * CELL].cast("B").cast("Q")
    if not len(cells) or cells[0] != MAGIC:
        raise ValueError("it is no record of coverage, or one of another version of elitescript")
    programs, facts, is_complete = [], set(), True
    for kind, payload in _records(cells):
        if kind == FULL:
            is_complete = False
            break
        about, counts = _parts(payload)
        if kind == COUNTERS and isinstance(about, Mapping):
            name, digest = about.get("name"), about.get("digest")
            if not isinstance(name, str) or not isinstance(digest, str):
                raise ValueError("a program without a name")
            programs.append(RecordedProgram(name, digest, counts))
        elif kind == FACT and isinstance(about, list) and all(isinstance(word, str) for word in about):
            facts.add(tuple(about))
        else:
            raise ValueError(f"an unknown record of kind {kind}")
    return Record(tuple(programs), frozenset(facts), is_complete)


def _records(cells: memoryview) -> Iterator[tuple[int, memoryview]]:
    at = 1
    while at + _HEAD <= len(cells) and (kind := cells[at]):
        size = cells[at + 1]
        if at + _HEAD + size > len(cells):
            raise ValueError("a record that is longer than its block")
        yield kind, cells[at + _HEAD : at + _HEAD + size]
        at += _HEAD + size


def _parts(payload: memoryview) -> tuple[Any, tuple[int, ...]]:
    """Return the object of a record and its counters."""
    text_cells = _text_cells(payload)
    if not 0 < text_cells < len(payload):
        raise ValueError("a record without its text")
    return json.loads(bytes(payload[1:].cast("B")[: payload[0]])), tuple(payload[1 + text_cells :])


def _text_cells(payload: memoryview) -> int:
    """Return the number of cells of the text of a record."""
    return -(-payload[0] // CELL) if len(payload) else 0
