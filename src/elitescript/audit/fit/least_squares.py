"""Weighted linear least squares in plain Python: Householder QR, then singular values of the triangle.

A few unknowns and up to some thousands of equations. The triangle has the singular values of the whole system, so what
the data does not determine is found in a small matrix (one-sided Jacobi, Demmel and Veselić 1992: also small singular
values are exact relative to their size).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, exp, hypot, inf, lgamma, log, sqrt
from statistics import NormalDist
from typing import Final

from elitescript.records import record

RELATIVE_FLOOR: Final = 1e-13
"""A direction whose singular value is below this share of the largest is rounding alone."""

MAX_SWEEPS: Final = 60


@record
class Direction:
    """One direction in the space of the unknowns.

    Attributes:
        vector: unit vector, one component for each unknown.
        sigma: standard deviation of the unknowns along it; infinite if the data says nothing.
    """

    vector: tuple[float, ...]
    sigma: float


@record
class Solution:
    """Unknowns of a linear system and how well they are known.

    Attributes:
        values: estimate of each unknown; directions that the data says nothing of are left at 0.
        directions: orthogonal directions, the best known first.
        chi_square: sum of the squares of the weighted residuals.
        freedom: equations beyond the number of directions that are determined.
        residuals: weighted residual of each equation.
    """

    values: tuple[float, ...]
    directions: tuple[Direction, ...]
    chi_square: float
    freedom: int
    residuals: tuple[float, ...]

    def sigma(self, weights: Sequence[float]) -> float:
        """Return the standard deviation of a linear combination of the unknowns, for equations of sigma 1."""
        total = 0.0
        for direction in self.directions:
            share = sum(w * v for w, v in zip(weights, direction.vector, strict=True))
            if direction.sigma == inf:
                if abs(share) > 1e-9:
                    return inf
                continue
            total += (share * direction.sigma) ** 2
        return sqrt(total)

    def sigma_of(self, index: int) -> float:
        """Return the standard deviation of one unknown, for equations of sigma 1."""
        return self.sigma([1.0 if index == other else 0.0 for other in range(len(self.values))])


def solve(rows: Sequence[Sequence[float]], values: Sequence[float]) -> Solution:
    """Solve an overdetermined system for the least sum of squares.

    Args:
        rows: coefficients of each equation, divided by the standard deviation of its value.
        values: of each equation, divided likewise.
    """
    count = len(rows[0])
    R, c, _ = _triangle(rows, values, count)
    U, singular, V = _singular(R)
    largest = max(singular, default=0.0)
    order = sorted(range(count), key=lambda k: -singular[k])
    found = [0.0] * count
    directions = []
    rank = 0
    for k in order:
        if singular[k] <= RELATIVE_FLOOR * largest or singular[k] == 0.0:
            directions.append(Direction(tuple(V[k]), inf))
            continue
        rank += 1
        share = sum(U[k][i] * c[i] for i in range(count)) / singular[k]
        for i in range(count):
            found[i] += share * V[k][i]
        directions.append(Direction(tuple(V[k]), 1.0 / singular[k]))
    residuals = tuple(
        value - sum(a * x for a, x in zip(row, found, strict=True)) for row, value in zip(rows, values, strict=True)
    )
    return Solution(tuple(found), tuple(directions), sum(r * r for r in residuals), max(0, len(rows) - rank), residuals)


def _triangle(
    rows: Sequence[Sequence[float]], values: Sequence[float], count: int
) -> tuple[list[list[float]], list[float], float]:
    """Return the upper triangle R, the first entries of Q^T b, and the norm of the rest (Householder)."""
    A = [[*row, value] for row, value in zip(rows, values, strict=True)]
    A.extend([0.0] * (count + 1) for _ in range(count - len(A)))
    for k in range(count):
        norm = _norm([row[k] for row in A[k:]])
        if norm == 0.0:
            continue
        alpha = -copysign(norm, A[k][k])
        v = [row[k] for row in A[k:]]
        v[0] -= alpha
        square = sum(x * x for x in v)
        if square == 0.0:
            continue
        for j in range(k, count + 1):
            factor = 2.0 * sum(x * row[j] for x, row in zip(v, A[k:], strict=True)) / square
            for x, row in zip(v, A[k:], strict=True):
                row[j] -= factor * x
    R = [[A[i][j] if j >= i else 0.0 for j in range(count)] for i in range(count)]
    return R, [A[i][count] for i in range(count)], _norm([row[count] for row in A[count:]])


def _norm(values: Sequence[float]) -> float:
    return hypot(*values)


def _singular(R: list[list[float]]) -> tuple[list[list[float]], list[float], list[list[float]]]:
    """Return left vectors, singular values and right vectors of a square matrix, as lists of vectors."""
    count = len(R)
    columns = [[R[i][j] for i in range(count)] for j in range(count)]
    V = [[1.0 if i == j else 0.0 for i in range(count)] for j in range(count)]
    for _ in range(MAX_SWEEPS):
        is_done = True
        for p in range(count - 1):
            for q in range(p + 1, count):
                a, b = columns[p], columns[q]
                aa, bb = sum(x * x for x in a), sum(x * x for x in b)
                ab = sum(x * y for x, y in zip(a, b, strict=True))
                if abs(ab) <= 1e-15 * sqrt(aa * bb):
                    continue
                is_done = False
                zeta = (bb - aa) / (2.0 * ab)
                t = copysign(1.0, zeta) / (abs(zeta) + hypot(1.0, zeta))
                cosine = 1.0 / hypot(1.0, t)
                sine = cosine * t
                for pair in (columns, V):
                    left, right = pair[p], pair[q]
                    pair[p] = [cosine * x - sine * y for x, y in zip(left, right, strict=True)]
                    pair[q] = [sine * x + cosine * y for x, y in zip(left, right, strict=True)]
        if is_done:
            break
    singular = [_norm(column) for column in columns]
    U = [[x / s for x in column] if s > 0.0 else [0.0] * count for column, s in zip(columns, singular, strict=True)]
    return U, singular, V


# ---------------------------------------------------------------- quantiles


NORMAL_95: Final = 1.959963984540054
"""Half width of a 95 % interval of a normal distribution with sigma 1."""


def student_quantile(freedom: int, confidence: float = 0.95) -> float:
    """Return the half width of a two-sided interval of Student's distribution.

    Args:
        freedom: degrees of freedom, at least 1.
        confidence: probability inside.
    """
    # Bisection of the distribution: calls are rare, and every approximation has its bad corner at few degrees.
    low, high = 0.0, 1e4
    for _ in range(200):
        middle = 0.5 * (low + high)
        if _student_inside(middle, freedom) < confidence:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _student_inside(t: float, freedom: int) -> float:
    """Return the probability of [-t, t]: the regularised incomplete beta function."""
    return 1.0 - _incomplete_beta(freedom / 2.0, 0.5, freedom / (freedom + t * t))


def _incomplete_beta(a: float, b: float, x: float) -> float:
    if x <= 0.0:
        return 0.0
    if x >= 1.0:
        return 1.0
    front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log(1.0 - x))
    if x < (a + 1.0) / (a + b + 2.0):
        return front * _fraction(a, b, x) / a
    return 1.0 - front * _fraction(b, a, 1.0 - x) / b


def _fraction(a: float, b: float, x: float) -> float:
    """Return the continued fraction of the incomplete beta function (Lentz)."""
    tiny = 1e-300
    c, d = 1.0, 1.0 - (a + b) * x / (a + 1.0)
    d = 1.0 / (d if abs(d) > tiny else tiny)
    value, change = d, 0.0
    for m in range(1, 300):
        for factor in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1.0 + factor * d
            d = 1.0 / (d if abs(d) > tiny else tiny)
            c = 1.0 + factor / c
            c = c if abs(c) > tiny else tiny
            change = c * d
            value *= change
        if abs(change - 1.0) < 1e-15:
            break
    return value


def chi_square_quantile(freedom: int, probability: float) -> float:
    """Return the quantile of the chi-square distribution (Wilson and Hilferty 1931; within 1 % from 3 degrees on)."""
    z = NormalDist().inv_cdf(probability)
    term = 2.0 / (9.0 * freedom)
    return freedom * max(0.0, 1.0 - term + z * sqrt(term)) ** 3
