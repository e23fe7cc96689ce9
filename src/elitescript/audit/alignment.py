"""Finds which marks of two runs belong together: a diff of what happened, not of when.

A mark is a change of the program's line, an edge of an output, or, of a run without lines, a standstill. Times play no
part: a move that takes twice as long stays the same move, and a pass of a loop that one run makes and the other does
not is an insertion.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Final

from elitescript.records import NamedTuple

DISTANCE_MAX: Final = 400
"""Insertions and deletions up to which a stretch of the diff is the shortest one; from there on the furthest is taken,
so that two hours without anything in common take seconds."""

_WINDOW: Final = 1000
"""Marks that a follower looks ahead."""


class Match(NamedTuple):
    """Marks that belong together, by their places in both runs."""

    first: int
    second: int


def matched(
    first: Sequence[Hashable], second: Sequence[Hashable], *, has_begin: bool = True, has_end: bool = True
) -> list[Match]:
    """Return the pairs of a longest common subsequence, in order.

    Where several are as long, as with one more pass of a loop, it is the one that stays together longest from the begin
    on: two runs of a program are the same until they part.

    It is found with Myers' greedy algorithm, in a time of the length and the number of differences. Beyond
    `DISTANCE_MAX` differences in one place the subsequence is a common one, but perhaps not the longest.

    Args:
        first: marks of one run.
        second: marks of the other.
        has_begin: whether both are there from their begin on; else it is the one that is together longest up to the
            end.
        has_end: whether both are over. If they go on, the last marks of one need not be the last of the other.
    """
    numbers: dict[Hashable, int] = {}
    a = [numbers.setdefault(mark, len(numbers)) for mark in first]
    b = [numbers.setdefault(mark, len(numbers)) for mark in second]
    least = min(len(a), len(b))
    begin = end = 0
    while has_begin and begin < least and a[begin] == b[begin]:
        begin += 1
    while has_end and end < least - begin and a[len(a) - 1 - end] == b[len(b) - 1 - end]:
        end += 1
    x_end, y_end = len(a) - end, len(b) - end
    found = [Match(place, place) for place in range(begin)]
    x = y = begin
    while x < x_end and y < y_end:
        pairs, x, y = _leg(a, b, x, y, x_end, y_end)
        found += pairs
    found += [Match(x_end + place, y_end + place) for place in range(end)]
    return found


def _leg(a: list[int], b: list[int], x0: int, y0: int, x_end: int, y_end: int) -> tuple[list[Match], int, int]:
    """Return pairs from a place on, and the place that they lead to: the end, or where the distance is too large."""
    n, m = x_end - x0, y_end - y0
    reach = {1: 0}
    """For each diagonal, x minus y, the furthest x on it."""
    history: list[dict[int, int]] = []
    for distance in range(min(n + m, DISTANCE_MAX) + 1):
        history.append(dict(reach) if distance else {})
        for diagonal in range(-distance, distance + 1, 2):
            is_down = diagonal == -distance or (
                diagonal != distance and reach.get(diagonal - 1, -1) < reach.get(diagonal + 1, -1)
            )
            x = reach.get(diagonal + 1, 0) if is_down else reach.get(diagonal - 1, 0) + 1
            y = x - diagonal
            while x < n and y < m and a[x0 + x] == b[y0 + y]:
                x += 1
                y += 1
            reach[diagonal] = x
            if x >= n and y >= m:
                return _walked_back(history, x, y, x0, y0), x_end, y_end
    # The furthest place of all that lies within both.
    x, y = max(
        ((x, x - diagonal) for diagonal, x in reach.items() if 0 <= x <= n and 0 <= x - diagonal <= m),
        key=sum,
        default=(n, m),
    )
    return _walked_back(history, x, y, x0, y0), x0 + x, y0 + y


def _walked_back(history: list[dict[int, int]], x: int, y: int, x0: int, y0: int) -> list[Match]:
    """Return the pairs on the way to a place, from what each distance had reached before it."""
    pairs: list[Match] = []
    # A place that is not on the last distance's diagonals was reached with one step less.
    distance = len(history) - 1
    if (x - y - distance) % 2:
        distance -= 1
    for step in range(distance, 0, -1):
        reach = history[step]
        diagonal = x - y
        is_down = diagonal == -step or (diagonal != step and reach.get(diagonal - 1, -1) < reach.get(diagonal + 1, -1))
        before = diagonal + 1 if is_down else diagonal - 1
        x_before = reach.get(before, 0)
        y_before = x_before - before
        x_from = x_before if is_down else x_before + 1
        while x > x_from:
            x -= 1
            y -= 1
            pairs.append(Match(x0 + x, y0 + y))
        x, y = x_before, y_before
    while x > 0 and y > 0:
        x -= 1
        y -= 1
        pairs.append(Match(x0 + x, y0 + y))
    pairs.reverse()
    return pairs


class Follower:
    """Follows a run along the marks of another one while it goes on.

    Marks that the other run has more, or that this one has more, are passed over once what follows fits again: the more
    marks of this run did not fit, the further ahead a fit is believed.

    Args:
        marks: of the run that is followed; it may grow meanwhile.

    Attributes:
        place: index of the last mark of `marks` that this run has made as well; -1 before the first.
    """

    __slots__ = ("_marks", "_missed", "place")

    def __init__(self, marks: Sequence[Hashable]) -> None:
        self._marks = marks
        self._missed = 0
        self.place = -1

    def take(self, mark: Hashable) -> bool:
        """Take the next mark of this run; return whether it is one of the other run, which is `place` then."""
        marks, begin = self._marks, self.place + 1
        # Twice as far: what fits moves ahead with every mark that did not.
        ahead = min(2 * self._missed + 2, _WINDOW)
        for place in range(begin, min(begin + ahead, len(marks))):
            if marks[place] == mark:
                self.place, self._missed = place, 0
                return True
        self._missed += 1
        return False
