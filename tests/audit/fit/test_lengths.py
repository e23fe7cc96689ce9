"""Lengths from points with joints and pose: hidden lengths, rounded digits, what is not determined."""

import random
from math import pi

import pytest

from elitescript.audit.fit.lengths import fit_lengths
from elitescript.audit.fit.pairs import points_of_file, points_of_program
from elitescript.errors import UsageError
from elitescript.kinematics.transforms import pose_from_transform, transform_from_pose
from elitescript.models.model import load_model
from elitescript.records import replace

NOMINAL = load_model("CS66").arm
TAUGHT = (0.4, -1.3, -1.7, -1.4, 1.5, 0.2)
TRUE = {"d1": 0.1628, "a2": -0.4275, "a3": -0.3901, "d4": 0.1474, "d5": 0.0969, "d6": 0.095}
HIDDEN = replace(NOMINAL, **TRUE)


def csv_of(arm, joints, digits=5, tcp=(0.0,) * 6):
    T_flange_tcp = transform_from_pose(tcp)
    lines = []
    for q in joints:
        pose = pose_from_transform(arm.forward_tcp(q, T_flange_tcp))
        lines.append(",".join(repr(round(value, digits)) for value in (*q, *pose)))
    return "\n".join(lines)


def fitted(arm, joints, digits=5, tcp=(0.0,) * 6, **more):
    return fit_lengths(points_of_file(csv_of(arm, joints, digits, tcp), "points.csv", tcp), NOMINAL, **more)


def spread(seed, count, reach=0.8):
    rng = random.Random(seed)
    return [tuple(angle + rng.uniform(-reach, reach) for angle in TAUGHT) for _ in range(count)]


def tool_down(count):
    # q2 + q3 + q4 = -3 pi / 2 + ... and q5 = pi / 2 keep the flange pointing down.
    rng = random.Random(1)
    joints = []
    for _ in range(count):
        q2, q3 = -1.3 + rng.uniform(-0.3, 0.3), -1.7 + rng.uniform(-0.3, 0.3)
        joints.append((rng.uniform(-0.5, 0.5), q2, q3, -1.5 * pi - q2 - q3, pi / 2, rng.uniform(-0.5, 0.5)))
    return joints


def by_name(fit):
    return {parameter.name: parameter for parameter in fit.parameters}


def test_hidden_lengths_are_found_from_five_digits():
    fit = fitted(HIDDEN, spread(3, 8))
    assert fit.differs
    for name, true in TRUE.items():
        parameter = by_name(fit)[name]
        assert parameter.found == pytest.approx(true, abs=2e-5)
        low, high = parameter.interval
        assert high - low < 6e-5
    assert fit.rms_before > 1e-3
    assert fit.rms_after < 2e-5


def test_the_right_model_agrees():
    fit = fitted(NOMINAL, spread(4, 6))
    assert not fit.differs
    assert not any(parameter.differs for parameter in fit.parameters)


def test_intervals_hold_the_truth_as_often_as_they_say():
    held = total = 0
    for seed in range(100):
        fit = fitted(HIDDEN, spread(1000 + seed, 4))
        for name, true in TRUE.items():
            low, high = by_name(fit)[name].interval
            held += low <= true <= high
            total += 1
    # 95 % of 600; six lengths of one fit hang together, so the band is that of 250 independent ones.
    assert 0.91 <= held / total <= 0.985


def test_with_the_tool_down_only_the_difference_is_known():
    fit = fitted(HIDDEN, tool_down(10), digits=9)
    found = by_name(fit)
    assert found["d1"].found is None
    assert found["d6"].why == "known only together with d1"
    assert found["a2"].found == pytest.approx(TRUE["a2"], abs=1e-6)
    (row,) = fit.combinations
    assert row.text == "d1 - d6"
    assert row.interval[0] <= TRUE["d1"] - TRUE["d6"] <= row.interval[1]
    assert any("only their difference is determined" in words for words in fit.words)


def test_one_point_determines_no_length_but_contradicts_the_model():
    fit = fitted(HIDDEN, [TAUGHT])
    assert fit.differs
    assert sum(parameter.found is None for parameter in fit.parameters) >= 3


