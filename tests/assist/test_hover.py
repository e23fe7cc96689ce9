"""What is explained at marked places of texts."""

from __future__ import annotations

import warnings

import pytest

from elitescript.assist.document import Settings
from elitescript.assist.hover import hover
from elitescript.assist.last_run import LastRun
from elitescript.commands.catalogue import CATALOGUE
from elitescript.messages.profile import PROFILES
from elitescript.models.model import load_model
from tests.assist.reading import cut, marked

ARM = Settings(arm=load_model("CS66"))

JOB = """def job():
  global parts
  parts = 0
  HOME = [0, -1.57, 1.57, -1.57, -1.57, 0]
  FAR = [0, 0, 0, 0, 0, 9]
  PLACE = [0.4, 0.2, 0.3, 3.14, 0, 0]
  AWAY = [0.4, 1.9, 0.3, 3.14, 0, 0]
  SPEED = 0.25
  def raised(pose, height=0.1):
    # The pose, higher.
    up = pose.copy()
    return up
  end
  def watch():
    sync()
  end
  start_thread(watch, ())
  movej(HOME)
  movej(FAR)
  movel(PLACE, v=SPEED)
  movel(AWAY)
  HERE
end
"""

# A line with a cursor, what the hover is about, what it says.
TABLE = [
    ("mov¦ej(HOME)",
     "movej", ["movej(q, a=1.396263", "**[rad/s^2]**", "default `1.396263`", "MotionError", "*Since 2.10"]),
    ("x = get_standard_digital_in¦(0)", "get_standard_digital_in", ["in [0, 15]", "**Returns**", "value = get_st"]),
    ("movej(HOME, ¦a=1)", "a", ["movej(q,", "`a`: **float, >= 0** **[rad/s^2]**"]),
    ("movel(PLACE, v=0.¦25)", "0.25", ["`v` of `movel`", "0.25 m/s (250 mm/s)"]),
    ("movej([0, -1.5¦7, 0, 0, 0, 0])", "-1.57", ["`q`[1], shoulder", "-1.57 rad (-89.954 deg)"]),
    ("movel([0.4, 0.2, ¦0.3, 3.14, 0, 0])", "0.3", ["`p`[2], z", "0.3 m (300 mm)"]),
    ("movel([0.4, 0.2, 0.3, 3.¦14, 0, 0])", "3.14", ["`p`[3], Rx", "179.91 deg"]),
    ("sleep(0.0¦2)", "0.02", ["0.02 s (20 ms)"]),
    ("d2r(-9¦0)", "-90", ["-90 deg (-1.5708 rad)"]),
    ("movej(HO¦ME)",
     "HOME", ["HOME = [0, -1.57,", "joints", "shoulder: -1.57 rad (-89.954 deg)", "Within the joint",
      "set in line 4"]),
    ("movej(FA¦R)", "FAR", ["**Not reachable**: wrist3 is outside -360 to 360 deg by 155.7 deg"]),
    ("movel(PLA¦CE)", "PLACE", ["pose", "z: 0.3 m (300 mm)", "The arm reaches it", "`p` of `movel`"]),
    ("movel(AW¦AY)", "AWAY", ["**Not reachable**: too far by"]),
    ("x = SPE¦ED", "SPEED", ["SPEED = 0.25", "0.25 m/s (250 mm/s)", "Used as `v` of `movel`"]),
    ("x = par¦ts", "parts", ["Global", "set in line 3"]),
    ("x = rais¦ed(PLACE)", "raised", ["def raised(pose, height=0.1):", "The pose, higher.", "Line 9"]),
    ("x = wat¦ch", "watch", ["Runs as a thread"]),
    ("x = raised(¦height=1)", "height", ["raised(pose, height=0.1)"]),
    ("x = '¦standard_digital_in[3]'",
     "standard_digital_in[3]", ["Digital inputs of the control box", "bool", "points 0 to 15"]),
    ("x = 'output_int_register[¦3]'", "output_int_register[3]", ["-2.14748e+09 to 2.14748e+09", "kept when"]),
    ("rtsi_set_watchdog('¦input_int_register0', 1, 'stop')", "input_int_register0", ["RTSI input"]),
    ("socket_open('a', 1, 'cam')\n  socket_close('c¦am')", "cam", ["`socket_name` of `socket_close`", "lines 22"]),
    ("en¦d", "end", ["Closes the block"]),
    ("whi¦le True:\n    sync()\n  end", "while", ["as long as"]),
    ("x = le¦n(HOME)", "len", ["len(obj)", "number of items"]),
    ("import ma¦th", "math", ["import math"]),
    ("import math\n  x = math.p¦i", "pi", ["3.14159"]),
    ("import math\n  x = math.si¦n(1)", "sin", ["math.sin(x)", "sine"]),
    ("x = 'a'.upp¦er()", "upper", ["upper", "uppercase"]),
    ("x = [q¦ for q in HOME]", "q", ["Loop variable"]),
    ("x = f'{SPE¦ED}'", "SPEED", ["0.25"]),
    ("movej(HO¦ME, a=", "HOME", ["joints"]),
    ("p = get_actual_tcp_pose()\n  movel(¦p)", "p", ["Variable, pose in the base frame, measured; set in line 22."]),
    ("p = get_actual_tcp_pose()\n  x = p[¦2]", "p[2]", ["p[2]", "Float m, measured."]),
    ("p = get_actual_tcp_pose()\n  x = p[2] ¦+ 0.1", "p[2] + 0.1", ["Float m, measured."]),
    ("x = read_input_integer_register(4)\n  ¦x", "x", ["Variable, int -2147483648…2147483647, a signal;"]),
    ("i = str_find('a', socket_read_string())\n  ¦i", "i", ["position or -1 (not found)", "-1: not found."]),
    ("ok = socket_send_line('a')\n  ¦ok", "ok", ["Variable, bool;", "False: failed."]),
    ("v = socket_read_ascii_float(3)\n  ¦v", "v", ["list of 4, first element: how many, sent by a peer;"]),
    ("m = modbus_get_signal_status('a')\n  ¦m", "m", ["may have no value yet; set", "There may be no value yet."]),
    ("n = 0\n  while n < 3:\n    n = n ¦+ 1\n  end", "n + 1", ["Int 1…3."]),
    ("t = None\n  if parts:\n    t = get_actual_tcp_pose()\n  end\n  if t is not None:\n    x = ¦t\n  end",
     "t", ["Variable, pose in the base frame, measured; set in lines 22, 24."]),
    ("t = None\n  if parts:\n    t = get_actual_tcp_pose()\n  end\n  x = ¦t",
     "t", ["pose in the base frame or None, measured;"]),
    ("mov¦ej(HOME, a=", "movej", ["Move straight"]),
]  # fmt: skip

