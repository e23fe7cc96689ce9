from __future__ import annotations

from tests.lint.checking import body


def test_it_is_found():
    assert body("movej(get_actual_tcp_pose())") == ["W237 2:9"]
    assert body("h = get_actual_joint_positions()", "movel(h)") == ["W237 3:9"]
    assert body("p = get_actual_tcp_pose()", "p[2] = p[2] + 0.1", "movej(p)") == ["W237 4:9"]
    assert body("p = get_actual_tcp_pose()", "q = p.copy()", "movej(q)") == ["W237 4:9"]
    assert body("movej(get_target_joint_speeds())") == ["W237 2:9"]
    assert body("speedl(get_actual_joint_speeds(), 0.1, 1)") == ["W237 2:10"]


def test_a_misspelt_command_hides_no_other_mistake():
    assert body("q = get_actual_joint_positions()", "movejj(q)", "movel(q)") == ["E301 3:3", "W237 4:9"]


def test_what_almost_is_one_is_not_found():
    assert body("movej(get_inverse_kin(get_actual_tcp_pose()))") == []
    assert body("p = get_actual_tcp_pose()", "p = get_actual_joint_positions()", "movej(p)") == []
    assert body("p = get_actual_tcp_pose()", "for i in range(6):", "  p[i] = 0", "end", "movej(p)") == []
