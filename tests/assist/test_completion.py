"""What is offered at marked places of texts, most of which do not parse."""

from __future__ import annotations

import re

import pytest

from elitescript.assist.completion import Completion, ItemKind, completions, fitting_completions, plain_text, resolved
from elitescript.assist.describing import example, sample
from elitescript.assist.document import Document, Settings
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.registry import Command
from elitescript.messages.profile import PROFILES
from tests.assist.reading import marked

NEWEST = max(PROFILES.values(), key=lambda profile: profile.release)

JOB = """def job():
  global parts
  parts = 0
  HOME = [0, -1.57, 1.57, -1.57, -1.57, 0]
  SPEED = 0.25
  name = "abc"
  def raised(pose, height=0.1):
    # The pose, higher.
    up = pose.copy()
    return up
  end
  def watch():
    sync()
  end
  HERE
end
"""


def at(line: str) -> str:
    """Put lines in place of `HERE`; the first one is indented already."""
    return JOB.replace("HERE", line)


# Text with a cursor, what must be offered, what must not.
TABLE: list[tuple[str, str, str]] = [
    # Commands.
    ("mov¦", "movej movel movec movep", "nothing"),
    ("movej¦", "movej", ""),
    ("def job():\n  mov¦\nend\n", "movej", ""),
    ("def job():\n  x = get_¦\nend\n", "get_actual_tcp_pose get_inverse_kin", "break"),
    ("def job():\n  if get_¦\n  y = 1\nend\n", "get_standard_digital_in", "while"),
    ("movej = 3\nmov¦", "movej movel", ""),
    # Own names, and where they are visible.
    (at("x = ¦"), "HOME SPEED raised watch name parts", "up pose height"),
    (at("movej(H¦"), "HOME", "up"),
    (JOB.replace("    return up", "    return ¦"), "up pose height HOME SPEED raised", ""),
    (JOB.replace("    return up", "    return u¦"), "up pose height", ""),
    (JOB.replace("    sync()", "    sync()\n    ¦"), "HOME raised parts", "up pose"),
    (JOB.replace("  HERE", "  HERE\n  ¦"), "HOME watch", "up"),
    ("x = 1\ndef f(a):\n  b = 2\n  ¦\nend\n", "a b x f", ""),
    ("x = 1\ndef f(a):\n  b = 2\nend\n¦", "x f", "a b"),
    ("def f(a):\n  b = 2\n\n  ¦", "a b", ""),
    ("total = 1\ntot¦", "total", "tot"),
    ("tota¦", "", "tota"),
    ("for box in boxes:\n  bo¦\nend\n", "box", ""),
    ("y = [part¦ for part in (1, 2)]", "part", ""),
    ("f = lambda angle: ang¦", "angle", ""),
    ("try:\n  sync()\nexcept Exception as error:\n  textmsg(err¦\nend\n", "error", ""),
    # Arguments of commands.
    (at("movej(HOME, ¦)"), "a= v= t= r=", "q="),
    (at("movej(HOME, a=1, ¦)"), "v= t= r=", "a= q="),
    (at("movej(HOME, ¦, a=1)"), "v= t= r=", "a= q="),
    (at("movej(HOME, 1.4, ¦"), "v= t= r=", "a= q="),
    (at("movej(HOME, v¦"), "v=", ""),
    (at("movej(HOME, v=¦)"), "SPEED", "a= t= v="),
    (at("movej(¦"), "q= HOME get_inverse_kin", ""),
    (at("movej([¦"), "SPEED d2r", "q= a="),
    (at("movej([0, -1.57, ¦], a=1)"), "SPEED d2r", "v= q="),
    (at("movej(get_inverse_kin(¦), a=1)"), "p= qnear= tcp= raised", "v= r="),
    (at("movel(raised(HOME, ¦)"), "height=", "pose= v="),
    (at("raised(¦"), "pose= height=", "q="),
    (at("raised(height=1, ¦)"), "pose=", "height="),
    (at("movej(HOME, a=f(1, ¦"), "SPEED", "v="),
    ("def f(a, *, b):\n  sync()\nend\nf(1, ¦)", "b=", "a="),
    ("movel(p, a=1.2,\n  ¦)", "v= t= r=", "a= p="),
    ("movel(p,\n  a=1.2,\n  ¦", "v= t= r=", "a="),
    ("movel(p,\n¦\nx = 1", "a=", ""),
    ("movej(q, a = ¦", "d2r", "v="),
    # Values of enumerated arguments.
    ("set_tool_voltage(¦)", "0 12 24 voltage=", ""),
    ("set_tool_voltage(voltage=¦)", "0 12 24", "voltage="),
    ("set_standard_digital_out(1, ¦", "True False b=", "n="),
    ("set_standard_analog_input_domain(0, ¦)", "0 1", "12"),
    ("serial_config(True, ¦)", "9600 115200", ""),
    ('set_gp_boolean_input_action(0, ¦)', '"default" "freedrive"', ""),
    ('set_gp_boolean_input_action(0, "¦")', "default freedrive", "movej"),
    ('freedrive_mode([1,1,1,1,1,1], "¦")', "base tool", "default"),
    ('rpc_factory("¦', "xmlrpc", "movej"),
    ("set_tool_voltage(1 + ¦)", "d2r", "0 12 24"),
    # Functions as arguments.
    (at("start_thread(¦"), "watch raised function=", ""),
    (at("start_thread(watch, ¦)"), "args= detach_mode=", "function="),
    # Names in strings.
    ('socket_open("a", 1, "cam")\nsocket_close("¦")', "cam socket_0", "movej"),
    ('socket_open("a", 1, "cam")\nsocket_close("c¦', "cam", "movej"),
    ('CAMERA = "eye"\nsocket_open("a", 1, CAMERA)\nsocket_send_line("x", 0, "¦")', "eye", ""),
    ('modbus_add_signal("10.0.0.2", 1, 3, 0, "valve")\nmodbus_set_output_signal("¦", True)', "valve", "10.0.0.2"),
    ('modbus_add_signal("10.0.0.2", 1, 3, 0, "valve")\nmodbus_reset_connection("¦")', "10.0.0.2", "valve"),
    ('rtsi_set_watchdog("¦", 1, "stop")', "input_int_register0 speed_slider_fraction", "stop"),
    ('rtsi_set_watchdog("input_int_register0", 1, "¦")', "ignore pause stop", "input_int_register0"),
    ('load_micro_line_file("a.txt")\nload_micro_line_file("¦")', "a.txt", ""),
    ('textmsg("mov¦")', "", "movej"),
    ('x = "mov¦', "", "movej"),
    ('x = "a" + mov¦', "movej", ""),
    (at('textmsg(f"{¦}")'), "SPEED name", ""),
    (at('textmsg(f"{SP¦")'), "SPEED", ""),
    (at('textmsg(f"SP¦")'), "", "SPEED"),
    (at('textmsg(f"{{SP¦")'), "", "SPEED"),
    ("x = '''\nmov¦\n'''", "", "movej"),
    # Comments.
    ("# mov¦", "", "movej"),
    ("x = 1  # mov¦", "", "movej x"),
    ("movej(q, # a¦", "", "a= v= movej"),
    ('x = "#" + mov¦', "movej", ""),
    # Words of the language.
    ("¦", "if while def import sec", "end break elif"),
    ("def job():\n  ¦\nend\n", "end return global import", "break elif sec"),
    ("while True:\n  ¦\nend\n", "break continue end", "elif"),
    ("while True:\n  def f():\n    ¦\n  end\nend\n", "end return", "break"),
    ("if x:\n  sync()\n¦", "if", "break"),
    ("¦while True:\n  sync()\nend\n", "while", "break end"),
    ("if x:\n  sync()\n  ¦\nend\n", "elif else end", "except"),
    ("try:\n  sync()\n  ¦\nend\n", "except finally end", "elif"),
    ("x = 3 ¦", "and or if in is not", "movej while"),
    ("if x ¦", "and or in is", "movej"),
    ("if ¦", "not True movej", "while break"),
    ("for i ¦", "in", "movej or"),
    ("for i in ¦", "range movej", "while"),
    ("def ¦", "", "movej if"),
    ("def na¦():\nend", "", "movej"),
    ("def f(a, ¦", "", "movej a"),
    ("import math as ¦", "", "movej"),
    ("x = 12¦", "", "movej if"),
    ("x = 0.¦", "", "movej real"),
    ("x = 1e-¦", "", ""),
    ("if x: ¦", "movej pass return", "end"),
    ("a = 1; mov¦", "movej", ""),
    ("global ¦", "", "movej"),
    (JOB.replace("    sync()", "    global ¦"), "parts", "movej"),
    ("except ¦", "Exception ValueError", "sync"),
    ("try:\n  sync()\nexcept ¦", "Exception ValueError", "sync"),
    ("raise ¦", "ValueError", "sync"),
    # Line marks.
    (at("$ ¦"), "LINE", "movej HOME while"),
    (at("$mov¦"), "LINE", "movej"),
    (at("$ LINE: (¦"), "", "LINE movej HOME"),
    (at('$ LINE: (1, "a"); mov¦'), "movej", "LINE"),
    (at('x = "$" + ¦'), "HOME", "LINE"),
    # Modules.
    ("import ¦", "math time threading queue", "socket movej"),
    ("import ma¦", "math", "movej"),
    ("import os.¦", "os.path", "movej"),
    ("import math, ¦", "time", "movej"),
    ("from ¦", "math", "movej"),
    ("from math ¦", "import", "math"),
    ("from math import ¦", "pi sqrt", "movej"),
    ("from math import pi, ¦", "sqrt", "movej"),
    ("import math\nx = math.¦", "pi sqrt atan2", "movej __doc__ __name__"),
    ("import math\nx = math.s¦", "sin sqrt", ""),
    ("import math as m\nm.¦", "pi", ""),
    ("x = math.¦", "", "pi movej"),
    ("import queue\nq = queue.Queue(3)\nq.¦", "put get", "append"),
    ("import threading\nlock = threading.Lock()\nlock.¦", "", "movej"),
    ("import os\nos.path.¦", "join", "getcwd"),
    ("import time\ntime.¦", "sleep monotonic", "movej"),
    ("copy.¦", "copy deepcopy", "movej"),
    # Methods.
    (at("name.¦"), "split upper strip", "append movej __len__"),
    (at("HOME.¦"), "append copy pop", "split"),
    (at('x = "a".¦'), "join upper", "append"),
    (at("[1, 2].¦"), "append", "join"),
    (at("x = get_actual_tcp_pose().¦"), "copy index", "upper"),
    (at("x = raised(HOME).¦"), "", "movej"),
    ("p = get_actual_tcp_pose()\np.¦", "copy", "upper"),
    ("d = {}\nd.¦", "keys items", "append"),
    ("x = []\nx = 'a'\nx.¦", "", "append upper"),
    ("unknown.¦", "", "movej append"),
    ("x = 'a'.upper().¦", "split", "append"),
    ("names = 'a b'.split()\nnames.¦", "append", "upper"),
    ("class Box:\n  def __init__(self):\n    self.size = 1\n  end\n  def open(self, far):\n    self.¦\n  end\nend",
     "size open", "movej"),
    ("class Box:\n  def open(self, far):\n    pass\n  end\nend\nb = Box()\nb.¦", "open", "movej"),
    # Text that is broken elsewhere.
    (at("x = (1,\n  movej(HOME, ¦)"), "v=", ""),
    ("def f(:\n  a = 1\nend\nx = 1\nmovej(q, ¦)\n", "a= x", ""),
    ("if x\n  y = 1\nend\nmovej(¦", "q=", ""),
    ("x = [1, 2\nmov¦", "movej", ""),
    ("x = 'abc\nmov¦", "movej", ""),
    ("movej((¦", "d2r", ""),
    ("movej(q,,¦", "", ""),
    (")¦", "", ""),
    ("\ufeffmov¦", "movej", ""),
    ("x = 1\r\nmov¦\r\n", "movej x", ""),
    ("größe = 1\ny = gr¦", "größe", ""),
]  # fmt: skip


