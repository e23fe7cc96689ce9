from __future__ import annotations

from tests.lint.checking import body


def test_it_is_found():
    assert body("set_payload(500, [0, 0, 0])") == ["W233 2:15"]


def test_what_almost_is_one_is_not_found():
    assert body("set_payload(25, [0, 0, 0])") == []
