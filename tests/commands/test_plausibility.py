from __future__ import annotations

import pytest

from elitescript.commands.definition.plausibility import JUDGES, PAYLOAD_MOST_KG, mistaken
from elitescript.errors import MotionError
from elitescript.models.model import load_model, model_names


def codes(meaning, value, arm=None):
    return [(doubt.code, doubt.element) for doubt in JUDGES[meaning](value, arm)]


@pytest.mark.parametrize(
    ("meaning", "value", "expected"),
    [
        ("joints", [0, -90, 90, 0, 90, 0], [("W230", 1)]),
        ("joints", [0, 0, 0, 0, 0, 7], [("W230", 5)]),
        ("joints", [6.29, -6.28, 1.57, -3.14, 0, 2], []),
        ("joints", [6.98132, 0, 0, 0, 0, 0], []),
        ("pose", [0.4, -0.2, 0.3, 180, 0, 90], [("W230", 3)]),
        ("pose", [400, -200, 300, 0, 180, 0], [("W231", 0), ("W230", 4)]),
        ("pose", [2.4, -1.2, 1.3, 6.2832, -6.9, 9.42478], []),
        ("pose", [0, -1.57, -1.5708, -1.57, 1.57, 0], [("W237", None)]),
        ("pose", [0.785, -1.57, 0.3, 0, 0, 0], []),
        ("tcp", [0, 0, 120, 0, 0, 0], [("W231", 2)]),
        ("tcp", [0, 0, 1.2, 0, 0, 1.57], []),
        ("centre of gravity", [0, 0, 60], [("W231", 2)]),
        ("centre of gravity", [0, 0.1, 0.6], []),
        ("joint speed", 60, [("W232", None)]),
        ("joint speed", 6.28, []),
        ("joint acceleration", 80, [("W232", None)]),
        ("joint acceleration", 40, []),
        ("joint speeds", [0, 0, -30, 0, 0, 0], [("W232", 2)]),
        ("joint speeds", [3.14] * 6, []),
        ("tool speed", 250, [("W232", None)]),
        ("tool speed", 3.0, []),
        ("tool acceleration", 1200, [("W232", None)]),
        ("tool acceleration", 40, []),
        ("tool velocity", [0, 50, 0, 0, 0, 0], [("W232", 1)]),
        ("tool velocity", [0, 0, 0, 0, 0, 45], [("W232", 5)]),
        ("tool velocity", [1.5, 0, 0, 0, 6.2, 0], []),
        ("blend radius", 50, [("W231", None)]),
        ("blend radius", 0.5, []),
        ("payload", 500, [("W233", None)]),
        ("payload", 25, []),
        ("fraction", 24, [("W234", None)]),
        ("fraction", -0.1, [("W234", None)]),
        ("fraction", 1.0, []),
    ],
)
def test_what_nobody_means_is_doubted_and_what_arms_do_is_not(meaning, value, expected):
    assert codes(meaning, value) == expected


def test_the_arm_that_is_known_decides_on_payload_and_centre_of_gravity():
    cs66 = load_model("CS66")
    assert codes("payload", 6, cs66) == []
    assert codes("payload", 6.5, cs66) == [("W233", None)]
    assert codes("centre of gravity", [0, 0, 1.5], cs66) == [("W231", 2)]


def test_without_an_arm_the_strongest_one_counts():
    assert max(load_model(name).payload_max_kg for name in model_names()) == PAYLOAD_MOST_KG


@pytest.mark.parametrize("name", model_names())
def test_no_arm_is_as_fast_as_what_is_doubted(name):
    model = load_model(name)
    for joint in model.joints:
        assert codes("joint speed", joint.qd_max) == codes("joint acceleration", joint.qdd_max) == []
    assert codes("tool speed", model.max_tool_speed) == codes("tool acceleration", model.max_tool_acceleration) == []
    assert codes("pose", [model.reach_m + 1.0, 0, 0, 0, 0, 0]) == []


def test_hints_turn_the_number_into_the_unit():
    (doubt,) = JUDGES["joints"]([0, 90, 0, 0, 0, 0], None)
    assert doubt.hint == "90 looks like degrees: d2r(90) is 1.5708"
    (doubt,) = JUDGES["tool speed"](250, None)
    assert doubt.hint == "250 looks like mm/s: that is 0.25 m/s"
    (doubt,) = JUDGES["fraction"](5, None)
    assert doubt.hint.endswith("5 V are 0.5")


@pytest.mark.parametrize(
    ("meaning", "kind", "is_doubted"),
    [
        ("joints", "pose", True),
        ("pose", "joints", True),
        ("pose", "pose", False),
        ("tcp", "joints", True),
        ("tcp", "pose", False),
        ("pose", "", False),
    ],
)
def test_a_list_of_the_other_kind_is_doubted(meaning, kind, is_doubted):
    assert (mistaken(meaning, kind) is not None) is is_doubted


def test_a_call_tells_its_doubts_with_command_and_parameter(call, robot):
    call("movel", [400, 0, 0.3, 0, 0, 0], v=250)
    assert [(code, text) for code, text, _ in robot.told] == [
        ("W231", "movel: p[0], x, is 400 m"),
        ("W232", "movel: v is 250 m/s, more than any arm does"),
    ]


def test_a_refusal_says_what_the_doubt_knows_and_nothing_else_is_told(call, robot):
    robot.refusal = MotionError("out of range", code="R110")
    with pytest.raises(MotionError) as caught:
        call("movej", [0, 90, 0, 0, 0, 0])
    assert caught.value.hint == "90 looks like degrees: d2r(90) is 1.5708"
    assert robot.told == robot.doubts == []


def test_a_refusal_for_another_reason_keeps_its_hint(call, robot):
    robot.refusal = MotionError("not ready", code="R115", hint="switch it on")
    with pytest.raises(MotionError) as caught:
        call("movej", [0, 90, 0, 0, 0, 0])
    assert caught.value.hint == "switch it on"


def test_what_a_command_returned_is_known_again(call, robot):
    pose = call("pose_trans", [0.4, 0.1, 0.3, 0, 1, 0], [0, 0, 0.1, 0, 0, 0])
    call("movej", pose)
    assert [code for code, _, _ in robot.told] == ["W237"]
