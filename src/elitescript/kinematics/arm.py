"""Arm geometry: six link lengths and the forward kinematics.

All CS arms have the same structure: joints 2, 3 and 4 are parallel, the last three are mutually
perpendicular in pairs. The standard Denavit-Hartenberg form is
`T_i = Rz(q_i) Tz(d_i) Tx(a_i) Rx(alpha_i)` with a = (0, a2, a3, 0, 0, 0),
d = (d1, 0, 0, d4, d5, d6), alpha = (pi/2, 0, 0, pi/2, -pi/2, 0); the flange is frame 6 and the
base frame is frame 0.

Symbols used in this package: in the vertical plane of the arm the radial direction
r = (c1, s1, 0), up z = (0, 0, 1) and the normal n = r x z = (s1, -c1, 0), which is the direction
of joints 2, 3 and 4. A vector with components (u, v, w) along (r, z, n) is
(c1 u + s1 w, s1 u - c1 w, v) in the base frame. s234 is sin(q2 + q3 + q4), and so on.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, isfinite, pi, sin
from typing import TYPE_CHECKING, Final

from elitescript.errors import UsageError
from elitescript.kinematics.limits import SixFloats
from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform, compose
from elitescript.records import record, replace

if TYPE_CHECKING:
    from elitescript.kinematics.chain import CalibratedChain


@record
class Arm:
    """Link lengths of an arm, m, and optionally the measured chain of one specimen.

    a2 and a3 are negative: at q = 0 the arm lies stretched along -x of the base.

    Args:
        d1: height of the shoulder joint above the base.
        a2: length of the upper arm, negative.
        a3: length of the forearm, negative.
        d4: offset of the wrist along the shoulder joint.
        d5: from the joint-4 axis to the wrist centre.
        d6: from the wrist centre to the flange.
        calibration: measured chain; see `calibrated`.

    Raises:
        UsageError: a length that is not finite or has the wrong sign.
    """

    d1: float
    a2: float
    a3: float
    d4: float
    d5: float
    d6: float
    calibration: CalibratedChain | None = None

    def __post_init__(self) -> None:
        for name in ("d1", "a2", "a3", "d4", "d5", "d6"):
            length = getattr(self, name)
            if not isfinite(length):
                raise UsageError(f"{name} of the arm is {length} m; it has to be a finite number")
        for name in ("a2", "a3"):
            if not getattr(self, name) < 0.0:
                raise UsageError(f"{name} of the arm is {getattr(self, name)} m; it has to be negative")
        if not self.d4 > 0.0:
            raise UsageError(f"d4 of the arm is {self.d4} m; it has to be positive")

    def forward(self, q: Sequence[float]) -> Transform:
        """Return `T_base_flange` for six joint angles in rad."""
        if self.calibration is not None:
            return self.calibration.forward(q)
        q1, q2, q3, q4, q5, q6 = q
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
        d5 = self.d5
        d6 = self.d6
        # x6, y6, z6 and the flange position in (r, z, n) components.
        c5_c6 = c5 * c6
        c5_s6 = c5 * s6
        xr = c234 * c5_c6 - s234 * s6
        xn = s5 * c6
        yr = -c234 * c5_s6 - s234 * c6
        yn = -s5 * s6
        zr = -c234 * s5
        zz = -s234 * s5
        pr = self.a2 * cos(q2) + self.a3 * cos(q23) + d5 * s234 + d6 * zr
        pn = self.d4 + d6 * c5
        return (
            c1 * xr + s1 * xn,
            c1 * yr + s1 * yn,
            c1 * zr + s1 * c5,
            s1 * xr - c1 * xn,
            s1 * yr - c1 * yn,
            s1 * zr - c1 * c5,
            s234 * c5_c6 + c234 * s6,
            c234 * c6 - s234 * c5_s6,
            zz,
            c1 * pr + s1 * pn,
            s1 * pr - c1 * pn,
            self.d1 + self.a2 * sin(q2) + self.a3 * sin(q23) - d5 * c234 + d6 * zz,
        )

    def forward_tcp(self, q: Sequence[float], T_flange_tcp: Transform) -> Transform:
        """Return `T_base_tcp` for six joint angles in rad and a TCP offset."""
        return compose(self.forward(q), T_flange_tcp)

    def elbow(self, q: Sequence[float]) -> Vector3:
        """Return the position of the elbow in the base frame, m.

        The elbow is the intersection of the elbow joint with the vertical plane through the
        shoulder; the width of its housing is left out.
        """
        if self.calibration is not None:
            return self.calibration.elbow(q)
        q1, q2 = q[0], q[1]
        radius = self.a2 * cos(q2)
        return cos(q1) * radius, sin(q1) * radius, self.d1 + self.a2 * sin(q2)

    @property
    def modified_dh(self) -> tuple[SixFloats, SixFloats, SixFloats]:
        """The arrays (a, d, alpha), m and rad, in the modified form that the controller reports.

        `T_i = Rx(alpha_i) Tx(a_i) Rz(q_i) Tz(d_i)`; same flange pose as the standard form.
        Calibrated arms give their measured values.
        """
        if self.calibration is not None:
            return self.calibration.a, self.calibration.d, self.calibration.alpha
        return (
            (0.0, 0.0, self.a2, self.a3, 0.0, 0.0),
            (self.d1, 0.0, 0.0, self.d4, self.d5, self.d6),
            _NOMINAL_ALPHA,
        )

    def calibrated(
        self,
        a: Sequence[float] | None = None,
        d: Sequence[float] | None = None,
        alpha: Sequence[float] | None = None,
    ) -> Arm:
        """Return this arm with measured link parameters.

        Args:
            a: six lengths in the modified form, m; None keeps the present values.
            d: six offsets in the modified form, m; None keeps the present values.
            alpha: six twists in the modified form, rad; None keeps the present values.

        Forward kinematics and Jacobian are then exact for the given chain; the inverse starts
        from the nominal closed form and is refined. The parameters have to be close to nominal
        (millimetres and milliradians).

        Raises:
            UsageError: an array that does not hold six finite numbers, or that is further from
                nominal than any calibration (`MAX_CALIBRATION_OFFSET`).
        """
        # Calibrated arms are rare, so the import is not made for the others.
        from elitescript.kinematics.chain import CalibratedChain

        nominal = replace(self, calibration=None).modified_dh
        present = self.modified_dh
        given = (kept if values is None else values for values, kept in zip((a, d, alpha), present, strict=True))
        chain = CalibratedChain(*(tuple(values) for values in given))  # type: ignore[arg-type]
        for name, measured, expected in zip(("a", "d", "alpha"), (chain.a, chain.d, chain.alpha), nominal, strict=True):
            for index, (value, reference) in enumerate(zip(measured, expected, strict=True)):
                if abs(value - reference) > MAX_CALIBRATION_OFFSET:
                    unit = "rad" if name == "alpha" else "m"
                    raise UsageError(
                        f"{name}[{index}] of the calibration is {value:g} {unit}, nominal is {reference:g} {unit}; "
                        f"a difference above {MAX_CALIBRATION_OFFSET:g} {unit} is not a calibration but another arm"
                    )
        return replace(self, calibration=chain)


MAX_CALIBRATION_OFFSET: Final = 0.02
"""Largest plausible difference between a measured and a nominal parameter, m or rad. Real arms
stay below a millimetre and a milliradian; beyond this the refinement of the inverse may end on
another branch."""

_NOMINAL_ALPHA: Final[SixFloats] = (0.0, 0.5 * pi, 0.0, 0.0, 0.5 * pi, -0.5 * pi)