def test_the_given_tcp_decides_between_it_and_d6():
    tcp = (0.01, -0.02, 0.15, 0.0, 0.3, 0.0)
    fit = fitted(HIDDEN, spread(5, 8), tcp=tcp)
    assert by_name(fit)["d6"].found == pytest.approx(TRUE["d6"], abs=3e-5)
    longer = points_of_file(csv_of(NOMINAL, spread(5, 8), tcp=(0.0, 0.0, 0.003, 0.0, 0.0, 0.0)), "points.csv")
    other = fit_lengths(longer, NOMINAL)
    assert by_name(other)["d6"].found == pytest.approx(0.095, abs=3e-5)
    assert any("a TCP offset along the z axis of the flange are the same" in words for words in other.words)


def test_a_point_that_does_not_fit_the_others_is_left_out_and_named():
    lines = csv_of(HIDDEN, spread(6, 8)).splitlines()
    cells = lines[3].split(",")
    cells[7] = repr(float(cells[7]) + 0.01)
    lines[3] = ",".join(cells)
    fit = fit_lengths(points_of_file("\n".join(lines), "points.csv"), NOMINAL)
    assert fit.used == 7
    assert fit.left_out == ("points.csv:4: its pose is not that of its joints, while the other points agree",)
    assert by_name(fit)["d6"].found == pytest.approx(TRUE["d6"], abs=3e-5)


def test_noise_beyond_the_digits_widens_the_intervals():
    rng = random.Random(7)
    rows = []
    for line in csv_of(HIDDEN, spread(8, 12)).splitlines():
        cells = [float(cell) for cell in line.split(",")]
        cells[6:9] = [round(cell + rng.gauss(0.0, 2e-4), 5) for cell in cells[6:9]]
        rows.append(",".join(map(repr, cells)))
    fit = fit_lengths(points_of_file("\n".join(rows), "points.csv"), NOMINAL)
    assert any("the intervals are widened" in words for words in fit.words)
    low, high = by_name(fit)["d6"].interval
    assert high - low > 1e-4
    assert low <= TRUE["d6"] <= high


def test_joint_zeros_are_found_when_asked_for():
    zeros = (0.0, 0.002, -0.003, 0.001, 0.004, 0.0)
    joints = spread(9, 20)
    shown = [tuple(angle - zero for angle, zero in zip(q, zeros, strict=True)) for q in joints]
    lines = []
    for q, read in zip(joints, shown, strict=True):
        pose = pose_from_transform(HIDDEN.forward(q))
        lines.append(",".join(repr(round(value, 7)) for value in (*read, *pose)))
    fit = fit_lengths(points_of_file("\n".join(lines), "points.csv"), NOMINAL, zeros=True)
    found = by_name(fit)
    for name, true in zip(("shoulder", "elbow", "wrist1", "wrist2"), zeros[1:5], strict=True):
        assert found[f"zero.{name}"].found == pytest.approx(true, abs=1e-5)
    assert found["d6"].found == pytest.approx(TRUE["d6"], abs=1e-5)


# Three points of one welding program for a CS66 that its teach pendant wrote, all digits as they stand there.
WRITTEN_BY_A_PENDANT = """\
def resource():
  set_tcp([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
  movej(get_inverse_kin(touched([0.3840815975778526, 0.06940005726177045, 0.4753079998448488, -3.141591470706301, \
7.522785813227031E-7, -1.570795659007012]), qnear=[0.56630344846347,-1.2721295632916005,-1.870202375828231,\
-1.5700556394316383,1.570796327,0.5663027806760305]), 1.396, 1.047, 0, 0.0)
  movej(get_inverse_kin(touched([0.38408019562375223, 0.06939916594756605, 0.4380482243344044, -3.141590115328999, \
1.6139795880866472E-6, -1.5707956590054084]), qnear=[0.56630344846347,-1.2766912192911313,-1.9626691851781655,\
-1.4730255679762436,1.570796327,0.5663027806760305]), 1.396, 1.047, 0, 0.0)
  movej(get_inverse_kin(touched([0.38408013533368235, 0.06939912761721295, 0.4117729016652193, -3.141591194942183, \
9.275860339063794E-7, -1.5707956590067804]), qnear=[0.56630344846347,-1.2856477513771662,-2.0244361281989303,\
-1.40230337224439,1.570796327,0.5663027806760305]), 1.396, 1.047, 0, 0.0)
  movej(get_inverse_kin(touched([0.38907999519916653, 0.06939899523614561, 0.4167730417940553, -3.141591194942183, \
9.275860339063794E-7, -1.5707956590067804]), qnear=[0.56630344846347,-1.2856477513771662,-2.0244361281989303,\
-1.40230337224439,1.570796327,0.5663027806760305]), 1.396, 1.047, 0, 0.0)
end
"""


