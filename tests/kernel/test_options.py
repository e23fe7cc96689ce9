"""Options of a robot: what they take, who counts more, and that one place suffices for one."""

from __future__ import annotations

import inspect
import subprocess
import sys
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from typing import get_type_hints

import pytest
from numpy import int64

from elitescript import VirtualRobot
from elitescript.controller.modes import PowerTimes
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits
from elitescript.errors import UsageError
from elitescript.kernel.options import (
    IN_VIRTUAL_TIME,
    KEYWORDS,
    OPTIONS,
    RobotOptions,
    options_of_table,
    robot_options,
)
from elitescript.messages.plant import PlantConfig

SOURCE = Path(__file__).parents[2] / "src" / "elitescript"

BY_HAND = {
    "model": "CS66",
    "firmware": "2.14",
    "controller_version": "",
    "seed": 0,
    "epoch_s": datetime(2024, 1, 1, tzinfo=UTC).timestamp(),
    "joints": None,
    "speed": 1.0,
    "power_on": False,
    "remote": True,
    "robot_id": "elitescript",
    "serial_number": "ES0000000001",
    "query_form": "bracketed",
    "configuration": "default.configuration",
    "safety": None,
    "contact": None,
    "plant": None,
    "work_per_tick": 2000,
    "held_up_max_s": 0.25,
    "rpc_timeout_s": 60.0,
    "network": "local",
    "strict": False,
    "ignore": "",
    "confirms_popups": False,
}
"""What users may set, with the defaults."""

CODES = 'ignore must be codes of findings such as "W230,N280", '
NETWORK = 'network must be "none", "local", "all" or addresses such as "192.168.1.5:502,camera.local"'


def test_the_defaults_are_those_that_are_promised():
    options = RobotOptions()
    assert {name: getattr(options, name) for name in ("model", *KEYWORDS)} == BY_HAND
    assert (options.model_text, options.first_tick, options.signals, options.faults) == ("", 0, (), ())
    assert options.power_times == PowerTimes(0.4, 0.8, 1.0)
    assert {"power_on": True, "power_times": PowerTimes(0.0, 0.0, 0.0), "confirms_popups": True} == IN_VIRTUAL_TIME


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("speed", 1.5, "speed must be in [0, 1], got 1.5"),
        ("speed", -0.1, "speed must be in [0, 1], got -0.1"),
        ("speed", float("nan"), "speed must be finite, got nan"),
        ("speed", True, "speed must be a number, got True"),
        ("speed", "1", "speed must be a number, got '1'"),
        ("speed", None, "speed must be a number, got None"),
        ("rpc_timeout_s", float("inf"), "rpc_timeout_s must be finite, in s, got inf"),
        ("rpc_timeout_s", [1], "rpc_timeout_s must be a number in s, got [1]"),
        ("network", 1, f"{NETWORK}, got 1"),
        ("network", "", f"{NETWORK}, got '': write HOST[:PORT], a network such as 192.168.1.0/24, local, all or none"),
        ("network", "none,all", f"{NETWORK}, got 'none,all': "),
        ("network", "10.0.0.1:0", f"{NETWORK}, got '10.0.0.1:0': a port is a number from 1 to 65535"),
        ("seed", 1.0, "seed must be a whole number, got 1.0"),
        ("seed", True, "seed must be a whole number, got True"),
        ("work_per_tick", 0, "work_per_tick must be a whole number >= 1, got 0"),
        ("firmware", "2.13", """firmware must be "2.10" or "2.14", got '2.13'"""),
        ("firmware", 2.14, """firmware must be "2.10" or "2.14", got 2.14"""),
        ("controller_version", 2.15, "controller_version must be a version such as 2.15.0.0, got 2.15"),
        ("controller_version", "2", "controller_version must be a version such as 2.15.0.0, each part up to 255; got"),
        ("controller_version", "2.15.0.0.1", "controller_version must be a version such as 2.15.0.0, each part up to"),
        ("controller_version", "2.256", "controller_version must be a version such as 2.15.0.0, each part up to 255"),
        ("controller_version", "2.-1", "controller_version must be a version such as 2.15.0.0, each part up to 255"),
        ("query_form", "json", """query_form must be "bracketed" or "plain", got 'json'"""),
        ("strict", 1, "strict must be true or false, got 1"),
        ("ignore", 1, CODES + "got 1"),
        ("ignore", "W230, W9", CODES + "there is no code 'W9'"),
        ("ignore", "E001", CODES + "E001 (Python syntax) cannot be left out"),
        ("robot_id", 7, "robot_id must be a text, got 7"),
        ("joints", [0.0] * 5, "joints must be six numbers in rad, got 5"),
        ("joints", "000000", "joints must be six numbers in rad, got '000000'"),
        ("joints", [0.0] * 5 + ["x"], "joints must be a number in rad, got 'x'"),
        ("joints", 3, "joints must be six numbers in rad, got 3"),
        ("epoch_s", "now", "epoch_s must be a number in s, got 'now'"),
        ("epoch_s", datetime(2024, 1, 1), "epoch_s must be seconds since 1970, or a date and time with a time zone"),
        ("safety", {"tcp_speed": 1}, "safety must be a `SafetyLimits`, got {'tcp_speed': 1}"),
        ("plant", SafetyLimits(), "plant must be a `PlantConfig`, got SafetyLimits("),
    ],
)
def test_a_value_that_makes_no_sense_is_refused(name, value, words):
    with pytest.raises(UsageError) as caught:
        RobotOptions(**{name: value})
    assert str(caught.value).startswith(words)


