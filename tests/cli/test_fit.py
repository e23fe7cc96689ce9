"""`elitescript fit` on the command line."""

import json

import pytest

from elitescript.cli.main import main
from elitescript.kinematics.transforms import pose_from_transform
from elitescript.models.model import load_model
from elitescript.records import replace

JOINTS = (
    (0.4, -1.3, -1.7, -1.4, 1.5, 0.2),
    (0.9, -1.0, -1.2, -2.0, 0.9, 1.0),
    (-0.3, -1.7, -1.1, -0.9, 2.0, -0.4),
    (0.1, -0.8, -2.0, -1.1, 1.2, 0.6),
)
LONGER = replace(load_model("CS66").arm, d6=0.095)


@pytest.fixture
def cell(tmp_path):
    lines = []
    for q in JOINTS:
        pose = [round(value, 5) for value in pose_from_transform(LONGER.forward(q))]
        lines.append(f"  movej(get_inverse_kin({pose}, qnear={list(q)}))")
    path = tmp_path / "cell.script"
    path.write_text("def cell():\n" + "\n".join(lines) + "\nend\n", encoding="utf-8")
    return path


def test_a_longer_flange_differs_and_its_arm_file_agrees(cell, tmp_path, capsys):
    arm = tmp_path / "my_arm.toml"
    assert main(["fit", str(cell), "--out", str(arm)]) == 1
    out = capsys.readouterr().out
    assert "d6         0.092 m" in out
    assert out.rstrip().endswith("they differ")
    assert load_model(arm).arm.d6 == pytest.approx(0.095, abs=2e-5)
    assert main(["fit", str(cell), "--robot", str(arm)]) == 0


def test_json_has_the_parameters(cell, capsys):
    assert main(["fit", str(cell), "--json"]) == 1
    said = json.loads(capsys.readouterr().out)
    d6 = said["parameters"]["d6"]
    assert d6["model"] == 0.092
    assert d6["found"] == pytest.approx(0.095, abs=2e-5)
    assert d6["interval"][0] <= 0.095 <= d6["interval"][1]
    assert said["agrees"] is False


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "name programs with points"),
        (["none.script"], "cannot read none.script"),
        (["CELL", "--tcp", "1,2"], "--tcp 1,2: write six numbers in m and rad"),
        (["CELL", "--tcp", "0,0,nan,0,0,0"], "--tcp 0,0,nan,0,0,0: six finite numbers are needed"),
        (["NONE", "NONE"], "no point is known both as joints and as pose"),
        (["CELL", "--out", "arm.json"], "ends in .toml"),
        (["CELL", "--robot", "CS99"], "CS99"),
    ],
)
def test_wrong_usage_is_two(arguments, words, cell, tmp_path, capsys):
    (tmp_path / "none.script").write_text("textmsg(1)\n", encoding="utf-8")
    files = {"CELL": str(cell), "NONE": str(tmp_path / "none.script")}
    assert main(["fit", *(files.get(word, word) for word in arguments)]) == 2
    assert words in capsys.readouterr().err


def test_more_points_than_can_be_fitted_are_refused_with_the_number(tmp_path, capsys):
    row = ",".join(["0.1"] * 12) + "\n"
    (tmp_path / "many.csv").write_text(row * 20_001)
    assert main(["fit", "--pairs", str(tmp_path / "many.csv")]) == 2
    assert "20001 points with joints and pose are given; at most 20000 are fitted" in capsys.readouterr().err
