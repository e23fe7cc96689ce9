"""Expressions over the record of a run: values, margins, what has no value, functions of files."""

import os
import subprocess
import sys

import pytest

from elitescript import VirtualRobot
from elitescript.errors import UsageError
from elitescript.properties.checks import Checks
from elitescript.properties.parsing import function_place, parse_measure, parse_property

PROGRAM = """\
def p():
  global count, name, nothing, items, table, thing, huge
  class Thing():
    def __eq__(self, other):
      textmsg("compared")
      return True
    end
    def __gt__(self, other):
      while True:
        pass
      end
    end
  end
  count = 3
  name = "box"
  nothing = None
  items = [1, 2.5, "x"]
  table = {"a": [7]}
  thing = Thing()
  huge = 10 ** 5000
  set_standard_digital_out(2, True)
  write_output_float_register(1, 0.25)
  movej([0, -1.5, 1.5, -1.5, -1.5, 0], 2, 1)
  textmsg("hello")
  sleep("x")
end
"""


@pytest.fixture(scope="module")
def run():
    return VirtualRobot("CS66").run(PROGRAM)


def verdict(text, run, **options):
    """Return what a property comes to."""
    return Checks([parse_property(text, **options)]).watch().results(run).verdicts[0]


@pytest.mark.parametrize(
    ("text", "holds", "margin"),
    [
        ('state == "alarm"', True, None),
        ("findings.error >= 1", True, None),
        ("findings.warning + findings.note >= 0", True, None),
        ('findings["error"] == 0', False, None),
        ('state in ["finished", "stopped"]', False, None),
        ('globals["count"] == 3', True, 0.0),
        ('globals["count"] > 5', False, -2.0),
        ('2 <= globals["count"] < 10', True, 1.0),
        ('globals["count"] < 10 and globals["items"][1] < 3', True, None),
        ('globals["name"] == "box"', True, None),
        ('globals["name"] != 3', True, None),
        ('"o" in globals["name"]', True, None),
        ('"x" in globals["items"]', True, None),
        ('"count" in globals and "other" not in globals', True, None),
        ('globals["table"]["a"][0] == 7', True, 0.0),
        ('globals["table"] == globals["table"]', True, None),
        ('globals["nothing"] is None', True, None),
        ('globals["count"] is not None', True, None),
        ('len(globals["items"]) == 3', True, 0.0),
        ('max(globals["count"], 1) == 3', True, 0.0),
        ('signals["standard_digital_out[2]"]', True, None),
        ('signals["standard_digital_out[2]"] == True', True, None),
        ("standard_digital_out[2]", True, None),
        ("output_float_register[1] < 0.3", True, pytest.approx(0.05)),
        ("joints.base == joints[0] and tcp_pose.rz == tcp_pose[5]", True, 0.0),
        ('signals["output_float_register[1]"] < 0.3', True, pytest.approx(0.05)),
        ('signals["standard_digital_out[2]"] + signals["standard_digital_out[3]"] <= 1', True, 0.0),
        ("abs(joints[1] + 1.5) < 1e-3", True, pytest.approx(1e-3, abs=1e-6)),
        ("not abs(joints[1] + 1.5) < 1", False, pytest.approx(-1, abs=1e-6)),
        ('len(alarms) == 1 and alarms[0]["code"] == "R101" and alarms[-1]["line"] == 25', True, None),
        ('alarms[0]["t"] == time_s or alarms[0]["t"] < 3', True, None),
        ('"hello" in log and log[-1] == "hello"', True, None),
        ("len(log) == 1", True, 0.0),
        ("(time_s if len(alarms) == 1 else 0) > 1", True, None),
        ("3 ** 2 == 9 and 7 // 2 == 3 and -7 % 3 == 2 and 1 / 4 == 0.25", True, None),
        ("hypot(3, 4) == 5 and sqrt(9) == 3 and round(2.345, 1) == 2.3 and sum([1, 2]) == 3", True, None),
        ("degrees(pi) == 180 and cos(0) == 1 and sin(0) == 0 and radians(180) == pi", True, None),
    ],
)
def test_properties_of_the_record(text, holds, margin, run):
    found = verdict(text, run)
    assert found.holds is holds, found
    if margin is not None:
        assert found.margin == margin


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('globals["other"] > 1', "global 'other' has no value"),
        ('globals["nothing"] > 1', "None, no number"),
        ('globals["name"] > 1', "'box', no number"),
        ('globals["thing"] == 1', "class 'Thing'"),
        ('globals["thing"] > 1', "class 'Thing'"),
        ('globals["huge"] * 0.5 > 1', "too large"),
        ('globals["huge"] > 0.5 and globals["huge"] / 3 > 1', "too large"),
        ('globals["count"][0] == 1', "3, which has no parts"),
        ('globals["items"][3] == 1', "3 parts, and none at 3"),
        ('globals["items"]["a"] == 1', "no 'a'"),
        ('globals["table"]["b"] == 1', "no 'b'"),
        ('max(globals["items"]) > 1', "'x', no number"),
        ('globals["name"]', "'box', not true or false"),
        ("1 / (len(alarms) - 1) > 1", "division by zero in 1 / (len(alarms) - 1)"),
        ("1 % (len(alarms) - 1) > 1", "division by zero"),
        ("sqrt(-time_s) > 1", "sqrt(-time_s) has no value"),
        ("(0 * time_s) ** -1 > 1", "has no value"),
        ('alarms[1]["line"] == 3', "alarms has 1 part, and none at 1"),
        ("printed[0] == 'x'", "printed has 0 parts"),
        ("clearance > 0.1", "no solids"),
        ("eventually(1 / (line - line) > 1)", "division by zero in 1 / (line - line) at 0.000 s"),
        ("max_of(1 / (line - line)) > 1", "division by zero"),
        ("not eventually(sqrt(-1) > 0) and first(line == 99) > 1", "never holds"),
    ],
)
def test_what_has_no_value_does_not_hold_and_says_why(text, words, run):
    checks = Checks([parse_property(text)])
    watching = checks.watch()
    if watching.trace:
        run = VirtualRobot("CS66").run(PROGRAM, trace=watching.trace)
    found = watching.results(run).verdicts[0]
    assert not found.holds
    assert words in found.words
    assert run.log == ["hello"]


