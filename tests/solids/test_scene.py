"""The message `scene`."""

from __future__ import annotations

import json
from math import pi, sqrt

import pytest

from elitescript.kinematics.rotations import rotation_from_rotvec
from elitescript.models.model import load_model
from elitescript.solids.scene import mounting_of, scene
from elitescript.solids.shapes import Part


def test_it_has_what_a_page_draws():
    model = load_model("CS66")
    part = Part(7, "box", (0.1, 0.2, 0.3), (0.0, 0.0, 0.15, 0.0, 0.0, 0.0), "tool", "gripper", "#ff0000")
    message = scene(
        model, tcp=(0.0, 0.0, 0.1, 0.0, 0.0, pi / 2), payload_kg=1.5, center_of_gravity=(0.0, 0.0, 0.05), parts=[part]
    )
    assert json.loads(json.dumps(message)) == message
    assert message["type"] == "scene"
    assert message["robot"] == "CS66"
    assert message["dh"][2] == {"a": -0.427, "d": 0.0, "alpha": 0.0}
    assert message["limits"]["position_max"] == pytest.approx([2 * pi] * 6)
    assert message["limits"]["reach"] == 0.914
    assert message["tcp"] == pytest.approx([0.0, 0.0, 0.1, 0.0, 0.0, pi / 2])
    assert message["payload_kg"] == 1.5
    assert message["mounting"] == [0.0] * 6
    assert "urdf" not in message
    *arm, tool = message["parts"]
    assert tool == {
        "link": 7, "kind": "box", "size": [0.1, 0.2, 0.3], "pose": [0.0, 0.0, 0.15, 0.0, 0.0, 0.0],
        "role": "tool", "name": "gripper", "color": "#ff0000",
    }  # fmt: skip
    assert {its["role"] for its in arm} == {"base", "housing", "tube", "cap", "ring", "flange"}
    assert all("name" not in its for its in arm)
    assert scene(model, urdf="cell.urdf")["urdf"] == "cell.urdf"


def test_rotations_of_the_message_are_rotation_vectors():
    """Roll, pitch and yaw of scripts differ from it as soon as two of them are not zero."""
    message = scene(load_model("CS66"), tcp=(0.0, 0.0, 0.0, pi / 2, 0.0, pi / 2))
    third = 2 * pi / 3 / sqrt(3)
    assert message["tcp"][3:] == pytest.approx([third, third, third])


@pytest.mark.parametrize(
    ("up", "expected"),
    [
        ((0.0, 0.0, 9.82), (0.0, 0.0, 0.0)),
        ((0.0, 0.0, -9.82), (pi, 0.0, 0.0)),
        ((0.0, 9.82, 0.0), (pi / 2, 0.0, 0.0)),
        ((9.82, 0.0, 0.0), (0.0, -pi / 2, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    ],
)
def test_the_mounting_turns_up_to_the_z_axis_of_the_world(up, expected):
    turn = mounting_of(up)[3:]
    assert turn == pytest.approx(expected)
    if any(up):
        R = rotation_from_rotvec(turn)
        z = sum(R[6 + i] * up[i] for i in range(3))
        assert z == pytest.approx(9.82)