def test_a_written_program_has_a_flange_of_three_millimetres_more():
    fit = fit_lengths(points_of_program(WRITTEN_BY_A_PENDANT, "resource.script"), NOMINAL)
    found = by_name(fit)
    assert fit.used == 3
    assert found["d6"].found == pytest.approx(0.095, abs=1e-9)
    assert found["d6"].interval[0] <= 0.095 <= found["d6"].interval[1]
    for name in ("d1", "a2", "a3", "d4", "d5"):
        assert found[name].found == pytest.approx(getattr(NOMINAL, name), abs=1e-9)
        assert not found[name].differs
    assert fit.rms_before == pytest.approx(3e-3)
    assert fit.rms_after < 1e-15
    # The fourth is a pose that was moved by the program; its joints are those of the third.
    assert len(fit.left_out) == 1
    assert fit.left_out[0].startswith("line 6: another pose with the same joints")


def test_joints_of_another_attitude_are_a_hint_and_no_point():
    text = "movej(get_inverse_kin([0.4, -0.2, 0.4, 3.1, 0.2, 1.5], qnear=[0, -1.5, -1.5, -1.5, 1.5, 0]))"
    with pytest.raises(UsageError, match="no point is known both as joints and as pose: line 1: the pose is turned"):
        fit_lengths(points_of_program(text, "hint.script"), NOMINAL)


def test_a_measured_chain_has_no_six_lengths():
    with pytest.raises(UsageError, match="measured chain"):
        fit_lengths(points_of_file(csv_of(NOMINAL, [TAUGHT]), "p.csv"), NOMINAL.calibrated(d=NOMINAL.modified_dh[1]))


def test_poses_measured_again_count_and_points_written_twice_do_not():
    rng = random.Random(4)
    rows = []
    for line in csv_of(NOMINAL, spread(2, 5), digits=6).splitlines():
        q, pose = line.split(",")[:6], [float(cell) for cell in line.split(",")[6:]]
        for _ in range(3):
            noisy = [value + rng.gauss(0.0, 1e-4) for value in pose[:3]] + pose[3:]
            rows.append(",".join([*q, *(f"{value:.6f}" for value in noisy)]))
    fit = fit_lengths(points_of_file("\n".join([*rows, rows[0]]), "p.csv"), NOMINAL)
    assert fit.used == 15
    assert fit.left_out == ("p.csv:16: the same point as p.csv:1",)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("p.csv", '"' + "a" * 200_000, "p.csv:1: not CSV"),
        ("p.json", "[" * 100_000, "nested more than 100 deep"),
        ("p.json", '[{"q": [1' + "0" * 400 + ', 0, 0, 0, 0, 0], "pose": [0, 0, 0, 0, 0, 0]}]', "six finite numbers"),
    ],
)
def test_files_that_no_table_has_are_refused_in_words(name, text, words):
    with pytest.raises(UsageError, match=words):
        points_of_file(text, name)


def test_numbers_beyond_all_range_in_a_program_are_no_point():
    text = "a_q = [1" + "0" * 400 + ", 0, 0, 0, 0, 0]\na_p = [0.1, 0.1, 0.1, 0, 0, 0]\n"
    assert points_of_program(text, "p.script").points == ()


def test_other_units_are_said_to_be_other_units():
    rows = csv_of(NOMINAL, spread(2, 2)).splitlines()
    cells = [row.split(",") for row in rows]
    text = "\n".join(",".join([*row[:6], *(f"{1e3 * float(x):.3f}" for x in row[6:9]), *row[9:]]) for row in cells)
    with pytest.raises(UsageError, match="not in rad and m"):
        fit_lengths(points_of_file(text, "p.csv"), NOMINAL)
