"""What exceeds a limit is found, with the number that is measured and the one that is allowed."""

from math import dist, radians

import pytest

from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.controller.safety.monitor import SafetyMonitor
from elitescript.kinematics.transforms import IDENTITY, transform_from_pose
from elitescript.messages.enums import SafetyMode
from elitescript.models.model import load_model

MODEL = load_model("CS66")
HOME = MODEL.home
NORMAL, REDUCED, RECOVERY = SafetyMode.NORMAL, SafetyMode.REDUCED, SafetyMode.RECOVERY
X, Y, Z = MODEL.arm.forward(HOME)[9:]
UP = (0.0, 0.0, 1.0)


def monitor(**limits):
    return SafetyMonitor(MODEL.arm, SafetyLimits(**limits))


def test_nothing_is_watched_without_limits():
    assert not monitor().is_watching(NORMAL)
    assert monitor().is_watching(REDUCED)
    assert monitor().position_breach(HOME, IDENTITY, NORMAL) is None
    assert monitor().speed_breach(HOME, (9.0,) * 6, IDENTITY, NORMAL) is None


def test_a_force_above_the_limit_of_the_mode_says_what_to_try():
    assert monitor().force_breach(250.0, NORMAL) is None
    breach = monitor().force_breach(151.0, REDUCED)
    assert (breach.kind, breach.value, breach.limit, breach.unit) == ("tcp_force", 151.0, "<= 150", "N")
    assert "151.0 N; 150 N are allowed in reduced mode" in breach.text
    assert len(breach.hints) == 3


def test_a_joint_outside_its_range_is_named_with_value_and_limit():
    watch = monitor(
        normal=SafetyBounds(q_min=(-1.0, -2.0, -2.0, -2.0, 0.0, -1.0), q_max=(1.0, 0.0, -1.6, 0.0, 2.0, 1.0))
    )
    breach = watch.position_breach(HOME, IDENTITY, NORMAL)
    assert (breach.kind, breach.subject, breach.value) == ("joint_range", "elbow", HOME[2])
    assert breach.limit == "[-2, -1.6]"
    assert breach.unit == "rad"
    assert "-1.5708 rad (-90.0 deg)" in breach.text
    assert len(breach.hints) == 3


@pytest.mark.parametrize(("height", "is_inside"), [(Z - 0.001, True), (Z, True), (Z + 0.001, False)])
def test_the_tcp_may_be_on_a_plane_but_not_behind_it(height, is_inside):
    watch = monitor(planes=(SafetyPlane("table", (0.0, 0.0, height), UP),))
    breach = watch.position_breach(HOME, IDENTITY, NORMAL)
    assert (breach is None) == is_inside
    if breach is not None:
        assert (breach.kind, breach.subject, breach.unit) == ("plane", "table", "m")
        assert breach.value == pytest.approx(-0.001)
        assert "1.00 mm behind safety plane 'table'" in breach.text


def test_a_plane_holds_for_the_tcp_and_not_for_the_flange():
    watch = monitor(planes=(SafetyPlane("table", (0.0, 0.0, Z - 0.05), UP),))
    tool = transform_from_pose((0.0, 0.0, 0.1, 0.0, 0.0, 0.0))
    assert watch.position_breach(HOME, IDENTITY, NORMAL) is None
    assert watch.position_breach(HOME, tool, NORMAL).value == pytest.approx(-0.05)


@pytest.mark.parametrize(
    ("use", "mode", "counts"),
    [
        ("always", NORMAL, True),
        ("always", REDUCED, True),
        ("normal", NORMAL, True),
        ("normal", REDUCED, False),
        ("reduced", NORMAL, False),
        ("reduced", REDUCED, True),
        ("trigger_reduced", NORMAL, False),
        ("trigger_reduced", REDUCED, False),
    ],
)
def test_a_plane_counts_in_its_mode(use, mode, counts):
    watch = monitor(planes=(SafetyPlane("p", (0.0, 0.0, Z + 1.0), UP, use=use),))
    assert (watch.position_breach(HOME, IDENTITY, mode) is not None) == counts
    assert watch.asks_for_reduced(HOME, IDENTITY, (False,) * 4) == (use == "trigger_reduced")


def test_a_pair_of_inputs_switches_its_planes():
    watch = monitor(planes=(SafetyPlane("p", (0.0, 0.0, Z + 1.0), UP, pair=2),))
    assert watch.position_breach(HOME, IDENTITY, NORMAL) is None
    assert watch.position_breach(HOME, IDENTITY, NORMAL, (True, True, False, True)) is None
    assert watch.position_breach(HOME, IDENTITY, NORMAL, (False, False, True, False)) is not None


@pytest.mark.parametrize(("tilt_deg", "is_inside"), [(29.9, True), (30.1, False)])
def test_the_tool_stays_in_its_cone(tilt_deg, is_inside):
    watch = monitor(tool_direction=ToolDirection((0.0, 0.0, -1.0), radians(30.0)))
    tool = transform_from_pose((0.0, 0.0, 0.0, radians(tilt_deg), 0.0, 0.0))
    breach = watch.position_breach(HOME, tool, NORMAL)
    assert (breach is None) == is_inside
    if breach is not None:
        assert breach.value == pytest.approx(radians(30.1))


def test_a_joint_that_turns_too_fast_is_named():
    watch = monitor(normal=SafetyBounds(qd_max=(1.0, 1.0, 1.0, 2.0, 2.0, 2.0)))
    assert watch.speed_breach(HOME, (1.0, -1.0, 1.0, 2.0, 2.0, -2.0), IDENTITY, NORMAL) is None
    breach = watch.speed_breach(HOME, (0.0, -1.5, 0.0, 0.0, 0.0, 0.0), IDENTITY, NORMAL)
    assert (breach.kind, breach.subject, breach.value, breach.limit) == ("joint_speed", "shoulder", 1.5, "<= 1")


def test_the_speed_of_the_tcp_is_that_of_the_point_and_not_of_its_rotation():
    watch = monitor(normal=SafetyBounds(tcp_speed_max=0.2))
    qd = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    radius = dist((0.0, 0.0), (X, Y))
    assert watch.tcp_speed(HOME, qd, IDENTITY) == pytest.approx(radius)
    assert watch.speed_breach(HOME, qd, IDENTITY, NORMAL).value == pytest.approx(radius)
    assert watch.speed_breach(HOME, (0.0, 0.0, 0.0, 0.0, 0.0, 3.0), IDENTITY, NORMAL) is None


def test_recovery_keeps_the_speeds_of_reduced_mode():
    watch = monitor(reduced=SafetyBounds(tcp_speed_max=0.1))
    qd = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert watch.speed_breach(HOME, qd, IDENTITY, NORMAL) is None
    assert "recovery" in watch.speed_breach(HOME, qd, IDENTITY, RECOVERY).text
    assert watch.speed_share(HOME, qd, IDENTITY, REDUCED) == pytest.approx(watch.tcp_speed(HOME, qd, IDENTITY) / 0.1)


def test_a_number_that_is_none_is_a_breach():
    watch = monitor(
        normal=SafetyBounds(qd_max=(1.0,) * 6, q_min=(-9.0,) * 6, q_max=(9.0,) * 6, tcp_speed_max=1.0),
    )
    nan = float("nan")
    assert watch.position_breach((nan,) * 6, IDENTITY, NORMAL).kind == "joint_range"
    assert watch.speed_breach(HOME, (nan,) * 6, IDENTITY, NORMAL).kind == "joint_speed"
