"""What is drawn for a run: from the seed of the sweep, the number of the run and a name alone.

So one more `--vary` changes no other value, run 70,000 is made without the 69,999 before it, and 200 runs begin as 100
do. Of `random.Random` only `seed(int)` and `random()` are used, which are the same in every version of Python.
"""

from __future__ import annotations

from hashlib import sha256
from math import log, sqrt
from random import Random
from typing import Final

_DRAWN: Final = Random()
"""Seeded before every use: to make one takes longer."""


def seed_of_run(seed: int, run: int) -> int:
    """Return the seed of a run: 53 bits, which every reader of JSON, TOML and CSV has exactly."""
    return _number_of(f"{seed}/{run}")


def seed_of_name(seed: int, run: int, name: str) -> int:
    """Return the seed of what is called by a name in a run, 53 bits."""
    return _number_of(f"{seed}/{run}/{name}")


def fraction(seed: int, run: int, name: str) -> float:
    """Return a number in [0, 1), evenly distributed."""
    _DRAWN.seed(seed_of_name(seed, run, name))
    return _DRAWN.random()


def _number_of(text: str) -> int:
    return int.from_bytes(sha256(text.encode()).digest()[:8], "big") >> 11


def normal_quantile(p: float) -> float:
    """Return the value below which a standard normal variable is with a probability in (0, 1).

    Acklam's rational approximation, relative error below 1.2e-9: sums, products, one logarithm and one square root.
    """
    if p < _LOW:
        q = sqrt(-2.0 * log(p))
        return _ratio(_TAIL_UP, _TAIL_DOWN, q)
    if p > 1.0 - _LOW:
        q = sqrt(-2.0 * log(1.0 - p))
        return -_ratio(_TAIL_UP, _TAIL_DOWN, q)
    q = p - 0.5
    return q * _ratio(_MIDDLE_UP, _MIDDLE_DOWN, q * q)


def _ratio(up: tuple[float, ...], down: tuple[float, ...], x: float) -> float:
    above = below = 0.0
    for factor in up:
        above = above * x + factor
    for factor in down:
        below = below * x + factor
    return above / below


_LOW: Final = 0.02425

_MIDDLE_UP: Final = (
    -3.969683028665376e01,
    2.209460984245205e02,
    -2.759285104469687e02,
    1.383577518672690e02,
    -3.066479806614716e01,
    2.506628277459239e00,
)
_MIDDLE_DOWN: Final = (
    -5.447609879822406e01,
    1.615858368580409e02,
    -1.556989798598866e02,
    6.680131188771972e01,
    -1.328068155288572e01,
    1.0,
)
_TAIL_UP: Final = (
    -7.784894002430293e-03,
    -3.223964580411365e-01,
    -2.400758277161838e00,
    -2.549732539343734e00,
    4.374664141464968e00,
    2.938163982698783e00,
)
_TAIL_DOWN: Final = (
    7.784695709041462e-03,
    3.224671290700398e-01,
    2.445134137142996e00,
    3.754408661907416e00,
    1.0,
)
