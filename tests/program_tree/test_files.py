"""Files of strangers: what is kept, what is refused with its place, what is survived."""

from __future__ import annotations

import re
from random import Random
from time import process_time

import pytest

from elitescript.environment.task_files import script_of_data
from elitescript.lint.engine import check_source
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from elitescript.program_tree import (
    TaskFileError,
    generated,
    insert,
    nodes,
    read_configuration,
    read_task,
    read_variables,
    remove,
    rows_of,
    set_enabled,
    task_bytes,
)
from elitescript.program_tree.configuration import with_values
from elitescript.program_tree.kinds import BY_ELEMENT
from elitescript.program_tree.listing import tree_text
from elitescript.records import replace
from tests.program_tree.trees import random_task

ODD = b"""\xef\xbb\xbf<?xml version='1.0' encoding='utf-8'?>
<!-- by hand -->
<EliTask  name = 'cell'  extra="1" robotType="CS66" >
\t<MainTask isTaskAlwaysLoops="false"><!-- here -->
      <FolderNode display='a &quot;b" &#x4e2d;' unknown="kept"><Extra><Deep/></Extra></FolderNode>
      <StrangeNode a="1"><HaltNode/></StrangeNode><HaltNode></HaltNode>
   </MainTask>
   <StrangeNode/>
</EliTask>
<!-- end -->
"""


def test_an_odd_file_is_kept_to_the_byte() -> None:
    assert task_bytes(read_task(ODD)) == ODD


def test_an_edit_of_an_odd_file_leaves_the_rest() -> None:
    task = read_task(ODD)
    marks = ["Robot Main Task", 'a "b" \u4e2d', "Extra", "StrangeNode", "Halt", "StrangeNode"]
    assert [row.mark for row in rows_of(task)] == marks
    new = task_bytes(insert(task, 5, nodes.Wait(duration=0.5)))
    head, _, tail = ODD.partition(b"<HaltNode></HaltNode>")
    assert new.startswith(head)
    assert new.endswith(b"<HaltNode></HaltNode>" + tail)
    assert b"<valueInSi>0.5</valueInSi>" in new


def test_what_is_not_understood_moves_along() -> None:
    task = read_task(ODD)
    new = task_bytes(set_enabled(task, 2, False))
    assert b'<FolderNode display=\'a &quot;b" &#x4e2d;\' unknown="kept">' in new
    assert b"<Deep/>" in new
    assert read_task(new) == set_enabled(task, 2, False)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", ":1:1: no XML"),
        (b"<EliTask>", ":1:10: no XML"),
        (b"<EliTask>\n <a></b>\n</EliTask>", ":2:"),
        (b"<Other/>", ":1: this is no task: its outermost element is `Other`"),
        (b"\n<ConfigurationSettings/>", ":2: this is no task"),
        (b'<!DOCTYPE a [<!ENTITY x "y">]><EliTask>&x;</EliTask>', ":1:13: a task file has no DTD"),
        (b'<!DOCTYPE a SYSTEM "file:///etc/passwd"><EliTask/>', "no DTD"),
        (b"<EliTask>&x;</EliTask>", "no XML"),
        (b"<EliTask>" + b"<a>" * 450 + b"</a>" * 450 + b"</EliTask>", "more than 450 elements"),
        (
            b"<EliTask><MainTask>" + b"<FolderNode>" * 201 + b"</FolderNode>" * 201 + b"</MainTask></EliTask>",
            "200 nodes",
        ),
        ("<EliTask/>".encode("utf-16"), ": the text is UTF-16, not UTF-8"),
        ("<EliTask name='é'/>".encode("latin-1"), ":1: this is not UTF-8"),
        (b"<?xml version='1.0' encoding='gbk'?><EliTask/>", "encoding"),
    ],
)
def test_refused_with_its_place(data: bytes, words: str) -> None:
    with pytest.raises(TaskFileError) as refused:
        read_task(data, "cell.task")
    assert str(refused.value).startswith("cell.task:1") or str(refused.value).startswith("cell.task:2")
    assert words in str(refused.value)


def test_a_reference_that_leads_nowhere_is_said() -> None:
    task = read_task(
        b'<EliTask><MainTask>\n<LoopNode type="LOOP_X_TIMES" loopCount="2"><TaskVariable reference="../../Gone"/>'
        b"</LoopNode></MainTask></EliTask>"
    )
    assert [(row.line, row.text) for row in task.damage] == [
        (2, "`TaskVariable` refers to something that is not there")
    ]
    assert "Loop_2 = 0" in generated(task).text


