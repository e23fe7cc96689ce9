"""Forward and inverse kinematics of many poses at once, with numpy.

The same conventions as the scalar functions, which stay the reference: the tests compare the
two. numpy is optional; these functions raise `UsageError` where it is not installed.
"""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

from elitescript.errors import UsageError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import BRANCHES, solutions
from elitescript.kinematics.limits import REACH_TOLERANCE_M, TURN, WRIST_SINGULAR_SINE
from elitescript.kinematics.transforms import Transform

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    FloatArray = NDArray[np.float64]


def forward(arm: Arm, q: ArrayLike) -> FloatArray:
    """Return n matrices `T_base_flange`, shape (n, 4, 4), for joint angles of shape (n, 6), rad.

    Raises:
        UsageError: numpy is missing, or the shape is wrong.
    """
    np = _numpy()
    angles = np.asarray(q, dtype=float)
    if angles.ndim != 2 or angles.shape[1] != 6:
        raise UsageError(f"joint angles need the shape (n, 6); they have {angles.shape}")
    if arm.calibration is not None:
        return _forward_chain(np, arm, angles)
    q1, q2, _, _, q5, q6 = angles.T
    q23 = q2 + angles[:, 2]
    q234 = q23 + angles[:, 3]
    c1, s1 = np.cos(q1), np.sin(q1)
    c234, s234 = np.cos(q234), np.sin(q234)
    c5, s5 = np.cos(q5), np.sin(q5)
    c6, s6 = np.cos(q6), np.sin(q6)
    # Columns x6, y6, z6 and the position, in (r, z, n) components.
    radial = np.stack((c234 * c5 * c6 - s234 * s6, -c234 * c5 * s6 - s234 * c6, -c234 * s5))
    up = np.stack((s234 * c5 * c6 + c234 * s6, c234 * c6 - s234 * c5 * s6, -s234 * s5))
    normal = np.stack((s5 * c6, -s5 * s6, c5))
    pr = arm.a2 * np.cos(q2) + arm.a3 * np.cos(q23) + arm.d5 * s234 + arm.d6 * radial[2]
    pz = arm.d1 + arm.a2 * np.sin(q2) + arm.a3 * np.sin(q23) - arm.d5 * c234 + arm.d6 * up[2]
    pn = arm.d4 + arm.d6 * c5
    T: FloatArray = np.zeros((len(angles), 4, 4))
    T[:, 0, :3] = (c1 * radial + s1 * normal).T
    T[:, 1, :3] = (s1 * radial - c1 * normal).T
    T[:, 2, :3] = up.T
    T[:, 0, 3] = c1 * pr + s1 * pn
    T[:, 1, 3] = s1 * pr - c1 * pn
    T[:, 2, 3] = pz
    T[:, 3, 3] = 1.0
    return T


