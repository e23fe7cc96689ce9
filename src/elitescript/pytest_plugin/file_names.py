"""Names of program files, and of those that hold tests in the language."""

from __future__ import annotations

from fnmatch import fnmatch
from typing import Final

SUFFIX: Final = ".script"

TEST_FILES: Final = ("test_*.script", "*_test.script")
"""Files whose functions `test_...` are collected without being named on the command line."""


def holds_tests(name: str) -> bool:
    """Return whether a file is one of tests, by its name."""
    return any(fnmatch(name, pattern) for pattern in TEST_FILES)
