"""Numbers of the six arms against tables written by hand.

Lengths, masses, centres of mass, inertia and efforts are those of the vendor's description package (inertia converted
to the centre of mass, to five digits); that the lengths are right is confirmed by the manual's worked example. Payload
and reach follow the catalogue. What is *chosen* is so because the arm's own value is not known.
"""

from __future__ import annotations

from math import pi, radians

import pytest

from elitescript.models.model import RobotModel, load_model
from tests.tables import rows

# Model, type number, d1, a2, a3, d4, d5, d6 (m), payload (kg), reach (m), largest speed of the tool (m/s, chosen).
ARMS = """
CS63    6203   0.1530   -0.2700   -0.2575   0.1445   0.0965   0.0920    3   0.624   2.0
CS66    6206   0.1625   -0.4270   -0.3905   0.1475   0.0965   0.0920    6   0.914   2.5
CS612   6212   0.1930   -0.6150   -0.5710   0.1775   0.1180   0.1103   12   1.304   2.5
CS616   6216   0.1930   -0.5520   -0.4300   0.1775   0.1180   0.1103   16   1.100   2.5
CS620   6220   0.2350   -0.9000   -0.7720   0.1725   0.1280   0.1250   20   1.800   2.5
CS625   6225   0.2350   -0.7500   -0.6220   0.1725   0.1280   0.1250   25   1.500   2.5
"""

# Joint speeds (deg/s), rated torques (N m), torque constants (N m/A, chosen), from base to wrist 3.
JOINTS = """
CS63    180 180 180 360 360 360    56  56  28  12  12  12    10   10   9    8    8    8
CS66    150 150 180 230 230 230   150 150 150  28  28  28    12.5 12.5 12.5 9    9    9
CS612   120 120 180 180 180 180   330 330 150  56  56  56    17   17   12.5 10   10   10
CS616   120 120 180 180 180 180   330 330 150  56  56  56    17   17   12.5 10   10   10
CS620   120 120 150 210 210 210   730 730 430 100 100 100    24   24   19   11   11   11
CS625   120 120 150 210 210 210   730 730 430 100 100 100    24   24   19   11   11   11
"""

