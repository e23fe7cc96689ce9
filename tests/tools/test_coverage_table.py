"""The table of coverage, from a report written by hand."""

from __future__ import annotations

from typing import Any

import pytest

from tools.coverage_table import package_of, packages, ranges, table, uncovered


def entry(
    statements: int, ran: list[int], missing: list[int], branches: int, jumps: list[list[int]] | None = None
) -> dict[str, Any]:
    """What `coverage json` says of a file."""
    jumps = jumps or []
    return {
        "executed_lines": ran,
        "missing_lines": missing,
        "missing_branches": jumps,
        "summary": {
            "num_statements": statements,
            "covered_lines": len(ran),
            "num_branches": branches,
            "covered_branches": branches - len(jumps),
        },
    }


REPORT = {
    "files": {
        "src/elitescript/robot.py": entry(2, [1, 2], [], 0),
        "src/elitescript/motion/paths/cartesian.py": entry(6, [1, 2, 8], [4, 5, 7], 4, [[2, 4], [2, 8], [8, -1]]),
        "src/elitescript/motion/paths/zones.py": entry(4, [1, 2, 3, 4], [], 2),
    }
}


def test_files_are_counted_by_package() -> None:
    found = packages(REPORT)
    assert list(found) == ["motion", "."]
    motion = found["motion"]
    assert (motion.statements, motion.ran, motion.branches, motion.taken) == (10, 7, 6, 3)
    assert motion.percent == pytest.approx(100 * 10 / 16)
    assert found["."].percent == 100.0


def test_the_table_begins_with_the_worst_and_ends_with_the_whole() -> None:
    assert [line.split() for line in table(packages(REPORT))] == [
        ["package", "statements", "missed", "branches", "missed", "percent"],
        ["motion", "10", "3", "6", "3", "62.5"],
        [".", "2", "0", "0", "0", "100.0"],
        ["all", "12", "3", "6", "3", "66.7"],
    ]


def test_places_are_named_and_branches_of_lines_that_never_ran_are_not_named_twice() -> None:
    assert list(uncovered(packages(REPORT))) == ["", "motion", "  motion/paths/cartesian.py: 4-7, 2->8, 8->exit"]


@pytest.mark.parametrize(
    ("lines", "ran", "shown"),
    [
        ([], {1}, []),
        ([3], {1}, ["3"]),
        ([3, 4, 9], {1, 10}, ["3-9"]),
        ([3, 4, 9], {6}, ["3-4", "9"]),
    ],
)
def test_lines_that_cannot_run_do_not_end_a_range(lines: list[int], ran: set[int], shown: list[str]) -> None:
    assert list(ranges(lines, ran)) == shown


def test_a_file_beside_the_packages_has_a_row_with_its_like() -> None:
    assert package_of("src/elitescript/errors.py") == "."
    assert package_of("src/elitescript/devices/channels/faults.py") == "devices"
