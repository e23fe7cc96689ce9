"""Takes addresses of objects, which differ from run to run, out of what leaves a program.

Python writes the address of an object into the text of one that has no text of its own: `<Part object at 0x7f...>`. A
program may also have such a text from elsewhere, and that one stays as it is. Which it is shows where the number
points: Linux lists the memory of a process; elsewhere objects lie side by side in pieces of memory that hold many.
"""

from __future__ import annotations

import builtins
import gc
import re
import sys
from typing import Final

_PATTERN: Final = re.compile(r" at 0x([0-9a-fA-F]{6,16})(>|&gt;)")
"""As texts of objects end, in XML too."""
_PIECE_BITS: Final = 20
"""Python takes memory for small objects in pieces of 2**20 bytes, which begin at multiples of that."""
_MAPS: Final = "/proc/self/maps"
_MAPPED: Final = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) rw-p [0-9a-f]+ \S+ 0(?: |$)", re.MULTILINE)
"""Memory of this process that is no file: first address, and the one behind the last."""
_BLOCKS: Final = 1000
"""Fewer objects than a piece of memory holds."""
_ABSENT_MAX: Final = 64
"""Pieces of memory, each with no object at its first look, for which objects are looked for at once."""


def without_addresses(text: str) -> str:
    """Return a text without the addresses of objects of this process."""
    return _PATTERN.sub(_without_one, text)


def _without_one(match: re.Match[str]) -> str:
    return match[2] if _MEMORY.holds(int(match[1], 16)) else match[0]


class _Memory:
    """The pieces of memory of this process that hold objects; one process has one."""

    __slots__ = ("_absent", "_blocks", "_pieces")

    def __init__(self) -> None:
        self._pieces: set[int] = set()
        self._absent: set[int] = set()
        self._blocks = -_BLOCKS

    def holds(self, address: int) -> bool:
        """Return whether there are objects beside this address."""
        piece = address >> _PIECE_BITS
        if piece in self._pieces:
            return True
        # The number of objects may be what it was although pieces came and went, so a new one is always looked for.
        is_new = piece not in self._absent and len(self._absent) < _ABSENT_MAX
        if is_new or abs(sys.getallocatedblocks() - self._blocks) >= _BLOCKS:
            is_mapped = _is_mapped(address)
            if is_mapped:
                self._pieces.add(piece)
            elif is_mapped is None:
                self._pieces.update(id(value) >> _PIECE_BITS for value in _objects())
            self._blocks = sys.getallocatedblocks()
            if is_new and piece not in self._pieces:
                self._absent.add(piece)
        return piece in self._pieces


def _is_mapped(address: int) -> bool | None:
    """Return whether an address is in the memory of this process; None: this system does not tell."""
    from pathlib import Path

    try:
        regions = _MAPPED.findall(Path(_MAPS).read_text("ascii", "replace"))
    except OSError:
        return None
    return any(int(first, 16) <= address < int(end, 16) for first, end in regions)


def _objects() -> list[object]:
    """Return objects of this process: most, and with them at least one beside nearly every other.

    Those without references of their own are not among the collector's: those that hold them are. Those of Python
    itself are in neither.
    """
    tracked = gc.get_objects()
    return [*tracked, *gc.get_referents(*tracked), *vars(builtins).values(), *range(-5, 257)]


_MEMORY: Final = _Memory()
