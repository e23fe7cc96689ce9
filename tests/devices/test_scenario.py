"""World files: what they declare, and where a mistake is."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.devices.scenario import KINDS
from elitescript.errors import UsageError
from elitescript.world_file import WORLD_SECTIONS, load_world_file
from tests.devices.programs import run

CLASSES = """
from __future__ import annotations

from dataclasses import dataclass

from elitescript.testing.world import Device, ModbusDevice, SerialDevice, TcpServer, XmlRpcServer


@dataclass
class Pose:
    x: float


class Camera(TcpServer):
    offset = 1

    def line_received(self, connection, line):
        return str(Pose(self.offset).x)


class Button(Device):
    input = "standard_digital_in[0]"

    def started(self):
        self.cell.set(self.input, True, after_s=0.5)


class Explosive(Device):
    def check(self):
        raise ValueError("boom")
"""


@pytest.fixture
def file(tmp_path):
    (tmp_path / "cell.py").write_text(CLASSES)
    (tmp_path / "broken.py").write_text("import nothing_of_that_name\n")

    def write(text):
        path = tmp_path / "cell.toml"
        path.write_text(text)
        return path

    return write


def run_with(path, body):
    found = run(body, robot=VirtualRobot("CS66", world=path))
    return [text.strip() for text in found.log], found


def ask(*questions):
    lines = ['socket_open("h", 5000)']
    for question in questions:
        lines += [f'socket_send_line("{question}")', 'textmsg(socket_read_string("socket_0", "", "", 1.0))']
    return "\n".join(lines)


def test_replies_by_text_pattern_sequence_and_expression(file):
    path = file(r"""
[[tcp]]
port = 5000
greeting = "hello"
otherwise = "what?"
replies = [
  { to = "where?", send = ["1", "2"] },
  { match = "item (\\d+) of (\\w+)", send = "\\2:\\1" },
  { to = "force?", expression = "standard_analog_out[0] * 10" },
  { match = "double (\\d+)", expression = "int(groups[0]) * 2" },
  { to = "late", send = "now", after_s = 0.5 },
]
""")
    body = 'set_standard_analog_out(0, 0.5)\nsocket_open("h", 5000)\ntextmsg(socket_read_string())\n' + ask(
        "where?", "where?", "where?", "item 7 of box", "force?", "double 21", "late", "nonsense"
    )
    assert run_with(path, body)[0] == ["hello", "1", "2", "2", "box:7", "50.0", "42", "now", "what?"]


def test_a_reply_sets_signals_and_closes(file):
    path = file("""
[[tcp]]
port = 5000
replies = [
  { to = "grip", set = { "standard_digital_in[1]" = true }, after_s = 0.2 },
  { to = "bye", send = "bye", close = true },
]
""")
    body = """
socket_open("h", 5000)
socket_send_line("grip")
sleep(0.1)
textmsg(get_standard_digital_in(1))
sleep(0.2)
textmsg(get_standard_digital_in(1))
socket_send_line("bye")
textmsg(socket_read_string())
sleep(0.1)
textmsg(socket_is_connected())
"""
    assert run_with(path, body)[0] == ["False", "True", "bye", "False"]


def test_a_question_without_a_reply_is_a_warning(file):
    found = run_with(file("[[tcp]]\nname = 'camera'\nport = 5000\n"), ask("where?"))[1]
    assert found.warnings == ["camera: has no reply to 'where?'"]


def test_procedures_are_constants_expressions_and_faults(file):
    path = file("""
[[rpc]]
port = 8000
[rpc.procedures]
ready = true
pose = [0.1, 0.2]
add = { expression = "a + b", arguments = ["a", "b"] }
level = { expression = "standard_digital_out[3]", after_s = 0.5 }
fail = { fault = 3, text = "no part" }
settings = { speed = 3 }
""")
    body = """
s = rpc_factory("xmlrpc", "http://h:8000")
textmsg(s.ready(), s.pose(), s.add(1, 2), s.level(), s.settings())
for call in [s.fail, s.add]:
  try:
    call()
  except Exception as error:
    textmsg(error)
  end
