"""Settings for every test."""

from __future__ import annotations

import gc

import pytest
from hypothesis import settings

pytest_plugins = ["pytester", "tests.findings", "tests.specification.plugin"]

# The same examples in every run, on every machine; a shared machine is no reason to fail.
settings.register_profile("elitescript", derandomize=True, deadline=None, database=None)
settings.load_profile("elitescript")


def pytest_collection_finish(session: pytest.Session) -> None:
    """Take what the session has collected from the garbage collector, which would go through all of it again and again.

    That is half a million objects: a collection took 350 ms, and some tests begin a dozen.
    """
    gc.collect()
    gc.freeze()
