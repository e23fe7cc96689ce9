"""What viewers are shown: names and forms of the well-known schemas, and the mathematics in them."""

from __future__ import annotations

import json
from math import inf, nan, pi, sqrt

import pytest

from elitescript.kinematics.rotations import rotation_from_rpy
from elitescript.recorder import channels
from elitescript.recorder.channels import SCHEMAS, encoded, frame_transforms, joint_states, log_line, pose_in_frame

NS = 1_700_000_000_250_000_000
STAMP = {"sec": 1_700_000_000, "nsec": 250_000_000}
HALF = sqrt(0.5)


@pytest.mark.parametrize(
    ("rpy", "wanted"),
    [
        ((0, 0, 0), (0, 0, 0, 1)),
        ((pi, 0, 0), (1, 0, 0, 0)),
        ((0, pi / 2, 0), (0, HALF, 0, HALF)),
        ((0, 0, -pi / 2), (0, 0, -HALF, HALF)),
        ((pi / 2, 0, pi / 2), (0.5, 0.5, 0.5, 0.5)),
    ],
)
def test_quaternions_by_hand(rpy, wanted):
    assert channels.quaternion(*rpy) == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("rpy", [(0.3, -0.8, 2.1), (-3.0, 1.4, -0.2), (1.0, 1.0, 1.0)])
def test_quaternions_are_the_rotation(rpy):
    x, y, z, w = channels.quaternion(*rpy)
    assert rotation_from_rpy(*rpy) == pytest.approx(
        (
            1 - 2 * (y * y + z * z),
            2 * (x * y - z * w),
            2 * (x * z + y * w),
            2 * (x * y + z * w),
            1 - 2 * (x * x + z * z),
            2 * (y * z - x * w),
            2 * (x * z - y * w),
            2 * (y * z + x * w),
            1 - 2 * (x * x + y * y),
        )
    )


def test_the_well_known_messages():
    assert SCHEMAS["/joint_states"][0] == "foxglove.JointStates"
    assert joint_states(NS, [1, 2, 3, 4, 5, 6], [0] * 6, [9] * 6)["joints"][1] == {
        "name": "shoulder_lift_joint",
        "position": 2,
        "velocity": 0,
        "effort": 9,
    }
    assert SCHEMAS["/tcp"][0] == "foxglove.PoseInFrame"
    assert pose_in_frame(NS, (1.0, 2.0, 3.0, pi, 0.0, 0.0)) == {
        "timestamp": STAMP,
        "frame_id": "base",
        "pose": {
            "position": {"x": 1.0, "y": 2.0, "z": 3.0},
            "orientation": pytest.approx({"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}),
        },
    }
    assert SCHEMAS["/tf"][0] == "foxglove.FrameTransforms"
    (frame,) = frame_transforms(NS, (1.0, 2.0, 3.0, 0.0, 0.0, 0.0))["transforms"]
    assert (frame["parent_frame_id"], frame["child_frame_id"], frame["translation"]) == (
        "base",
        "tcp",
        {"x": 1.0, "y": 2.0, "z": 3.0},
    )
    assert SCHEMAS["/log"][0] == "foxglove.Log"
    assert log_line(NS, "error", "no part", "script exception", 40) == {
        "timestamp": STAMP,
        "level": 4,
        "message": "no part",
        "name": "script exception",
        "file": "",
        "line": 40,
    }


def test_every_message_has_what_its_schema_names():
    made = {
        "/joint_states": joint_states(NS, [0.0] * 6, [0.0] * 6, [0.0] * 6),
        "/tcp": pose_in_frame(NS, [0.0] * 6),
        "/tf": frame_transforms(NS, [0.0] * 6),
        "/log": log_line(NS, "info", "", ""),
    }
    for channel, message in made.items():
        _check(message, SCHEMAS[channel][1])


def _check(value, schema) -> None:
    kind = schema["type"]
    if kind == "object":
        assert value.keys() == schema["properties"].keys()
        for name, part in schema["properties"].items():
            _check(value[name], part)
    elif kind == "array":
        for item in value:
            _check(item, schema["items"])
    else:
        assert isinstance(value, {"number": (int, float), "integer": int, "string": str}[kind])


def test_what_json_cannot_hold_is_null():
    assert json.loads(encoded({"a": [1.0, nan, (inf,)], "b": {"c": -inf}})) == {
        "a": [1.0, None, [None]],
        "b": {"c": None},
    }
