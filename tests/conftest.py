"""Settings for every test."""

from __future__ import annotations

import gc
from itertools import count

from hypothesis import settings

pytest_plugins = ["pytester", "tests.findings", "tests.sound_values", "tests.specification.plugin"]

# The same examples in every run, on every machine; a shared machine is no reason to fail.
settings.register_profile("elitescript", derandomize=True, deadline=None, database=None)
settings.load_profile("elitescript")


# What the session has collected and reported is a million objects in the end. The garbage collector would go through
# all of them again and again, 350 ms each time, and some tests have it do so a dozen times.
FROZEN_EACH = 1000
"""Tests after which what is left of them is taken from the garbage collector."""

_finished = count(1)


def pytest_collection_finish() -> None:
    """Take what has been collected from the garbage collector."""
    freeze()


def pytest_runtest_logfinish() -> None:
    """Take what has been reported from it too, now and then."""
    if next(_finished) % FROZEN_EACH == 0:
        freeze()


def freeze() -> None:
    gc.collect()
    gc.freeze()
