from __future__ import annotations

from tests.lint.checking import body


def test_it_is_found():
    assert body("set_standard_analog_out(0, 24)") == ["W234 2:30"]


def test_what_almost_is_one_is_not_found():
    assert body("set_standard_analog_out(0, 1)") == []
