from __future__ import annotations

from tests.lint.checking import body


def test_it_is_found():
    assert body("movej([0, 0, 0, 0, 0, 0], a=80, v=60)") == ["W232 2:31", "W232 2:37"]
    assert body("speedl([100, 0, 0, 0, 0, 0], 1, 1)") == ["W232 2:11"]
    assert body("stopj(500)") == ["W232 2:9"]


def test_what_almost_is_one_is_not_found():
    assert body("movej([0, 0, 0, 0, 0, 0], a=40, v=3.14)", "stopl(40)") == []
