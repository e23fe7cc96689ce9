"""Tests whether a rigid body can have a tensor of inertia."""

from __future__ import annotations

from typing import Final

from elitescript.kinematics.limits import SixFloats

_ROUNDING: Final = 0.02
"""Share of the trace that counts as rounding: inertias are often given with two digits."""


def is_inertia_of_a_body(inertia: SixFloats) -> bool:
    """Return whether a body can have that tensor: Ixx, Iyy, Izz, Ixy, Ixz, Iyz, about its centre of mass.

    No principal moment is negative, and none is larger than the sum of the other two. Both hold exactly if the
    second moments of the mass, tr(I) / 2 - I, are positive semidefinite. Two per cent of the trace are allowed for
    rounding.
    """
    ixx, iyy, izz, ixy, ixz, iyz = inertia
    half = 0.5 * (ixx + iyy + izz)
    slack = 2.0 * _ROUNDING * abs(half)
    a, b, c = half - ixx + slack, half - iyy + slack, half - izz + slack
    determinant = a * (b * c - iyz * iyz) - ixy * (ixy * c + iyz * ixz) - ixz * (ixy * iyz + b * ixz)
    return min(a, b, c) >= 0.0 and min(a * b - ixy**2, a * c - ixz**2, b * c - iyz**2) >= 0.0 and determinant >= 0.0
