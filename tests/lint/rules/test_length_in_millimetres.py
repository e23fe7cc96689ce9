from __future__ import annotations

from tests.lint.checking import body


def test_it_is_found():
    assert body("movel([400, 0, 0.3, 0, 0, 0])") == ["W231 2:10"]
    assert body("set_tcp([0, 0, 150, 0, 0, 0])") == ["W231 2:18"]
    assert body("set_payload(1, [0, 0, 50])") == ["W231 2:25"]
    assert body("movel(pose_trans([0, 0, 0, 0, 0, 0], [0, 0, 300, 0, 0, 0]))") == ["W231 2:9"]
    assert body("movel(get_actual_tcp_pose(), r=50)") == ["W231 2:34"]


def test_what_almost_is_one_is_not_found():
    assert body("x = pose_trans([400, 0, 0, 0, 0, 0], [0, 0, 300, 0, 0, 0])") == []
    assert body("set_tcp([0, 0, 1.1, 0, 0, 0])") == []