def labels(text: str, settings: Settings | None = None) -> dict[str, Completion]:
    return {item.label: item for item in completions(*marked(text, settings))}


def fitting(text: str) -> tuple[list[str], bool]:
    found = fitting_completions(*marked(text))
    return [item.label for item in found.items], found.is_all


@pytest.mark.parametrize(
    ("written", "found", "left_out"),
    [
        ("movej", ["movej", "movejoint"], ["movel", "textmsg", "if"]),
        ("MOVEJ", ["movej"], ["movel"]),
        (
            "digital_out",
            ["set_standard_digital_out", "get_standard_digital_out"],
            ["textmsg", "get_standard_digital_in"],
        ),
        ("gstd", ["get_standard_digital_in"], ["movej"]),
        ("movejo", ["movejoint"], ["movej"]),
    ],
)
def test_what_fits_what_is_written(written, found, left_out):
    labels, is_all = fitting(f"def p():\n  movejoint = 1\n  {written}¦\nend\n")
    assert set(found) <= set(labels)
    assert not set(left_out) & set(labels)
    assert not is_all


def test_nothing_fits_what_no_name_has():
    assert fitting("def p():\n  qqzzqq¦\nend\n") == ([], False)


def test_all_that_can_stand_there_fits_nothing():
    assert fitting("def p():\n  ¦\nend\n") == (
        [item.label for item in completions(*marked("def p():\n  ¦\nend\n"))],
        True,
    )