NOTHING = [
    "# mov¦ej",
    "x = 1  # mov¦ej",
    "x = 'mov¦ej'",
    "x =¦ 1",
    "x = unknown¦_name",
    "x = 1¦2",
    "x = unknown.pi¦ece",
    "¦",
    "movej(HOME, a=1 + ¦2)",
    "x = f'SPE¦ED {1}'",
]


def shown(line: str, **options):
    document, row, column = marked(JOB.replace("HERE", line), ARM)
    return document, hover(document, row, column, **options)


@pytest.mark.parametrize(("line", "about", "parts"), TABLE)
def test_what_is_explained(line, about, parts):
    document, found = shown(line)
    assert found is not None
    assert cut(document, found.span).partition(":")[2] == about
    assert [part for part in parts if part not in found.markdown] == []


@pytest.mark.parametrize("line", NOTHING)
def test_where_nothing_is_explained(line):
    assert shown(line)[1] is None


@pytest.mark.parametrize("name", list(CATALOGUE.names()))
def test_every_command_is_explained(name):
    document, row, column = marked(f"¦{name}()")
    found = hover(document, row, column)
    command = CATALOGUE.get(name)
    assert found is not None
    assert command is not None
    assert command.signature in found.markdown
    assert command.evidence in found.markdown
    for param in command.params:
        assert f"`{param.name}`: **" in found.markdown
        assert param.quantity.unit in found.markdown


