"""Cell files: what they set, and where a mistake in them is."""

from pathlib import Path

import pytest

from elitescript import UsageError, VirtualRobot
from elitescript.controller.safety.limits import SafetyLimits
from elitescript.kernel.options import SECTIONS
from elitescript.world_file import load_world_file

GOOD = """# a cell
[safety]
tcp_speed = 0.5   # m/s

[[safety.planes]]
name = "table"
point = [0, 0, 0]
normal = [0, 0, 1]

[plant]
lag_s = 0.03

[signals]
"standard_digital_in[3]" = true
reduced_mode = true
"""


@pytest.fixture
def cell(tmp_path):
    def write(text):
        path = tmp_path / "cell.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def test_a_file_sets_limits_and_signals(cell):
    read = load_world_file(cell(GOOD))
    assert read.options["plant"].lag_s == 0.03
    assert read.options["safety"].normal.tcp_speed_max == 0.5
    assert read.signals == {"standard_digital_in[3]": True, "reduced_mode": True}
    robot = VirtualRobot("CS66", world=cell(GOOD))
    assert robot.signals["standard_digital_in[3]"] is True
    assert robot.state.safety_mode.name == "REDUCED"
    assert robot.run("def p():\n  textmsg(is_within_safety_limits([0.5, -0.1, -0.1, 0, 0, 0]))\nend\n").log == ["False"]


def test_the_example_of_the_reference_is_read(cell):
    page = Path(__file__).parents[1] / "docs" / "reference" / "safety.md"
    example = page.read_text(encoding="utf-8").partition("```toml\n")[2].partition("```")[0]
    limits = load_world_file(cell(example)).options["safety"]
    assert (len(limits.planes), limits.planes[0].pair, limits.tool_direction.axis) == (1, 0, (0.0, 0.0, -1.0))


def test_an_empty_file_sets_nothing(cell):
    assert load_world_file(cell("")).options == {}


def test_every_section_is_read_by_something_that_exists(cell):
    for section in SECTIONS:
        assert load_world_file(cell(f"[{section}]\n")).options[section] is not None


def test_a_section_is_given_once(cell):
    with pytest.raises(UsageError, match="safety is given by the world file too"):
        VirtualRobot("CS66", world=cell(GOOD), safety=SafetyLimits())


PLANES = "[safety]\n[[safety.planes]]\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("\n[safty]\n", 2, r"\[safty\] is not known; there are \[safety\].*\[signals\]"),
        ("safety = 3\n", 1, r"\[safety\] must be a table"),
        ("safety.tcp_sped = 3\n", 1, "tcp_sped is not known"),
        (
            "[safety]\n# tcp_speed\njoint_speed = 3\ntcp_speed = -1\n",
            4,
            "tcp_speed must be a number > 0 in m/s, got -1",
        ),
        ("[safety]\ntcp_speed = 1\n[safety.reduced]\ntcp_speed = 'x'\n", 4, "tcp_speed must be a number"),
        (PLANES + "[[safety.planes]]\npoint = [0, 0, 0]\nnormal = [0, 0]\n", 7, "normal must be three numbers"),
        (PLANES + "nam = 'x'\n", 5, "nam is not known"),
        ("[safety]\n[[safety.planes]]\npoint = [0, 0, 0]\n", 2, "normal is missing"),
        ("[safety]\ntool_direction = {axis = [0, 0, 0], angle = 1}\n", 2, "axis must be a direction"),
        ("[signals]\nreduced_mode = true\nstandard_digital_in = true\n", 3, "standard_digital_in needs an index"),
        ('[signals]\n"standard_digital_in[1]" = 7\n', 2, "takes True or False, not 7"),
        ("[signals]\nno_such = 1\n", 2, "no signal is called 'no_such'"),
        ("[plant]\nlag_s = 0.02\nlag = 1\n", 3, "plant.lag: unknown key"),
        ("[plant]\nseed = 1\nlag_s = 'a'\n", 3, "lag_s of the plant needs a number, has 'a'"),
    ],
)
def test_a_mistake_has_file_line_and_words(cell, text, line, words):
    path = cell(text)
    place = f"{path}:{line}: " if line else f"{path}: "
    with pytest.raises(UsageError, match=words) as caught:
        load_world_file(path)
    assert str(caught.value).startswith(place)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"[safety\n", "is not TOML: .*line 1.[^;]*$"),
        (b"[signals]\nstandard_digital_in[3] = true\n", 'line 2.*; names with an index stand in quotes: "standard'),
        (b"a = '\xff'\n", "is not UTF-8: .* at byte 5"),
    ],
)
def test_a_file_that_is_no_toml_says_where(cell, text, words):
    with pytest.raises(UsageError, match=words):
        load_world_file(cell(text))


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(UsageError, match=r"world file .*nothing\.toml: No such file"):
        load_world_file(tmp_path / "nothing.toml")