def test_what_fits_in_a_string_is_what_begins_as_its_whole_text():
    opened = '  socket_open("1.2.3.4", 1, "left side")\n  socket_open("1.2.3.4", 1, "right side")\n'
    text = f'def p():\n{opened}  socket_send_string("x", "{{}}¦")\nend\n'
    assert "right side" not in fitting(text.format("left s"))[0]
    assert "left side" in fitting(text.format("left s"))[0]
    assert {"left side", "right side"} <= set(fitting(text.format(""))[0])


@pytest.mark.parametrize(("text", "offered", "missing"), TABLE)
def test_what_is_offered(text, offered, missing):
    found = labels(text)
    assert [name for name in offered.split() if name not in found] == []
    assert [name for name in missing.split() if name in found] == []


def test_the_table_is_long_enough():
    assert len(TABLE) >= 80


class TestItems:
    def test_a_command_has_places_for_its_required_arguments(self):
        assert labels("mov¦")["movel"].snippet == "movel(${1:p})"
        assert labels("set_¦")["set_standard_digital_out"].snippet == "set_standard_digital_out(${1:n}, ${2:b})"
        assert labels("syn¦")["sync"].snippet == "sync()"
        assert labels("set¦")["set_tool_voltage"].snippet == "set_tool_voltage(${1|0,12,24|})"

    def test_clients_without_snippets_get_the_name(self):
        assert labels("mov¦")["movel"].text == "movel"

    def test_brackets_that_are_there_already_are_not_added(self):
        assert labels("mov¦([0], a=1)")["movel"].snippet == ""
        assert labels("def f(a):\n  sync()\nend\nf¦(1)")["f"].snippet == ""

    def test_the_word_is_replaced_as_a_whole(self):
        item = labels("x = mo¦vej(q)")["movel"]
        assert item.span == (1, 5, 1, 10)

    def test_an_equals_sign_that_is_there_already_is_not_added(self):
        assert labels("movej(q, ¦=1)")["a="].text == "a"
        assert labels("movej(q, ¦)")["a="].text == "a="

    def test_a_name_in_a_string_replaces_what_is_in_the_quotes(self):
        item = labels('set_gp_boolean_input_action(0, "free¦drive")')["default"]
        assert item.span == (1, 33, 1, 42)
        item = labels('set_gp_boolean_input_action(0, "free¦ + x')["freedrive"]
        assert item.span == (1, 33, 1, 37)

    def test_an_own_function_has_places_for_its_required_parameters(self):
        item = labels(at("x = ra¦"))["raised"]
        assert (item.snippet, item.detail, item.kind) == (
            "raised(${1:pose})",
            "raised(pose, height=0.1)",
            ItemKind.FUNCTION,
        )
        assert "The pose, higher." in resolved(item).documentation

    def test_a_function_for_a_thread_is_not_called(self):
        assert labels(at("start_thread(¦"))["watch"].snippet == ""

    @pytest.mark.parametrize(
        ("name", "detail"),
        [
            ("HOME", "[0, -1.57, 1.57, -1.57, -1.57, 0]"),
            ("SPEED", "0.25"),
            ("name", "'abc'"),
            ("parts", "global 0"),
        ],
    )
    def test_a_name_shows_its_value(self, name, detail):
        assert labels(at("¦"))[name].detail == detail

    @pytest.mark.parametrize(
        ("text", "detail"),
        [
            ("x = get_actual_joint_positions()\n¦", "variable: joint positions, measured"),
            ("x = get_actual_tcp_pose()\n¦", "variable: pose in the base frame, measured"),
            ("x = [0, 0, 0, 0, 0, 1]\nmovej(x)\n¦", "joints [0, 0, 0, 0, 0, 1]"),
            ("x = input_value\n¦", "variable"),
            ("def f(x):\n  ¦\nend\n", "parameter of f"),
            ("for x in (1, 2):\n  ¦\nend\n", "loop variable: 1 or 2"),
            ("import math as x\n¦", "module math"),
        ],
    )
    def test_a_name_shows_what_it_is(self, text, detail):
        assert labels(text)["x"].detail == detail

    @pytest.mark.parametrize(
        ("call", "first"),
        [
            ("movel(¦", ["goal", "near"]),
            ("pose_trans(¦", ["goal", "near"]),
            ("movel(near, r=¦", ["height", "speed"]),
            ("movej(¦", ["home"]),
            ("movej(home, t=¦", ["speed"]),
            ("set_standard_digital_out(0, ¦", ["is_on"]),
            ("textmsg(str_cat(¦", ["answer"]),
            ("socket_open(¦", ["answer"]),
            ("join_thread(¦", ["worker"]),
        ],
    )
    def test_names_that_fit_an_argument_come_first(self, call, first):
        text = (
            "near = get_actual_tcp_pose()\ngoal = pose_trans(near, [0, 0, 0.1, 0, 0, 0])\nheight = near[2]\n"
            "home = get_actual_joint_positions()\nforces = get_tcp_force()\nis_on = get_flag(0)\nspeed = float('1')\n"
            "answer = socket_read_string()\nworker = start_thread(halt, ())\n"
        )
        own = ["answer", "forces", "goal", "height", "home", "is_on", "near", "speed", "worker"]
        listed = [item.label for item in completions(*marked(text + call)) if item.label in own]
        assert listed[: len(first)] == first

    def test_commands_of_newer_firmware_are_marked_and_last(self):
        items = completions(*marked("¦", Settings(profile=PROFILES["2.10"])))
        newer = next(item for item in items if item.label == "join_thread")
        assert (newer.is_missing, newer.detail) == (True, "needs firmware 2.14")
        assert items.index(newer) > items.index(next(item for item in items if item.label == "movej"))
        assert not labels("¦", Settings(profile=NEWEST))["join_thread"].is_missing

    def test_a_secondary_program_is_warned_of_commands_that_wait(self):
        assert labels("sec s():\n  ¦\nend")["movej"].detail == "not in secondary programs"

    def test_names_beside_the_robot_are_offered(self):
        settings = Settings(names={"connection": ("scale",), "address": ("10.0.0.7",), "file": ("seam.txt",)})
        assert "scale" in labels('socket_close("¦")', settings)
        assert "10.0.0.7" in labels('socket_open("¦")', settings)
        assert labels('load_micro_line_file("¦")', settings)["seam.txt"].kind is ItemKind.FILE

    def test_globals_that_have_a_value_before_the_program_are_offered(self):
        found = labels("x = ¦", Settings(presets=frozenset({"tray", "x"})))
        assert found["tray"].detail == "global"

    def test_remains_of_python_2_are_marked(self):
        found = labels("x = ¦")
        assert [name for name, item in found.items() if item.is_deprecated] == ["long", "unichr"]

    def test_blocks_follow_the_indentation_of_the_text(self):
        wide = labels("def job():\n    sync()\n    ¦\nend\n")["while … end"].snippet
        assert wide == "while ${1:True}:\n    ${0:sync()}\nend"
        narrow = labels("¦")["while … end"].snippet
        assert narrow == "while ${1:True}:\n  ${0:sync()}\nend"


