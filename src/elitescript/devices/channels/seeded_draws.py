"""Chance without a generator: numbers that follow from a seed and from what they are for.

Whatever else is drawn, and in which order, does not change them.
"""

from __future__ import annotations

from typing import Final

_MASK: Final = (1 << 64) - 1


def drawn(*key: int) -> int:
    """Return a whole number in [0, 2**64) for a key (the finalizer of SplitMix64: Steele, Lea, Flood 2014)."""
    value = 0
    for part in key:
        value = (value + part + 0x9E3779B97F4A7C15) & _MASK
        value = ((value ^ value >> 30) * 0xBF58476D1CE4E5B9) & _MASK
        value = ((value ^ value >> 27) * 0x94D049BB133111EB) & _MASK
        value ^= value >> 31
    return value


def share(*key: int) -> float:
    """Return a number in [0, 1) for a key."""
    return (drawn(*key) >> 11) / (1 << 53)
