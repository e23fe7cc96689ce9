"""The law of force control against a spring, and the four ways in which its frame follows the arm."""

from math import hypot, pi

import pytest

from elitescript.kinematics.rotations import IDENTITY_ROTATION, rotation_from_rpy
from elitescript.kinematics.transforms import IDENTITY, rotation_of, transform_from_pose
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.corrections.admittance import FIRM, GAIN, ForceFrame, ForceLaw, along_axes, in_base, selected

X = (True, False, False, False, False, False)
NONE = (0.0,) * 6


def law(target=20.0, *, limit=0.05, gain=0.2, damping=0.0):
    return ForceLaw(X, (target, 0.0, 0.0, 0.0, 0.0, 0.0), (limit,) * 6, gain, damping)


def along(value):
    return (value, 0.0, 0.0, 0.0, 0.0, 0.0)


def pressed(law, stiffness, *, gap=0.002, ticks=4000, v=0.0):
    """Forces, tick by tick, of an axis that meets a spring after a gap."""
    x, forces = -gap, []
    for _ in range(ticks):
        force = stiffness * max(0.0, x)
        forces.append(force)
        after = law.speeds(along(v), along(force))[0]
        x += 0.5 * PERIOD_S * (v + after)
        v = after
    return forces


@pytest.mark.parametrize("stiffness", [1e3, 3e3, 1e4, 3e4, 1e5])
@pytest.mark.parametrize("gain", [0.1, 0.2, 0.5])
def test_it_settles_at_the_target_on_a_spring(stiffness, gain):
    forces = pressed(law(gain=gain), stiffness)
    assert all(force == pytest.approx(20.0, rel=0.01) for force in forces[-100:])


@pytest.mark.parametrize("stiffness", [1e3, 1e4, 1e5])
def test_the_time_constant_is_that_of_admittance_and_stiffness(stiffness):
    forces = pressed(law(), stiffness, gap=0.0)
    expected_s = 1.0 / (0.2 * GAIN[0] * stiffness)
    reached = next(tick for tick, force in enumerate(forces) if force >= 20.0 * (1.0 - 0.36788))
    assert reached * PERIOD_S == pytest.approx(expected_s, rel=0.1, abs=3 * PERIOD_S)


def test_gain_scaling_1_is_the_limit_of_a_hard_surface():
    assert max(pressed(law(gain=0.9), 1e5)[-100:]) < 20.5
    shaking = pressed(law(gain=1.1), 1e5)[-100:]
    assert max(shaking) - min(shaking) > 5.0


def test_the_limit_of_the_speed_holds_before_and_in_contact():
    assert law(500.0).speeds(along(0.05), NONE)[0] == pytest.approx(0.05)
    assert law(-500.0).speeds(along(-0.05), NONE)[0] == pytest.approx(-0.05)
    assert law().speeds(along(0.04), along(5000.0))[0] >= -0.05


def test_an_axis_that_is_too_fast_at_first_slows_down_to_its_limit():
    v = 0.5
    for _ in range(40):
        v = law(500.0).speeds(along(v), NONE)[0]
    assert v == pytest.approx(0.05)


@pytest.mark.parametrize(("damping", "left"), [(0.0, 0.04), (0.1, 0.04 * 0.92**10), (1.0, 0.04 * 0.2**10)])
def test_without_a_force_only_damping_slows_down(damping, left):
    v = 0.04
    for _ in range(10):
        v = law(0.0, damping=damping).speeds(along(v), NONE)[0]
    assert v == pytest.approx(left)


def test_a_firm_contact_slows_down_by_itself():
    v = law(20.0).speeds(along(0.04), along(20.0))[0]
    assert v < 0.01
    faint = law(0.1).speeds(along(0.04), along(0.1))[0]
    assert faint == pytest.approx(0.04 * (1 - 0.8 * 0.1 / FIRM[0]))


def test_axes_that_are_not_selected_have_no_speed():
    speeds = law().speeds((0.01,) * 6, (1.0,) * 6)
    assert speeds[1:] == NONE[1:]


