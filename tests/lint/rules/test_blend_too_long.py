from __future__ import annotations

from tests.lint.checking import body


def test_it_is_found():
    assert body("movel([0.4, 0, 0.30, 3.14, 0, 0])", "movel([0.4, 0, 0.34, 3.14, 0, 0], r=0.05)") == ["W235 3:39"]


def test_what_almost_is_one_is_not_found():
    assert body("movel([0.4, 0, 0.30, 3.14, 0, 0])", "movel([0.4, 0, 0.40, 3.14, 0, 0], r=0.05)") == []
    assert (
        body(
            "movel([0.4, 0, 0.30, 3.14, 0, 0])",
            "movel(get_actual_tcp_pose())",
            "movel([0.4, 0, 0.34, 3.14, 0, 0], r=0.05)",
        )
        == []
    )