def test_values_are_held_in_one_form():
    options = RobotOptions(speed=1, joints=[0, -1, 1, 0, 1, 0], epoch_s=0)
    assert (type(options.speed), type(options.epoch_s), options.joints) == (
        float,
        float,
        (0.0, -1.0, 1.0, 0.0, 1.0, 0.0),
    )
    assert type(RobotOptions(seed=int64(3)).seed) is int
    moment = datetime(1970, 1, 1, 1, 0, 30, tzinfo=timezone(timedelta(hours=1)))
    assert RobotOptions(epoch_s=moment).epoch_s == 30.0


def test_what_is_given_counts_more_than_the_file_and_that_more_than_the_front_door():
    options = robot_options({"seed": 1, "speed": None}, {"seed": 2, "speed": 0.5}, seed=3, speed=0.3, strict=True)
    assert (options.seed, options.speed, options.strict, options.firmware) == (1, 0.5, True, "2.14")


def test_a_section_is_given_in_one_place():
    with pytest.raises(UsageError, match="safety is given by the world file too"):
        robot_options({"safety": SafetyLimits()}, {"safety": SafetyLimits()})
    assert robot_options({"safety": None}, {"safety": SafetyLimits()}).safety == SafetyLimits()


def test_a_table_sets_options():
    table = {
        "model": "CS63",
        "joints": [0, -1, 1, 0, 1, 0],
        "power_on": True,
        "epoch_s": datetime(2025, 1, 1, tzinfo=UTC),
    }
    assert options_of_table(table) == {
        "model": "CS63",
        "joints": (0.0, -1.0, 1.0, 0.0, 1.0, 0.0),
        "power_on": True,
        "epoch_s": 1_735_689_600.0,
    }


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"sped": 1.0}, r"^\[robot\] sped is not known; there are model, firmware, .*; did you mean 'speed'\?$"),
        ({"speed": 2}, r"^\[robot\] speed must be in \[0, 1\], got 2$"),
        ({"safety": {}}, r"^\[robot\] safety is a section of its own: \[safety\]$"),
        ({"first_tick": 5}, r"^\[robot\] first_tick is not known"),
    ],
)
def test_a_mistake_in_a_table_begins_with_its_place(table, words):
    with pytest.raises(UsageError, match=words):
        options_of_table(table)


# ---------------------------------------------------------------- VirtualRobot


def test_keywords_reach_the_robot():
    limits = SafetyLimits(SafetyBounds(tcp_speed_max=0.5))
    robot = VirtualRobot("cs63", seed=4, speed=0.5, firmware="2.10", strict=True, safety=limits, plant=PlantConfig())
    options = robot.options
    assert (options.model, options.seed, options.speed, options.firmware) == ("CS63", 4, 0.5, "2.10")
    assert (options.strict, options.safety, robot.profile.name, robot.model.name) == (True, limits, "2.10", "CS63")
    assert (options.power_on, robot.state.speed_scale) == (True, 0.5)


def test_a_misspelt_keyword_is_refused_as_by_any_function():
    with pytest.raises(TypeError, match=r"unexpected keyword argument 'sped'; did you mean 'speed'\?"):
        VirtualRobot("CS66", sped=0.5)
    with pytest.raises(TypeError, match="unexpected keyword argument 'first_tick'"):
        VirtualRobot("CS66", first_tick=3)


def test_the_signature_names_every_option_with_its_default():
    shown = inspect.signature(VirtualRobot).parameters
    assert not [name for name, row in shown.items() if row.kind is row.VAR_KEYWORD]
    in_virtual_time = {**BY_HAND, "model": None, "power_on": True, "confirms_popups": True}
    assert {name: row.default for name, row in shown.items() if name in BY_HAND} == in_virtual_time
    assert shown["task_dir"].default is None
    assert (str(shown["joints"].annotation), shown["joints"].kind.name) == ("Six | None", "KEYWORD_ONLY")


def test_the_docstring_describes_every_option():
    # Python 3.13 keeps less of the indentation.
    text = "\n".join(line.strip() for line in inspect.getdoc(VirtualRobot).splitlines())
    assert (
        "\nrpc_timeout_s: how long a remote procedure call waits for its answer; 0 waits for ever (default: 60.0)."
        in text
    )
    assert [name for name in KEYWORDS if f"\n{name}: " not in text] == []
    assert "**options" not in text
    assert text.index("\nstrict: ") < text.index("\nRaises:")