@pytest.mark.parametrize("axis", range(6))
def test_every_axis_has_its_own_target_and_limit(axis):
    selection = tuple(index == axis for index in range(6))
    target = tuple(1000.0 if index == axis else 0.0 for index in range(6))
    limits = tuple(0.01 * (index + 1) for index in range(6))
    v = NONE
    for _ in range(30):
        v = ForceLaw(selection, target, limits, 0.2, 0.0).speeds(v, NONE)
    assert v[axis] == pytest.approx(0.01 * (axis + 1))


class TestFrame:
    REFERENCE = transform_from_pose((0.3, 0.4, 0.5, 0.1, -0.2, 0.7))

    def test_mode_0_is_the_reference(self):
        frame = ForceFrame(0, self.REFERENCE)
        assert frame.axes(IDENTITY, (1.0, 0.0, 0.0), IDENTITY_ROTATION) == rotation_of(self.REFERENCE)

    def test_mode_1_points_with_y_to_the_origin_of_the_reference(self):
        frame = ForceFrame(1, self.REFERENCE)
        R = frame.axes(IDENTITY, NONE[:3], frame.at_start())
        length = hypot(0.3, 0.4, 0.5)
        assert (R[1], R[4], R[7]) == pytest.approx((0.3 / length, 0.4 / length, 0.5 / length))
        self.require_rotation(R)

    @pytest.mark.parametrize("rpy", [(0.0, 0.0, -pi / 2), (0.0, 0.0, pi / 2)])
    def test_mode_1_has_axes_where_x_points_to_the_origin(self, rpy):
        frame = ForceFrame(1, transform_from_pose((0.0, 0.3, 0.0, *rpy)))
        # The x axis of the reference is along the way to its origin, and gives no third direction.
        self.require_rotation(frame.axes(IDENTITY, NONE[:3], rotation_from_rpy(0.0, 0.0, pi / 2)))

    def test_mode_1_keeps_its_axes_at_the_origin_itself(self):
        frame = ForceFrame(1, IDENTITY)
        before = rotation_from_rpy(0.1, 0.2, 0.3)
        assert frame.axes(IDENTITY, NONE[:3], before) == before

    def test_mode_2_has_x_along_the_travel_in_the_plane_of_the_reference(self):
        frame = ForceFrame(2, IDENTITY)
        R = frame.axes(IDENTITY, (-0.3, 0.4, 5.0), IDENTITY_ROTATION)
        assert (R[0], R[3], R[6]) == pytest.approx((-0.6, 0.8, 0.0))
        assert (R[2], R[5], R[8]) == (0.0, 0.0, 1.0)
        self.require_rotation(R)

    def test_mode_2_keeps_its_axes_without_travel(self):
        before = rotation_from_rpy(0.0, 0.0, 0.3)
        assert ForceFrame(2, IDENTITY).axes(IDENTITY, (0.0, 0.0, 1.0), before) == before

    def test_mode_3_is_the_tool(self):
        frame = ForceFrame(3, IDENTITY)
        assert frame.axes(self.REFERENCE, NONE[:3], IDENTITY_ROTATION) == rotation_of(self.REFERENCE)

    def require_rotation(self, R):
        x, y, z = [(R[i], R[i + 3], R[i + 6]) for i in range(3)]
        for one, other in ((x, y), (y, z), (z, x)):
            assert sum(a * b for a, b in zip(one, other, strict=True)) == pytest.approx(0.0, abs=1e-12)
        cross = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
        assert cross == pytest.approx(z)


def test_selecting_is_a_projection():
    R = rotation_from_rpy(0.3, -0.5, 1.2)
    selection = (True, False, True, False, True, False)
    six = (0.1, -0.2, 0.3, 0.4, 0.5, -0.6)
    once = selected(R, selection, six)
    assert selected(R, selection, once) == pytest.approx(once)
    kept = along_axes(R, once)
    whole = along_axes(R, six)
    assert kept == pytest.approx([b if s else 0.0 for s, b in zip(selection, whole, strict=True)])
    assert in_base(R, whole) == pytest.approx(six)
