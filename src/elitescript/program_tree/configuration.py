"""What stands beside a task: the configuration (tools, payload, inputs and outputs, frames) and its variables."""

from __future__ import annotations

from typing import Final

from elitescript.program_tree.cells import Pose, number_text, six
from elitescript.program_tree.xml_text import Document, Element, TaskFileError, made, read_document, written
from elitescript.records import record
from elitescript.said import said


@record
class GlobalVariable:
    """A variable of the configuration: its value is the text of a literal."""

    name: str
    value: str = ""
    remarks: str = ""


@record
class Tool:
    """A tool with its TCP, m and rad in the flange frame; `number_texts` are its six numbers as the file has them."""

    name: str
    tcp: Pose | None
    number_texts: tuple[str, ...] = ()


@record
class Frame:
    """A frame of the user in the base frame; None: it has no value."""

    name: str
    pose: Pose | None


@record
class Pins:
    """Names of inputs and outputs that users have given: the group and the number of each.

    A group is `standard_digital_in`, `tool_analog_out`, `input_boolean_register` and the like.
    """

    by_name: tuple[tuple[str, str, int], ...] = ()

    def find(self, name: str) -> tuple[str, int] | None:
        """Return group and number of a name that a user gave."""
        for given, group, number in self.by_name:
            if given == name:
                return group, number
        return None


@record
class Configuration:
    """What scripts of all tasks of an installation begin with.

    Attributes:
        tool_lines: statements for the tool's inputs and outputs; `setup_lines` for TCP, payload and signals.
        tools: by the order of the file; `active_tool` is the name of the one that is set.
        frames: of the user.
        pins: names of inputs and outputs.
        notes: what it has that gives no line, for reports.
    """

    tool_lines: tuple[str, ...] = ()
    setup_lines: tuple[str, ...] = ()
    tools: tuple[Tool, ...] = ()
    active_tool: str = ""
    frames: tuple[Frame, ...] = ()
    pins: Pins = Pins()
    notes: tuple[str, ...] = ()

    def tool(self, name: str) -> Tool | None:
        """Return a tool by its name."""
        return next((tool for tool in self.tools if tool.name == name), None)

    def frame(self, name: str) -> Frame | None:
        """Return a frame of the user by its name."""
        return next((frame for frame in self.frames if frame.name == name), None)


# ---------------------------------------------------------------- variables


def read_variables(data: bytes, name: str = "the file") -> tuple[GlobalVariable, ...]:
    """Read an `INST.configuration.variables` file.

    Raises:
        TaskFileError: it is not such a file; with line and column.
    """
    document = read_document(data, name)
    if document.root.name != "VariablesManager":
        raise _other(name, document, "VariablesManager", "variables of a configuration")
    return tuple(
        GlobalVariable(given["name"], given.get("value", ""), given.get("remarks", ""))
        for given in (element.attributes for element in document.root.elements if element.name == "Variable")
        if given.get("name")
    )


def with_values(data: bytes, values: dict[str, str], name: str = "the file") -> bytes:
    """Return the file with other values of variables, all else as it was; new variables stand last."""
    document = read_document(data, name)
    root = document.root
    missing = dict(values)
    for index, element in enumerate(root.elements):
        value = missing.pop(element.attributes.get("name", ""), None)
        if element.name == "Variable" and value is not None:
            root = root.with_replaced(index, element.with_attribute("value", value))
    for variable, value in missing.items():
        element = made("Variable", {"name": variable, "value": value, "remarks": "", "favorite": "false"})
        root = root.with_child(len(root.elements), element, "  ")
    return written(Document(document.front, root, document.behind))


# ---------------------------------------------------------------- configuration


