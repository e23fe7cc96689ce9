"""The parts of arms against a table written by hand, mm: extents of the vendor's meshes in link frames."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.models.model import load_model, parse_model
from elitescript.solids.arm import arm_parts
from elitescript.solids.shapes import transform_of

NAMES = ("CS63", "CS66", "CS612", "CS616", "CS620", "CS625")

# What is meant, then one column for each model: numbers in mm.
TABLE = """
foot radius                 64    75    95    95    120   120
base height                 86    92    101   101   117   117
shoulder radius             50    60    77    77    93    93
shoulder z from            -67   -71   -92   -92   -118  -118
shoulder z to               78    77    92    92    116   116
shoulder y to              -61   -70   -89   -89   -107  -107
upper arm radius            50    61    78    78    93    93
upper arm z from            61    70    89    89    107   107
upper arm z to              206   219   272   272   341   341
upper tube radius first     46    59    76    76    91    91
upper tube radius rest      43.5  48.5  59    59    76    76
upper tube z                128   141   181   181   225   225
elbow radius                45    50    61    61    78    78
elbow z from                61    74    110   110   134   134
elbow z to                  190   219   258   258   317   317
forearm radius              43    49    59    59    76    76
forearm z from             -33   -31   -20   -15   -14   -9
forearm z to                61    74    110   110   134   134
fore tube radius first      40    48.5  59    59    66    73
fore tube radius rest       38    38    43.5  43.5  48.5  48.5
fore tube z                 10    13    39    40    45    44
end radius                  40    40    45    45    50    50
end z from                 -57   -54   -22   -22   -33   -33
end z to                    59    62    107   107   112   112
wrist 1 radius              38    38    43.5  43.5  48.5  48.5
wrist 1 z from             -86   -86   -71   -71   -61   -61
wrist 1 y from             -49   -49   -67   -67   -67   -67
wrist 1 y to                67    67    62    62    78    78
wrist 2 radius              38    38    43.5  43.5  48.5  48.5
wrist 2 z from             -47   -47   -51   -51   -61   -61
wrist 2 y from             -67   -67   -62   -62   -78   -78
wrist 2 y to                49    49    67    67    67    67
wrist 3 radius              38    38    43    43    48    48
wrist 3 z from             -43   -43   -43   -43   -58   -58
wrist 3 z to                0     0     0     0     0     0
wrist 3 y from             -44   -44   -50   -50   -54   -54
"""


def extent(parts, direction):
    """Return the farthest that parts reach along a direction of their link frame, m."""
    x, y, z = direction
    best = None
    for part in parts:
        r11, r12, r13, r21, r22, r23, r31, r32, r33, px, py, pz = transform_of(part.pose)
        # Direction in the frame of the part.
        u, v, w = r11 * x + r21 * y + r31 * z, r12 * x + r22 * y + r32 * z, r13 * x + r23 * y + r33 * z
        across = (u * u + v * v) ** 0.5
        if part.kind == "box":
            reach = 0.5 * (abs(u) * part.size[0] + abs(v) * part.size[1] + abs(w) * part.size[2])
        elif part.kind == "cone":
            low, high, length = part.size
            reach = max(low * across - 0.5 * length * w, high * across + 0.5 * length * w)
        else:
            radius, length = part.size
            reach = radius * across + 0.5 * length * abs(w)
        value = px * x + py * y + pz * z + reach
        best = value if best is None else max(best, value)
    return best


def span(parts, axis):
    direction = tuple(float(i == axis) for i in range(3))
    opposite = tuple(-float(i == axis) for i in range(3))
    return -1000.0 * extent(parts, opposite), 1000.0 * extent(parts, direction)


def measured(model):
    """Return the numbers of the table as the parts have them, mm."""
    parts = [part for part in arm_parts(model) if part.role != "ring"]
    found = {}

    def link(number, *roles, near=None):
        chosen = [part for part in parts if part.link == number and (not roles or part.role in roles)]
        if near is not None:
            chosen = [part for part in chosen if abs(part.pose[0] - near) < 1e-9]
        return chosen

    found["foot radius"] = span(link(0), 0)[1]
    found["base height"] = span(link(0), 2)[1]
    found["shoulder radius"] = span(link(1), 0)[1]
    found["shoulder z from"], found["shoulder z to"] = span(link(1), 2)
    found["shoulder y to"] = span(link(1), 1)[0]
    for name, number, x in (
        ("upper arm", 2, 0.0),
        ("elbow", 2, model.arm.a2),
        ("forearm", 3, 0.0),
        ("end", 3, model.arm.a3),
    ):
        housing = link(number, "housing", "cap", near=x)
        found[f"{name} radius"] = span(housing, 1)[1]
        found[f"{name} z from"], found[f"{name} z to"] = span(housing, 2)
    for name, number, a in (("upper", 2, model.arm.a2), ("fore", 3, model.arm.a3)):
        tube = link(number, "tube")
        low, high = span(tube, 0)
        assert low == pytest.approx(1000.0 * a)
        assert high == pytest.approx(0.0, abs=1e-6)
        found[f"{name} tube radius first"] = span(tube, 1)[1]
        found[f"{name} tube radius rest"] = span([part for part in tube if part.kind == "cylinder"], 1)[1]
        found[f"{name} tube z"] = sum(span(tube, 2)) / 2.0
    for name, number in (("wrist 1", 4), ("wrist 2", 5), ("wrist 3", 6)):
        found[f"{name} radius"] = span(link(number), 0)[1]
        found[f"{name} z from"] = span(link(number), 2)[0]
        found[f"{name} y from"], found[f"{name} y to"] = span(link(number), 1)
    found["wrist 3 z to"] = span(link(7), 2)[1]
    return found


@pytest.mark.parametrize("column", range(6), ids=NAMES)
def test_extents_are_those_of_the_table(column):
    found = measured(load_model(NAMES[column]))
    checked = 0
    for line in TABLE.strip().splitlines():
        *words, a, b, c, d, e, f = line.split()
        name, expected = " ".join(words), float((a, b, c, d, e, f)[column])
        assert found[name] == pytest.approx(expected, abs=1.0), name
        checked += 1
    assert checked == 36


@pytest.mark.parametrize(
    ("name", "wrist_1_from", "wrist_2_to"),
    [("CS63", 59 - 144.5, 92 - 43), ("CS66", 62 - 147.5, 92 - 43), ("CS612", 107 - 177.5, 110.3 - 43),
     ("CS616", 107 - 177.5, 110.3 - 43), ("CS620", 112 - 172.5, 125 - 58), ("CS625", 112 - 172.5, 125 - 58)],
)  # fmt: skip
def test_sums_with_the_lengths_hold(name, wrist_1_from, wrist_2_to):
    found = measured(load_model(name))
    assert found["wrist 1 z from"] == pytest.approx(wrist_1_from, abs=0.6)
    assert found["wrist 2 y to"] == pytest.approx(wrist_2_to, abs=0.6)


def test_an_own_arm_has_the_outline_of_its_base_and_no_gaps():
    own = parse_model("own.toml", 'base = "CS66"\n[arm]\na2 = -0.5\nd4 = 0.2\nd6 = 0.15\n[outline]\nbase = [0.1]\n')
    found = measured(own)
    assert found["upper arm radius"] == pytest.approx(61.0)
    assert found["foot radius"] == pytest.approx(100.0)
    assert found["wrist 1 z from"] == pytest.approx(62.0 - 200.0)
    assert found["wrist 3 z from"] == pytest.approx(49.0 - 150.0)


def test_a_wrong_row_of_an_own_arm_is_refused_with_file_and_key():
    own = parse_model("own.toml", 'base = "CS66"\n[outline]\nshoulder = [0.1]\n')
    with pytest.raises(UsageError, match=r"own\.toml: outline\.shoulder: needs 4 numbers, has 1"):
        arm_parts(own)
    with pytest.raises(UsageError, match=r"outline\.shulder: unknown key; did you mean 'outline.shoulder'"):
        parse_model("own.toml", 'base = "CS66"\n[outline]\nshulder = [0.1]\n')


def test_rings_are_at_every_joint_and_the_notch_is_at_the_x_axis():
    parts = arm_parts(load_model("CS66"))
    rings = [part for part in parts if part.role == "ring" and part.kind == "cylinder"]
    assert [part.link for part in rings] == [1, 2, 3, 4, 5, 6]
    (notch,) = [part for part in parts if part.role == "ring" and part.kind == "box"]
    assert notch.link == 7
    assert notch.pose[0] > 0.025
    assert notch.pose[1] == 0.0


def test_the_thick_end_of_a_tube_is_at_its_joint():
    (cone,) = [part for part in arm_parts(load_model("CS66")) if part.kind == "cone" and part.link == 3]
    low, high, length = cone.size
    assert (low, high) == (0.038, 0.0485)
    _, _, r13, *_ = transform_of(cone.pose)
    assert r13 == pytest.approx(1.0)  # its z axis is the x axis of the link
    assert cone.pose[0] + length / 2 == pytest.approx(0.0)
