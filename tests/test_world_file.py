"""World files: what they set, and where a mistake in them is."""

import json
from pathlib import Path

import pytest

from elitescript import UsageError, VirtualRobot
from elitescript.cli.main import _parsed, main
from elitescript.cli.serve import robot_configs
from elitescript.controller.safety.limits import SafetyLimits
from elitescript.kernel.options import SECTIONS
from elitescript.world_file import closed_world, load_world_file

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


def test_what_is_beside_the_robot_can_be_left_out(cell):
    read = load_world_file(cell('[robot]\nstrict = true\n[[device]]\nclass = "no.py:Such"\n'), with_world=False)
    assert (read.world, read.options) == (None, {"strict": True})
    assert read.beside == {"device": [{"class": "no.py:Such"}]}


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
    with pytest.raises(UsageError, match=r"cannot read .*nothing\.toml: No such file"):
        load_world_file(tmp_path / "nothing.toml")


ROBOT = """\
[robot]
model = "my_arm.toml"
firmware = "2.10"
speed = 0.5
joints = [0.1, -1.5, -1.5, -1.5, 1.5, 0.0]
epoch_s = 2025-01-01T00:00:00Z
strict = true

[safety]
tcp_speed = 0.5
"""
"""Options of a robot; the arm is described by a file beside the world file."""


@pytest.fixture
def robot_file(cell):
    path = cell(ROBOT)
    (path.parent / "my_arm.toml").write_text('base = "CS63"\nname = "cell 3"\n')
    return path


def test_a_file_sets_options_of_the_robot(robot_file):
    robot = VirtualRobot(world=robot_file)
    assert (robot.model.name, robot.profile.name, robot.options.strict) == ("cell 3", "2.10", True)
    assert (robot.state.speed_scale, robot.state.q_actual[0], robot.options.epoch_s) == (0.5, 0.1, 1_735_689_600.0)


def test_a_keyword_counts_more_than_the_file(robot_file):
    robot = VirtualRobot("CS66", world=robot_file, speed=0.25, firmware="2.14", joints=None)
    assert (robot.model.name, robot.profile.name, robot.state.speed_scale) == ("CS66", "2.14", 0.25)
    assert (robot.state.q_actual[0], robot.options.strict) == (0.1, True)


def test_the_command_line_counts_more_than_the_file(robot_file, tmp_path, capsys):
    program = tmp_path / "p.script"
    program.write_text("textmsg(get_actual_joint_positions()[0])\n")

    def joint_0(*options):
        assert main(["run", str(program), "--world", str(robot_file), "--json", *options]) == 0
        return json.loads(capsys.readouterr().out.splitlines()[-1])["joints"][0]

    assert joint_0() == 0.1
    assert joint_0("--joints", "0.2,-1.5,-1.5,-1.5,1.5,0") == 0.2
    assert main(["run", str(program), "--world", str(robot_file), "--speed", "7"]) == 2
    assert "--speed must be in [0, 1], got 7.0" in capsys.readouterr().err


def test_served_robots_take_the_options_of_the_file(robot_file):
    (first, second), _ = robot_configs(_parsed(["serve", "--world", str(robot_file), "--robots", "2"]))
    assert (first.model, first.model_text[:13], first.firmware) == ("my_arm.toml", 'base = "CS63"', "2.10")
    assert (first.speed, first.epoch_s, first.power_on) == (0.5, 1_735_689_600.0, False)
    assert (first.robot_id, second.robot_id) == ("cell 3-0", "cell 3-1")
    (given,), _ = robot_configs(_parsed(["serve", "--world", str(robot_file), "--robot", "CS66", "--speed", "1"]))
    assert (given.model, given.model_text, given.speed, given.firmware) == ("CS66", "", 1.0, "2.10")


def test_a_file_names_the_served_robots(cell):
    path = cell('[robot]\nrobot_id = "left"\nremote = false\npower_on = true\n')
    (alone,), _ = robot_configs(_parsed(["serve", "--world", str(path)]))
    assert (alone.robot_id, alone.remote, alone.power_on, alone.model) == ("left", False, True, "CS66")
    several, _ = robot_configs(_parsed(["serve", "--world", str(path), "--robots", "2", "--instance", "4"]))
    assert [config.robot_id for config in several] == ["left-4", "left-5"]


def test_programs_are_checked_for_the_robot_of_the_file(cell, tmp_path, capsys):
    program = tmp_path / "p.script"
    program.write_text("movej([0, -1.5, 0, 0, 0, 0])\nmovel([1.2, 0, 0.3, 0, 3.1, 0])\n")
    assert main(["check", str(program), "--world", str(cell('[robot]\nmodel = "CS63"\n')), "--json"]) == 0
    assert "W237" in (found := capsys.readouterr().out) or "reach" in found
    path = cell('[robot]\nmodel = "CS625"\n')
    assert main(["check", str(program), "--world", str(path), "--json"]) == 0
    assert "reach" not in capsys.readouterr().out
    assert main(["check", str(program), "--world", str(path), "--robot", "CS63", "--json"]) == 0
    assert "reach" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("[robot]\nseed = 1\nspeed = 2\n", 3, r"\[robot\] speed must be in \[0, 1\], got 2"),
        ("[robot]\nseed = 1\nsped = 1\n", 3, r"\[robot\] sped is not known; .*did you mean 'speed'"),
        ("[robot]\n\nmodel = 'CS99'\n", 3, r"\[robot\] model: .*CS99"),
        ("[robot]\nmodel = 'none.toml'\n", 2, r"\[robot\] model: .*none.toml"),
        ("[robot]\njoints = [1, 2]\n", 2, r"\[robot\] joints must be six numbers in rad, got 2"),
        ("[robot]\nfirmware = 2.14\n", 2, r'\[robot\] firmware must be "2.10" or "2.14", got 2.14'),
        ("[robot]\nsafety = 1\n", 2, r"\[robot\] safety is a section of its own: \[safety\]"),
        ("robot = 1\n", 1, r"\[robot\] must be a table"),
    ],
)
def test_a_mistake_in_the_options_of_the_robot_is_located(cell, text, line, words):
    path = cell(text)
    with pytest.raises(UsageError, match=words) as caught:
        load_world_file(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")


class TestClosedWorld:
    def test_nothing_is_around_without_a_file(self):
        world = closed_world(None)
        assert (world.network.outside, world.settings, world.devices) == (None, None, [])

    def test_it_has_the_settings_of_a_file_without_devices(self, tmp_path):
        (tmp_path / "cell.toml").write_text('[robot]\nmodel = "CS63"\n')
        world = closed_world(tmp_path / "cell.toml")
        assert world.network.outside is None
        assert world.settings.options["model"] == "CS63"

    @pytest.mark.parametrize("is_trusted", [False, True])
    def test_the_network_of_this_computer_is_refused(self, tmp_path, is_trusted):
        (tmp_path / "cell.toml").write_text('[world]\nnetwork = "real"\n')
        with pytest.raises(UsageError, match="network: 'real' is not allowed here"):
            closed_world(tmp_path / "cell.toml", is_trusted=is_trusted)

    def test_it_can_be_allowed(self, tmp_path):
        (tmp_path / "cell.toml").write_text('[world]\nnetwork = "real"\n')
        assert not closed_world(tmp_path / "cell.toml", is_trusted=True, may_connect=True).is_closed
        assert not closed_world(None, may_connect=True).is_closed
        assert closed_world(None).is_closed
