"""The settings of the plant."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.messages.plant import PlantConfig


def test_the_default_is_a_perfect_arm() -> None:
    assert (PlantConfig().lag_s, PlantConfig().noise_rad) == (0.0, 0.0)


def test_a_table_names_what_the_class_names() -> None:
    table = {"lag_s": 0.02, "noise_rad": 1e-5, "coulomb_friction": 0.1, "viscous_friction": 0.05, "seed": 7}
    assert PlantConfig.from_table(table) == PlantConfig(0.02, 1e-5, 0.05, 0.1, seed=7)
    assert PlantConfig.from_table({"lag_s": 0}) == PlantConfig()


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"lag": 0.02}, r"^plant\.lag: unknown key \(known: lag_s, noise_rad, "),
        ({"lag_s": -0.1}, r"^plant: lag_s of the plant must be in \[0, 1\] s, got -0\.1"),
        ({"lag_s": 20}, r"in \[0, 1\] s, got 20"),
        ({"lag_s": 1e-5}, "lag_s of the plant must be 0 or at least 0.001 s, got 1e-05"),
        ({"noise_rad": "big"}, "noise_rad of the plant needs a number, has 'big'"),
        ({"noise_rad": float("nan")}, "needs a number, has nan"),
        ({"coulomb_friction": True}, "needs a number, has True"),
        ({"seed": 1.5}, r"seed of the plant needs a whole number, has 1\.5"),
    ],
)
def test_what_makes_no_sense_is_refused(table: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        PlantConfig.from_table(table)
