from __future__ import annotations

from tests.lint.checking import body, problems


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


BIN = "b = [0.4, 0.3, 0.2, 3.14, 0, -1.57]"


def test_one_list_that_goes_to_commands_as_both():
    assert body(BIN, "movel(b)", "movej(b)") == ["W237 4:9"]
    assert body(BIN, "movej(b)", "movel(b)", "movel(b)") == ["W237 3:9"]
    assert body(BIN, "q = b.copy()", "movel(q)", "q[2] = 0.3", "movej(q)") == ["W237 6:9"]
    text = problems(f"def job():\n  {BIN}\n  movel(b)\n  movej(b)\nend\n")[0].text
    assert text == "movej: q is a pose, where joint positions belong: in line 3 the same list goes to movel"


def test_a_choice_between_two_moves_is_none():
    move = ("def go(p, straight):", "  if straight:", "    movel(p)", "  else:", "    movej(p)", "  end", "end")
    assert body(*move, BIN, "go(b, get_flag(0))") == []
    buffer = ("b = [0] * 6", "for i in range(6):", "  b[i] = get_target_tcp_pose()[i]", "end", "movel(b)")
    assert body(*buffer, "b[:] = get_target_joint_positions()", "movej(b)") == []
    received = "b = socket_read_ascii_float(6)[1:]"
    assert "W237" not in [row.split()[0] for row in body(received, "movel(b)", "movej(b)")]


def test_degrees_in_a_transform_whose_result_is_a_target():
    frame = "tray = [0.4, -0.3, 0.1, 180, 0, 0]"
    assert body(frame, "part = pose_add(tray, [0.1, 0, 0, 0, 0, 0])", "movel(part)") == ["W230 3:19"]
    moved = ("def up(p):", "  return pose_trans(p, [0, 0, 0.1, 0, 0, 0])", "end")
    assert body(*moved, frame, "movel(up(pose_add(tray, [0.1, 0, 0, 0, 0, 0])))") == ["W230 6:21"]
    assert body(frame, "textmsg(pose_add(tray, [0.1, 0, 0, 0, 0, 0]))") == []
