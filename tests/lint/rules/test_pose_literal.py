from __future__ import annotations

from tests.lint.checking import body, marked, repaired

TEXT = "def job():\n  target = p[0.4, 0, 0.3, 0, 3.14, 0]\nend\n"


def test_a_pose_of_urscript_is_found():
    assert body("movel(p[0.4, 0, 0.3, 0, 3.14, 0])") == ["W211 2:9"]
    assert marked(TEXT) == "p[0.4, 0, 0.3, 0, 3.14, 0]"


def test_the_fix_makes_it_a_list():
    assert repaired(TEXT) == "def job():\n  target = [0.4, 0, 0.3, 0, 3.14, 0]\nend\n"


def test_six_numbers_are_a_pose_also_when_there_is_a_variable_p():
    assert body("p = get_target_tcp_pose()", "movel(p[0.4, 0, 0.3, 0, 3.14, 0])") == ["W211 3:9"]


def test_an_element_of_a_variable_p_is_none():
    assert body("p = get_target_tcp_pose()", "p[2] = p[2] + 0.1", "movel(p)", "textmsg(p[1:3])") == []


def test_an_element_of_an_unknown_p_is_an_unknown_name():
    assert body("textmsg(p[0])") == ["W201 2:11"]
