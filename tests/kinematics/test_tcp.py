"""The pose of the TCP in one pass against the three functions that it stands for, to the last bit."""

from __future__ import annotations

import random
from math import pi
from struct import pack

import pytest

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.tcp import tcp_pose, tcp_poses
from elitescript.kinematics.transforms import IDENTITY, Transform, pose_from_transform, transform_from_pose

CS66 = Arm(0.1625, -0.427, -0.3905, 0.1475, 0.0965, 0.092)
MEASURED = CS66.calibrated(d=[value + 1e-4 for value in CS66.modified_dh[1]])
OFFSETS = {
    "none": IDENTITY,
    "along the flange axis": transform_from_pose((0.0, 0.0, 0.145, 0.0, 0.0, 0.0)),
    "turned": transform_from_pose((0.02, -0.05, 0.18, 0.3, -1.1, 2.0)),
}


def reference(arm: Arm, q: tuple[float, ...], T_flange_tcp: Transform) -> bytes:
    return pack("6d", *pose_from_transform(arm.forward_tcp(q, T_flange_tcp)))


@pytest.mark.parametrize("arm", [CS66, MEASURED], ids=["nominal", "calibrated"])
@pytest.mark.parametrize("T_flange_tcp", OFFSETS.values(), ids=OFFSETS.keys())
def test_poses_are_those_of_forward_kinematics_offset_and_angles(arm: Arm, T_flange_tcp: Transform) -> None:
    rng = random.Random(7)
    joints = [tuple(rng.uniform(-2.0 * pi, 2.0 * pi) for _ in range(6)) for _ in range(500)]
    # Multiples of a quarter turn make zeros of either sign, and a tool axis that lies in the plane of pitch.
    joints += [tuple(rng.randrange(-4, 5) * 0.5 * pi for _ in range(6)) for _ in range(500)]
    joints += [(0.0, -0.0, 0.0, -0.0, 0.0, -0.0), (0.0,) * 6]
    poses = tcp_poses(arm, joints, T_flange_tcp)
    assert [pack("6d", *pose) for pose in poses] == [reference(arm, q, T_flange_tcp) for q in joints]


def test_a_tool_that_points_along_the_base_plane_has_its_whole_turn_in_rz() -> None:
    T_flange_tcp = transform_from_pose((0.0, 0.0, 0.1, 0.0, 0.5 * pi, 0.0))
    q = (0.3, -0.5 * pi, -0.5 * pi, -0.5 * pi, 0.5 * pi, 0.2)
    pose = tcp_pose(CS66, q, T_flange_tcp)
    assert abs(pose[4]) == pytest.approx(0.5 * pi)
    assert pose[3] == 0.0
    assert pack("6d", *pose) == reference(CS66, q, T_flange_tcp)


def test_no_joints_have_no_poses() -> None:
    assert tcp_poses(CS66, [], IDENTITY) == []