def inverse(arm: Arm, T_base_flange: ArrayLike, q6_near: float = 0.0) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return joint angles of shape (n, 8, 6), rad, and a mask (n, 8) of those that are solutions.

    The second index is the branch. Rows outside the mask are NaN. Singular wrists fill the
    branches of wrist 0 alone, as `inverse.solutions` does.

    Args:
        arm: the arm; calibrated ones are solved pose by pose.
        T_base_flange: n homogeneous matrices, shape (n, 4, 4).
        q6_near: q6 where the wrist is singular.

    Raises:
        UsageError: numpy is missing, or the shape is wrong.
    """
    np = _numpy()
    T = np.asarray(T_base_flange, dtype=float)
    if T.ndim != 3 or T.shape[1:] != (4, 4):
        raise UsageError(f"transforms need the shape (n, 4, 4); they have {T.shape}")
    count = len(T)
    q = np.full((count, BRANCHES, 6), np.nan)
    mask = np.zeros((count, BRANCHES), dtype=bool)
    if arm.calibration is not None:
        for index, matrix in enumerate(T):
            for branch, solution in solutions(arm, _flat(matrix), q6_near):
                q[index, branch] = solution
                mask[index, branch] = True
        return q, mask

    longest, shortest = -arm.a2 - arm.a3, abs(arm.a2 - arm.a3)
    wx = T[:, 0, 3] - arm.d6 * T[:, 0, 2]
    wy = T[:, 1, 3] - arm.d6 * T[:, 1, 2]
    wz = T[:, 2, 3] - arm.d6 * T[:, 2, 2] - arm.d1
    rho = np.sqrt(wx * wx + wy * wy)
    reachable = rho >= arm.d4 - REACH_TOLERANCE_M
    with np.errstate(divide="ignore", invalid="ignore"):
        rho_inside = np.maximum(rho, arm.d4)
        X = np.sqrt((rho_inside - arm.d4) * (rho_inside + arm.d4))
        scale = 1.0 / (rho * rho_inside)
        for shoulder in (0, 1):
            side = 1.0 - 2.0 * shoulder
            c1 = (side * wx * X - wy * arm.d4) * scale
            s1 = (side * wy * X + wx * arm.d4) * scale
            along_n = T[:, 0, :3] * s1[:, None] - T[:, 1, :3] * c1[:, None]
            along_r = T[:, 0, :3] * c1[:, None] + T[:, 1, :3] * s1[:, None]
            xn, yn, zn = along_n.T
            h = np.sqrt(xn * xn + yn * yn)
            singular = h < WRIST_SINGULAR_SINE
            q5_plus = np.where(singular, np.where(zn > 0.0, 0.0, np.pi), np.arctan2(h, zn))
            q6_plus = np.where(singular, q6_near, np.arctan2(-yn, xn))
            c6 = np.where(singular, np.cos(q6_near), xn / h)
            s6 = np.where(singular, np.sin(q6_near), -yn / h)
            c5 = np.where(singular, np.where(zn > 0.0, 1.0, -1.0), zn)
            s5 = np.where(singular, 0.0, h)
            u = np.stack((c5 * c6, -c5 * s6, -s5), axis=1)
            c234 = np.sum(along_r * u, axis=1)
            s234 = np.sum(T[:, 2, :3] * u, axis=1)
            length = np.sqrt(c234 * c234 + s234 * s234)
            q234_plus = np.arctan2(s234, c234)
            for wrist in (0, 1):
                flip = 1.0 - 2.0 * wrist
                X4 = side * X - flip * arm.d5 * s234 / length
                Y4 = wz + flip * arm.d5 * c234 / length
                r = np.sqrt(X4 * X4 + Y4 * Y4)
                valid = reachable & (r >= shortest - REACH_TOLERANCE_M) & (r <= longest + REACH_TOLERANCE_M)
                if wrist:
                    valid &= ~singular
                r = np.clip(r, shortest, longest)
                far = np.sqrt((longest - r) * (longest + r))
                near = np.sqrt((r - shortest) * (r + shortest))
                q3_plus = 2.0 * np.arctan2(far, near)
                beta = np.arctan2(0.5 * far * near / arm.a2, arm.a2 + 0.25 * (near * near - far * far) / arm.a2)
                gamma = np.arctan2(Y4, X4)
                for elbow in (0, 1):
                    bend = 1.0 - 2.0 * elbow
                    q2 = gamma - bend * beta
                    q3 = bend * q3_plus
                    q4 = q234_plus + wrist * np.pi - q2 - q3
                    branch = 4 * shoulder + 2 * wrist + elbow
                    row = np.stack((np.arctan2(s1, c1), q2, q3, q4, flip * q5_plus, q6_plus + wrist * np.pi), axis=1)
                    q[valid, branch] = _wrapped(np, row[valid])
                    mask[:, branch] = valid
    return q, mask


def _numpy() -> ModuleType:
    try:
        import numpy
    except ImportError:
        raise UsageError(
            "the batch kinematics needs numpy, which is not installed; `pip install numpy`, or use the scalar functions"
        ) from None
    return numpy


def _wrapped(np: ModuleType, q: FloatArray) -> FloatArray:
    """Return the angles in (-pi, pi]."""
    wrapped: FloatArray = q - TURN * np.ceil((q - np.pi) / TURN)
    return wrapped


def _flat(T: FloatArray) -> Transform:
    r11, r12, r13, x, r21, r22, r23, y, r31, r32, r33, z = (float(value) for value in T[:3].ravel())
    return r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z


def _forward_chain(np: ModuleType, arm: Arm, q: FloatArray) -> FloatArray:
    assert arm.calibration is not None
    T: FloatArray = np.tile(np.eye(4), (len(q), 1, 1))
    for joint, (a, d, ca, sa) in enumerate(arm.calibration.links):
        c, s = np.cos(q[:, joint]), np.sin(q[:, joint])
        link = np.zeros((len(q), 4, 4))
        link[:, 0, 0], link[:, 0, 1], link[:, 0, 3] = c, -s, a
        link[:, 1, 0], link[:, 1, 1], link[:, 1, 2], link[:, 1, 3] = s * ca, c * ca, -sa, -sa * d
        link[:, 2, 0], link[:, 2, 1], link[:, 2, 2], link[:, 2, 3] = s * sa, c * sa, ca, ca * d
        link[:, 3, 3] = 1.0
        T = T @ link
    return T
