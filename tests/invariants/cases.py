"""How many cases a sweep tries: as many as `ELITESCRIPT_INVARIANTS` says, else few enough for `make test`."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, Final

import pytest

CASES: Final = int(os.environ.get("ELITESCRIPT_INVARIANTS", "10"))


def first_of(values: Iterable[Any], count: int) -> list[Any]:
    """Return parameters of a test of which `make test` takes the first ones alone, and `make invariants` all."""
    return [
        value if place < count else pytest.param(value, marks=pytest.mark.slow) for place, value in enumerate(values)
    ]