def test_references_in_a_circle_are_survived() -> None:
    task = read_task(
        b'<EliTask><MainTask><LoopNode><TaskVariable reference="../TaskVariable[2]"/>'
        b'<TaskVariable reference="../TaskVariable"/></LoopNode></MainTask></EliTask>'
    )
    assert len(task.damage) == 2


def test_a_definition_that_is_removed_passes_to_the_next_use() -> None:
    data = (
        b'<EliTask><MainTask><LoopNode type="LOOP_X_TIMES" loopCount="2"><TaskVariable name="n" type="Loop" extra="1"/>'
        b'</LoopNode><AssignmentNode><TaskVariable reference="../../LoopNode/TaskVariable"/></AssignmentNode>'
        b'<AssignmentNode><TaskVariable reference="../../LoopNode/TaskVariable"/></AssignmentNode></MainTask></EliTask>'
    )
    new = task_bytes(remove(read_task(data), 2))
    assert new == (
        b'<EliTask><MainTask><AssignmentNode><TaskVariable name="n" type="Loop" extra="1"/></AssignmentNode>'
        b'<AssignmentNode><TaskVariable reference="../../AssignmentNode/TaskVariable"/></AssignmentNode>'
        b"</MainTask></EliTask>"
    )


def test_a_sub_task_inside_its_first_call() -> None:
    data = (
        b'<EliTask><MainTask><CallSubTaskNode><subTask name="grip"><children><HaltNode/></children></subTask>'
        b'</CallSubTaskNode><CallSubTaskNode><subTask reference="../../CallSubTaskNode/subTask"/></CallSubTaskNode>'
        b'</MainTask><SubTaskNode reference="../MainTask/CallSubTaskNode/subTask"/></EliTask>'
    )
    task = read_task(data)
    assert [row.mark for row in rows_of(task)] == ["Robot Main Task", "grip", "grip", "grip", "Halt"]
    assert (
        '  def subTask_grip():\n    $ LINE: (4, "grip")\n    $ LINE: (5, "Halt")\n    halt()\n  end\n'
        in generated(task).text
    )
    new = task_bytes(remove(remove(task, 5), 2))
    assert new == (
        b'<EliTask><MainTask><CallSubTaskNode><subTask name="grip"><children/></subTask></CallSubTaskNode>'
        b'</MainTask><SubTaskNode reference="../MainTask/CallSubTaskNode/subTask"/></EliTask>'
    )


def test_mutated_files() -> None:
    """Each is read, or refused with its place; what is read is written and generated."""
    random = Random(7)
    whole = [task_bytes(random_task(random, 10)) for _ in range(6)]
    for _ in range(400):
        data = bytearray(random.choice(whole))
        for _ in range(random.randrange(1, 4)):
            place = random.randrange(len(data))
            match random.randrange(4):
                case 0:
                    data[place] = random.randrange(256)
                case 1:
                    del data[place : place + random.randrange(1, 40)]
                case 2:
                    data[place:place] = random.choice((b"<", b"NaN", b"1e999", b'"', b"&#0;", b"<FolderNode>", b"-"))
                case _:
                    data[place : place + 8] = data[place + 20 : place + 40]
        try:
            task = read_task(bytes(data))
        except TaskFileError as error:
            assert ":" in str(error)
            continue
        assert task_bytes(task) == bytes(data)
        generated(task)
        rows_of(task)


# ---------------------------------------------------------------- what stands beside a task

VARIABLES = b"""<VariablesManager>
  <Variable name="home" value="[0.0, -1.5]" remarks="start &amp; end" favorite="false"/>
  <Variable name="n" value="3"/>
</VariablesManager>"""


def test_variables() -> None:
    rows = read_variables(VARIABLES)
    assert [(row.name, row.value, row.remarks) for row in rows] == [
        ("home", "[0.0, -1.5]", "start & end"),
        ("n", "3", ""),
    ]
    assert with_values(VARIABLES, {"n": "4"}) == VARIABLES.replace(b'value="3"', b'value="4"')
    with pytest.raises(TaskFileError, match="this is no variables of a configuration"):
        read_variables(b"<EliTask/>")