class TestOrder:
    def order(self, text: str) -> list[str]:
        return [item.label for item in completions(*marked(text))]

    def test_nearer_names_come_first_then_commands_then_python(self):
        text = "outer = 1\ndef f(a):\n  near = 2\n  ¦\nend\n"
        found = self.order(text)
        order = [found.index(name) for name in ("near", "outer", "movej", "range", "while … end", "while")
                 if name in found]  # fmt: skip
        assert order == sorted(order)
        assert len(order) >= 5

    def test_values_come_before_arguments_and_these_before_names(self):
        found = self.order("x = 1\nset_tool_voltage(¦)")
        order = [found.index(name) for name in ("0", "12", "24", "voltage=", "x", "movej")]
        assert order == sorted(order)

    def test_arguments_come_in_their_order(self):
        found = [label for label in self.order("movej(q, ¦)") if label.endswith("=")]
        assert found == ["a=", "v=", "t=", "r="]

    def test_names_of_the_wanted_kind_come_first(self):
        found = self.order("a = 1\nz = get_actual_joint_positions()\nmovej(¦)")
        assert found.index("z") < found.index("a")


class TestDocumentation:
    def test_nothing_is_computed_before_it_is_asked_for(self):
        assert {item.documentation for item in completions(*marked("¦"))} == {""}

    @pytest.mark.parametrize(
        ("text", "label", "part"),
        [
            ("mov¦", "movej", "**[rad/s^2]**"),
            ("movej(q, ¦)", "v=", "leading joint"),
            ("¦", "if … end", "Runs its block"),
            ("x = ¦", "len", "number of items"),
            ("import ¦", "math", "mathematical"),
            ("import math\nmath.¦", "sin", "sine"),
            ("'a'.¦", "upper", "uppercase"),
        ],
    )
    def test_it_explains(self, text, label, part):
        assert part in resolved(labels(text)[label]).documentation

    def test_an_item_without_more_stays_as_it_is(self):
        item = labels("x = 1\n¦")["x"]
        assert resolved(item) is item


