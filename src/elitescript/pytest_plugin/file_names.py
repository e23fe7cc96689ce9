"""Names of program files, of those that hold tests in the language, and of cases of sweeps."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import Final

TEST_FILES: Final = ("test_*.script", "*_test.script")
"""Files whose functions `test_...` are collected without being named on the command line."""


def holds_tests(name: str) -> bool:
    """Return whether a file is one of tests, by its name."""
    return any(fnmatchcase(name.lower(), pattern) for pattern in TEST_FILES)


CASE_FILES: Final = ("CASE.toml", "*.case.toml")
"""Files that are one test each; `sweep.failures.cases` gives them these names."""


def is_case(name: str) -> bool:
    """Return whether a file is a case of a sweep, by its name."""
    return any(fnmatchcase(name, pattern) for pattern in CASE_FILES)