# Mass (kg), centre of mass (m), Ixx, Iyy, Izz, Ixy, Ixz, Iyz (kg m^2), from shoulder to wrist 3.
LINKS = {
    "CS63": """
        3.095    3.7e-05  -0.0149   -0.0105   0.0069297  0.0044988 0.0059989 -7.4403e-06 -4.2264e-06 0.00050191
        5.073   -0.11596  -2.6e-05   0.1148   0.0073107  0.084298  0.082825   2.2795e-05 -0.0019538  6.7581e-06
        2.425   -0.1542    1.4e-05   0.0238   0.0037084  0.033386  0.032095  -2.5351e-06 -0.0032761  2.534e-06
        1.559    1.3e-05  -0.00479  -0.02274  0.003659   0.0034102 0.001418  -2.0571e-06  2.1851e-06 0.00017017
        1.447   -1.4e-05   0.0051   -0.0127   0.0021077  0.0018525 0.0012815 -2.0563e-06 -2.3857e-06 -9.9306e-05
        0.5     -0.000684 -0.000175 -0.0423   0.00053634 0.00053502 0.00032625 2.9185e-07 6.5116e-06 2.4353e-06
    """,
    "CS66": """
        4.521    2.2e-05  -0.016526 -0.014442 0.012014  0.0082552 0.011542 -1.9483e-05 -4.0943e-07 0.0011258
        7.533   -0.17828   4e-06     0.12803  0.013711  0.29849   0.29706   7.0304e-05  0.0035679 -3.7322e-06
        3.009   -0.20416  -7e-06     0.03064  0.0059355 0.094566  0.092181 -1.3462e-05 -0.0080577 -2.3237e-07
        1.559    1.3e-05  -0.00479  -0.02274  0.003659  0.0034102 0.0014181 -2.0581e-06 2.1851e-06 0.00017017
        1.447   -1.4e-05   0.005107 -0.012702 0.0021075 0.0018524 0.0012814 -2.0565e-06 -2.3857e-06 -9.945e-05
        0.5     -0.000684 -0.000175 -0.04234  0.00053505 0.00053333 0.00032625 2.9185e-07 6.5253e-06 2.4388e-06
    """,
    "CS612": """
        6.83     9.3e-05  -0.02697  -0.02115  0.031205  0.022023  0.032531   1.1257e-05 -5.2723e-05 0.0041842
        13.037  -0.2304   -3.9e-05   0.16068  0.03681   0.99005   0.98894    0.000177    0.018761   5.1173e-05
        4.827   -0.2998    1.3e-05   0.06176  0.011694  0.31178   0.30825   -6.3127e-06 -0.012821   2.5495e-06
        2.315    1e-05    -0.0148   -0.01682  0.0049271 0.0043154 0.0027996 -1.5616e-06  3.6776e-06 0.00058903
        2.195   -1.3e-05   0.015559 -0.011803 0.0038009 0.0032015 0.0025983 -1.755e-06  -3.4922e-06 -0.00041728
        0.616   -0.001704 -0.000705 -0.039231 0.00074583 0.00076244 0.00056801 6.1301e-07 2.1397e-05 9.3372e-06
    """,
    "CS616": """
        6.83     9.3e-05  -0.02697  -0.02115  0.031207  0.022023  0.032531   1.1257e-05 -5.2723e-05 0.0041842
        13      -0.2069   -4.4e-05   0.16068  0.037798  0.80429   0.80216    0.00017386  0.019604   4.1529e-05
        4.7     -0.2303    1.5e-05   0.0622   0.01203   0.16731   0.16356   -7.8682e-06 -0.010726   2.8001e-06
        2.315    1e-05    -0.0148   -0.01682  0.0049291 0.0043176 0.0028002 -1.5986e-06  3.6776e-06 0.000589
        2.195   -1.3e-05   0.015559 -0.011803 0.003802  0.0032029 0.0025988 -1.755e-06  -3.4922e-06 -0.00041728
        0.616   -0.001704 -0.000705 -0.039231 0.00074668 0.00076347 0.00056853 6.1301e-07 2.1397e-05 9.3372e-06
    """,
    "CS620": """
        17.04    9.9e-05  -0.026311 -0.026723 0.10633   0.073047  0.10206    3.8324e-05 -0.00015178 0.012644
        26.927  -0.323686 -3.9e-05   0.200968 0.11679   4.165     4.1592     0.00080686  0.037169   9.4111e-05
        8.386   -0.376841  1.5e-05   0.070311 0.028586  0.92809   0.91831   -0.00013759 -0.056534  -5.0096e-06
        3.095   -3.7e-05  -0.01051  -0.014865 0.0069326 0.0060024 0.0044988  4.2276e-06  7.4363e-06 0.0005012
        3.095    3.7e-05   0.01051  -0.014865 0.0069326 0.0060024 0.0044988  4.2276e-06 -7.4363e-06 -0.0005012
        0.879    0.000242 -0.001192 -0.050422 0.0018299 0.0018256 0.0011691 -1.5439e-05  7.2733e-07 1.0679e-05
    """,
    "CS625": """
        17.04    9.9e-05  -0.026311 -0.026723 0.10633   0.073046  0.10206    3.8324e-05 -0.00015178 0.012644
        26.543  -0.27762  -1.7e-05   0.20184  0.11565   2.9846    2.9763     0.00095799  0.052268   6.3884e-05
        7.816   -0.30259   2.1e-05   0.07237  0.026861  0.58433   0.57516   -9.4663e-05 -0.044798  -2.6215e-06
        3.095   -3.7e-05  -0.01051  -0.014865 0.0069326 0.0060024 0.0044988  4.2276e-06 -4.0317e-06 0.00046588
        3.095    3.7e-05   0.01051  -0.014865 0.0069326 0.0060024 0.0044988  4.2276e-06 -7.4363e-06 -0.0005012
        0.879    0.000242 -0.001192 -0.050422 0.0018299 0.0018256 0.0011691 -1.5439e-05  7.2733e-07 1.0679e-05
    """,
}

