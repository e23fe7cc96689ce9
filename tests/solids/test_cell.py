"""Solids of world files: what they give, and where a mistake in them is."""

from __future__ import annotations

from math import pi

import pytest

from elitescript.errors import UsageError
from elitescript.solids.cell import LINKS
from elitescript.world_file import load_world_file

GOOD = """[[box]]
name = "table"
size = [1.0, 0.8, 0.04]
pose = [0.2, 0.0, -0.02]
color = "#8a8f98"

[[cylinder]]
radius = 0.05
length = 0.3
pose_deg = [0.3, 0.0, 0.15, 0, 90, 0]

[[sphere]]
name = "table"
radius = 0.1

[tool]
name = "gripper"
color = "#102030"
ignore = ["table"]

[[tool.box]]
name = "jaw"
size = [0.02, 0.02, 0.05]

[[tool.cylinder]]
radius = 0.03
length = 0.1
pose = [0, 0, 0.05]

[tool.payload]
[[tool.payload.sphere]]
radius = 0.02
ignore = ["arm"]
"""


def load(tmp_path, text):
    path = tmp_path / "cell.toml"
    path.write_text(text)
    return load_world_file(path)


def test_it_gives_parts_with_names_poses_and_colours(tmp_path):
    file = load(tmp_path, GOOD)
    assert file.world is None
    parts = {(part.name, part.kind): part for part in file.cell.parts}
    table = parts["table", "box"]
    assert (table.link, table.role, table.size, table.color) == (0, "thing", (1.0, 0.8, 0.04), "#8a8f98")
    assert table.pose == (0.2, 0.0, -0.02, 0.0, 0.0, 0.0)
    assert parts["cylinder 1", "cylinder"].pose == pytest.approx((0.3, 0.0, 0.15, 0.0, pi / 2, 0.0))
    assert parts["table", "sphere"].size == (0.1,)
    jaw = parts["jaw", "box"]
    assert (jaw.link, jaw.role, jaw.color) == (7, "tool", "#102030")
    assert parts["gripper", "cylinder"].pose[2] == 0.05
    assert parts["payload", "sphere"].role == "payload"
    pairs = {tuple(sorted(pair)) for pair in file.cell.ignored}
    assert pairs == {("jaw", "table"), ("gripper", "table"), *(tuple(sorted(("payload", link))) for link in LINKS)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[box]]\nsize = [1, 1]\n", "cell.toml:2: [[box]] 1: size: needs 3 numbers in brackets, got [1, 1]"),
        ("[[box]]\nname = 'a'\n", "cell.toml:1: [[box]] 1: size: missing; lengths are m"),
        ("[[box]]\nsize = [800, 1, 1]\n", "cell.toml:2: [[box]] 1: size: must be > 0 and at most 20 m, got 800"),
        ("[[sphere]]\nradius = 1\n[[sphere]]\nradius = -1\n", "cell.toml:4: [[sphere]] 2: radius: must be > 0"),
        ("[[sphere]]\nradius = 'x'\n", "cell.toml:2: [[sphere]] 1: radius: needs a finite number, got 'x'"),
        ("[[sphere]]\nradius = nan\n", "cell.toml:2: [[sphere]] 1: radius: needs a finite number, got nan"),
        ("[[cylinder]]\nradius = 1\nlenght = 1\n", "did you mean 'length'?"),
        ("[[cylinder]]\nradius = 1\nlenght = 1\n", "cell.toml:3: [[cylinder]] 1: lenght: is not known"),
        ("[[sphere]]\nradius = 1\npose = [1, 2]\n", "cell.toml:3: [[sphere]] 1: pose: needs 3 or 6 numbers"),
        ("[[sphere]]\nradius = 1\npose=[400,2,3]\n", "cell.toml:3: [[sphere]] 1: pose: must be within"),
        ("[[sphere]]\nradius = 1\npose=[0,0,0]\npose_deg=[0,0,0]\n", "cell.toml:4: [[sphere]] 1: pose_deg: the"),
        ("[[sphere]]\nradius = 1\ncolor = 'red'\n", 'cell.toml:3: [[sphere]] 1: color: must be as'),
        ("[[sphere]]\nradius = 1\nname = 3\n", "cell.toml:3: [[sphere]] 1: name: must be a text, got 3"),
        ("[[sphere]]\nradius = 1\nname = 'forearm'\n", "cell.toml:3: [[sphere]] 1: name: 'forearm' is a"),
        ("[[sphere]]\nradius = 1\nignore = 'arm'\n", "cell.toml:3: [[sphere]] 1: ignore: must be a list"),
        ("[[sphere]]\nradius = 1\nignore = ['gripper']\n", "cell.toml:3: [[sphere]] 1: ignore: 'gripper' is"),
        ("[sphere]\nradius = 1\n", "cell.toml:1: [[sphere]] must be a list of tables"),
        ("[[tool]]\nname = 'a'\n", "cell.toml:1: [tool] must be a table"),
        ("[tool]\nname = 'a'\n", "cell.toml:1: [tool] has no solid: write [[tool.box]]"),
        ("[tool]\nsize = 3\n", "cell.toml:2: [tool] size: is not known; there are name,"),
        ("[tool]\n[[tool.box]]\nsize = [1,1,1]\n[[tool.box]]\nsize=1\n", "cell.toml:5: [[tool.box]] 2: size: needs"),
        ("[tool]\n[tool.payload]\n", "cell.toml:2: [tool.payload] has no solid"),
        ("[[box]]\nname = 'tool'\nsize = [1,1,1]\n[tool]\n[[tool.box]]\nsize=[1,1,1]\n", "is the name of a thing"),
        ("[[boxx]]\n", "cell.toml:1: [boxx] is not known"),
    ],
)  # fmt: skip
def test_a_mistake_is_refused_with_its_line(tmp_path, text, message):
    with pytest.raises(UsageError) as caught:
        load(tmp_path, text)
    assert message in str(caught.value)
