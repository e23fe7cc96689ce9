"""Points in programs, CSV and JSON."""

import pytest

from elitescript.audit.fit.pairs import points_of_file, points_of_program
from elitescript.errors import UsageError

Q = (0.1, -1.2, -1.5, -1.4, 1.5, 0.3)
P = (0.4, -0.1, 0.3, 3.1, 0.1, 1.5)
QS, PS = map(str, map(list, (Q, P)))


@pytest.mark.parametrize(
    "text",
    [
        f"movej(get_inverse_kin({PS}, qnear={QS}), v=1.0)",
        f"movej(get_inverse_kin({PS}, {QS}))",
        f"def f():\n  movej(get_inverse_kin(offset({PS}), qnear={QS}))\nend",
        f"pick = {PS}\nnear = {QS}\nmovej(get_inverse_kin(pick, qnear=near))",
        f"pick_p = {PS}\npick_q = {QS}",
        f"pick_pose = {PS}\npick_joints = {QS}",
        f"movej({QS}, a=1.4)  # pose {PS}",
        f"movej({QS})  # p{PS}",
    ],
)
def test_forms_of_points_in_programs(text):
    (point,) = points_of_program(text, "cell.script").points
    assert (point.q, point.pose) == (Q, P)
    assert point.tcp == (0.0,) * 6


@pytest.mark.parametrize(
    "text",
    [
        "movej(get_inverse_kin(pose, qnear=q))",
        f"movej({QS})",
        f"pick_p = {PS}\nplace_q = {QS}",
        f"near = {QS}\nnear = [1, 1, 1, 1, 1, 1]\nmovej(get_inverse_kin({PS}, qnear=near))",
        f"movej(get_inverse_kin({PS}, qnear=[a, 0, 0, 0, 0, 0]))",
    ],
)
def test_what_is_no_point(text):
    assert points_of_program(text, "cell.script").points == ()


def test_the_tcp_is_that_of_the_program_above_the_point():
    text = (
        f"set_tcp([0, 0, 0.1, 0, 0, 0])\na_p = {PS}\na_q = {QS}\nset_tcp([0, 0, 0.2, 0, 0, 0])\nb_p = {QS}\nb_q = {PS}"
    )
    points = points_of_program(text, "cell.script")
    assert [point.tcp[2] for point in points.points] == [0.1, 0.2]
    assert points.tcp_words == "the TCP offset is that of set_tcp in line 1, 4"
    given = points_of_program(text, "cell.script", (0.0, 0.0, 0.5, 0.0, 0.0, 0.0))
    assert given.points[0].tcp[2] == 0.5


def test_an_unknown_tcp_is_none():
    points = points_of_program(f"set_tcp(tool)\na_p = {PS}\na_q = {QS}", "cell.script")
    assert points.points[0].tcp is None
    assert "give --tcp" in points.tcp_words


def test_the_step_is_that_of_the_finest_number():
    points = points_of_file("0.1,0.25,0.375,1,2,3,0.1234,0.5,0.5,1,2,3.14159", "p.csv")
    assert (points.q_step, points.position_step, points.angle_step) == (1e-3, 1e-4, 1e-5)


def test_csv_and_json_are_the_same_points():
    row = ",".join(map(str, (*Q, *P)))
    head = "q1,q2,q3,q4,q5,q6,x,y,z,rx,ry,rz"
    (csv_point,) = points_of_file(f"{head}\n# taught today\n\n{row}\n", "p.csv").points
    (json_point,) = points_of_file(f'[{{"q": {QS}, "pose": {PS}, "tcp": [0, 0, 0.1, 0, 0, 0]}}]', "p.json").points
    assert (csv_point.q, csv_point.pose) == (json_point.q, json_point.pose) == (Q, P)
    assert json_point.tcp[2] == 0.1


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("p.csv", "1,2,3", "p.csv:1: has 3 numbers, needs twelve"),
        ("p.csv", "head\n1,x", "p.csv:2: needs twelve numbers"),
        ("p.csv", "nan,0,0,0,0,0,0,0,0,0,0,0", "needs six finite numbers"),
        ("p.csv", "90,0,0,0,0,0,0,0,0,0,0,0", "90 rad is more than two turns: joints are in rad"),
        ("p.json", "{", "p.json:1: not JSON"),
        ("p.json", "{}", "needs a list of"),
        ("p.json", "[1]", 'point 0: needs "q" and "pose"'),
        ("p.json", '[{"q": 1, "pose": []}]', "point 0: needs six finite numbers, has 1"),
    ],
)
def test_refusals_name_the_place(name, text, words):
    with pytest.raises(UsageError) as refused:
        points_of_file(text, name)
    assert words in str(refused.value)
