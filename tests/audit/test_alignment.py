"""Marks of two runs that belong together."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest

from elitescript.audit.alignment import DISTANCE_MAX, Follower, matched


def common(a, b):
    """Length of a longest common subsequence, by the table that every textbook has."""
    row = [0] * (len(b) + 1)
    for x in a:
        corner = 0
        for place, y in enumerate(b, 1):
            corner, row[place] = row[place], corner + 1 if x == y else max(row[place], row[place - 1])
    return row[-1]


class TestMatched:
    @pytest.mark.parametrize(
        ("first", "second", "pairs"),
        [
            ("", "", []),
            ("abc", "", []),
            ("", "abc", []),
            ("abc", "abc", [(0, 0), (1, 1), (2, 2)]),
            ("abc", "abxc", [(0, 0), (1, 1), (2, 3)]),
            ("abxc", "abc", [(0, 0), (1, 1), (3, 2)]),
            ("abc", "xyz", []),
            ("abc", "axc", [(0, 0), (2, 2)]),
            ("xab", "ab", [(1, 0), (2, 1)]),
            ("ab", "abx", [(0, 0), (1, 1)]),
        ],
    )
    def test_small_ones(self, first, second, pairs):
        assert matched(first, second) == pairs

    def test_one_more_pass_of_a_loop_is_an_insertion(self):
        once = list("habcdhabcdz")
        twice = list("habcdhabcdhabcdz")
        pairs = matched(once, twice)
        assert [pair.first for pair in pairs] == list(range(len(once)))
        missing = sorted(set(range(len(twice))) - {pair.second for pair in pairs})
        # As a program that ran on: the pass behind those in common.
        assert missing == list(range(10, 15))
        # Of a recording that began in the middle it is one of the passes before.
        begun = matched(twice[5:], twice, has_begin=False)
        assert [pair.second for pair in begun] == list(range(5, len(twice)))

    def test_random_ones_are_as_long_as_possible(self):
        draw = random.Random(3)
        for _ in range(300):
            a = [draw.randrange(4) for _ in range(draw.randrange(14))]
            b = [draw.randrange(4) for _ in range(draw.randrange(14))]
            pairs = matched(a, b)
            assert all(a[x] == b[y] for x, y in pairs)
            assert all(x < u and y < v for (x, y), (u, v) in pairwise(pairs))
            assert len(pairs) == common(a, b), (a, b)

    def test_beyond_the_largest_distance_what_is_common_at_both_ends_is_still_found(self):
        a = [*range(50), *range(1000, 1000 + 2 * DISTANCE_MAX), *range(50, 100)]
        b = [*range(50), *range(5000, 5000 + 3 * DISTANCE_MAX), *range(50, 100)]
        assert [a[x] for x, _ in matched(a, b)] == list(range(100))

    def test_an_hour_of_marks_is_matched_without_comparing_each_with_each(self):
        """Ten thousand million comparisons would not end within the time of a test."""
        draw = random.Random(5)
        cycle = list(range(25))
        a = cycle * 4000
        b = [mark for mark in a if draw.random() > 0.001]
        assert len(matched(a, b)) == len(b)


class TestFollower:
    def follow(self, marks, run):
        follower = Follower(marks)
        return [follower.place if follower.take(mark) else None for mark in run]

    @pytest.mark.parametrize(
        ("marks", "run", "places"),
        [
            ("abcd", "abcd", [0, 1, 2, 3]),
            # A mark that the other run does not have, such as a line in a lost package.
            ("abdabcd", "abcdabcd", [0, 1, None, 2, 3, 4, 5, 6]),
            # A mark that this run does not have.
            ("abcd", "abd", [0, 1, 3]),
            # One pass more in the other run: found again after as many marks as it has.
            ("abcabcabcxyzuvw", "abcabcxyzuvw", [0, 1, 2, 3, 4, 5, None, None, 11, 12, 13, 14]),
            # One pass more in this run.
            ("abcdxyz", "abcdabcdxyz", [0, 1, 2, 3, None, None, None, None, 4, 5, 6]),
        ],
    )
    def test_places(self, marks, run, places):
        assert self.follow(list(marks), list(run)) == places

    def test_marks_may_come_while_it_follows(self):
        marks = ["a"]
        follower = Follower(marks)
        assert follower.take("a")
        marks.append("b")
        assert follower.take("b")
        assert follower.place == 1