# What all arms share; D: the manual or the vendor's driver says so, C: chosen.
SHARED = """
default_joint_speed            1.047197   D
default_joint_acceleration     1.396263   D
default_tool_speed             0.25       D
default_tool_acceleration      1.2        D
max_tool_acceleration          40         D
planning_joint_acceleration    5          D
stop_joint_deceleration        8          D
stop_tool_deceleration         3          C
equivalent_radius_m            0.25       C
speed_ramp_s                   0.2        C
tracking_acceleration          3          C
tracking_speed                 0.25       C
controller_temperature         35         C
thermal.time_constant_s        1200       C
thermal.joint_rise_torque      28         C
thermal.joint_rise_speed       20         C
thermal.controller_rise        10         C
safety.joint_speed_margin      0.19       C
safety.joint_position_margin   0.05       C
safety.tracking_error_max      0.1        C
safety.normal.tool_speed       1.5        C
safety.normal.elbow_speed      1.5        C
safety.normal.tool_force       150        C
safety.normal.power            300        C
safety.normal.momentum         25         C
safety.normal.stop_time_s      0.4        C
safety.normal.stop_distance    0.5        C
safety.reduced.tool_speed      0.75       C
safety.reduced.elbow_speed     0.75       C
safety.reduced.tool_force      120        C
safety.reduced.power           200        C
safety.reduced.momentum        10         C
safety.reduced.stop_time_s     0.3        C
safety.reduced.stop_distance   0.3        C
"""


@pytest.mark.parametrize("row", rows(ARMS), ids=lambda row: row[0])
def test_arm(row: tuple[str, ...]) -> None:
    name, number, *lengths, payload, reach, speed = row
    model = load_model(name)
    arm = model.arm
    assert model.type_id == int(number)
    assert (arm.d1, arm.a2, arm.a3, arm.d4, arm.d5, arm.d6) == tuple(map(float, lengths))
    assert (model.payload_max_kg, model.reach_m, model.max_tool_speed) == (float(payload), float(reach), float(speed))


@pytest.mark.parametrize("row", JOINTS.strip().split("\n"), ids=lambda row: row.split()[0])
def test_joints(row: str) -> None:
    name, *cells = row.split()
    speeds, torques, constants = (list(map(float, cells[at : at + 6])) for at in (0, 6, 12))
    joints = load_model(name).joints
    assert [joint.qd_max for joint in joints] == [radians(speed) for speed in speeds]
    assert [joint.effort_max for joint in joints] == torques
    assert [joint.torque_constant for joint in joints] == constants
    for joint in joints:
        assert (joint.q_min, joint.q_max, joint.qdd_max) == (-2 * pi, 2 * pi, 40.0)


@pytest.mark.parametrize("name", LINKS)
def test_links(name: str) -> None:
    shown = [(link.mass, *link.com, *link.inertia) for link in load_model(name).links]
    wanted = [tuple(map(float, line.split())) for line in LINKS[name].strip().split("\n")]
    assert [row[:4] for row in shown] == [pytest.approx(row[:4], rel=2e-3) for row in wanted]
    assert [row[4:] for row in shown] == [pytest.approx(row[4:], rel=5e-4) for row in wanted]


@pytest.mark.parametrize("name", LINKS)
@pytest.mark.parametrize(("path", "value", "mark"), rows(SHARED))
def test_shared_numbers(name: str, path: str, value: str, mark: str) -> None:
    model: RobotModel = load_model(name)
    found: object = model
    for part in path.split("."):
        found = getattr(found, part)
    assert found == float(value)
    assert (model.source(path).source == "chosen") == (mark == "C")


def test_where_an_arm_begins_and_what_pulls_it() -> None:
    model = load_model("CS66")
    assert model.home == pytest.approx([radians(angle) for angle in (0, -90, -90, -90, 90, 0)])
    assert model.gravity == (0.0, 0.0, 9.82)
    assert model.joint_temperatures == (30.0,) * 6