def test_what_and_and_or_do_not_come_to_needs_no_value(run):
    assert verdict('len(printed) == 0 or printed[0] == "x"', run).holds
    assert not verdict('len(printed) > 0 and printed[0] == "x"', run).holds


def test_margins_of_different_units_are_told_by_themselves(run):
    found = verdict("time_s < 60 and joints[0] < 1 and tcp_pose[2] > 0.1", run)
    assert found.holds
    assert found.margin is None
    assert list(found.margins) == ["s", "rad", "m"]


def test_a_measure_without_a_value_says_why(run):
    checks = Checks((), {"a": parse_measure("time_s / 0"), "b": parse_measure('globals["count"]')})
    results = checks.watch().results(run)
    assert results.measures == {"a": None, "b": 3}
    assert results.reasons == {"a": "division by zero in time_s / 0"}


def test_a_failing_property_says_when_and_by_how_much():
    watching = Checks([parse_property("always(tcp[2] > 0.5) and time_s < 60")]).watch()
    run = VirtualRobot("CS66").run(
        "def p():\n  pose = get_target_tcp_pose()\n  pose[2] -= 0.05\n  movel(pose)\n"
        "  movej([0, -1.5, 1, -1.5, -1.5, 0])\nend",
        trace=watching.trace,
    )
    lowest = min(VirtualRobot("CS66").run(run.unit, trace=True).trace, key=lambda row: row.tcp_pose[2])
    found = watching.results(run).verdicts[0]
    assert not found.holds
    assert found.t == lowest.t
    assert "tcp[2] > 0.5 does not hold at 0.000 s" in found.words
    assert f"at {lowest.t:.3f} s, the worst moment" in found.words


