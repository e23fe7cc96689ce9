"""Poses of the TCP: forward kinematics, TCP offset and roll-pitch-yaw angles in one pass.

The results are those of `pose_from_transform(arm.forward_tcp(q, T_flange_tcp))` to the last bit: the same operations in
the same order, without the elements of the rotation that no angle needs.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import atan2, cos, sin, sqrt

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.limits import SixFloats
from elitescript.kinematics.rotations import PITCH_LIMIT
from elitescript.kinematics.transforms import Transform, pose_from_transform


class TcpKinematics:
    """Poses of one TCP of one arm; those of an arm that rests are computed once.

    Args:
        arm: the arm.
        T_flange_tcp: the TCP in the flange frame.
    """

    __slots__ = ("T_flange_tcp", "_at", "_pose", "arm")

    def __init__(self, arm: Arm, T_flange_tcp: Transform) -> None:
        self.arm = arm
        self.T_flange_tcp = T_flange_tcp
        self._at: SixFloats | None = None
        self._pose: SixFloats

    def pose(self, q: SixFloats) -> SixFloats:
        """Return the pose of the TCP at joint angles (rad), base frame: m, rad."""
        if q is not self._at:
            self._at, self._pose = q, tcp_pose(self.arm, q, self.T_flange_tcp)
        return self._pose

    def poses(self, joints: Sequence[SixFloats]) -> list[SixFloats]:
        """Return the poses of the TCP at many joint angles (rad), base frame: m, rad."""
        return [self.pose(joints[0])] if len(joints) == 1 else tcp_poses(self.arm, joints, self.T_flange_tcp)


def tcp_pose(arm: Arm, q: Sequence[float], T_flange_tcp: Transform) -> SixFloats:
    """Return the pose of the TCP at joint angles (rad), base frame: m, rad."""
    return tcp_poses(arm, (q,), T_flange_tcp)[0]


def tcp_poses(arm: Arm, joints: Iterable[Sequence[float]], T_flange_tcp: Transform) -> list[SixFloats]:
    """Return the poses of the TCP at many joint angles (rad), base frame: m, rad."""
    if arm.calibration is not None:
        return [pose_from_transform(arm.forward_tcp(q, T_flange_tcp)) for q in joints]
    d1, a2, a3, d4, d5, d6 = arm.d1, arm.a2, arm.a3, arm.d4, arm.d5, arm.d6
    b1, b2, b3, b4, b5, b6, b7, b8, b9, bx, by, bz = T_flange_tcp
    poses: list[SixFloats] = []
    for q1, q2, q3, q4, q5, q6 in joints:
        # As in `Arm.forward`.
        q23 = q2 + q3
        q234 = q23 + q4
        c1 = cos(q1)
        s1 = sin(q1)
        c234 = cos(q234)
        s234 = sin(q234)
        c5 = cos(q5)
        s5 = sin(q5)
        c6 = cos(q6)
        s6 = sin(q6)
        c5_c6 = c5 * c6
        c5_s6 = c5 * s6
        xr = c234 * c5_c6 - s234 * s6
        xn = s5 * c6
        yr = -c234 * c5_s6 - s234 * c6
        yn = -s5 * s6
        zr = -c234 * s5
        zz = -s234 * s5
        pr = a2 * cos(q2) + a3 * cos(q23) + d5 * s234 + d6 * zr
        pn = d4 + d6 * c5
        r11 = c1 * xr + s1 * xn
        r12 = c1 * yr + s1 * yn
        r13 = c1 * zr + s1 * c5
        r21 = s1 * xr - c1 * xn
        r22 = s1 * yr - c1 * yn
        r23 = s1 * zr - c1 * c5
        r31 = s234 * c5_c6 + c234 * s6
        r32 = c234 * c6 - s234 * c5_s6
        # As in `compose`.
        x11 = r11 * b1 + r12 * b4 + r13 * b7
        x21 = r21 * b1 + r22 * b4 + r23 * b7
        # As in `rpy_from_rotation`.
        ry = atan2(-(r31 * b1 + r32 * b4 + zz * b7), sqrt(x11 * x11 + x21 * x21))
        if -PITCH_LIMIT <= ry <= PITCH_LIMIT:
            rx = atan2(r31 * b2 + r32 * b5 + zz * b8, r31 * b3 + r32 * b6 + zz * b9)
            rz = atan2(x21, x11)
        else:
            rx = 0.0
            rz = atan2(-(r11 * b2 + r12 * b5 + r13 * b8), r21 * b2 + r22 * b5 + r23 * b8)
        poses.append(
            (
                r11 * bx + r12 * by + r13 * bz + (c1 * pr + s1 * pn),
                r21 * bx + r22 * by + r23 * bz + (s1 * pr - c1 * pn),
                r31 * bx + r32 * by + zz * bz + (d1 + a2 * sin(q2) + a3 * sin(q23) - d5 * c234 + d6 * zz),
                rx,
                ry,
                rz,
            )
        )
    return poses
