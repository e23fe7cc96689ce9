from __future__ import annotations

import pytest

from elitescript.language.advice.unknown_names import nearest

NAMES = ["movej", "movel", "set_standard_digital_out", "get_standard_digital_in", "textmsg", "sleep"]


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("textmgs", "textmsg"),
        ("TextMsg", "textmsg"),
        ("set_standard_digital_output", "set_standard_digital_out"),
        ("get_standart_digital_in", "get_standard_digital_in"),
        ("slep", "sleep"),
    ],
)
def test_a_slip_is_recognised(name, meant):
    assert nearest(name, NAMES) == meant


@pytest.mark.parametrize("name", ["grip", "open_gripper", "x", "mv", "standard"])
def test_another_word_is_no_slip(name):
    assert nearest(name, NAMES) == ""


def test_the_order_of_the_candidates_does_not_matter():
    assert nearest("movex", NAMES) == nearest("movex", reversed(NAMES))