end
"""
    log, _ = run_with(path, body)
    assert log[0] == "True[0.1, 0.2]3False{'speed': 3}"
    assert "fault 3: no part" in log[1]
    assert "takes 2 arguments, not 0" in log[2]


def test_a_modbus_device_reacts_and_follows(file):
    path = file("""
[[modbus]]
line = "tool"
unit = 9
holding_registers = 4
reactions = [
  { write = "holding_registers[0]", set = "input_registers[0]", value = "value * 2", after_s = 0.2 },
  { write = "holding_registers[0]", set = "standard_digital_in[2]", value = "value > 3" },
  { write = "holding_registers[1]", set = "coils[7]", when = "value == 5", value = 1 },
]
follows = { "discrete_inputs[0]" = "standard_digital_out[2]" }
""")
    body = """
tool_serial_config(True, 115200, 0, 1, 8, True)
set_standard_digital_out(2, True)
tool_modbus_write_single_register(9, 0, 4)
sleep(0.01)
textmsg(get_standard_digital_in(2), tool_modbus_read_input_registers(9, 0, 1))
sleep(0.3)
textmsg(tool_modbus_read_input_registers(9, 0, 1), tool_modbus_read_input_bits(9, 0, 1))
tool_modbus_write_single_register(9, 1, 4)
textmsg(tool_modbus_read_bits(9, 7, 1))
tool_modbus_write_single_register(9, 1, 5)
textmsg(tool_modbus_read_bits(9, 7, 1))
"""
    assert run_with(path, body)[0] == ["True[0]", "[8][1]", "[0]", "[1]"]


def test_a_serial_device_answers_and_talks_by_itself(file):
    path = file("""
[[serial]]
line = "box"
replies = [{ to = "W", send = "1.25" }]
every_s = 0.1
unasked = ["a", "b"]
""")
    body = """
serial_config(True, 115200, 0, 1)
sleep(0.35)
textmsg(serial_read(64, False, 0.01))
serial_write("W\\n")
textmsg(serial_read(5, False, 0.05))
"""
    assert run_with(path, body)[0] == ["b'a\\nb\\nb\\n'", "b'1.25\\n'"]


def test_a_class_of_a_file_beside_takes_the_other_keys_as_settings(file):
    path = file("""
[[tcp]]
class = "cell.py:Camera"
port = 5000
offset = 5

[[device]]
class = "cell.py:Button"
input = "standard_digital_in[4]"
""")
    log, _ = run_with(path, ask("x") + "\nsleep(1)\ntextmsg(get_standard_digital_in(4))")
    assert log == ["5", "True"]


def test_one_file_has_everything(file):
    path = file("""