CONFIGURATION = b"""<ConfigurationSettings robotType="6212">
  <ToolIoConfig toolAnalogWorkMode="3" toolDigitalWorkMode="0" toolAnalogInputDomain="0" toolAnalogOutputDomain="0"
    enabled="false" baudRate="BAUD_115200"
    parity="NONE" stopBits="ONE" modbusRTUMode="false" usageMode="SCRIPT" toolOutputVoltage="TOOL_VOLTAGE_24V">
    <digitalIO index="0" enabled="false" output="false" outputMode="0"/>
    <digitalIO index="1" enabled="true" output="true" outputMode="2"/>
  </ToolIoConfig>
  <ToolsManager Active="u2">
    <TcpTool name="flange" uuid="u1"><ToolShape value="0.0, 0.0, 0.0, 0.0, 0.0, 0.0"/></TcpTool>
    <TcpTool name="gripper" uuid="u2"><ToolShape value="0.0, 0.0, 0.2, 0.0, 0.0, 0.0"/></TcpTool>
  </ToolsManager>
  <PayloadConfigManager Active="p"><PayloadConfig uuid="p" Mass="1.5" CoG="0.0, 0.0, 0.05"
    InertiaMatrix="1.0, 4.0, 5.0, 4.0, 2.0, 6.0, 5.0, 6.0, 3.0"/></PayloadConfigManager>
  <IOConfig analogInputRange="1, 1, 0" analogOutputDomain="0, 1, 0">
    <standardDigitalInputNames value="start,,part"/></IOConfig>
  <FramesManager><Frame name="table"><Transform value="0.4, 0.1, 0.0, 0.0, 0.0, 0.0"/></Frame></FramesManager>
</ConfigurationSettings>"""


def test_configuration() -> None:
    read = read_configuration(CONFIGURATION)
    assert read.tool_lines == (
        "set_tool_analog_io_work_mode(3)",
        "set_tool_digital_io_work_mode(0)",
        "set_tool_analog_input_domain(0)",
        "set_tool_analog_output_domain(0)",
        "set_tool_digital_io_config(0,0,False,False)",
        "set_tool_digital_io_config(1,2,True,True)",
        "tool_serial_config(False,115200,0,1,modbus_rtu = False,usage = 0)",
        "set_tool_voltage(24)",
    )
    assert read.setup_lines == (
        "set_tcp([0.0, 0.0, 0.2, 0.0, 0.0, 0.0])",
        "set_payload(1.5, [0.0, 0.0, 0.05], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])",
        "set_standard_analog_input_domain(0, 1)",
        "set_standard_analog_input_domain(1, 1)",
        "set_standard_analog_output_domain(0, 0)",
        "set_standard_analog_output_domain(1, 1)",
        "set_input_actions_to_default()",
        "set_gravity([0.0, 0.0, 9.82])",
    )
    assert read.pins.find("part") == ("standard_digital_in", 2)
    assert read.pins.find("") is None
    assert read.frame("table") is not None


def test_preamble_in_its_order() -> None:
    task = read_task(
        b'<EliTask name="a b" installationName="i"><InitVariables/><MainTask isTaskAlwaysLoops="true" '
        b'hasInitVariables="true" typeName="Robot Main Task"><HaltNode typeName="Halt"/></MainTask></EliTask>'
    )
    text = generated(task, read_configuration(CONFIGURATION), read_variables(VARIABLES)).text
    assert (
        text
        == """def a_b():
  # Preamble Script.
  # Test Preamble Script To Be Added In The Future.
  set_safety_mode_transition_hardness(1)
  # Configuration Preamble Script.
  # Configuration variables.
  # start & end
  global home
  home = [0.0, -1.5]
  #\x20
  global n
  n = 3
  set_tool_analog_io_work_mode(3)
  set_tool_digital_io_work_mode(0)
  set_tool_analog_input_domain(0)
  set_tool_analog_output_domain(0)
  set_tool_digital_io_config(0,0,False,False)
  set_tool_digital_io_config(1,2,True,True)
  tool_serial_config(False,115200,0,1,modbus_rtu = False,usage = 0)
  set_tool_voltage(24)
  set_tcp([0.0, 0.0, 0.2, 0.0, 0.0, 0.0])
  set_payload(1.5, [0.0, 0.0, 0.05], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
  set_standard_analog_input_domain(0, 1)
  set_standard_analog_input_domain(1, 1)
  set_standard_analog_output_domain(0, 0)
  set_standard_analog_output_domain(1, 1)
  set_input_actions_to_default()
  set_gravity([0.0, 0.0, 9.82])
  # Frame variables.
  global table
  table = [0.4, 0.1, 0.0, 0.0, 0.0, 0.0]
  # Temporary frame variables.
  # Conveyor Config
  # Set Node Preamble Script.
  # Loop Node Preamble Script.
  # Waypoint Node Preamble Script.
  # Initial Variables value.
  # Timer Node Preamble Script.
  # SubTask Node Preamble Script.
  # Before Start Preamble Script.
  # Thread Node Preamble Script.
  # Event Node Preamble Script.
  # Main Task Script.
  while (True):
    $ LINE: (2, "Robot Main Task")
    $ LINE: (3, "Halt")
    halt()
  end
end
"""
    )