def test_a_command_that_the_firmware_lacks_says_so():
    document, row, column = marked("join_¦thread(1)", Settings(profile=PROFILES["2.10"]))
    found = hover(document, row, column)
    assert found is not None
    assert "needs firmware 2.14" in found.markdown


def test_values_of_the_last_run_are_shown():
    values = {"": {"parts": "12"}, "raised": {"up": "[1, 2]"}}
    document, found = shown("x = par¦ts", last_run=LastRun(JOB, values=values))
    assert found is not None
    assert "In the last run at last: `12`" in found.markdown
    document, row, column = marked(JOB.replace("return up", "return u¦p"))
    found = hover(document, row, column, LastRun(JOB, values=values))
    assert found is not None
    assert "`[1, 2]`" in found.markdown


def test_without_an_arm_nothing_is_said_of_its_reach():
    document, row, column = marked(JOB.replace("HERE", "movel(AW¦AY)"))
    found = hover(document, row, column)
    assert found is not None
    assert "y: 1.9 m" in found.markdown
    assert "reach" not in found.markdown


def test_a_variable_named_like_a_command_is_that_variable():
    document, row, column = marked("time = 3\nx = ti¦me")
    found = hover(document, row, column)
    assert found is not None
    assert found.markdown.startswith("```elitescript\ntime = 3")


def test_a_value_is_shown_in_each_unit_in_which_it_is_used() -> None:
    document, line, column = marked("¦N = 0.5\nmovel([0.4, 0, 0.3, 3.14, 0, 0], v=N)\nmovej([0, 0, 0, 0, 0, 0], v=N)\n")
    found = hover(document, line, column)
    assert found is not None
    assert "0.5 m/s (500 mm/s)" in found.markdown
    assert "0.5 rad/s (28.648 deg/s)" in found.markdown


def test_a_number_too_large_for_a_float_is_shown_without_another_unit() -> None:
    number = "1" + "0" * 400
    document, line, column = marked(f"movej([0, 0, 0, 0, 0, 0], v=¦{number})\n")
    found = hover(document, line, column)
    assert found is not None
    assert "rad/s" in found.markdown


@pytest.mark.parametrize("text", ["sleep(¦1if 1 else 2)\n", "sleep(1if 1 else 2).¦x\n"])
def test_pythons_warnings_about_a_text_stay_away(text: str) -> None:
    document, line, column = marked(text)
    _ = document.program
    with warnings.catch_warnings(record=True) as shown:
        warnings.simplefilter("always")
        hover(document, line, column)
    assert shown == []


def test_what_a_stranger_wrote_is_text_and_no_link() -> None:
    text = 'def go():\n  """[run](command:a.b) <img src=x> **b**"""\n  sleep(1)\nend\ng¦o()\n'
    document, line, column = marked(text)
    found = hover(document, line, column)
    assert found is not None
    assert r"\[run\](command:a.b) \<img src=x\> \*\*b\*\*" in found.markdown
    assert "[run](" not in found.markdown
    document, line, column = marked("# [run](javascript:x)\ndef go(a='```'):\n  sleep(1)\nend\ng¦o()\n")
    found = hover(document, line, column)
    assert found is not None
    assert r"\[run\](javascript:x)" in found.markdown
    assert found.markdown.startswith("````elitescript\ndef go(a='```'):\n````")
    values = {"": {"parts": "'`[x](command:y)`'"}}
    _, found = shown("x = par¦ts", last_run=LastRun(JOB, values=values))
    assert found is not None
    assert "``'`[x](command:y)`'``" in found.markdown