COMMANDS = [CATALOGUE.get(name) for name in CATALOGUE.names()]


def problems(text: str) -> list[str]:
    found = Document("cell.script", text, 0, Settings(profile=NEWEST)).problems
    # The newest simulated firmware may lack a command.
    return [str(problem) for problem in found if problem.code != "E302" and problem.severity != "note"]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
class TestEveryCommand:
    def test_what_is_inserted_is_a_call_that_check_accepts(self, command: Command):
        item = labels(f"def job():\n  {command.name}¦\nend\n", Settings(profile=NEWEST))[command.name]
        call = plain_text(item.snippet)
        names = {param.name: sample(command, param) for param in command.params if param.is_required}
        places = re.findall(r"\$\{\d+:(\w+)\}", item.snippet)
        given = [f"  {name} = {names[name]}\n" for name in places if names[name] != "work"]
        given += [f"  def {name}():\n    sleep(1)\n  end\n" for name in places if names[name] == "work"]
        result = f"  value = {call}\n  textmsg(value)\n" if command.details.returns_text else f"  {call}\n"
        text = f"def job():\n{''.join(given)}{result}end\n"
        if not item.snippet.endswith("($0)"):
            assert problems(text) == []

    def test_its_example_is_a_call_that_check_accepts(self, command: Command):
        lines = "".join(f"  {line}\n" for line in example(command).split("\n"))
        used = "".join(f"  textmsg({name})\n" for name in ("value", "handle") if f"  {name} = " in lines)
        assert problems(f"def job():\n{lines}{used}end\n") == []


@pytest.mark.parametrize("label", [item.label for item in completions(*marked("¦")) if item.kind is ItemKind.SNIPPET])
def test_every_block_parses_as_it_is_inserted(label):
    item = labels("¦")[label]
    text = f"{item.text}\n"
    found = [problem for problem in Document("cell.script", text).problems if problem.is_error]
    assert found == []