[world]
seed = 4
[signals]
"standard_digital_in[5]" = true
[safety]
tcp_speed = 0.7
[[wire]]
when = "standard_digital_in[5]"
then = "standard_digital_in[6]"
[[schedule]]
signal = "standard_digital_in[7]"
at = [[0.5, true]]
[[parts]]
counts_per_m = 1000
pitch_m = 0.2
[[fault]]
kind = "drop"
on = "tool"
""")
    robot = VirtualRobot("CS66", world=path)
    found = run("sleep(1)", robot=robot)
    assert {found.signals[f"standard_digital_in[{index}]"] for index in (5, 6, 7)} == {True}
    assert load_world_file(path).world.seed == 4
    assert len(load_world_file(path).world.faults) == 1


@pytest.mark.parametrize("text", ["[[wire]]\nwhen='flag[0]'\nthen='flag[1]'", "[[tcp]]\nport=5", "[world]"])
def test_a_world_is_closed_only_if_it_says_so(file, text):
    assert not load_world_file(file(text)).world.is_closed
    text = text.replace("[world]", "")
    assert not load_world_file(file(f"[world]\nnetwork = 'real'\n{text}")).world.is_closed
    assert load_world_file(file(f"[world]\nnetwork = 'virtual'\n{text}")).world.is_closed


def test_every_section_is_read():
    assert set(WORLD_SECTIONS) == {"world", *KINDS}


MISTAKES = [
    ("[[tcp]]\nport = 1\n\n[[tcp]]\nport = 'x'", 5, "[[tcp]] 2: port: must be a whole number"),
    ("[[tcp]]\n", 1, "[[tcp]] 1: port: is missing"),
    ("[[tcp]]\nport = 5000\nlatncy_s = 3", 3, "[[tcp]] 1: latncy_s: is not known; settings are name, port"),
    ("[[tcp]]\nport = 5\n[[rpc]]\nport = 5\nprocedures = { a = 1 }", 4, "[[rpc]] 1: port: 5 is taken by tcp 1 already"),
    ("[[tcp]]\nport = 3\nreplies = 'all'", 3, "[[tcp]] 1: replies: write a list of tables"),
    ("[[tcp]]\nport = 3\nreplies = [{ to = 'a' }]", 3, "replies: row 1: send: say what happens"),
    ("[[tcp]]\nport = 3\nreplies = [{ send = 'a' }]", 3, "replies: row 1: to: give either to"),
    ("[[tcp]]\nport = 3\nreplies = [{ match = '(', send = 'a' }]", 3, "row 1: match: '(' is no regular expression"),
    ("[[tcp]]\nport = 3\nreplies = [{ to = 'a', send = 1 }]", 3, "row 1: send: write a text"),
    ("[[tcp]]\nport = 3\nreplies = [{ to = 'a', sned = 'b' }]", 3, "row 1: sned: is not known"),
    (
        "[[tcp]]\nport = 3\nreplies = [{ to = 'a', expression = 'x' }]",
        3,
        "row 1: expression: 'x': nothing is called 'x'",
    ),
    ("[[tcp]]\nport = 3\nreplies = [{ to = 'a', set = { x = 1 } }]", 3, "row 1: set: no signal is called 'x'"),
    (
        "[[tcp]]\nport = 3\nreplies = [{ match = 'a', send = '\\1' }]",
        3,
        "row 1: send: '\\\\1' does not go with match 'a'",
    ),
    ("[[tcp]]\nport = 3\nreplies = [{ match = 'a', send = '\\g<x>' }]", 3, "which has 0 groups"),
    (
        "[[tcp]]\nport = 3\nencoding = 'ascii'\nreplies = [{ to = 'a', send = 'é' }]",
        4,
        "row 1: send: 'é' has 'é', which",
    ),
    ("[[tcp]]\nport = 3\nencoding = 'ascii'\notherwise = 'é'", 4, "[[tcp]] 1: otherwise: 'é' has"),
    ("[[serial]]\nline = 'tool'\nevery_s = 1\nunasked = ['é']", 4, "[[serial]] 1: unasked: 'é' has"),
    ("[[tcp]]\nport = 3\nclass = 'cell.py'", 3, "class: write file and class"),
    ("[[tcp]]\nport = 3\nclass = 'none.py:X'", 3, "class: there is no file"),
    ("[[tcp]]\nport = 3\nclass = 'cell.py:X'", 3, "class: cell.py has no class X"),
    ("[[tcp]]\nport = 3\nclass = 'cell.py:Button'", 3, "class: Button must be made of TcpServer"),
    ("[[tcp]]\nport = 3\nclass = 'broken.py:X'", 3, "broken.py:1: ModuleNotFoundError"),
    ("[[tcp]]\nport = 3\nclass = 5", 3, "class: write file and class"),
    ("[[wire]]\nclass = 'cell.py:Button'", 2, "[[wire]] 1: class: is not possible here"),
    ("[[device]]\nname = 'x'", 1, "[[device]] 1: class: name one"),
    ("[[device]]\nclass = 'cell.py:Explosive'", 2, "class: cell.py:Explosive cannot be made: ValueError: boom"),
    ("[[rpc]]\nport = 3", 1, "[[rpc]] 1: procedures: write a table"),
    (
        "[[rpc]]\nport = 3\nprocedures = { a = { expression = '?' } }",
        3,
        "procedures: a: expression: '?' is no expression",
    ),
    ("[[modbus]]\nunit = 3", 1, "[[modbus]] 1: port: give either a port"),
    ("[[modbus]]\nport = 3\ncoils = 'x'", 3, "[[modbus]] 1: coils: write a list"),
    ("[[modbus]]\nport = 3\nreactions = [{ write = 'coils[0]' }]", 3, "reactions: row 1: set: must be a text"),
    ("[[modbus]]\nport = 3\nreactions = [{ write = 'x', set = 'coils[0]' }]", 3, "row 1: write: write a place such as"),
    ("[[modbus]]\nport = 3\nfollows = { x = 'flag[0]' }", 3, "follows: write a place such as"),
    (
        "[[modbus]]\nport = 3\nholding_registers = 8\nreactions = [{ write='holding_registers[8]', set = 'flag[0]' }]",
        4,
        "row 1: write: holding_registers[8] does not exist",
    ),
    (
        "[[modbus]]\nport = 3\ncoils = 1\nreactions = [{ write = 'coils[0]', set = 'coils[1]' }]",
        4,
        "row 1: set: coils[1] does not exist",
    ),
    ("[[modbus]]\nport = 3\ncoils = 1\nfollows = { 'coils[1]' = 'flag[0]' }", 4, "follows: coils[1] does not exist"),
    ("[[modbus]]\nport = 3\ncoils = [0, 2]", 3, "coils: the value at address 1 must be in [0, 1], got 2"),
    ("[[wire]]\nwhen = 'flag[0]'", 1, "[[wire]] 1: then: is missing"),
    ("[[wire]]\nthen = 'flag[0]'", 1, "[[wire]] 1: when: write an expression"),
    ("[[schedule]]\nat = [[1, true]]", 1, "[[schedule]] 1: signal: is missing"),
    ("[[serial]]\nbaud = 9600", 1, "[[serial]] 1: line: the robot has no serial port ''"),
    ("[[serial]]\nline = 'tool'\nevery_s = 1", 1, "[[serial]] 1: unasked: goes with every_s"),
    ("[[wire]]\nwhen = 'bla[0]'\nthen = 'flag[0]'", 2, "[[wire]] 1: when: 'bla[0]': no signal is called 'bla'"),
    ("[[schedule]]\nsignal = 'flag[0]'\nat = [[1, 2]]", 3, "[[schedule]] 1: at: flag[0] takes True or False, not 2"),
    ("[[parts]]\ncounts_per_m = 3", 1, "[[parts]] 1: pitch_m: give either pitch_m or every_s"),
    ("[[fault]]\non = 3", 1, "[[fault]] 1: kind: is missing"),
    ("[[fault]]\nkind = 'drop'\non = 3\nwhen = 3", 4, "[[fault]] 1: when: is not known"),
    ("[[fault]]\nkind = 'refuse'\non = 'tool'", 2, "[[fault]] 1: kind: refuse on 'tool': a serial line cannot refuse"),
    ("[[fault]]\nkind = 'drop'\non = 3\n[[fault]]\nkind = 'reconnect'\non = 3", 5, "[[fault]] 2: kind: reconnect on 3"),
    (
        "[[tcp]]\nport = 3\n[[fault]]\nkind = 'wrong_reply'\non = 3\nform = 'unit'",
        6,
        "[[fault]] 1: form: unit on 3: tcp 1 there speaks no MODBUS",
    ),
    ("[tcp]\nport = 3", 1, "[[tcp]] must be a list of tables"),
    ("[world]\nseed = 'x'", 2, "[world] seed: must be a whole number"),
    ("[world]\nnetwork = 'moon'", 2, "[world] network: must be virtual or real"),
    ("[world]\nsead = 3", 2, "[world] sead: is not known"),
    ("world = 3", 1, "[world] must be a table"),
    ("[wrld]", 1, "[wrld] is not known; there are [safety]"),
]


@pytest.mark.parametrize("text, line, words", MISTAKES)
def test_a_mistake_has_file_line_place_and_words(file, text, line, words):
    path = file(text)
    with pytest.raises(UsageError) as caught:
        load_world_file(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert words in str(caught.value)
