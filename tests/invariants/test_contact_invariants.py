"""Contacts and closest distances are those of looking at every pair in every control period."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.invariants.cases import CASES
from tests.solids.every_tick import compare


@pytest.mark.invariants
@pytest.mark.slow
@pytest.mark.parametrize("seed", range(CASES))
def test_contacts_are_those_of_every_tick(seed: int, tmp_path: Path) -> None:
    compare(seed, tmp_path)