def read_configuration(data: bytes, name: str = "the file") -> Configuration:
    """Read an `INST.configuration` file; what is missing in it gives no line.

    Raises:
        TaskFileError: it is not such a file; with line and column.
    """
    document = read_document(data, name)
    root = document.root
    if root.name != "ConfigurationSettings":
        raise _other(name, document, "ConfigurationSettings", "configuration")
    parts = {element.name: element for element in root.elements}
    notes: list[str] = []
    tools, active = _tools(parts.get("ToolsManager"))
    setup: list[str] = []
    tool = next((tool for tool in tools if tool.name == active), None)
    if tool is not None and tool.tcp is not None:
        setup.append(f"set_tcp([{', '.join(tool.number_texts)}])")
    setup += _payload(parts.get("PayloadConfigManager"))
    setup += _io(parts.get("IOConfig"), notes)
    setup.append("set_gravity([0.0, 0.0, 9.82])")
    for conveyor in _all(parts.get("ConveyorConfig"), "Conveyor"):
        if conveyor.attributes.get("enabled") == "true":
            notes.append(said("conveyor {id}: its lines are not known", id=conveyor.attributes.get("id", "?")))
    for plugin in _all(parts.get("Extensions"), "Contribution"):
        title = plugin.attributes.get("ConfigurationTitle") or plugin.attributes.get("Name") or plugin.name
        notes.append(said("plugin {title}: its lines are not known", title=title))
    return Configuration(
        tuple(_tool_io(parts.get("ToolIoConfig"))),
        tuple(setup),
        tools,
        active,
        _frames(parts.get("FramesManager")),
        _pins(parts.get("IOConfig")),
        tuple(notes),
    )


_TOOL_LINES: Final = (
    ("toolAnalogWorkMode", "set_tool_analog_io_work_mode"),
    ("toolDigitalWorkMode", "set_tool_digital_io_work_mode"),
    ("toolAnalogInputDomain", "set_tool_analog_input_domain"),
    ("toolAnalogOutputDomain", "set_tool_analog_output_domain"),
)
_PARITIES: Final = {"NONE": "0", "ODD": "1", "EVEN": "2"}
_STOP_BITS: Final = {"ONE": "1", "TWO": "2"}


def _tool_io(element: Element | None) -> list[str]:
    if element is None:
        return []
    given = _flat(element)
    lines = [f"{command}({given[key]})" for key, command in _TOOL_LINES if key in given]
    for row in element.everything():
        if row.name == "digitalIO" and "index" in row.attributes:
            of = row.attributes
            flags = ",".join("True" if of.get(key) == "true" else "False" for key in ("output", "enabled"))
            lines.append(f"set_tool_digital_io_config({of['index']},{of.get('outputMode', '0')},{flags})")
    if "baudRate" in given:
        flag = "True" if given.get("enabled") == "true" else "False"
        rtu = "True" if given.get("modbusRTUMode") == "true" else "False"
        usage = "0" if given.get("usageMode", "SCRIPT") == "SCRIPT" else "1"
        lines.append(
            f"tool_serial_config({flag},{given['baudRate'].removeprefix('BAUD_')},"
            f"{_PARITIES.get(given.get('parity', 'NONE'), '0')},{_STOP_BITS.get(given.get('stopBits', 'ONE'), '1')},"
            f"modbus_rtu = {rtu},usage = {usage})"
        )
    voltage = given.get("toolOutputVoltage", "")
    if voltage.startswith("TOOL_VOLTAGE_"):
        lines.append(f"set_tool_voltage({voltage.removeprefix('TOOL_VOLTAGE_').removesuffix('V')})")
    return lines


def _flat(element: Element) -> dict[str, str]:
    """Return the attributes of an element and those of elements in it, and the texts of elements without attributes."""
    given: dict[str, str] = {}
    for inner in element.everything():
        if inner.name == "digitalIO":
            continue
        for key, value in inner.attributes.items():
            given.setdefault(key, value)
        if not inner.elements and inner.text.strip():
            given.setdefault(inner.name, inner.text.strip())
    return given


def _tools(element: Element | None) -> tuple[tuple[Tool, ...], str]:
    if element is None:
        return (), ""
    active = _value(element, "Active")
    tools: list[Tool] = []
    active_name = ""
    for row in _all(element, "TcpTool"):
        shape = next((inner for inner in row.everything() if inner.name == "ToolShape"), None)
        text = shape.attributes.get("value", "") if shape is not None else ""
        tcp = six(text)
        texts = tuple(number_text(value) for value in tcp) if tcp is not None else ()
        tools.append(Tool(row.attributes.get("name", ""), tcp, texts))
        if active and row.attributes.get("uuid") == active:
            active_name = tools[-1].name
    return tuple(tools), active_name


