from __future__ import annotations

from tests.lint.checking import body


def test_it_is_found():
    assert body("movej([0, -90, 90, 0, 90, 0])") == ["W230 2:13"]
    assert body("rx = 180", "movel([0.4, 0, 0.3, rx, 0, 0])") == ["W230 3:23"]


def test_what_almost_is_one_is_not_found():
    assert body("movej([0, d2r(-90), 6.28, 0, 1.57, 0])") == []
    assert body("movel([0.4, 0, 0.3, 6.9, 9.42478, 0])") == []