FILE = """\
import math
COUNT = []

def good(run):
    COUNT.append(1)
    return len(COUNT) == 1 and run.time_s > 1

def bad(run):
    return run.nothing

def number(run):
    return math.floor(run.time_s)

def none(run):
    pass

def leaves(run):
    raise SystemExit("gone")

def two(run, other):
    return True
"""


def load(path):
    """Return the names of the only file."""
    names = {}
    if path != "my/checks.py":
        raise UsageError(f"{path}: no such file")
    exec(compile(FILE, path, "exec"), names)
    return names


@pytest.mark.parametrize(
    ("name", "holds", "words"),
    [
        ("good", True, ""),
        ("bad", False, "my/checks.py, line 9: AttributeError: 'Run' object has no attribute 'nothing'"),
        ("number", False, "returned 3, not True or False"),
        ("none", False, "returned None, not True or False"),
        ("leaves", False, "my/checks.py, line 18: SystemExit: gone"),
    ],
)
def test_functions_of_files_judge_a_run(name, holds, words, run):
    checks = Checks([parse_property(f"my/checks.py:{name}", load=load)])
    for _ in range(2):
        found = checks.watch().results(run).verdicts[0]
        assert found.holds is holds
        assert words in found.words


def test_functions_of_files_measure_a_run(run):
    checks = Checks((), {name: parse_measure(f"my/checks.py:{name}", load=load) for name in ("number", "none")})
    results = checks.watch().results(run)
    assert results.measures == {"number": 3, "none": None}
    assert "no number" in results.reasons["none"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("my/checks.py:god", "did you mean 'good'?"),
        ("my/checks.py:two", "must take one argument"),
        ("my/other.py:good", "no such file"),
    ],
)
def test_functions_that_are_not_there_are_refused(text, words):
    with pytest.raises(UsageError, match=words.replace("?", r"\?")):
        parse_property(text, load=load)


def test_the_place_of_a_function_is_file_and_name():
    assert function_place("C:\\cells\\checks.py:good") == ("C:\\cells\\checks.py", "good")
    assert function_place("always(t < 3)") is None


def test_properties_with_names_are_made_by_the_caller(run):
    class Limits:
        text = "limits"

        def __init__(self, margin=0.0):
            self.margin = margin

    assert parse_property(" limits ", named={"limits": Limits}).margin == 0.0
    assert parse_property("limits(0.5)", named={"limits": Limits}).margin == 0.5
    with pytest.raises(UsageError, match="column 1: limits does not take these arguments"):
        parse_property("limits(1, 2)", named={"limits": Limits})
    with pytest.raises(UsageError, match="column 8: limits takes literals"):
        parse_property("limits(time_s)", named={"limits": Limits})
    with pytest.raises(UsageError, match="did you mean 'limits'"):
        parse_property("limit", named={"limits": Limits})


def test_verdicts_do_not_depend_on_the_hash_seed():
    code = (
        "from elitescript import VirtualRobot\n"
        "from elitescript.properties.checks import Checks\n"
        "from elitescript.properties.parsing import parse_property\n"
        "texts = ['time_s < 1 and joints[0] > 1 or tcp_pose[0] > 9 or signals[\"tool_voltage\"] > 1',\n"
        ' \'eventually(signal("flag[1]") or signal("flag[0]") and line > 9 and tcp[0] > 9 and q[0] > 9)\']\n'
        "watching = Checks([parse_property(text) for text in texts]).watch()\n"
        "run = VirtualRobot('CS66').run('def p():\\n  sleep(0.1)\\nend', trace=watching.trace)\n"
        "print(watching.results(run))\n"
        "try:\n  parse_property('always(tpc > 1)')\nexcept Exception as error:\n  print(error)\n"
    )
    texts = {
        subprocess.run(
            [sys.executable, "-c", code], env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True, check=True
        ).stdout
        for seed in ("0", "7")
    }
    assert len(texts) == 1
