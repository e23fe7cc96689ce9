"""The API page: the public names of the package, from their signatures and docstrings."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

from tools.markdown import NOTICE, anchor

PUBLIC: Final[dict[str, tuple[str, ...]]] = {
    "elitescript": (),
    "elitescript.testing.world": (),
    "elitescript.controller.views.trace_rows": ("TraceRows",),
    "elitescript.controller.force.contact": ("ContactConfig", "Plane"),
    "elitescript.controller.safety.limits": ("SafetyLimits", "SafetyBounds", "SafetyPlane", "ToolDirection"),
}
"""The public names of each module; all of its `__all__` where none are given."""

MEMBERS: Final[dict[str, str]] = {
    "VirtualRobot": "run start advance pause resume stop interrupt compile submit_secondary at set_start "
    "set_speed fault protective_stop unlock_protective_stop restart_safety tick time_s state current threads",
    "Run": "check time_s globals joints tcp_pose signals trace is_over is_reproducible",
    "TraceRows": "between column times has_actual",
    "PlantConfig": "from_table",
    "Device": "started signal_changed after every log warn random title check",
    "ModbusClient": "read_registers read_coils write_register write_coil",
    "ModbusDevice": "register_written coil_written reading refuse",
    "Parts": "fronts_m",
    "RobotSignals": "time_s read set pulse watch",
    "SerialDevice": "opened received line_received closed send",
    "TcpClient": "opened received line_received closed is_connected connect send close",
    "TcpConnection": "is_open send send_line after close",
    "TcpServer": "opened received line_received closed connections send_to_all disconnect",
    "World": "add fault end_faults",
    "XmlRpcServer": "delayed",
    "ContactConfig": "from_table",
    "SafetyLimits": "from_table bounds",
    "SafetyBounds": "is_empty",
}
"""Public methods and properties by class, in the order of the page. The others serve the package itself."""

INTRODUCTIONS: Final[dict[str, str]] = {
    "elitescript": "`from elitescript import VirtualRobot`: run programs and look at what they did.",
    "elitescript.testing.world": "What is around the robot in a test: devices, wires, schedules, faults. "
    "[Devices beside the robot](../how-to/devices.md) shows them at work.",
    "elitescript.controller.views.trace_rows": "What `Run.trace` is: a sequence of rows.",
    "elitescript.controller.force.contact": "What the TCP can touch; `VirtualRobot(contact=...)`.",
    "elitescript.controller.safety.limits": "What the safety system watches; `VirtualRobot(safety=...)`.",
}

_HEADINGS: Final = {
    "Args": "**Arguments**",
    "Attributes": "**Attributes**",
    "Returns": "**Returns**",
    "Yields": "**Yields**",
    "Raises": "**Raises**",
    "Example": "**Example**",
}
_SECTION: Final = re.compile(rf"^({'|'.join(_HEADINGS)}):$")
_ENTRY: Final = re.compile(r"^(\*{0,2}\w+(?:, \w+)*): (.*)$")
_PAGE: Final = re.compile(r"`docs/([\w/-]+)\.md`")


class Member(NamedTuple):
    """A public method or property of a class."""

    name: str
    signature: str
    doc: str


def api_page() -> str:
    """Write every public class and function with its signature and docstring."""
    lines = [
        "# Python API",
        "",
        NOTICE,
        "Everything that is public, by the module it is imported from. What is not here may change at any time.",
        "[elitescript from Python](../how-to/python.md) shows how it is used.",
    ]
    for module_name in PUBLIC:
        lines += ["", f"- [`{module_name}`](#{anchor(module_name)}): " + ", ".join(_links(module_name))]
    for module_name in PUBLIC:
        lines += ["", f"## {module_name}", "", INTRODUCTIONS[module_name]]
        module = importlib.import_module(module_name)
        for name in names(module_name):
            lines += _section(name, getattr(module, name))
    return "\n".join(lines) + "\n"


def names(module_name: str) -> list[str]:
    """List the public names of a module, without those in underscores."""
    chosen = PUBLIC[module_name] or importlib.import_module(module_name).__all__
    return [name for name in chosen if not name.startswith("_")]


def _links(module_name: str) -> list[str]:
    return [f"[`{name}`](#{name.lower()})" for name in names(module_name)]


def _section(name: str, item: Any) -> Iterator[str]:
    yield from ("", f"### {name}", "")
    if not inspect.isclass(item):
        yield from ("```python", f"def {name}{signature(item)}", "```", "", *markdown(inspect.getdoc(item)))
        return
    arguments = "" if issubclass(item, Exception) else signature(item).replace("(**settings: Any)", "(**settings)")
    yield from ("```python", f"class {name}{arguments}", "```", "")
    public = _public_items()
    bases = [f"[`{base.__name__}`](#{base.__name__.lower()})" for base in item.__mro__[1:] if base in public]
    if bases:
        yield from (f"Is a {', '.join(bases)}.", "")
    yield from markdown(inspect.getdoc(item))
    for member in members(item):
        head = f"{member.name}{member.signature}"
        yield from ("", f"#### {name}.{member.name}", "", "```python", head, "```", "", *markdown(member.doc))


def _public_items() -> set[Any]:
    return {getattr(importlib.import_module(module), name) for module in PUBLIC for name in names(module)}


def members(kind: type) -> list[Member]:
    """Read signature and docstring of the public methods and properties of a class.

    Raises:
        AttributeError: a name of `MEMBERS` that the class does not have.
    """
    return [_member(name, inspect.getattr_static(kind, name)) for name in MEMBERS.get(kind.__name__, "").split()]


def _member(name: str, item: Any) -> Member:
    if isinstance(item, property):
        assert item.fget is not None
        kind = inspect.signature(item.fget).return_annotation
        return Member(name, f": {_text(kind)}", inspect.getdoc(item) or "")
    if isinstance(item, (staticmethod, classmethod)):
        item = item.__func__
    return Member(name, signature(item), inspect.getdoc(item) or "")


def signature(item: Any) -> str:
    """Write the arguments and the result of a function or class, one argument per line where they are many."""
    found = inspect.signature(item)
    shown = [parameter for parameter in found.parameters.values() if parameter.name not in ("self", "cls")]
    parts: list[str] = []
    kinds = [parameter.kind for parameter in shown]
    for index, parameter in enumerate(shown):
        is_first_keyword = parameter.kind is parameter.KEYWORD_ONLY and parameter.KEYWORD_ONLY not in kinds[:index]
        if is_first_keyword and parameter.VAR_POSITIONAL not in kinds:
            parts.append("*")
        parts.append(_parameter(parameter))
    result = "" if inspect.isclass(item) else f" -> {_text(found.return_annotation)}"
    line = f"({', '.join(parts)}){result}"
    if len(line) <= 88:
        return line
    return "(\n" + "".join(f"    {part},\n" for part in parts) + f"){result}"


def _parameter(parameter: inspect.Parameter) -> str:
    stars = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
    kind = "" if parameter.annotation is parameter.empty else f": {_text(parameter.annotation)}"
    default = "" if parameter.default is parameter.empty else f" = {parameter.default!r}"
    return f"{stars}{parameter.name}{kind}{default}"


def _text(annotation: Any) -> str:
    if annotation is inspect.Signature.empty:
        return "None"
    return annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)


def markdown(doc: str | None) -> list[str]:
    """Turn a docstring into Markdown: sections become headings with lists, `>>>` becomes a block of code.

    Args:
        doc: a docstring as `inspect.getdoc` gives it.
    """
    lines: list[str] = []
    section = ""
    for line in (doc or "").splitlines():
        heading = _SECTION.match(line)
        if heading is not None:
            section = heading.group(1)
            lines += [_HEADINGS[section], ""]
        elif section and line.startswith("    "):
            lines.append(_entry(line[4:], section))
        else:
            section = section if not line else ""
            lines.append(line)
    text = _PAGE.sub(lambda found: f"[{found.group(1)}](../{found.group(1)}.md)", "\n".join(lines))
    return _with_fences(text.replace("](../reference/", "](").rstrip()).split("\n")


def _entry(line: str, section: str) -> str:
    entry = _ENTRY.match(line)
    if section in ("Args", "Attributes", "Raises") and entry is not None:
        listed = ", ".join(f"`{name}`" for name in entry.group(1).split(", "))
        return f"- {listed}: {entry.group(2)}"
    return f"  {line.strip()}" if line.startswith("    ") and section != "Example" else line


def _with_fences(text: str) -> str:
    """Put examples of the interactive interpreter, which end at an empty line, into fences."""
    blocks = []
    for block in text.split("\n\n"):
        head, mark, code = block.partition(">>> ")
        blocks.append(f"{head}```pycon\n{mark}{code}\n```" if mark else block)
    return "\n\n".join(blocks)
