"""Statistics of samples in plain Python: intervals of shares, tests of ranks, tails of distributions.

Sources: E. B. Wilson, JASA 22 (1927) for the interval; Kruskal and Wallis, JASA 47 (1952) with their correction for
ties; the incomplete gamma function as series and continued fraction (Abramowitz and Stegun 6.5.29 and 6.5.31).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Final

from elitescript.records import NamedTuple

_Z: Final = 1.959963984540054
"""Half width of 95 % of the normal distribution."""


class Difference(NamedTuple):
    """Outcome of a test.

    Attributes:
        p: probability of at least such a difference if there were none.
        share: of the variance of the ranks that the groups explain, 0 to 1.
    """

    p: float
    share: float


def share_interval(count: int, of: int) -> tuple[float, float]:
    """Return the 95 % interval of a probability: Wilson's; with a count of 0 it ends at 3 / n."""
    if of == 0:
        return 0.0, 1.0
    if count == 0:
        return 0.0, min(1.0, 3.0 / of)
    if count == of:
        return max(0.0, 1.0 - 3.0 / of), 1.0
    share = count / of
    middle = share + _Z * _Z / (2 * of)
    half = _Z * math.sqrt(share * (1 - share) / of + _Z * _Z / (4 * of * of))
    scale = 1 + _Z * _Z / of
    return (middle - half) / scale, (middle + half) / scale


def chi_squared_tail(x: float, degrees: int) -> float:
    """Return the probability that chi squared with `degrees` degrees of freedom is at least `x`."""
    a, half = degrees / 2.0, x / 2.0
    if half <= 0.0:
        return 1.0
    front = math.exp(a * math.log(half) - half - math.lgamma(a))
    if half < a + 1.0:
        term = total = 1.0 / a
        n = a
        while abs(term) > abs(total) * 1e-15:
            n += 1.0
            term *= half / n
            total += term
        return max(0.0, 1.0 - front * total)
    # Continued fraction, by the modified method of Lentz.
    b = half + 1.0 - a
    c, d = 1e300, 1.0 / b
    fraction = d
    for i in range(1, 1000):
        step = -i * (i - a)
        b += 2.0
        d = 1.0 / (step * d + b)
        c = b + step / c
        fraction *= c * d
        if abs(c * d - 1.0) < 1e-15:
            break
    return front * fraction


def ranks(values: Sequence[float]) -> list[float]:
    """Return the rank of each value, from 1; equal values share the mean of their ranks."""
    order = sorted(range(len(values)), key=values.__getitem__)
    found = [0.0] * len(values)
    begin = 0
    while begin < len(order):
        end = begin + 1
        while end < len(order) and values[order[end]] == values[order[begin]]:
            end += 1
        for place in order[begin:end]:
            found[place] = (begin + 1 + end) / 2.0
        begin = end
    return found


def rank_correlation(first: Sequence[float], second: Sequence[float]) -> float:
    """Return Spearman's coefficient from ranks; 0 if one of them is constant."""
    n = len(first)
    mean = (n + 1) / 2.0
    xy = math.fsum((a - mean) * (b - mean) for a, b in zip(first, second, strict=True))
    xx = math.fsum((a - mean) ** 2 for a in first)
    yy = math.fsum((b - mean) ** 2 for b in second)
    return xy / math.sqrt(xx * yy) if xx > 0.0 and yy > 0.0 else 0.0


def groups_differ(groups: Sequence[int], ranked: Sequence[float]) -> Difference:
    """Test whether the values of groups differ: Kruskal and Wallis, with the correction for ties.

    Args:
        groups: number of the group of each value.
        ranked: rank of each value.
    """
    n = len(ranked)
    sums: dict[int, float] = {}
    counts = Counter(groups)
    for group, rank in zip(groups, ranked, strict=True):
        sums[group] = sums.get(group, 0.0) + rank
    tied = sum(count**3 - count for count in Counter(ranked).values())
    ties = 1.0 - tied / (n**3 - n) if n > 1 else 0.0
    if len(counts) < 2 or ties <= 0.0:
        return Difference(1.0, 0.0)
    between = math.fsum(total * total / counts[group] for group, total in sums.items())
    h = max(0.0, (12.0 / (n * (n + 1.0)) * between - 3.0 * (n + 1.0)) / ties)
    return Difference(chi_squared_tail(h, len(counts) - 1), min(1.0, h / (n - 1.0)))


def at_least_so_many(hits: int, drawn: int, good: int, of: int) -> float:
    """Return the probability that of `drawn` from `of`, of which `good` are good, at least `hits` are good.

    It is the one-sided exact test of Fisher.
    """
    most = min(drawn, good)
    total = _log_choose(of, drawn)
    terms = [
        math.exp(_log_choose(good, count) + _log_choose(of - good, drawn - count) - total)
        for count in range(max(hits, drawn - (of - good)), most + 1)
    ]
    return min(1.0, math.fsum(terms))


def _log_choose(n: int, k: int) -> float:
    return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)
