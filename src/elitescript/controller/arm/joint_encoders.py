"""Measures joints: positions with noise, and speeds as differences over one period.

The noise of a tick is a function of seed, tick and joint alone, so the order and number of readings do not matter.
"""

from __future__ import annotations

from math import cos, log, pi, sin, sqrt
from typing import Final

from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.messages.timing import PERIOD_S

_WORD: Final = (1 << 64) - 1


class JointEncoders:
    """Six encoders with independent, normally distributed noise.

    Args:
        noise_rad: standard deviation; 0 for exact encoders.
        seed: of the noise.
    """

    __slots__ = ("_noise", "_noise_tick", "_seed", "is_exact", "noise_rad")

    def __init__(self, noise_rad: float = 0.0, seed: int = 0) -> None:
        self.noise_rad = noise_rad
        self.is_exact = noise_rad == 0.0
        self._seed = mixed(seed & _WORD)
        self._noise_tick = -2
        self._noise: Six = ZERO_SIX

    def read(self, tick: int, joints: JointState) -> JointState:
        """Return the joints of a tick with the measured positions and speeds as actual state: rad, rad/s."""
        if self.is_exact:
            return joints
        before, here = self.noise(tick - 1), self.noise(tick)
        a, b, c, d, e, f = [q + n for q, n in zip(joints.q_actual, here, strict=True)]
        g, h, i, j, k, m = [qd + (n - n0) / PERIOD_S for qd, n, n0 in zip(joints.qd_actual, here, before, strict=True)]
        return JointState(joints.q_target, joints.qd_target, (a, b, c, d, e, f), (g, h, i, j, k, m))

    def noise(self, tick: int) -> Six:
        """Return the error of each encoder at a tick, rad."""
        if tick == self._noise_tick:
            return self._noise
        word = mixed(self._seed ^ (tick & _WORD))
        values: list[float] = []
        for _ in range(3):
            # Two uniform numbers give two normal ones (Box and Muller 1958).
            word = mixed(word)
            radius = self.noise_rad * sqrt(-2.0 * log(((word >> 11) + 1) / (1 << 53)))
            word = mixed(word)
            angle = 2.0 * pi * (word >> 11) / (1 << 53)
            values += (radius * cos(angle), radius * sin(angle))
        a, b, c, d, e, f = values
        self._noise_tick, self._noise = tick, (a, b, c, d, e, f)
        return self._noise


def mixed(word: int) -> int:
    """Return the 64-bit hash of `word` (SplitMix64: Steele, Lea and Flood 2014)."""
    word = (word + 0x9E3779B97F4A7C15) & _WORD
    word = ((word ^ (word >> 30)) * 0xBF58476D1CE4E5B9) & _WORD
    word = ((word ^ (word >> 27)) * 0x94D049BB133111EB) & _WORD
    return word ^ (word >> 31)
