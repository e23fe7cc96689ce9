"""The safety configuration: what makes no sense is refused, with the place."""

from math import pi, radians

import pytest

from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane, ToolDirection
from elitescript.errors import UsageError
from elitescript.kinematics.transforms import IDENTITY
from elitescript.messages.enums import SafetyMode

FULL = {
    "tcp_speed": 1.2,
    "joint_speed_deg": 90,
    "joint_range_deg": [[-180, 180]] * 5 + [[-360, 360]],
    "reduced": {"tcp_speed": 0.25, "joint_speed": [1, 1, 1, 1.5, 1.5, 1.5]},
    "planes": [
        {"name": "table", "point": [0, 0, 0.01], "normal": [0, 0, 2], "offset": 0.02},
        {"point": [0.5, 0, 0], "normal": [-1, 0, 0], "use": "reduced", "inputs": [2, 3]},
    ],
    "tool_direction": {"axis": [0, 0, -3], "angle_deg": 45},
}


def test_a_whole_table_is_read_in_its_units():
    limits = SafetyLimits.from_table(FULL)
    assert limits.normal.tcp_speed_max == 1.2
    assert limits.normal.qd_max == pytest.approx((pi / 2,) * 6)
    assert limits.normal.q_max == pytest.approx((pi,) * 5 + (2 * pi,))
    assert limits.bounds(SafetyMode.REDUCED).q_min == limits.normal.q_min
    assert limits.bounds(SafetyMode.REDUCED).qd_max == (1.0, 1.0, 1.0, 1.5, 1.5, 1.5)
    assert limits.bounds(SafetyMode.REDUCED).tcp_speed_max == 0.25
    table, wall = limits.planes
    assert (table.name, table.normal, table.offset_m, table.use, table.pair) == (
        "table",
        (0.0, 0.0, 1.0),
        0.02,
        "always",
        None,
    )
    assert (wall.name, wall.use, wall.pair) == ("plane 2", "reduced", 1)
    assert limits.tool_direction == ToolDirection((0.0, 0.0, -1.0), radians(45))
    assert not limits.is_default


def test_an_empty_table_watches_nothing_but_reduced_mode():
    limits = SafetyLimits.from_table({})
    assert limits == SafetyLimits()
    assert limits.is_default
    assert limits.bounds(SafetyMode.NORMAL).is_empty
    assert limits.bounds(SafetyMode.REDUCED).tcp_speed_max == 0.75


def test_speeds_of_reduced_mode_are_never_above_the_normal_ones():
    limits = SafetyLimits.from_table(
        {"tcp_speed": 0.3, "joint_speed": [1, 2, 3, 4, 5, 6], "reduced": {"joint_speed": 3}}
    )
    assert limits.bounds(SafetyMode.REDUCED).tcp_speed_max == 0.3
    assert limits.bounds(SafetyMode.REDUCED).qd_max == (1.0, 2.0, 3.0, 3.0, 3.0, 3.0)
    assert limits.bounds(SafetyMode.NORMAL).qd_max == (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)


def test_the_force_is_limited_in_every_mode_and_never_higher_in_reduced_mode():
    for table, normal, reduced in (
        ({}, 250.0, 150.0),
        ({"tcp_force": 400}, 400.0, 150.0),
        ({"tcp_force": 100}, 100.0, 100.0),
        ({"tcp_force": 400, "reduced": {"tcp_force": 390}}, 400.0, 390.0),
        ({"reduced": {"tcp_force": 300}}, 250.0, 250.0),
    ):
        limits = SafetyLimits.from_table(table)
        assert limits.tcp_force_max(SafetyMode.NORMAL) == normal
        assert limits.tcp_force_max(SafetyMode.REDUCED) == limits.tcp_force_max(SafetyMode.RECOVERY) == reduced
        assert limits.is_default