def test_the_types_of_keywords_are_those_of_the_options():
    from elitescript.kernel.option_keywords import RobotKeywords

    assert tuple(RobotKeywords.__annotations__) == KEYWORDS
    for name, kind in RobotKeywords.__annotations__.items():
        assert kind.__forward_arg__ == RobotOptions.__annotations__[name]
    types_alone = ("ChannelFault", "ContactConfig", "DisturbInput", "PlantConfig", "SafetyLimits")
    assert get_type_hints(RobotOptions, localns=dict.fromkeys(types_alone, object))


# ---------------------------------------------------------------- one place

NEW_OPTION = """    settle_s: float = option(
        0.25, "time to settle", Number(0.0, 2.0, "s"), flag="--settle", metavar="SECONDS", commands=("run", "serve")
    )
"""

PROBE = """
import contextlib, io, inspect, sys, types
from pathlib import Path

source = Path(sys.argv[1]).read_text(encoding="utf-8")
place = source.index("    strict: bool = option(")
module = types.ModuleType("elitescript.kernel.options")
module.__file__ = sys.argv[1]
import elitescript.kernel
sys.modules[module.__name__] = elitescript.kernel.options = module
exec(compile(source[:place] + sys.argv[3] + source[place:], sys.argv[1], "exec"), module.__dict__)

from elitescript import VirtualRobot
from elitescript.cli.main import _parsed, main
from elitescript.cli.robot_options import options_from
from elitescript.cli.serve import robot_configs
from elitescript.services.options_data import options_data, options_from_data
from tools.options_page import keywords_module, options_page

world = Path(sys.argv[2])
world.write_text("[robot]\\nsettle_s = 0.5\\n")
shown = io.StringIO()
with contextlib.redirect_stdout(shown), contextlib.suppress(SystemExit):
    main(["run", "--help"])
assert "--settle SECONDS" in shown.getvalue() and "time to settle (default 0.25)" in shown.getvalue()
assert options_from(_parsed(["run", "x.script", "--settle", "1.5"])) == {"settle_s": 1.5}
assert VirtualRobot().options.settle_s == 0.25
assert VirtualRobot(settle_s=1).options.settle_s == 1.0
assert VirtualRobot(world=world).options.settle_s == 0.5
assert VirtualRobot(world=world, settle_s=1.5).options.settle_s == 1.5
assert inspect.signature(VirtualRobot).parameters["settle_s"].default == 0.25
assert "settle_s: time to settle (default: 0.25)" in inspect.getdoc(VirtualRobot)
calls = (["serve", "--world", str(world)], ["serve", "--settle", "2"])
served = [config for call in calls for config in robot_configs(_parsed(call))[0]]
assert [config.settle_s for config in served] == [0.5, 2.0]
assert options_from_data(options_data(served[0])) == served[0]
row = "| `settle_s` | `--settle SECONDS` of `run`, `serve` | in [0, 2] s | `0.25` | time to settle |"
assert row in options_page()
assert "    settle_s: float\\n" in keywords_module()
for call, words in (
    (lambda: VirtualRobot(settle_s=3), "settle_s must be in [0, 2] s, got 3"),
    (lambda: options_from(_parsed(["run", "x", "--settle", "3"])), "--settle must be in [0, 2] s, got 3.0"),
):
    try:
        call()
    except Exception as error:
        assert str(error) == words, error
    else:
        raise AssertionError(words)
"""


def test_a_new_option_is_written_in_one_place(tmp_path):
    """In a process whose `RobotOptions` has one field more, everything that is derived has it."""
    arguments = [str(SOURCE / "kernel" / "options.py"), str(tmp_path / "world.toml"), NEW_OPTION]
    done = subprocess.run(
        [sys.executable, "-c", PROBE, *arguments], cwd=SOURCE.parents[1], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_an_option_stands_where_it_is_made_and_where_it_is_used():
    places = {
        path.relative_to(SOURCE).as_posix()
        for path in SOURCE.rglob("*.py")
        if "rpc_timeout_s" in path.read_text(encoding="utf-8")
    }
    made = {"kernel/options.py", "kernel/option_keywords.py"}
    used = {"kernel/kernel.py", "runtime/host.py", "runtime/names/context.py"}
    old_journals = {"services/journal/format2.py"}
    assert places == {*made, *used, *old_journals}


def test_every_flag_belongs_to_commands_that_exist():
    from elitescript.cli.arguments import COMMANDS

    for name, option in OPTIONS.items():
        assert bool(option.flag) == bool(option.commands), name
        assert set(option.commands) <= set(COMMANDS), name


@pytest.mark.parametrize("value", [1e300, -1e12, 253_402_300_800.0])
def test_a_moment_without_a_date_is_refused(value):
    with pytest.raises(UsageError, match="epoch_s must be seconds since 1970"):
        RobotOptions(epoch_s=value)
