"""How many robots a computer holds."""

from __future__ import annotations

import pytest

from elitescript.services.capacity import Capacity, own_capacity


@pytest.mark.parametrize(
    ("capacity", "text"),
    [
        (
            Capacity(3, 2, is_in_process=False),
            "2 cores hold about 10 robots with a client at 250 Hz each, 7 if all arms move",
        ),
        (
            Capacity(5, 1, is_in_process=False),
            "1 core holds about 5 robots with a client at 250 Hz each, 3 if all arms move",
        ),
        (
            Capacity(20, 8, is_in_process=True),
            "one process holds about 20 robots with a client at 250 Hz each, 11 if all arms move",
        ),
        (
            Capacity(12, 2, is_in_process=False),
            "2 cores hold about 10 robots with a client at 250 Hz each, 7 if all arms move; of 12 packages will come "
            "late and robot time will be left out. --in-process holds about 20, without a jail: for programs that you "
            "trust",
        ),
        (
            Capacity(32, 4, is_in_process=False),
            "4 cores hold about 20 robots with a client at 250 Hz each, 14 if all arms move; of 32 packages will come "
            "late and robot time will be left out",
        ),
    ],
)
def test_it_is_the_cores_times_what_one_holds(capacity: Capacity, text: str) -> None:
    assert str(capacity) == text


def test_this_computer_has_a_core() -> None:
    assert own_capacity(1, is_in_process=False).held >= 5
    assert own_capacity(1, is_in_process=True).held == 20