@pytest.mark.parametrize(
    ("table", "text"),
    [
        ({"tcp_force": 0}, r"^\[safety\] tcp_force must be a number > 0 in N, got 0"),
        ({"tcp_sped": 1}, r"^\[safety\] tcp_sped is not known; there are .*tcp_speed"),
        ({"tcp_speed": "fast"}, r"^\[safety\] tcp_speed must be a number > 0 in m/s, got 'fast'"),
        ({"tcp_speed": True}, r"tcp_speed must be a number > 0 in m/s, got True"),
        ({"tcp_speed": 0}, r"tcp_speed must be a number > 0 in m/s, got 0"),
        ({"tcp_speed": float("nan")}, r"tcp_speed must be a number > 0 in m/s, got nan"),
        ({"joint_speed": [1, 2]}, r"joint_speed must be 6 numbers in rad/s, got 2"),
        ({"joint_speed": 1, "joint_speed_deg": 1}, r"joint_speed_deg is given besides joint_speed"),
        ({"joint_range": [[0, 1]] * 5}, r"joint_range must be six pairs"),
        ({"joint_range_deg": [[0, 1]] * 5 + [[1, 0]]}, r"joint_range_deg\[5\] is an empty range: 1 to 0 deg"),
        ({"joint_range": [[0, 1]] * 5 + [7]}, r"joint_range\[5\] must be a pair"),
        ({"reduced": 3}, r"^\[safety.reduced\] must be a table"),
        ({"reduced": {"planes": []}}, r"^\[safety.reduced\] planes is not known"),
        ({"planes": {}}, r"planes must be a list of tables"),
        ({"planes": [{"point": [0, 0, 0]}]}, r"^\[\[safety.planes\]\] 1: normal is missing"),
        ({"planes": [{"normal": [0, 0, 0], "point": [0, 0, 0]}]}, r"normal must be a direction"),
        ({"planes": [{"normal": [0, 0, 1], "point": [0, 0]}]}, r"point must be 3 numbers in m, got 2"),
        ({"planes": [{"normal": [0, 0, 1], "point": [0, 0, 0], "use": "x"}]}, r"use must be one of 'always'"),
        ({"planes": [{"normal": [0, 0, 1], "point": [0, 0, 0], "inputs": [1, 2]}]}, r"inputs must be one of \[0, 1\]"),
        ({"planes": [{"normal": [0, 0, 1], "point": [0, 0, 0], "nam": "x"}]}, r"nam is not known"),
        ({"tool_direction": {"angle_deg": 10}}, r"^\[safety.tool_direction\] axis is missing"),
        ({"tool_direction": {"axis": [0, 0, 1]}}, r"angle_deg or angle must be given"),
        ({"tool_direction": {"axis": [0, 0, 1], "angle_deg": 200}}, r"angle must not be more than pi"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_place(table, text):
    with pytest.raises(UsageError, match=text):
        SafetyLimits.from_table(table)


@pytest.mark.parametrize(
    "make",
    [
        lambda: SafetyBounds(q_min=(0.0,) * 6, q_max=(0.0,) * 6),
        lambda: SafetyBounds(qd_max=(1.0, 1.0, 1.0, 1.0, 1.0, -1.0)),
        lambda: SafetyBounds(tcp_speed_max=0.0),
        lambda: SafetyPlane("p", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        lambda: SafetyPlane("p", (float("inf"), 0.0, 0.0), (0.0, 0.0, 1.0)),
        lambda: SafetyPlane("p", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), use="sometimes"),
        lambda: SafetyPlane("p", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), pair=4),
        lambda: ToolDirection((0.0, 0.0, 1.0), 4.0),
    ],
)
def test_a_configuration_made_in_python_is_checked_too(make):
    with pytest.raises(UsageError):
        make()


def test_a_plane_measures_along_its_normal_from_its_offset():
    plane = SafetyPlane("p", (0.0, 0.0, 1.0), (0.0, 0.0, 5.0), 0.25)
    assert plane.distance((*IDENTITY[:9], 7.0, 8.0, 3.0)) == pytest.approx(1.75)
    assert plane.distance((*IDENTITY[:9], 7.0, 8.0, 1.0)) == pytest.approx(-0.25)


@pytest.mark.parametrize("mode", ["automatic", "manual"])
def test_the_operational_mode_is_automatic_or_manual(mode):
    assert SafetyLimits.from_table({"operational_mode": mode}).operational_mode == mode


@pytest.mark.parametrize("mode", ["auto", 1, "not reported"])
def test_another_operational_mode_is_refused(mode):
    with pytest.raises(UsageError, match=r"\[safety\] operational_mode must be \"automatic\" or \"manual\", got"):
        SafetyLimits.from_table({"operational_mode": mode})