def _payload(element: Element | None) -> list[str]:
    if element is None:
        return []
    active = _value(element, "Active")
    for row in _all(element, "PayloadConfig"):
        if row.attributes.get("uuid") != active:
            continue
        mass = _value(row, "Mass")
        center = _numbers(_value(row, "CoG"))
        inertia = _numbers(_value(row, "InertiaMatrix"))
        if not mass or len(center) != 3:
            return []
        line = f"set_payload({mass}, [{', '.join(center)}]"
        if len(inertia) == 9:
            # Ixx, Iyy, Izz, Ixy, Ixz, Iyz of the matrix; the order is assumed.
            line += f", [{', '.join(inertia[place] for place in (0, 4, 8, 1, 2, 5))}]"
        return [f"{line})"]
    return []


def _io(element: Element | None, notes: list[str]) -> list[str]:
    if element is None:
        return []
    lines = []
    for key, command in (
        ("analogInputRange", "set_standard_analog_input_domain"),
        ("analogOutputDomain", "set_standard_analog_output_domain"),
    ):
        numbers = _numbers(_value(element, key))
        lines += [f"{command}({place}, {number})" for place, number in enumerate(numbers[:2])]
    for inner in element.everything():
        actions = {*_numbers(inner.attributes.get("value", "") or inner.text)} - {"NONE", ""}
        if inner.name.endswith("Actions") and actions:
            notes.append(said("{name}: the lines of these actions are not known", name=inner.name))
    lines.append("set_input_actions_to_default()")
    return lines


def _frames(element: Element | None) -> tuple[Frame, ...]:
    frames = []
    for row in _all(element, "Frame"):
        transform = next((inner for inner in row.everything() if inner.name == "Transform"), None)
        pose = six(transform.attributes.get("value", "")) if transform is not None else None
        frames.append(Frame(row.attributes.get("name", ""), pose))
    return tuple(frames)


_WORDS: Final = (
    (("configurable", "digital"), "configurable_digital"),
    (("tool", "digital"), "tool_digital"),
    (("tool", "analog"), "tool_analog"),
    (("bool",), "boolean_register"),
    (("int",), "integer_register"),
    (("float",), "float_register"),
    (("double",), "float_register"),
    (("digital",), "standard_digital"),
    (("analog",), "standard_analog"),
)
"""Words in names of elements with names of pins, and the group that they mean, first match first. *Assumed*: the names
of the elements are not public."""


def _pins(element: Element | None) -> Pins:
    if element is None:
        return Pins()
    found: list[tuple[str, str, int]] = []
    for inner in element.everything():
        if not inner.name.endswith("Names"):
            continue
        words = inner.name.lower().replace("input", "in_").replace("output", "out_")
        is_input = "in_" in words
        plain = words.replace("in_", " ").replace("out_", " ")
        group = next((group for needed, group in _WORDS if all(word in plain for word in needed)), "")
        if not group:
            continue
        if group.endswith("register"):
            group = f"{'input' if is_input else 'output'}_{group}"
        else:
            group = f"{group}_{'in' if is_input else 'out'}"
        texts = (inner.attributes.get("value", "") or inner.text).split(",")
        found += [(text.strip(), group, number) for number, text in enumerate(texts) if text.strip()]
    return Pins(tuple(found))


def _all(element: Element | None, name: str) -> list[Element]:
    return [] if element is None else [inner for inner in element.everything() if inner.name == name]


def _value(element: Element, name: str) -> str:
    """Return a value that stands in an attribute, or in an element as its attribute `value` or its text."""
    if name in element.attributes:
        return element.attributes[name].strip()
    for inner in element.elements:
        if inner.name == name:
            return (inner.attributes.get("value") or inner.attributes.get("uuid") or inner.text).strip()
    return ""


def _numbers(text: str) -> list[str]:
    return [part.strip() for part in text.split(",")] if text.strip() else []


def _other(name: str, document: Document, wanted: str, meant: str) -> TaskFileError:
    why = said(
        "this is no {meant}: its outermost element is `{element}`, not `{wanted}`",
        meant=meant,
        element=document.root.name[:60],
        wanted=wanted,
    )
    return TaskFileError(name, why, document.line_of(document.root))