@pytest.mark.slow
@pytest.mark.invariants
def test_many_mutated_files() -> None:
    """Ten thousand files as they may come from anywhere: each is read or refused in a second, in bounded memory."""
    import resource

    random = Random(11)
    whole = [task_bytes(replace(random_task(random, 25), installation="inst")) for _ in range(12)]
    beside = [CONFIGURATION, VARIABLES]
    most = 0.0
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for number in range(10_000):
        data = mutated(random, random.choice(whole))
        files = {
            "cell.task": data,
            "inst.configuration": beside[0] if random.random() < 0.8 else mutated(random, beside[0]),
            "inst.configuration.variables": beside[1] if random.random() < 0.8 else mutated(random, beside[1]),
        }
        start = process_time()
        source, errors = script_of_data("cell.task", files.get)
        most = max(most, process_time() - start)
        if errors:
            assert all(error.line >= 1 and error.text for error in errors)
        elif number % 5 == 0:
            check_source(source, profile(DEFAULT_FIRMWARE), arm=None)
        try:
            task = read_task(data)
        except TaskFileError:
            continue
        assert task_bytes(task) == data
        tree_text(task)
    assert most < 5.0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 150_000  # kB


def mutated(random: Random, data: bytes) -> bytes:
    """Return a file with some damage: other bytes, less, more, parts that have changed places or stand twice."""
    made = bytearray(data)
    for _ in range(random.randrange(1, 5)):
        place = random.randrange(len(made) + 1)
        # Most files stay well formed, and mean something else.
        match random.choice((0, 1, 2, 3, 4, 4, 4, 5, 5, 5, 5, 5, 5, 6, 6, 6, 6)):
            case 0 if place < len(made):
                made[place] = random.randrange(256)
            case 1:
                del made[place : place + random.randrange(1, 60)]
            case 2:
                made[place:place] = random.choice(PIECES)
            case 3:
                made[place : place + 8] = made[place + 20 : place + 40]
            case 4:
                # Whole elements change places, so that what is well formed means something else.
                tags = [found.span() for found in re.finditer(rb"<[A-Za-z][^<>]*/>", made)]
                if len(tags) > 1:
                    (a, b), (c, d) = sorted(random.sample(tags, 2))
                    made[a:d] = made[c:d] + made[b:c] + made[a:b]
            case 5:
                words = [found.span(1) for found in re.finditer(rb'="([^"]*)"', made)]
                if words:
                    a, b = random.choice(words)
                    made[a:b] = random.choice(WORDS)
            case _:
                names = [found.span(1) for found in re.finditer(rb"<([A-Z]\w+)", made)]
                if names:
                    a, b = random.choice(names)
                    made[a:b] = random.choice(NAMES_OF_ELEMENTS)
    return bytes(made)


PIECES = tuple(
    piece.encode("latin-1")
    for piece in (
        "<",
        "NaN",
        "1e999",
        '"',
        "&#0;",
        "<FolderNode>",
        "-",
        "<!DOCTYPE a>",
        "&lol;",
        "<![CDATA[x]]>",
        "\xff",
    )
)
WORDS = tuple(
    word.encode()
    for word in ("", "NaN", "-1", "99999999999", "1e308", "../../..", "__import__", "\u4f60", "true", "x y", "&#10;end")
)
OTHER_ELEMENTS = ("CompressNode", "CompressedNode", "children", "Expression")
NAMES_OF_ELEMENTS = tuple(name.encode() for name in (*BY_ELEMENT, *OTHER_ELEMENTS))
